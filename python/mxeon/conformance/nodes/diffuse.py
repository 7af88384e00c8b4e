# SPDX-License-Identifier: Apache-2.0
"""Subjects of the checks: the rough diffuse nodes, each with the model it has to be."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import ClassVar

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.samples.batch import Array, Batch, Candidate, Changes, Values, random_inputs
from mxeon.conformance.samples.edge_cases import special_inputs
from mxeon.conformance.samples.uneven_environment import sky
from mxeon.models import table as reference
from mxeon.models.table import Model
from mxeon.shaders.nodes import (
    EON,
    FLAG,
    INPUT_TYPES,
    OREN_NAYAR,
    document_text,
    input_text,
    material_text,
    node_text,
)


class ModelSubject:
    """Base class of subjects judged against a diffuse model."""

    model: str

    closure: ClassVar[bool] = True

    @property
    def value_candidates(self) -> tuple[Candidate, ...]:
        rows = {row.brdf: row for row in self._others + reference.KNOWN_DEFECTS + reference.MODELS}
        rows[reference.model(self.model).brdf] = reference.model(self.model)
        return self._candidates(rows.values(), Batch.expected)

    @property
    def albedo_candidates(self) -> tuple[Candidate, ...]:
        rows = reference.MODELS + reference.KNOWN_DEFECTS + self._others
        rows = tuple(row for row in rows if row.albedo_dir)
        return self._candidates(rows, Batch.albedo)

    @property
    def black(self) -> Values:
        return {"color": (0.0, 0.0, 0.0)}

    def expected(self, batch: Batch) -> Array:
        return batch.expected(self.model)

    def albedo(self, batch: Batch) -> Array:
        return batch.albedo(self.model)

    def sky(self, batch: Batch) -> Array:
        """Mean of the uneven sky that it scatters, (N, 3): of the viewer's side."""
        return sky(batch.normal)

    @property
    def _others(self) -> tuple[Model, ...]:
        """Models beside the common ones that it may have."""
        return ()

    def _candidates(
        self, rows: Iterable[Model], output: Callable[[Batch, str], Array]
    ) -> tuple[Candidate, ...]:
        ordered = sorted(rows, key=lambda row: row.name != self.model)
        return tuple(Candidate(row.title, partial(_limited, row, output)) for row in ordered)


def _limited(row: Model, output: Callable[[Batch, str], Array], batch: Batch) -> Array:
    """Output of a model where no roughness exceeds its largest."""
    roughness = np.minimum(batch.inputs["roughness"], row.largest)
    return output(batch.altered(roughness=roughness), row.name)


CHANGES: Values = {
    "weight": 0.5,
    "color": (0.9, 0.1, 0.6),
    "roughness": 0.3,
    "normal": (0.0, 0.6, 0.8),
}


@dataclass(frozen=True)
class DiffuseSubject(ModelSubject):
    """A node with its flag and the model it has to be."""

    node: str  # node category
    flag: bool | None  # energy_compensation, or None where the node has no such input
    model: str  # name of a row of `mxeon.models.table.MODELS`
    # Inputs that it may have; the flag counts only where it is not None.
    names: tuple[str, ...] = tuple(INPUT_TYPES)

    kind: ClassVar[str] = kinds.DIFFUSE
    libraries: ClassVar[tuple[str, ...]] = ()

    @property
    def title(self) -> str:
        flag = "" if self.flag is None else f", energy_compensation {str(self.flag).lower()}"
        return self.node + flag

    @property
    def inputs(self) -> tuple[str, ...]:
        return tuple(name for name in self.names if self.flag is not None or name != FLAG)

    def with_flag(self, inputs: Values) -> Values:
        return inputs if self.flag is None else {FLAG: self.flag, **inputs}

    def document(self, inputs: Values | None = None) -> str:
        return material_text(self.node, self.with_flag(inputs or {}), self.node)

    @property
    def changes(self) -> dict[str, Changes]:
        values = {**CHANGES, FLAG: not self.flag}
        return {name: ({}, {name: values[name]}) for name in self.inputs}

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Random colors and roughnesses; see `mxeon.conformance.samples.batch.random_inputs`."""
        return random_inputs(rng, count, reference.model(self.model))

    def special_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Colors and roughnesses of which half lie on an edge."""
        return special_inputs(rng, count, reference.model(self.model))


SUBJECTS = (
    DiffuseSubject(OREN_NAYAR, True, "eon"),
    DiffuseSubject(OREN_NAYAR, False, "qon"),
    DiffuseSubject(EON, None, "eon"),
)


@dataclass(frozen=True)
class DiffuseLobe(ModelSubject):
    """The diffuse lobe of a surface shader, whose other lobes cannot be switched off.

    What lies over the lobe depends on the directions alone, so that pictures of other colors
    tell the lobe apart; see `mxeon.conformance.probes.pictures.DiffuseLobeProbe`.
    """

    title: str  # name in reports, node category, and the model that its specification asks for
    node: str
    model: str
    color: str  # names of the inputs of the lobe; "" for no roughness
    roughness: str
    fixed: tuple[tuple[str, str, str], ...] = ()  # name, type and value of further inputs
    libraries: tuple[str, ...] = ()  # the libraries with which it is judged; () for all

    kind: ClassVar[str] = kinds.LOBE
    inputs: ClassVar[tuple[str, ...]] = ()
    changes: ClassVar[Mapping[str, Changes]] = {}

    def document(self, inputs: Values | None = None) -> str:
        inputs = inputs or {}
        lobe = {"color": (self.color, "color3"), "roughness": (self.roughness, "float")}
        values = [
            (*port, inputs[name]) for name, port in lobe.items() if name in inputs and port[0]
        ]
        ports = "".join(input_text(*each) for each in (*values, *self.fixed))
        return document_text(node_text(self.node, "surfaceshader", "shading", ports))


# OpenPBR asks for EON, Standard Surface for Oren-Nayar, USD Preview Surface and glTF for Lambert.
# The thin-walled lobe is MaterialX's own whatever the library, so it is judged once.
THIN_WALLED = (("geometry_thin_walled", "boolean", "true"), ("subsurface_weight", "float", "1.0"))
SURFACES = (
    DiffuseLobe(
        "open_pbr_surface", "open_pbr_surface", "eon", "base_color", "base_diffuse_roughness"
    ),
    DiffuseLobe(
        "open_pbr_surface, thin-walled",
        "open_pbr_surface",
        "eon",
        "subsurface_color",
        "base_diffuse_roughness",
        THIN_WALLED,
        ("stock",),
    ),
    DiffuseLobe(
        "standard_surface",
        "standard_surface",
        "qon",
        "base_color",
        "diffuse_roughness",
        (("base", "float", "1.0"),),
    ),
    DiffuseLobe("UsdPreviewSurface", "UsdPreviewSurface", "lambert", "diffuseColor", ""),
    DiffuseLobe(
        "gltf_pbr", "gltf_pbr", "lambert", "base_color", "", (("metallic", "float", "0.0"),)
    ),
)
