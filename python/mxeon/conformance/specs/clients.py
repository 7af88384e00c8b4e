# SPDX-License-Identifier: Apache-2.0
"""A material for tests of the uniforms that a client can bind: a mix of two matte surfaces."""

from dataclasses import dataclass

import numpy as np

from mxeon.conformance.samples import Values
from mxeon.conformance.spec import Ability, Spec
from mxeon.conformance.tolerance import roundings, sum_of
from mxeon.shaders import nodes

LOBES = {"first": (0.9, 0.3, 0.1), "second": (0.2, 0.5, 0.8), "behind": (0.3, 0.8, 0.4)}
SHARE = 0.25  # share of the first lobe in the front surface
FRONT = SHARE * np.array(LOBES["first"]) + (1.0 - SHARE) * np.array(LOBES["second"])
BACK = np.array(LOBES["behind"])


@dataclass(frozen=True, eq=False, kw_only=True)
class FrameSpec(Spec):
    """The node `surface`, drawn with all uniforms that a client can bind."""

    requires = Ability.CLIENT

    def document(self, inputs: Values | None = None) -> str:
        """A document whose inputs `front/opacity`, `back/opacity` and `shading/mix` can be set."""
        network = {
            name: nodes.Node(
                nodes.OREN_NAYAR, "BSDF", text=nodes.input_text("color", "color3", rho)
            )
            for name, rho in LOBES.items()
        }
        share = nodes.input_text("mix", "float", SHARE)
        network["lobe"] = nodes.Node("mix", "BSDF", ("first", "second"), share)
        opacity = nodes.input_text("opacity", "float", 1.0)
        for name, lobe in (("front", "lobe"), ("back", "behind")):
            ports = nodes.connection_text("bsdf", "BSDF", lobe) + opacity
            network[name] = nodes.Node("surface", "surfaceshader", text=ports)
        mix = nodes.input_text("mix", "float", 1.0)
        network["shading"] = nodes.Node("mix", "surfaceshader", ("front", "back"), mix)
        return nodes.document_text(nodes.network_text(network))


CLIENT_FRAME = FrameSpec(
    title="surface, a client's frame",
    node="surface",
    errors={"frame": sum_of(roundings(64, "of directions, distances and powers of four lights"))},
)
