# SPDX-License-Identifier: Apache-2.0
"""An emission or a medium as one object: its functions by MaterialX's inputs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from mxeon.models.core.arrays import Array, ArrayLike
from mxeon.models.media.volume import hg_pdf, hg_phase, hg_sample, transmittance
from mxeon.models.nodes.node import Inputs
from mxeon.models.nodes.parameters import Parameter
from mxeon.models.shading_model import NodeModel

DISTANCE = Parameter("distance", 1.0, "distance")
COSINE = Parameter("cos_theta", 1.0, "cos_theta")


@dataclass(frozen=True, repr=False)
class EmissionModel(NodeModel):
    """An EDF node by its name.

    Inputs and their shapes are those of `ShadingModel`.

        >>> import mxeon
        >>> mxeon.model("conical_edf").edf([0.6, 0.0, 0.8], color=2.0, outer_angle=90.0).round(6)
        np.float64(1.251183)
    """

    value: Callable[[Array, Inputs], Array]  # of wo, (N, C)
    power: Callable[[Inputs], Array]  # (N, C)

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of the functions that it has."""
        return ("edf", "exitance")

    def edf(self, wo: ArrayLike, *inputs: ArrayLike, **named: ArrayLike) -> Array:
        """Radiance towards `wo`, shape (..., C) or (...); below the horizon that of the back."""
        call = self._bound({"wo": wo}, inputs, named)
        return call.colors(self.value(call.vectors[0], call.inputs))

    def exitance(self, *inputs: ArrayLike, **named: ArrayLike) -> Array:
        """Integral of the radiance times the cosine over the hemisphere."""
        call = self._bound({}, inputs, named)
        return call.colors(self.power(call.inputs))


@dataclass(frozen=True, repr=False)
class MediumModel(NodeModel):
    """A VDF node by its name.

    Inputs and their shapes are those of `ShadingModel`.

        >>> import mxeon
        >>> mxeon.model("absorption_vdf").transmittance(2.0, [0.5, 1.0, 0.0]).round(6)
        array([0.367879, 0.135335, 1.      ])
    """

    @property
    def functions(self) -> tuple[str, ...]:
        """Names of the functions that it has."""
        scatters = len(self.parameters) > 1
        return ("transmittance", *(("phase", "sample", "pdf") if scatters else ()))

    def transmittance(self, distance: ArrayLike, *inputs: ArrayLike, **named: ArrayLike) -> Array:
        """Share of the radiance that passes a distance in m, shape (..., C) or (...)."""
        call = self._bound({}, inputs, {**named, "distance": distance}, DISTANCE)
        scattering = call.inputs.get("scattering", 0.0)
        length = call.inputs["distance"][..., None]
        return call.colors(transmittance(call.inputs["absorption"], scattering, length))

    def phase(self, cos_theta: ArrayLike, *inputs: ArrayLike, **named: ArrayLike) -> Array:
        """Phase function at the cosine of a deflection, 1/sr, shape (...)."""
        self._need("phase")
        call = self._bound({}, inputs, {**named, "cos_theta": cos_theta}, COSINE)
        return call.shaped(hg_phase(call.inputs["cos_theta"], call.inputs["anisotropy"]))

    def sample(
        self, wo: ArrayLike, u: ArrayLike, *inputs: ArrayLike, **named: ArrayLike
    ) -> tuple[Array, Array]:
        """Directions drawn by the phase function, shape (..., 3), and their density, shape (...)."""
        self._need("sample")
        call = self._bound({"wo": wo, "u": u}, inputs, named)
        wi, pdf = hg_sample(call.vectors[0], call.vectors[1], call.inputs["anisotropy"])
        return call.shaped(wi, (3,)), call.shaped(pdf)

    def pdf(self, wo: ArrayLike, wi: ArrayLike, *inputs: ArrayLike, **named: ArrayLike) -> Array:
        """Density of `sample` at wi, 1/sr, shape (...)."""
        self._need("pdf")
        call = self._bound({"wo": wo, "wi": wi}, inputs, named)
        return call.shaped(hg_pdf(call.vectors[0], call.vectors[1], call.inputs["anisotropy"]))
