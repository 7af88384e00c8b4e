# SPDX-License-Identifier: Apache-2.0
"""Time of a picture in Mitsuba with each BSDF of mxeon, beside Mitsuba's own.

    python -m tools.benchmarks.mitsuba_time

A ball under an even sky, 256 x 256 at 64 samples, in llvm_ad_rgb on one thread: the least processor time of
some pictures, each of a kernel that has been compiled. Writes the table of docs/mitsuba.md.
"""

import re
import time
from importlib import import_module
from pathlib import Path

from mxeon.io.files import write_text
from mxeon.mitsuba import register
from tools.benchmarks.values import mitsuba_version

PAGE = Path(__file__).resolve().parents[2] / "docs" / "mitsuba.md"
BLOCK = re.compile(r"(<!-- time -->\n).*?(<!-- end -->)", re.DOTALL)
SIZE, SAMPLES, PICTURES = 256, 64, 5
COLOR = {"type": "rgb", "value": [0.5, 0.3, 0.2]}
ROUGH = {"reflectance": COLOR, "roughness": 0.6}
BSDFS = {
    "diffuse": {"reflectance": COLOR},
    "eon": ROUGH,
    "principled": {"base_color": COLOR, "roughness": 0.55, "specular": 0.5},
    "roughplastic": {"distribution": "ggx", "diffuse_reflectance": COLOR, "alpha": 0.3},
    "dielectric_over_eon": ROUGH | {"alpha": 0.3, "ior": 1.5},
    "openpbr_base": {
        "base_color": COLOR,
        "base_diffuse_roughness": 0.6,
        "base_metalness": 0.25,
        "specular_roughness": 0.55,
    },
}


def ball(mi, bsdf):
    """A ball with a BSDF under an even sky."""
    look = mi.ScalarTransform4f().look_at(origin=[0, -5, 0], target=[0, 0, 0], up=[0, 0, 1])
    film = {"type": "hdrfilm", "width": SIZE, "height": SIZE, "rfilter": {"type": "box"}}
    return {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": 8},
        "sky": {"type": "constant"},
        "ball": {"type": "sphere", "bsdf": bsdf},
        "sensor": {"type": "perspective", "fov": 30, "to_world": look, "film": film},
    }


def seconds(mi, scenes):
    """Least processor time of a picture of each scene, rendered in turns."""
    times = {name: [] for name in scenes}
    for seed in range(PICTURES + 1):
        for name, scene in scenes.items():
            start = time.process_time()
            mi.render(scene, spp=SAMPLES, seed=seed).numpy()
            times[name].append(time.process_time() - start)
    return {name: min(each[1:]) for name, each in times.items()}


def table():
    """The table of the page."""
    mi = import_module("mitsuba")
    mi.set_variant("llvm_ad_rgb")
    register()
    import_module("drjit").set_thread_count(1)
    times = seconds(
        mi, {name: mi.load_dict(ball(mi, {"type": name} | row)) for name, row in BSDFS.items()}
    )
    head = f"| BSDF, Mitsuba {mitsuba_version()} | seconds | of `diffuse` |\n|---|---|---|\n"
    rows = (f"| `{n}` | {t:.2f} | {t / times['diffuse']:.2f} |\n" for n, t in times.items())
    return head + "".join(rows)


if __name__ == "__main__":
    found = table()
    print(found, end="")
    text = PAGE.read_text(encoding="utf-8")
    write_text(PAGE, BLOCK.sub(lambda match: match[1] + found + match[2], text))
