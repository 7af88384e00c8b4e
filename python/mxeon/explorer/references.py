# SPDX-License-Identifier: Apache-2.0
"""What the models make of a material at some pairs of directions: what a browser is compared with.

The models of all lobes, in float64, are too much to write twice. So a page holds their values, rounded to
DIGITS significant digits, which is an error of 5e-8 of a value, below the roundings of any shader.
"""

from collections.abc import Iterable, Iterator, Mapping

import MaterialX as mx
import numpy as np

from mxeon.conformance import reference
from mxeon.conformance.reference.nodes import COMBINATIONS
from mxeon.conformance.samples import Array, Batch, Candidate, rounded
from mxeon.conformance.spec import ZERO
from mxeon.conformance.specs import PLAIN_LOBES
from mxeon.conformance.specs.diffuse import DIFFUSE
from mxeon.conformance.specs.hair import HAIR
from mxeon.conformance.specs.lobes import PbrSpec
from mxeon.conformance.specs.microfacets import FILM_SPECS
from mxeon.conformance.specs.surface_shaders import SURFACE_SHADERS
from mxeon.conformance.tolerance import Tolerance
from mxeon.errors import NotRun
from mxeon.explorer.data import Direction, ReferenceBounds, ReferenceTable, ShaderForm
from mxeon.shaders.generation import Shader
from mxeon.shaders.nodes import DIFFUSE_NODES

DIGITS = 7
POLES = (8.0, 35.0, 60.0, 80.0)  # degrees from the normal, of both directions
AZIMUTHS = (0.0, 100.0, 180.0)  # between them; at 180 degrees they mirror each other
VIEWS = (0.05, 0.2, 0.4, 0.6, 0.8, 0.98)  # cosines
LOBES = ("BSDF", "VDF", "surfaceshader")
FILM = "thinfilm_thickness"


def _direction(pole: float, azimuth: float) -> Array:
    theta, phi = np.radians((pole, azimuth))
    return np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])


def _float32(directions: Iterable[Array]) -> Array:
    """Directions (N, 3) whose numbers float32 has, as a shader sees them."""
    return rounded(np.array(list(directions)).T)


WO = _float32(_direction(o, 0.0) for o in POLES for _ in POLES for _ in AZIMUTHS)
WI = _float32(_direction(i, azimuth) for _ in POLES for i in POLES for azimuth in AZIMUTHS)
SEEN = _float32(_direction(float(np.degrees(np.arccos(mu))), 0.0) for mu in VIEWS)


def pairs() -> tuple[tuple[Direction, Direction], ...]:
    """The pairs of directions of every reference, wo and wi."""
    return tuple(zip(_directions(WO), _directions(WI), strict=True))


def views() -> tuple[Direction, ...]:
    """The views of white surroundings of every reference."""
    return _directions(SEEN)


def _directions(rows: Array) -> tuple[Direction, ...]:
    return tuple((float(x), float(y), float(z)) for x, y, z in rows)


def reference_of(shader: Shader) -> ReferenceTable | None:
    """Values of a shader's material with its own inputs; None where no model covers all of its lobes."""
    lobes = lobes_of(shader)
    spec = _spec(lobes)
    try:
        if spec is HAIR:  # on a fiber, whose curve lies along x
            lights, surroundings = _batches(HAIR, shader)
            direct, white = HAIR.value(lights), HAIR.albedo(surroundings)
        else:
            direct, white = _values(shader)
    except (NotRun, ValueError):  # a lobe without a model, an input outside of the model's domain
        return None
    if not (np.isfinite(direct).all() and np.isfinite(white).all()):
        return None
    forms = tuple(_forms(spec, shader)) if spec else ()
    return ReferenceTable(_digits(direct), _digits(white), _bounds(lobes), forms)


