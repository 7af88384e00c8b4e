# SPDX-License-Identifier: Apache-2.0
"""Noise of a path tracer with exact samples of EON, and with samples of the cosine, at equal time.

    python -m tools.benchmarks.mitsuba_noise

Mitsuba 3 renders scenes whose surfaces are all EON, with 50 bounces, sampling lights and BSDF by multiple
importance sampling. The variance is that of independent pictures, averaged over pixels and channels;
the time is processor time, of one kernel that has been compiled. Writes the table of docs/sampling.md.
"""

import re
import time
from importlib import import_module
from pathlib import Path

import numpy as np

from mxeon.io.files import write_text
from mxeon.mitsuba import register
from mxeon.mitsuba.diffuse import EonPlugin, RoughDiffusePlugin, register_plugin
from tools.benchmarks.values import mitsuba_version

PAGE = Path(__file__).resolve().parents[2] / "docs" / "sampling.md"
BLOCK = re.compile(r"(<!-- mitsuba -->\n).*?(<!-- end -->)", re.DOTALL)
COSINE, EXACT = "eon_by_cosine", "eon"
SIZE, SAMPLES, PICTURES, BOUNCES = 96, 16, 12, 50
ROUGHNESS = (0.25, 1.0)


class EonByCosinePlugin(RoughDiffusePlugin):
    """EON, sampled by the cosine."""

    brdf = staticmethod(EonPlugin.brdf)


def register_both(mi):
    """The plugins `eon` and `eon_by_cosine`."""
    register()
    register_plugin(mi, COSINE, EonByCosinePlugin)


def eon(kind, color, roughness):
    """A BSDF of Mitsuba."""
    reflectance = {"type": "rgb", "value": list(color)}
    return {"type": kind, "reflectance": reflectance, "roughness": roughness}


def cornell_box(mi, kind, roughness):
    """Mitsuba's Cornell box, whose surfaces are EON."""
    scene = mi.cornell_box()
    for name, each in scene.items():
        if isinstance(each, dict) and each.get("type") == "diffuse":
            scene[name] = eon(kind, each["reflectance"]["value"], roughness)
    return scene


def balls(mi, kind, roughness):
    """Three balls on the ground under an even sky."""
    clay = {"type": "twosided", "bsdf": eon(kind, (0.8, 0.8, 0.8), roughness)}
    look = mi.ScalarTransform4f().look_at(origin=[0, -6, 2.5], target=[0, 0, 0.6], up=[0, 0, 1])
    scene = {
        "type": "scene",
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": [1.0, 1.0, 1.0]}},
        "ground": {
            "type": "rectangle",
            "to_world": mi.ScalarTransform4f().scale([20, 20, 1]),
            "bsdf": clay,
        },
        "sensor": {"type": "perspective", "fov": 40, "to_world": look},
    }
    for k in (-1, 0, 1):
        scene[f"ball{k + 2}"] = {
            "type": "sphere",
            "center": [1.7 * k, 0, 0.8],
            "radius": 0.8,
            "bsdf": clay,
        }
    return scene


SCENES = {"Cornell box": cornell_box, "three balls under an even sky": balls}


def noise_and_time(mi, scene):
    """Mean variance of a pixel, least processor time of a picture, and mean of all pixels."""
    scene["integrator"] = {"type": "path", "max_depth": BOUNCES, "rr_depth": BOUNCES}
    scene["sensor"]["film"] = {
        "type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}
    }  # fmt: skip
    loaded, pictures, seconds = mi.load_dict(scene), [], []
    for seed in range(PICTURES + 1):
        start = time.process_time()
        pictures.append(np.array(mi.render(loaded, spp=SAMPLES, seed=seed))[..., :3])
        seconds.append(time.process_time() - start)
    return np.var(pictures[1:], axis=0, ddof=1).mean(), min(seconds[1:]), np.mean(pictures[1:])


def rows():
    """Scene, roughness, quotients cosine / exact of variance, time and both, and of the means."""
    mi = import_module("mitsuba")
    mi.set_variant("llvm_ad_rgb")
    register_both(mi)
    for title, make in SCENES.items():
        for roughness in ROUGHNESS:
            cosine, exact = (
                noise_and_time(mi, make(mi, kind, roughness)) for kind in (COSINE, EXACT)
            )
            noise, seconds, mean = (a / b for a, b in zip(cosine, exact, strict=True))
            yield title, roughness, noise, seconds, noise * seconds, mean


def table():
    """The table of the page."""
    head = (
        f"| cosine / exact, Mitsuba {mitsuba_version()} | roughness | variance | time | variance times time |\n"
        "|---|---|---|---|---|\n"
    )
    lines = []
    for title, roughness, *quotients, mean in rows():
        if abs(mean - 1.0) > 0.01:
            raise ValueError(f"{title}: the pictures differ by {mean - 1.0:.3f} of their mean")
        cells = " | ".join(f"{each:.2f}" for each in quotients)
        lines.append(f"| {title} | {roughness} | {cells} |\n")
    return head + "".join(lines)


if __name__ == "__main__":
    found = table()
    print(found, end="")
    text = PAGE.read_text(encoding="utf-8")
    write_text(PAGE, BLOCK.sub(lambda match: match[1] + found + match[2], text))
