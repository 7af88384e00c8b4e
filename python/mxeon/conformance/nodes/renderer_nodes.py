# SPDX-License-Identifier: Apache-2.0
"""Nodes that a renderer has of its own, with the models that their documentation claims."""

from dataclasses import dataclass, replace

from mxeon.conformance.nodes.diffuse import DiffuseSubject
from mxeon.models.table import OTHERS, Model


@dataclass(frozen=True)
class RendererNode(DiffuseSubject):
    """A node of a renderer's own, and the model that its documentation claims.

    Attributes
    ----------
    forms : tuple of str
        Forms of the model that its paper publishes, if there are several. The one that is nearest to
        what is measured is judged.
    others : bool
        Whether other lobes lie beside the diffuse one, which do not depend on the color.
    sampled : bool
        Whether its renderer draws directions for it by a function that can be called.
    """

    forms: tuple[str, ...] = ()
    others: bool = False
    sampled: bool = False

    @property
    def _others(self) -> tuple[Model, ...]:
        """Models of renderers' own nodes; Burley's with the albedo that the node's own has."""
        name = self.model if self.model.startswith("burley") else "burley"
        left_out = {"burley", "burley_lambert"} - {name}
        return tuple(row for row in OTHERS if row.name not in left_out)


def _renderer_nodes(
    model: str, *nodes: str, forms: tuple[str, ...] = ()
) -> tuple[RendererNode, ...]:
    """Nodes of a renderer's own with a color and a roughness, which claim a model."""
    return tuple(RendererNode(node, None, model, ("color", "roughness"), forms) for node in nodes)


# The paper prints EON with the exact albedo and with a quartic for it.
PUBLISHED = ("eon", "eon_fitted")


# Nodes that a renderer has of its own, by the name of the host, with the models that their
# documentation claims. OpenPBR asks for EON, Standard Surface for Oren-Nayar.
NATIVE = {
    "cycles-native": _renderer_nodes("eon", "Diffuse BSDF", "Principled BSDF"),
    "three": (
        *_renderer_nodes(
            "eon",
            "MeshPhysicalMaterial, WebGLRenderer",
            "MeshPhysicalMaterial, WebGPURenderer",
            "open_pbr_surface, MaterialXLoader",
            forms=PUBLISHED,
        ),
        *_renderer_nodes("qon", "standard_surface, MaterialXLoader"),
    ),
    "babylon": (
        *_renderer_nodes(
            "eon",
            "PBRMaterial E_OREN_NAYAR, WebGL2",
            "PBRMaterial E_OREN_NAYAR, WebGPU",
            "OpenPBRMaterial, WebGL2",
            "OpenPBRMaterial, WebGPU",
            forms=PUBLISHED,
        ),
        *_renderer_nodes("burley", "PBRMaterial BURLEY, WebGL2", "PBRMaterial BURLEY, WebGPU"),
        *_renderer_nodes(
            "burley_lambert", "PBRMaterial LEGACY, WebGL2", "PBRMaterial LEGACY, WebGPU"
        ),
        *(
            RendererNode(f"PBRMaterial LAMBERT, {engine}", None, "lambert", ("color",))
            for engine in ("WebGL2", "WebGPU")
        ),
    ),
    "three-gpu-pathtracer": (
        *(
            replace(each, sampled=True)
            for each in _renderer_nodes("eon", "WebGPUPathTracer, eonBrdf", forms=PUBLISHED)
        ),
        *_renderer_nodes("fon", "WebGPUPathTracer, fonBrdf"),
        *_renderer_nodes(
            "burley", "WebGLPathTracer, diffuseEval", "WebGLPathTracer, diffuseEval, shorter wh"
        ),
    ),
    "mitsuba": (
        RendererNode("diffuse", None, "lambert", ("color",)),
        *_renderer_nodes("burley", "principled"),
    ),
    # Its manual has the roughness of both nodes for Cycles only.
    "eevee": tuple(
        RendererNode(node, None, "lambert", ("color",))
        for node in ("Diffuse BSDF", "Principled BSDF")
    ),
    "luxcore": (
        RendererNode("matte", None, "lambert", ("color",)),
        *_renderer_nodes("qon", "roughmatte", "roughmatte, sigma in degrees"),
        RendererNode("disney", None, "burley", ("color", "roughness"), others=True),
    ),
}
