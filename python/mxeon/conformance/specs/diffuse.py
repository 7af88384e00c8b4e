# SPDX-License-Identifier: Apache-2.0
"""The rough diffuse nodes, each mode with the model it has to be, and the diffuse lobes of surface shaders."""

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from itertools import product
from typing import ClassVar

import numpy as np

from mxeon.conformance.samples import (
    LOBE_RIM,
    TURNED,
    Array,
    Batch,
    Candidate,
    Counts,
    Values,
    directions_at,
)
from mxeon.conformance.spec import CHANGED_COLOR, Input, LobeSpec, color, draw, draw_edges
from mxeon.conformance.tolerance import Term, roundings, sum_in
from mxeon.models import table as reference
from mxeon.models.table import Model
from mxeon.shaders.nodes import (
    EON,
    FLAG,
    OREN_NAYAR,
    document_text,
    input_text,
    material_text,
    node_text,
)

EDGES = (0.0, 1e-6, 1e-3, 1.0)  # of a color channel, and of the roughness in units of the largest
UNIT = "pi f cos"
LOSS_FIT = 2.7e-7  # relative error of the fit of FON's loss H: tools/fits

VALUE = sum_in(
    UNIT,
    roundings(28, "(14, of numbers up to 2)"),
    Term(LOSS_FIT, "two fits of H, times a multiple-scattering part of at most 1/2"),
)
# 12 in the longest chain, two in the cosine, and two for the fit of H, which enters times 0.29.
ENVIRONMENT = sum_in(
    "albedo", roundings(16 * 1.02, "of numbers up to 1.02, the fit of H among them")
)
# In each of two cosines of at least 1/4 five, times 4 by s / t, 3 by a sine, and 2 by s and the cosine.
FRAME = sum_in(
    "pi f cos or albedo",
    roundings(2 * 28, "of two values"),
    roundings(2 * 5 * (1.0 / TURNED[0] + 5.0), "(five in each of two cosines, times 9)"),
)
LAMBERT = sum_in(UNIT, roundings(8))
ERRORS = {
    "value": VALUE,
    "albedo": ENVIRONMENT,
    "frame": FRAME,
    "integral": sum_in("albedo", VALUE.term("an average of values"), exact=True),
    "reciprocity": sum_in("pi f cos cos", *VALUE.terms),
    "lambert": LAMBERT,
}
LOBE_VALUE = sum_in(
    UNIT,
    roundings(16 / LOBE_RIM**2, "of a pixel's point, over the square of the least cosine, 1/4"),
    roundings(32, "in the lobe"),
    roundings(4 * 48, "in sums that other lobes make 48 times as large"),
    exact=True,
)


INPUTS = (
    Input("weight", change=0.5),
    Input("color", "color3", change=CHANGED_COLOR),
    Input("roughness", change=0.3),
    Input("normal", "vector3", change=(0.0, 0.6, 0.8)),
)


def inputs_of(*names: str) -> tuple[Input, ...]:
    return tuple(each for each in INPUTS if each.name in names)


def model_value(batch: Batch, model: str) -> Array:
    """pi f cos(theta_i) of a model or a known defect with weight and occlusion, (N, 3).

    It is 0 for light from below the horizon.
    """
    row = reference.model(model)
    parameter = [batch.inputs["roughness"]] if row.parameter else []
    above = batch.wi * np.where(batch.wi[:, 2:] < 0.0, [1.0, 1.0, -1.0], 1.0)
    value: Array = row.brdf(batch.wo, above, batch.inputs["color"], *parameter)
    occlusion = np.reshape(batch.inputs.get("occlusion", 1.0), (-1, 1))
    return np.pi * value * np.clip(batch.wi[:, 2:], 0.0, 1.0) * (batch.strength * occlusion)


def model_albedo(batch: Batch, model: str) -> Array:
    """Directional albedo of a model or a known defect with weight, (N, 3)."""
    row = reference.model(model)
    parameter = [batch.inputs["roughness"]] if row.parameter else []
    mu = np.minimum(batch.wo[:, 2], 1.0)
    return batch.strength * row.closed_albedo_dir(mu, batch.inputs["color"], *parameter)