def _bounds(lobes: list[mx.Node]) -> ReferenceBounds:
    """Largest errors of lobes: of a single one its own, of layers the sums with their throughputs."""
    errors = [_errors(node) for node in lobes if node.getCategory() not in COMBINATIONS]
    value = sum(each["value"].value for each in errors if "value" in each)
    albedo = sum(each["albedo"].value for each in errors if "albedo" in each)
    return (
        ReferenceBounds(value, albedo)
        if len(lobes) == 1
        else ReferenceBounds(value + albedo, 2.0 * albedo)
    )


def _errors(node: mx.Node) -> Mapping[str, Tolerance]:
    """Errors of a lobe or a surface shader, by quantity."""
    if node.getCategory() in DIFFUSE_NODES:
        return DIFFUSE[0].errors
    found = next((each for each in _rows(node) if _is_of(node, each)), SURFACE_SHADERS[0])
    return found.errors


def _rows(node: mx.Node) -> tuple[PbrSpec, ...]:
    """The specs that a node may be: those with a film if it has one."""
    film = node.getInput(FILM)
    return FILM_SPECS if film is not None and film.getValue() != 0.0 else (*PLAIN_LOBES, HAIR)


def _values(shader: Shader) -> tuple[Array, Array]:
    """pi f cos(theta_i) of the pairs, and what comes back of white surroundings."""
    host = reference.Reference()
    direct = np.pi * host.evaluate(shader, WO, WI, {}, "direct")
    return direct, host.evaluate(shader, SEEN, SEEN, {}, "environment")


def _forms(spec: PbrSpec, shader: Shader) -> Iterator[ShaderForm]:
    """What shaders have instead of a spec's functions: other values, and other albedos."""
    lights, surroundings = _batches(spec, shader)
    for candidate in _others(spec.value_candidates):
        values = _digits(candidate.values(lights))
        yield ShaderForm(candidate.title, candidate.permitted, direct=values)
    for candidate in _others(spec.albedo_candidates):
        values = _digits(candidate.values(surroundings))
        yield ShaderForm(candidate.title, candidate.permitted, white=values)


def _others(candidates: tuple[Candidate, ...]) -> list[Candidate]:
    """Candidates but for the first, which is the spec's own, and the one that is nothing."""
    return [each for each in candidates[1:] if each is not ZERO]


def _batches(spec: PbrSpec, shader: Shader) -> tuple[Batch, Batch]:
    """The pairs and the views with the inputs of a shader that is one node."""
    own = {port.path.rpartition("/")[2]: np.asarray(port.value) for port in shader.inputs}
    inputs = {name: own[name] for name in (*spec.row.inputs, "weight") if name in own}
    return Batch(WO, WI, inputs), Batch(SEEN, SEEN, inputs)


def lobes_of(shader: Shader, types: tuple[str, ...] = LOBES) -> list[mx.Node]:
    """The lobes and surface shaders of a material, but for the surface around one BSDF."""
    material = shader.document.getDescendant(shader.element)
    paths = {each.getUpstreamElement().getNamePath() for each in material.traverseGraph()}
    nodes = [shader.document.getDescendant(path) for path in sorted(paths)]
    return [each for each in nodes if each.getType() in types and each.getCategory() != "surface"]


def _spec(lobes: list[mx.Node]) -> PbrSpec | None:
    """What a material is that is one node of pbrlib whose inputs are constants; None for others."""
    if len(lobes) != 1:
        return None
    [node] = lobes
    if any(port.getConnectedOutput() or port.getConnectedNode() for port in node.getInputs()):
        return None
    return next((each for each in _rows(node) if _is_of(node, each)), None)


def _is_of(node: mx.Node, spec: PbrSpec) -> bool:
    """Whether a node is that of a spec: its category, in its mode."""
    if node.getCategory() != spec.node:
        return False
    definition = node.getNodeDef()
    ports = {name: node.getInput(name) or definition.getInput(name) for name in spec.row.fixed}
    return all(port.getValueString() == spec.row.fixed[name] for name, port in ports.items())


def _digits(values: Array) -> tuple[float, ...]:
    return tuple(float(f"{value:.{DIGITS}g}") for value in np.ravel(values))
