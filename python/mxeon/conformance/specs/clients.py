# SPDX-License-Identifier: Apache-2.0
"""The material that tests client bindings: a mix of two matte surfaces with opacities."""

from dataclasses import dataclass

import numpy as np

from mxeon.conformance.samples import Values
from mxeon.conformance.spec import Ability, Spec
from mxeon.conformance.tolerance import roundings, sum_of
from mxeon.shaders import nodes

LOBES = {"first": (0.9, 0.3, 0.1), "second": (0.2, 0.5, 0.8), "behind": (0.3, 0.8, 0.4)}
SHARE = 0.25  # weight of the first lobe in the mix
FRONT = SHARE * np.array(LOBES["first"]) + (1.0 - SHARE) * np.array(LOBES["second"])
BACK = np.array(LOBES["behind"])
SURFACE_NODE = "surface", "surfaceshader"
CLIENT_ERROR = sum_of(roundings(64, "of directions, distances and powers, four lights in all"))


@dataclass(frozen=True, eq=False, kw_only=True)
class FrameSpec(Spec):
    """The node `surface` with all client bindings."""

    requires = Ability.CLIENT

    def document(self, inputs: Values | None = None) -> str:
        """A document whose inputs `front/opacity`, `back/opacity` and `shading/mix` can be set."""
        make, node = nodes.lobe_text, "oren_nayar_diffuse_bsdf"
        lobes = (make(node, {"color": each}, name) for name, each in LOBES.items())
        weight = nodes.input_text("mix", "float", SHARE)
        mixed = nodes.Node("mix", "BSDF", ("first", "second"), weight)
        opacity = nodes.input_text("opacity", "float", 1.0)
        ports = {"front": "lobe", "back": "behind"}
        surfaces = (
            nodes.node_text(
                *SURFACE_NODE, name, nodes.connection_text("bsdf", "BSDF", lobe) + opacity
            )
            for name, lobe in ports.items()
        )
        share = nodes.input_text("mix", "float", 1.0)
        shading = {"shading": nodes.Node("mix", "surfaceshader", ("front", "back"), share)}
        texts = *lobes, nodes.network_text({"lobe": mixed}), *surfaces, nodes.network_text(shading)
        return nodes.document_text("".join(texts))


CLIENT_FRAME = FrameSpec(
    title="surface, a client's frame", node="surface", errors={"frame": CLIENT_ERROR}
)
