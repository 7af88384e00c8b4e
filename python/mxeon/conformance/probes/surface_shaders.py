# SPDX-License-Identifier: Apache-2.0
"""Probes of surface shaders as a whole, on hosts that evaluate any pairs."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from typing import ClassVar

import numpy as np

from mxeon.conformance.nodes.surface_shaders import SurfaceShader
from mxeon.conformance.probes.bsdf import LEAST_VIEW, reflected
from mxeon.conformance.probes.memory import Remembered
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.conformance.reference import Host as Reference
from mxeon.conformance.samples.batch import SEED, Array, Batch, Counts, directions, float32
from mxeon.errors import NotRun
from mxeon.hosts.calls import NORMAL, TANGENT
from mxeon.shaders.document.values import Plain
from mxeon.shaders.generation import Shader, generate

CHANGED = 8  # pairs that a change of an input has to show in
SPREAD = 0.3  # alpha of the lobe in which half of the lights lie about the mirror direction
STRETCHED = "anisotropy"  # in the names of inputs: an environment is summed too coarsely for them


class SurfaceShaderProbe(PairProbe):
    """A surface shader on a host that evaluates any pairs."""

    usual: ClassVar[Counts] = Counts(256, albedos=64, materials=1 << 11)  # a material a pair

    subject: SurfaceShader  # type: ignore[assignment]  # evaluated by the same verbs

    @cached_property
    def batches(self) -> tuple[Batch, ...]:
        """Random pairs, half of them near the mirror direction, with random materials."""
        rng, count = np.random.default_rng(SEED), self.counts.pairs
        wo, wi = self._views(rng, count), directions(rng, count)
        alpha = np.full((count, 2), SPREAD)
        near = reflected(wo, alpha, rng.random(count), rng.random(count))
        kept = (np.arange(count) % 2 == 0) & (near[:, 2] > 0.0)
        wi = np.where(kept[:, np.newaxis], near, wi)
        return (Batch(wo, wi, self.subject.random_inputs(rng, count)),)

    @property
    def few(self) -> tuple[Batch, ...]:
        return self.batches

    @cached_property
    def cosines(self) -> tuple[Batch, ...]:
        [batch] = self.batches
        return (_isotropic(batch.first(self.counts.albedos)),)

    @cached_property
    def albedos(self) -> tuple[Array, ...]:
        return tuple(self._reference(batch, "environment") for batch in self.cosines)

    @cached_property
    def materials(self) -> Batch:
        rng, count = np.random.default_rng(SEED), self.counts.materials
        wo = self._views(rng, count)
        return _isotropic(Batch(wo, wo, self.subject.every_input(rng, count)))

    @cached_property
    def white(self) -> Batch:
        [batch] = self.cosines
        return replace(batch, inputs=self.subject.table.white)

    @cached_property
    def changed(self) -> Batch:
        """A few views for each input: of the material with every lobe, then with a change of it."""
        table = self.subject.table
        rows = []
        for name in self.subject.inputs:
            before = {**table.seen, **table.needs.get(name, {})}
            rows += [before, {**before, name: table.changed[name]}]
        [batch] = self.batches
        few = batch.first(CHANGED)
        defaults = self._defaults
        names = sorted({name for row in rows for name in row})
        if missing := [name for name in names if name not in defaults]:
            raise NotRun(
                f"{self.subject.node} of this MaterialX lacks an input that is varied: {', '.join(missing)}"
            )
        inputs = {
            name: np.repeat(
                [np.asarray(row.get(name, defaults[name]), float) for row in rows], CHANGED, 0
            )
            for name in names
        }
        return Batch(np.tile(few.wo, (len(rows), 1)), np.tile(few.wi, (len(rows), 1)), inputs)

    @property
    def _defaults(self) -> Mapping[str, Plain]:
        """Values of the inputs that a document does not set."""
        vectors = {
            name: TANGENT if "tangent" in name else NORMAL
            for name in self.subject.inputs
            if name.endswith(("normal", "tangent"))
        }
        ports = {port.path.rsplit("/", 1)[-1]: port.value for port in self._shader.inputs}
        return {**vectors, **ports}

    def response(self, batch: Batch, branch: str) -> Array:
        return self._evaluate(batch, branch)

    def expected(self, batch: Batch) -> Array:
        return self._layered(batch)

    @cached_property
    def _layered(self) -> Remembered:
        """Values by the layer equation, of the document as this library has it."""
        return Remembered(lambda batch: np.pi * self._reference(batch, "direct"))

    def _views(self, rng: np.random.Generator, count: int) -> Array:
        """Random directions, none so grazing that a sheen's own equations gain energy."""
        wo = directions(rng, count)
        return float32(np.where(wo[:, 2:] < LEAST_VIEW, [0.6, 0.0, 0.8], wo))

    @cached_property
    def _document(self) -> Shader:
        [shader] = generate(self.subject.document(), "glsl", library=self.library)
        return shader

    def _reference(self, batch: Batch, branch: str) -> Array:
        return Reference().evaluate(self._document, batch.wo, batch.wi, batch.inputs, branch)


def _isotropic(batch: Batch) -> Batch:
    """The same pairs with lobes that are not stretched."""
    return batch.altered(
        **{name: np.zeros(len(batch.wo)) for name in batch.inputs if STRETCHED in name}
    )
