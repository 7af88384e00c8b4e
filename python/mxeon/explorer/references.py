# SPDX-License-Identifier: Apache-2.0
"""Float64 values of the models at fixed pairs of directions, for comparison in a browser.

Values are rounded to DIGITS significant digits, so the relative error is at most 5e-7.
"""

from collections.abc import Iterator

import MaterialX as mx
import numpy as np

from mxeon.conformance import reference
from mxeon.conformance.reference.nodes import COMBINATIONS
from mxeon.conformance.samples import Array, Batch, float32
from mxeon.conformance.spec import ZERO
from mxeon.conformance.specs import PLAIN_LOBES
from mxeon.conformance.specs.diffuse import DIFFUSE
from mxeon.conformance.specs.hair import HAIR
from mxeon.conformance.specs.lobes import PbrSpec
from mxeon.conformance.specs.microfacets import FILM_SPECS
from mxeon.conformance.specs.surface_shaders import SURFACE_SHADERS
from mxeon.errors import NotRun
from mxeon.explorer.data import Direction, ReferenceBounds, ReferenceTable, ShaderForm
from mxeon.shaders.generation import Shader
from mxeon.shaders.nodes import DIFFUSE_NODES
from mxeon.shaders.scene import direction

DIGITS = 7
POLES = (8.0, 35.0, 60.0, 80.0)  # angles of both directions from the normal, in degrees
# Differences in azimuth between the two directions, in degrees. The mirror direction, 180, is left
# out, because smooth lobes have no finite value in the mirror direction.
AZIMUTHS = (0.0, 100.0, 176.0)
VIEWS = (0.05, 0.2, 0.4, 0.6, 0.8, 0.98)  # cosines of the angles of view in a white environment
LOBES = ("BSDF", "VDF", "surfaceshader")
FILM = "thinfilm_thickness"

WO = float32([direction(0.0, o) for o in POLES for _ in POLES for _ in AZIMUTHS])
WI = float32([direction(azimuth, i) for _ in POLES for i in POLES for azimuth in AZIMUTHS])
SEEN = float32([direction(0.0, float(np.degrees(np.arccos(mu)))) for mu in VIEWS])


def pairs() -> tuple[tuple[Direction, Direction], ...]:
    """The pairs of directions (wo, wi) at which all references have values."""
    return tuple(zip(_directions(WO), _directions(WI), strict=True))


def views() -> tuple[Direction, ...]:
    """The directions of view at which all references have values in a white environment."""
    return _directions(SEEN)


def _directions(rows: Array) -> tuple[Direction, ...]:
    return tuple((float(x), float(y), float(z)) for x, y, z in rows)


def reference_of(shader: Shader) -> ReferenceTable | None:
    """Reference values of a shader's material; None if a lobe has no model."""
    lobes = lobes_of(shader)
    spec = _spec(lobes)
    try:
        if spec is HAIR:
            lights, surroundings = _batches(HAIR, shader)
            direct, white = HAIR.value(lights), HAIR.albedo(surroundings)
        else:
            host = reference.Reference()
            direct = np.pi * host.evaluate(shader, WO, WI, {}, "direct")
            white = host.evaluate(shader, SEEN, SEEN, {}, "environment")
    except (NotRun, ValueError):  # a lobe has no model, or an input is outside the model's domain
        return None
    if not (np.isfinite(direct).all() and np.isfinite(white).all()):
        return None
    # The tolerance is a sum over all lobes. Layers add the tolerances of throughputs.
    errors = []
    for node in lobes:
        if node.getCategory() in COMBINATIONS:
            continue
        rows = (each for each in _rows(node) if _matches(node, each))
        row = DIFFUSE[0] if node.getCategory() in DIFFUSE_NODES else next(rows, SURFACE_SHADERS[0])
        errors.append(row.errors)
    value = sum(each["value"].value for each in errors if "value" in each)
    albedo = sum(each["albedo"].value for each in errors if "albedo" in each)
    bounds = (value, albedo) if len(lobes) == 1 else (value + albedo, 2.0 * albedo)
    forms = tuple(_forms(spec, shader)) if spec else ()
    return ReferenceTable(_digits(direct), _digits(white), ReferenceBounds(*bounds), forms)


def _rows(node: mx.Node) -> tuple[PbrSpec, ...]:
    """The specs that may describe a node, which depend on whether the node has a thin film."""
    film = node.getInput(FILM)
    return FILM_SPECS if film is not None and film.getValue() != 0.0 else (*PLAIN_LOBES, HAIR)


def _forms(spec: PbrSpec, shader: Shader) -> Iterator[ShaderForm]:
    lights, surroundings = _batches(spec, shader)
    # The first candidate is the spec's own model.
    for candidate in spec.value_candidates[1:]:
        if candidate is not ZERO:
            values = _digits(candidate.values(lights))
            yield ShaderForm(candidate.title, candidate.permitted, direct=values)
    for candidate in spec.albedo_candidates[1:]:
        if candidate is not ZERO:
            values = _digits(candidate.values(surroundings))
            yield ShaderForm(candidate.title, candidate.permitted, white=values)


def _batches(spec: PbrSpec, shader: Shader) -> tuple[Batch, Batch]:
    """A batch of all pairs and a batch of all views, both with the inputs of a one-node shader."""
    values = {port.path.rpartition("/")[2]: np.asarray(port.value) for port in shader.inputs}
    inputs = {name: values[name] for name in (*spec.row.inputs, "weight") if name in values}
    return Batch(WO, WI, inputs), Batch(SEEN, SEEN, inputs)


def lobes_of(shader: Shader, types: tuple[str, ...] = LOBES) -> list[mx.Node]:
    """A material's lobes and surface shaders, except `surface` nodes."""
    material = shader.document.getDescendant(shader.element)
    paths = {each.getUpstreamElement().getNamePath() for each in material.traverseGraph()}
    nodes = [shader.document.getDescendant(path) for path in sorted(paths)]
    return [each for each in nodes if each.getType() in types and each.getCategory() != "surface"]


def _spec(lobes: list[mx.Node]) -> PbrSpec | None:
    """The spec of a material with a single lobe and constant inputs; None for other materials."""
    if len(lobes) != 1:
        return None
    [node] = lobes
    if any(port.getConnectedOutput() or port.getConnectedNode() for port in node.getInputs()):
        return None
    return next((each for each in _rows(node) if _matches(node, each)), None)


def _matches(node: mx.Node, spec: PbrSpec) -> bool:
    if node.getCategory() != spec.node:
        return False
    definition = node.getNodeDef()
    ports = {name: node.getInput(name) or definition.getInput(name) for name in spec.row.fixed}
    return all(port.getValueString() == spec.row.fixed[name] for name, port in ports.items())


def _digits(values: Array) -> tuple[float, ...]:
    return tuple(float(f"{value:.{DIGITS}g}") for value in np.ravel(values))