@dataclass(frozen=True, eq=False, kw_only=True)
class DiffuseModelSpec(LobeSpec):
    """What has to be a rough diffuse model: a row of `mxeon.models.table`."""

    beside: bool = False  # whether lobes that ignore the color lie beside it

    flat: ClassVar[bool] = True

    @property
    def row(self) -> Model:
        return reference.model(self.model)

    @property
    def other_models(self) -> tuple[Model, ...]:
        """Models beside the common ones that it may be."""
        return ()

    @property
    def value_candidates(self) -> tuple[Candidate, ...]:
        rows = {
            row.brdf: row for row in self.other_models + reference.KNOWN_DEFECTS + reference.MODELS
        }
        rows[self.row.brdf] = self.row
        return self._candidates(rows.values(), model_value)

    @property
    def albedo_candidates(self) -> tuple[Candidate, ...]:
        rows = reference.MODELS + reference.KNOWN_DEFECTS + self.other_models
        return self._candidates((row for row in rows if row.albedo_dir), model_albedo)

    def _candidates(
        self, rows: Iterable[Model], output: Callable[[Batch, str], Array]
    ) -> tuple[Candidate, ...]:
        ordered = sorted(rows, key=lambda row: row.name != self.model)
        return tuple(Candidate(row.title, partial(_limited, row, output)) for row in ordered)

    @property
    def black(self) -> Values:
        return {"color": (0.0, 0.0, 0.0)}

    def value(self, batch: Batch) -> Array:
        return model_value(batch, self.model)

    def albedo(self, batch: Batch) -> Array:
        return model_albedo(batch, self.model)

    @property
    def drawn(self) -> tuple[Input, Input]:
        """Its inputs; no roughness exceeds the model's largest by a rounding."""
        most = np.float32(self.row.largest)
        high = float(most if most <= self.row.largest else np.nextafter(most, np.float32(0.0)))
        edges = tuple(high * each for each in EDGES)
        return color("color", edges=EDGES), Input("roughness", high=high, edges=edges)

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """The last colors are gray."""
        inputs = draw(rng, count, self.drawn)
        inputs["color"][-(count // 16) :] = inputs["color"][-(count // 16) :, :1]
        return inputs

    def special_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        return draw_edges(rng, count, self.drawn)

    def edges(self, counts: Counts) -> Batch:
        cosine = [0.0, 1e-30, 1e-6, 0.5, 1.0]
        rows = product(cosine, cosine, [0.0, 1.0, 2.0, math.pi], [0.0, 1e-6, 1.0], [0.0, 0.5, 1.0])
        mu_o, mu_i, azimuth, roughness, color = np.array(list(rows)).T
        wo, wi = directions_at(mu_o, 0.0), directions_at(mu_i, azimuth)
        return Batch(wo, wi, {"color": np.stack([color] * 3, axis=-1), "roughness": roughness})


def _limited(row: Model, output: Callable[[Batch, str], Array], batch: Batch) -> Array:
    """Output of a model where no roughness exceeds its largest."""
    roughness = np.minimum(batch.inputs["roughness"], row.largest)
    return output(batch.altered(roughness=roughness), row.name)


@dataclass(frozen=True, eq=False, kw_only=True)
class DiffuseSpec(DiffuseModelSpec):
    """A rough diffuse node with its flag."""

    flag: bool | None  # energy_compensation, or None where the node has no such input

    def document(self, inputs: Values | None = None) -> str:
        return material_text(self.node, {**self.fixed, **(inputs or {})}, self.node)


def _diffuse(node: str, flag: bool | None, model: str) -> DiffuseSpec:
    words = "" if flag is None else f", energy_compensation {str(flag).lower()}"
    return DiffuseSpec(
        title=node + words,
        node=node,
        model=model,
        flag=flag,
        inputs=INPUTS if flag is None else (*INPUTS, Input(FLAG, "boolean", change=not flag)),
        fixed={} if flag is None else {FLAG: flag},
        errors=ERRORS,
        along=0.1 if model == "qon" else 0.0,
    )


DIFFUSE = (
    _diffuse(OREN_NAYAR, True, "eon"),
    _diffuse(OREN_NAYAR, False, "qon"),
    _diffuse(EON, None, "eon"),
)


@dataclass(frozen=True, eq=False, kw_only=True)
class SurfaceLobe(DiffuseModelSpec):
    """The diffuse lobe of a surface shader, whose other lobes cannot be switched off.

    What lies over the lobe depends on the directions alone, so that values of other colors tell the lobe
    apart: a black lobe leaves the other lobes, and a white one at roughness 0, which is Lambert in every
    model, gives how much of the light reaches the lobe and comes back.
    """

    color: str  # names of the inputs of the lobe
    roughness: str = ""  # "" for none
    set_inputs: tuple[tuple[str, str, str], ...] = ()  # name, type and value of further inputs

    @property
    def ports(self) -> dict[str, str]:
        """The names of its inputs, by those of a rough diffuse node."""
        return {"color": self.color, "roughness": self.roughness}

    def document(self, inputs: Values | None = None) -> str:
        types = {"color": "color3", "roughness": "float"}
        given = {name: port for name, port in self.ports.items() if port and name in (inputs or {})}
        values = [(port, types[name], (inputs or {})[name]) for name, port in given.items()]
        ports = "".join(input_text(*each) for each in (*values, *self.set_inputs))
        return document_text(node_text(self.node, "surfaceshader", "shading", ports))


def _lobe(
    title: str,
    model: str,
    color: str,
    roughness: str = "",
    *set_inputs: tuple[str, str, str],
    libraries: tuple[str, ...] = (),
) -> SurfaceLobe:
    return SurfaceLobe(
        title=title,
        node=title.split(",")[0],
        model=model,
        color=color,
        roughness=roughness,
        set_inputs=set_inputs,
        libraries=libraries,
        errors={"value": LOBE_VALUE},
    )


# OpenPBR asks for EON, Standard Surface for Oren-Nayar, USD Preview Surface and glTF for Lambert.
# The thin-walled lobe is MaterialX's own whatever the library, so it is judged once.
SURFACE_LOBES = (
    _lobe("open_pbr_surface", "eon", "base_color", "base_diffuse_roughness"),
    _lobe(
        "open_pbr_surface, thin-walled",
        "eon",
        "subsurface_color",
        "base_diffuse_roughness",
        ("geometry_thin_walled", "boolean", "true"),
        ("subsurface_weight", "float", "1.0"),
        libraries=("stock",),
    ),
    _lobe("standard_surface", "qon", "base_color", "diffuse_roughness", ("base", "float", "1.0")),
    _lobe("UsdPreviewSurface", "lambert", "diffuseColor"),
    _lobe("gltf_pbr", "lambert", "base_color", "", ("metallic", "float", "0.0")),
)
