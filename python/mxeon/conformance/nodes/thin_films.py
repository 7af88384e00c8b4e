# SPDX-License-Identifier: Apache-2.0
"""Subjects of the checks: microfacet nodes under a thin film."""

from dataclasses import dataclass

import numpy as np

from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.bsdf import BsdfSubject
from mxeon.conformance.nodes.combinations import node_over
from mxeon.conformance.samples.batch import Array, Values
from mxeon.models.nodes.thin_films import FILM_NODES
from mxeon.shaders.nodes import SURFACE, document_text, lobe_text

SUMMED = ("first", "second")  # names of lobes
THICK = (0.0, 1.0, 100.0, 1e4)  # thicknesses at the edges of the domain


@dataclass(frozen=True)
class FilmSubject(BsdfSubject):
    """A microfacet node under a thin film."""

    @property
    def title(self) -> str:
        return f"{self.row.category}, thin film"

    @property
    def kind(self) -> str:
        return kinds.FILM

    def random_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Random values; a dielectric below 1 counts as 1, a film in air.

        From below 1 on, total reflection gives the curve a kink, which no short average sees.
        """
        return self._in_air(super().random_inputs(rng, count))

    def special_inputs(self, rng: np.random.Generator, count: int) -> dict[str, Array]:
        """Values of which half lie on an edge; a quarter of the films have the substrate's index."""
        inputs = self._in_air(super().special_inputs(rng, count))
        if "tint" in inputs:
            same = rng.random(count) < 0.25
            inputs["thinfilm_ior"] = np.where(same, inputs["ior"], inputs["thinfilm_ior"])
        return inputs

    def _in_air(self, inputs: dict[str, Array]) -> dict[str, Array]:
        if "tint" not in inputs:
            return inputs
        return {**inputs, "ior": np.maximum(inputs["ior"], 1.0)}


@dataclass(frozen=True)
class FilmSum(FilmSubject):
    """Two lobes of a node in one pixel, `first` and `second`, each under a film."""

    def document(self, inputs: Values | None = None) -> str:
        lobes = (lobe_text(self.node, self.row.fixed, name, self.types) for name in SUMMED)
        both = node_over("add", in1=SUMMED[0], in2=SUMMED[1])
        return document_text("".join(lobes) + both + SURFACE)


FILMS = tuple(FilmSubject(row) for row in FILM_NODES)
# The limit of a Schlick substrate is that of the index alone.
FILM_MODELS = tuple(row.name for row in FILM_NODES)
LAYERED = tuple(row.name for row in FILM_NODES if row.layerable)
