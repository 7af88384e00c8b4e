# SPDX-License-Identifier: Apache-2.0
"""Render time and noise of Mitsuba with mxeon's BSDFs.

    python -m tools.benchmarks.mitsuba_pictures

The command writes two tables. The table in docs/mitsuba.md has render times of a ball with each
BSDF under a uniform sky. The table in docs/sampling.md compares EON's sampler with cosine-weighted
sampling in scenes with 50 bounces and multiple importance sampling. A time is the least processor
time of several pictures in llvm_ad_rgb, without compilation. The noise is the variance between
independent pictures, averaged over pixels and channels.
"""

import time
from importlib import import_module
from importlib.metadata import version

import numpy as np

from mxeon.io.files import write_text
from mxeon.mitsuba import register
from mxeon.mitsuba.diffuse import EonPlugin, RoughDiffusePlugin, register_plugin
from tools.site import DOCS, with_block

COSINE, EXACT = "eon_by_cosine", "eon"
COLOR = {"type": "rgb", "value": [0.5, 0.3, 0.2]}
ROUGH = {"reflectance": COLOR, "roughness": 0.6}
BSDFS = {
    "diffuse": {"reflectance": COLOR},
    "eon": ROUGH,
    "principled": {"base_color": COLOR, "roughness": 0.55, "specular": 0.5},
    "roughplastic": {"distribution": "ggx", "diffuse_reflectance": COLOR, "alpha": 0.3},
    "dielectric_over_eon": ROUGH | {"alpha": 0.3, "ior": 1.5},
    "varnished": ROUGH | {"alpha": 0.3, "ior": 1.5},
}


class EonByCosinePlugin(RoughDiffusePlugin):
    """EON with cosine-weighted sampling."""

    brdf = staticmethod(EonPlugin.brdf)


def sensor(mi, fov, origin, target, size):
    look = mi.ScalarTransform4f().look_at(origin=origin, target=target, up=[0, 0, 1])
    film = {"type": "hdrfilm", "width": size, "height": size, "rfilter": {"type": "box"}}
    return {"type": "perspective", "fov": fov, "to_world": look, "film": film}


def ball(mi, bsdf):
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 8},
        "sky": {"type": "constant"},
        "ball": {"type": "sphere", "bsdf": bsdf},
        "sensor": sensor(mi, 30, [0, -5, 0], [0, 0, 0], 256),
    }


def eon(plugin, color, roughness):
    reflectance = {"type": "rgb", "value": list(color)}
    return {"type": plugin, "reflectance": reflectance, "roughness": roughness}


def cornell_box(mi, plugin, roughness):
    """Mitsuba's Cornell box with EON on all diffuse surfaces."""
    scene = mi.cornell_box()
    for name, each in scene.items():
        if isinstance(each, dict) and each.get("type") == "diffuse":
            scene[name] = eon(plugin, each["reflectance"]["value"], roughness)
    scene["sensor"]["film"] = sensor(mi, 1, [0, -1, 0], [0, 0, 0], 96)["film"]
    return scene


def balls(mi, plugin, roughness):
    """Three balls on the ground under a uniform sky."""
    clay = {"type": "twosided", "bsdf": eon(plugin, (0.8, 0.8, 0.8), roughness)}
    ground = {"type": "rectangle", "to_world": mi.ScalarTransform4f().scale([20, 20, 1])}
    spheres = {
        f"ball{k + 2}": {"type": "sphere", "center": [1.7 * k, 0, 0.8], "radius": 0.8, "bsdf": clay}
        for k in (-1, 0, 1)
    }
    return {
        "type": "scene",
        "sky": {"type": "constant", "radiance": {"type": "rgb", "value": [1.0, 1.0, 1.0]}},
        "ground": ground | {"bsdf": clay},
        "sensor": sensor(mi, 40, [0, -6, 2.5], [0, 0, 0.6], 96),
    } | spheres


SCENES = {"Cornell box": cornell_box, "three balls under an even sky": balls}


def rendered(mi, scenes, pictures, samples):
    """Pictures and processor times by scene. Scenes take turns, after a warm-up round."""
    found = {name: [] for name in scenes}
    for seed in range(pictures + 1):
        for name, scene in scenes.items():
            start = time.process_time()
            image = np.array(mi.render(scene, spp=samples, seed=seed))[..., :3]
            found[name].append((image, time.process_time() - start))
    return {name: tuple(zip(*each[1:], strict=True)) for name, each in found.items()}


def time_table(mi):
    """Lines of the table in docs/mitsuba.md with the render time of each BSDF."""
    import_module("drjit").set_thread_count(1)
    scenes = {name: mi.load_dict(ball(mi, {"type": name} | row)) for name, row in BSDFS.items()}
    times = {n: min(seconds) for n, (_, seconds) in rendered(mi, scenes, 5, 64).items()}
    yield f"| BSDF, Mitsuba {version('mitsuba')} | seconds | relative to `diffuse` |\n|---|---|---|\n"
    for name, each in times.items():
        yield f"| `{name}` | {each:.2f} | {each / times['diffuse']:.2f} |\n"


def noise_table(mi):
    """Lines of the table in docs/sampling.md that compares cosine sampling with EON's sampler."""
    head = ("roughness", "variance", "time", "variance times time")
    yield f"| cosine / exact, Mitsuba {version('mitsuba')} | {' | '.join(head)} |\n{'|---' * 5}|\n"
    integrator = {"type": "path", "max_depth": 50, "rr_depth": 50}
    for title, make in SCENES.items():
        for roughness in (0.25, 1.0):
            scenes = {
                plugin: mi.load_dict(make(mi, plugin, roughness) | {"integrator": integrator})
                for plugin in (COSINE, EXACT)
            }
            cosine, exact = (
                (np.var(images, axis=0, ddof=1).mean(), min(seconds), np.mean(images))
                for images, seconds in rendered(mi, scenes, 12, 16).values()
            )
            noise, seconds, mean = (a / b for a, b in zip(cosine, exact, strict=True))
            if abs(mean - 1.0) > 0.01:
                raise ValueError(f"{title}: the pictures differ by {mean - 1.0:.3f} of their mean")
            cells = f"{noise:.2f} | {seconds:.2f} | {noise * seconds:.2f}"
            yield f"| {title} | {roughness} | {cells} |\n"


if __name__ == "__main__":
    mi = import_module("mitsuba")
    mi.set_variant("llvm_ad_rgb")
    register()
    register_plugin(mi, COSINE, EonByCosinePlugin)
    # Noise is measured first, because `time_table` permanently limits Mitsuba to one thread.
    for page, mark, rows in (
        ("sampling.md", "mitsuba", noise_table),
        ("mitsuba.md", "time", time_table),
    ):
        found = "".join(rows(mi))
        print(found, end="")
        text = (DOCS / page).read_text(encoding="utf-8")
        write_text(DOCS / page, with_block(text, mark, found))
