# SPDX-License-Identifier: Apache-2.0
"""The part of the `mitsuba` host that runs in Mitsuba's process; see `mxeon.hosts.process`."""

from __future__ import annotations

import math
from collections.abc import Callable
from importlib import import_module
from typing import Any, TypeAlias

import numpy as np

Mitsuba: TypeAlias = Any  # an object of Mitsuba, whose types depend on the variant
JsonObject: TypeAlias = dict[str, Any]

# Names of the BSDFs of `mxeon.mitsuba`.
PLUGINS = ("eon", "fon", "qon")

# Mitsuba's built-in BSDFs run in a scalar variant. PLUGINS run in a compiled variant, because
# Python code is too slow in a scalar variant.
OWN, COMPILED = "scalar_rgb", "llvm_ad_rgb"

mi: Mitsuba = import_module("mitsuba")
mi.set_variant(OWN)
mi.set_log_level(mi.LogLevel.Warn)


def bsdf(material: JsonObject, **inputs: object) -> JsonObject:
    """Properties of a material for Mitsuba. The values of `inputs` replace names in braces."""
    values = {name: inputs.get(str(value).strip("{}"), value) for name, value in material.items()}
    return {
        name: {"type": "rgb", "value": list(value)} if isinstance(value, (list, tuple)) else value
        for name, value in values.items()
    }


def evaluate(material: JsonObject, pairs: str) -> Mitsuba:
    """Values f cos(theta_i) of a BSDF for the pairs of directions in a file, (N, 3)."""
    columns = np.load(pairs)
    if mi.variant() == COMPILED:
        return evaluate_at_once(material, columns)
    context, point = mi.BSDFContext(), mi.SurfaceInteraction3f()
    point.t, point.n, point.sh_frame = 1.0, [0.0, 0.0, 1.0], mi.Frame3f([0.0, 0.0, 1.0])
    rows = []
    names = ("wo", "wi", "color", "roughness")
    for wo, wi, color, roughness in zip(*(columns[name].tolist() for name in names), strict=True):
        made = mi.load_dict(bsdf(material, color=color, roughness=roughness))
        point.wi = wo  # Mitsuba's wi points to the viewer
        rows.append(np.array(made.eval(context, point, wi)))
    return np.array(rows)


def evaluate_at_once(material: JsonObject, columns: JsonObject) -> Mitsuba:
    """Values for all pairs at once in a compiled variant. The inputs are texels of images."""
    inputs = {
        name: {
            "type": "bitmap",
            "data": mi.TensorXf(
                columns[name].astype(np.float32).reshape(1, len(columns["wo"]), -1)
            ),
            "filter_type": "nearest",
            "raw": True,
        }
        for name in ("color", "roughness")
    }
    made = mi.load_dict(bsdf(material, **inputs))
    wo, wi = (mi.Vector3f(columns[name].T.astype(np.float32)) for name in ("wo", "wi"))
    point = mi.SurfaceInteraction3f()
    point.wi = wo
    point.uv = mi.Point2f((np.arange(len(columns["wo"])) + 0.5) / len(columns["wo"]), 0.5)
    return np.array(made.eval(mi.BSDFContext(), point, wi)).T


def render(
    material: JsonObject,
    mesh: str,
    size: int,
    light: list[float] | None,
    environment: float | None,
    samples: int,
) -> Mitsuba:
    """Render the mesh with a BSDF to float32 pixels, row 0 at the top."""
    scene = {
        "type": "scene",
        "integrator": integrator(light is not None),
        "sensor": sensor(size, samples),
        "mesh": polyhedron(mesh, material),
    }
    if light is not None:
        scene["light"] = {
            "type": "directional",
            "direction": [-each for each in light],
            "irradiance": {"type": "rgb", "value": math.pi},
        }
    if environment is not None:
        scene["environment"] = {
            "type": "constant",
            "radiance": {"type": "rgb", "value": environment},
        }
    return np.array(mi.render(mi.load_dict(scene), seed=1))[:, :, :3]


def integrator(distant: bool) -> JsonObject:
    """An integrator for one bounce, which samples a distant light if there is one, or the BSDF."""
    samples = {"emitter_samples": int(distant), "bsdf_samples": int(not distant)}
    return {"type": "direct", "hide_emitters": True, **samples}


def sensor(size: int, samples: int) -> JsonObject:
    """An orthographic camera that looks along -z at [-1, 1]^2, with a linear float32 film."""
    look = mi.ScalarTransform4f().look_at(
        origin=[0.0, 0.0, 2.0], target=[0.0, 0.0, 0.0], up=[0.0, 1.0, 0.0]
    )
    return {
        "type": "orthographic",
        "to_world": look,
        "film": {
            "type": "hdrfilm",
            "width": size,
            "height": size,
            "pixel_format": "rgb",
            "component_format": "float32",
            "rfilter": {"type": "box"},
        },
        "sampler": {"type": "independent", "sample_count": samples},
    }


def polyhedron(path: str, material: JsonObject) -> Mitsuba:
    """Load a mesh without vertex normals, and assign a BSDF to the mesh."""
    data = np.load(path)
    properties = mi.Properties()
    properties["bsdf"] = mi.load_dict(bsdf(material))
    vertices, triangles = data["vertices"], data["triangles"]
    mesh = mi.Mesh("polyhedron", len(vertices), len(triangles), properties)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = vertices.astype(np.float32).ravel()
    parameters["faces"] = triangles.astype(np.uint32).ravel()
    parameters.update()
    return mesh


def start() -> tuple[dict[str, str], Callable[..., None], tuple[type[Exception], ...]]:
    def answer(output: str, material: JsonObject, **request: Any) -> None:
        mi.set_variant(COMPILED if material["type"] in PLUGINS else OWN)
        if material["type"] in PLUGINS:
            import_module("mxeon.mitsuba").register()
        work = evaluate if "pairs" in request else render
        np.save(output, work(material, **request))

    return {"version": mi.__version__}, answer, ()
