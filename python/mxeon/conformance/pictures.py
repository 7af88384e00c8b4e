# SPDX-License-Identifier: Apache-2.0
"""Compare pictures of documents' materials with reference pictures, and draw diffuse nodes."""

import warnings
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import NamedTuple, TypeAlias

import MaterialX as mx
import numpy as np
from numpy.typing import NDArray

import mxeon
from mxeon.conformance import backends, diagnosis, results, samples
from mxeon.conformance.case import Case
from mxeon.conformance.check import judge, not_measured
from mxeon.conformance.reference import ExpectedPicture, HostValues, Reference
from mxeon.conformance.reference.nodes import ShownLobe
from mxeon.conformance.results import Cause, Diagnosis, Kind, Picture, Quantity, Result
from mxeon.conformance.results.known_issues import RENDERER_NODES
from mxeon.conformance.specs import hair, microfacets, subsurface, utilities
from mxeon.conformance.specs import surface_shaders as surfaces
from mxeon.conformance.specs.diffuse import DiffuseModelSpec, SurfaceLobe
from mxeon.conformance.specs.sheen import ZELTNER_ALBEDO, ZELTNER_VALUE
from mxeon.conformance.tolerance import (
    Measurement,
    Term,
    Tolerance,
    count_of,
    errors_of,
    roundings,
    scaled,
    single,
    sum_in,
)
from mxeon.errors import DocumentError, NotRun, OutsideModel, ShaderError
from mxeon.hosts import host_row
from mxeon.hosts.base import Host
from mxeon.hosts.still import still
from mxeon.io.images import difference
from mxeon.io.srgb import SLOPE
from mxeon.models.hair import ROUGHNESSES
from mxeon.models.nodes import PBR_NODES
from mxeon.models.nodes.microfacets import LOBES as MICROFACETS
from mxeon.models.sheen import conty_kulla_albedo_dir
from mxeon.shaders.document import notes
from mxeon.shaders.document.graphs import categories, inner_nodes, surface_shader
from mxeon.shaders.document.policy import DEFAULT, Policy
from mxeon.shaders.generation import TARGETS, ApproximationWarning, CodeWarning, Shader, generate
from mxeon.shaders.inner_lobes import SUBSURFACE, inner_lobes
from mxeon.shaders.nodes import BSDF_NODES
from mxeon.shaders.scene import BACK, SIDE, STUDIO, Scene, sphere

# Nodes whose shaders use a fitted albedo.
FITTED_NODES = {row.category for row in PBR_NODES if row.fitted or row.mirror}
HAIR, SHEEN = "chiang_hair_bsdf", "sheen_bsdf"

# Errors are weighted by cos(theta_o), because the normal changes by 1 / cos(theta_o) per pixel.
POINT_AND_VALUE = roundings(16, "of a pixel's position"), roundings(32, "in the value")
PLAIN = sum_in(Quantity.PICTURE, *POINT_AND_VALUE, exact=True)
# OpenGL permits 8-bit filter weights, so the error is 2^-8 if neighboring texels differ by 1.
TEXTURED = single(2.0**-8, Quantity.PICTURE, "8-bit filter weights")
CODES = f"filtered sRGB codes, times the slope {SLOPE:.3g} of sRGB"
ENCODED = single(SLOPE * TEXTURED.value, Quantity.PICTURE, CODES)
FITTED, SHADED = (
    Tolerance((each, microfacets.sum_over(256)), Quantity.FITTED_PICTURE, scaled, exact=True)
    for each in (
        microfacets.MEAN.term("the fits of microfacets"),
        surfaces.ALBEDO.term("all lobes of a surface shader"),
    )
)


def tolerance_of(shader: Shader, lobes: Iterable[ShownLobe], host: Host, scene: Scene) -> Tolerance:
    """The tolerance of a material's picture.

    The terms are errors of fits, of image filters, and of some lobes. Decoding of sRGB colors
    amplifies the errors of a filter, because hosts filter encoded colors.
    """
    nodes, lobes = list(inner_nodes(shader.document)), tuple(lobes)
    fitted = FITTED_NODES & {lobe.category for lobe in lobes}
    modes = {lobe.inputs.get("mode") for lobe in lobes if lobe.category == SHEEN}
    zeltner = fitted == {SHEEN} and modes == {"zeltner"}  # Zeltner's albedo has a closed form
    if not zeltner and categories(shader.document.traverseTree()) & FITTED_NODES:
        tolerance = FITTED
    elif not zeltner and categories(nodes) & FITTED_NODES:
        tolerance = SHADED
    elif any(port.type == "filename" and port.value for port in shader.inputs):
        files = (each for each in nodes if each.isA(mx.Input) and each.getType() == "filename")
        encoded = any(each.getActiveColorSpace() == "srgb_texture" for each in files)
        tolerance = ENCODED if encoded else TEXTURED
    else:
        tolerance = PLAIN
    terms: list[Term] = []
    if SUBSURFACE in inner_lobes(shader):
        terms.append(subsurface.RINGS.term("subsurface scattering in six circles"))
    if "blackbody" in categories(nodes):
        terms += utilities.BLACKBODY.terms
    if zeltner:
        terms.append(ZELTNER_VALUE.term("Zeltner's sheens"))
        terms.append(ZELTNER_ALBEDO.term("their albedos"))
    terms += _lobe_terms(lobes, scene.environment is None)
    if rounding := host_row(host.name).rounding:
        terms.append(Term(rounding, "the pixels' own rounding"))
    if not terms:
        return tolerance
    return replace(tolerance.plus(*terms), quantity=Quantity.FITTED_PICTURE, metric=scaled)


def _lobe_terms(lobes: tuple[ShownLobe, ...], direct: bool) -> list[Term]:
    """Additional errors due to a film, an IOR below 1, and narrow lobes of hair and sheen."""
    terms: list[Term] = []
    inputs = [each.inputs for each in lobes]
    films = [each for each in inputs if np.any(each.get("thinfilm_thickness", 0.0) > 0.0)]
    # In direct light, the albedo of a film only affects light that the film passes to other lobes.
    if films and direct:
        terms += microfacets.film_terms(max(np.max(each["roughness"]) for each in films))
    if films and not (direct and {each.category for each in lobes} == {"conductor_bsdf"}):
        terms.append(microfacets.FILM_SHOWN.term("a film's albedo, times the cosine of the view"))
        if any(np.any(each.get("thinfilm_ior", 2.0) < microfacets.LEAST_FILM) for each in inputs):
            terms.append(microfacets.FILM_TRAPPED.term("a film with an IOR below 1.25"))
    dielectrics = (each.inputs for each in lobes if each.category == "dielectric_bsdf")
    if any(np.any(each.get("ior", 1.0) < 1.0) for each in dielectrics):
        terms.append(microfacets.ERRORS["denser"].term("the throughput for an IOR below 1"))
    if _stretched(lobes):
        terms.append(microfacets.ANISOTROPIC)
    fibers = product((each.inputs for each in lobes if each.category == HAIR), ROUGHNESSES)
    hairs = [np.reshape(fiber[name], (-1, 2)).min(axis=0) for fiber, name in fibers]
    if hairs:
        terms += hair.lobe_terms(*np.min(hairs, axis=0))
    sheens = (each for each in inputs if each.get("mode") == "conty_kulla")
    if roughness := [np.min(each["roughness"]) for each in sheens]:
        mu = np.linspace(1e-3, 1.0, 256)
        excess = float((mu * (conty_kulla_albedo_dir(mu, min(roughness)) - 1.0)).max())
        if excess > 0.0:
            terms.append(Term(excess, "the excess of a narrow sheen's albedo over 1"))
    return terms


def _stretched(lobes: Iterable[ShownLobe]) -> bool:
    """Whether a microfacet lobe has two different alphas."""
    alphas = (each.inputs["roughness"] for each in lobes if each.category in MICROFACETS)
    return any(bool(np.ptp(np.reshape(each, (-1, 2)), axis=1).any()) for each in alphas)


Pixels: TypeAlias = NDArray[np.floating]
Note: TypeAlias = tuple[str, str]  # a warning and the subject of the warning


class Shown(NamedTuple):
    """A host's picture of a scene, with a reference and a tolerance."""

    scene: Scene
    image: Pixels
    expected: ExpectedPicture
    tolerance: Tolerance


MATCH = "Every pixel matches the reference."
ONLY_FINITE = "picture is shown and only has to be finite"


def _read(
    make: Callable[[], tuple[Shader, ...]],
) -> tuple[tuple[Shader, ...], dict[str, str], list[CodeWarning | notes.DocumentWarning]]:
    """Shaders of a document, approximations in the shader of each element, and other notes."""
    with warnings.catch_warnings(record=True) as records:
        warnings.simplefilter("always")
        warnings.simplefilter("error", notes.MissingFileWarning)
        shaders = make()
    messages = [record.message for record in records]
    approximate = (each for each in messages if isinstance(each, ApproximationWarning))
    approximations = {each.element: each.approximation for each in approximate}
    others = [each for each in messages if isinstance(each, (CodeWarning, notes.DocumentWarning))]
    return shaders, approximations, others


def judge_document(
    file: Path, host: Host, judge: Reference, library: str, policy: Policy = DEFAULT
) -> tuple[tuple[Result, ...], tuple[Picture, ...], tuple[Note, ...]]:
    """Compare a host's pictures of all materials of a document with reference pictures.

    Raise DocumentError if no shader can be generated from the document.
    """
    make = partial(host.compile, file, library=library, policy=policy)
    shaders, approximations, document_notes = _read(make)
    found: list[Result] = []
    pictures: list[Picture] = []
    for shader in shaders:
        front_lit = shader.element in approximations
        values = HostValues(host, shader, library, policy)
        result, images = _judge_material(file, shader, host, judge, values, front_lit)
        found.append(result)
        pictures += images
    reported = [(text, f"{file.name}: {element}") for element, text in approximations.items()]
    # Add the reasons why pictures cannot be correct, without duplicates.
    reported += dict.fromkeys(
        (text, f"{file.name}: {shader.element}")
        for shader in shaders
        for scene in _scenes(host)
        for text in host.approximations(shader, scene)
    )
    # Omit warnings about ranges if results already name the inputs.
    named = any(each.diagnosis.kind is Kind.INPUT for each in found)
    for note in document_notes:
        if not (named and isinstance(note, notes.RangeWarning)):
            reported.append((str(note), file.name))
    return tuple(found), tuple(pictures), tuple(reported)


def _scenes(host: Host) -> tuple[Scene, ...]:
    scenes = host_row(host.name).scenes
    if host.active.environment == "none":
        scenes = tuple(each for each in scenes if each.environment is None)
    return scenes


def _judge_material(
    file: Path, shader: Shader, host: Host, judge: Reference, values: HostValues, front_lit: bool
) -> tuple[Result, tuple[Picture, ...]]:
    """Judge one material. If `front_lit`, only judge points with light on the viewer's side."""
    scenes, library = _scenes(host), values.library
    subject = f"{file.name}: {shader.element}"
    about = "picture", MATCH, subject, host.name, library
    place = Result(*about, results.NOT_RUN, document=str(file), element=shader.element)
    try:
        images = [host.picture(shader, scene) for scene in scenes]
    except (NotRun, ShaderError) as error:
        return not_measured(place, error), ()
    identity = host.identity()

    def picture(scene: Scene, image: Pixels, expected: ExpectedPicture | None = None) -> Picture:
        metadata = {
            "version": mxeon.__version__,
            "host": f"{host.name} {identity.version}",
            "device": identity.device,
            "library": library,
            "document": str(file),
            "element": shader.element,
            "scene": scene.name,
        }
        names = (file.name, shader.element, host.name, library, scene.name)
        if expected is None:
            return Picture(*names, image, None, metadata)
        if expected.measured:
            metadata["from the host"] = ", ".join(expected.measured)
        reference, mask = np.asarray(expected.image, np.float32), expected.judged
        partly = mask.sum() < sphere(scene.size).mask.sum()
        where = mask[..., None].astype(np.float32) if partly else None
        return Picture(*names, image, reference, metadata, where)

    # Compare pictures with the reference. If the models do not cover a material, the pixels only
    # have to be finite.
    try:
        if reason := host.unread(shader):
            raise NotRun(f"{host.name}: {reason}: the {ONLY_FINITE}")
        closures = sorted(categories(inner_nodes(shader.document)) & set(BSDF_NODES))
        if closures and host.language == "osl":  # separate checks cover closures
            names = ", ".join(closures)
            raise NotRun(f"{host.name} has its own closures for {names}: their {ONLY_FINITE}")
        expected = [judge.expected(shader, scene, values) for scene in scenes]
        if front_lit:
            expected = list(map(_front_lit, expected, scenes))
    except OutsideModel as error:
        return not_measured(place, error), ()
    except NotRun as error:
        return _judge_finite(place, images, str(error)), tuple(map(picture, scenes, images))
    lobes = [lobe for each in expected for lobe in each.lobes]
    # A prefiltered environment supports a single alpha only.
    one_alpha = host.active.environment == "prefilter" and _stretched(lobes)
    pictures, cases = [], []
    for scene, image, reference in zip(scenes, images, expected, strict=True):
        judged = not one_alpha or scene.environment is None
        pictures.append(picture(scene, image, reference if judged else None))
        if judged:
            tolerance = tolerance_of(shader, lobes, host, scene)
            cases.append(Shown(scene, image, reference, tolerance))

    def diagnose() -> Diagnosis:
        element = shader.document.getDescendant(shader.element)
        if names := notes.same_names(element):
            return diagnosis.defect("same_names", names[0])
        graph = element.getImplementation() if element.isA(mx.Node) else None
        if element.getType() == "material" and graph and graph.isA(mx.NodeGraph):
            return diagnosis.defect("material_graph")
        if library == RENDERER_NODES:
            return _input_at_fault(shader, host, judge, scenes)
        if other := judge.other_node(shader, values):
            return Diagnosis((Cause(Kind.DEFECT, "other_node", other),))
        follows = tuple({lobe.category: None for lobe in lobes})
        return Diagnosis((Cause(Kind.FOLLOWS, names=follows),))

    result = _judge_match(place, cases, diagnose)
    differences = filter(None, (each.difference for each in pictures))
    worst = max(differences, key=lambda each: abs(each.largest))
    return replace(result, difference=worst), tuple(pictures)


def _input_at_fault(
    shader: Shader, host: Host, judge: Reference, scenes: Sequence[Scene]
) -> Diagnosis:
    """Find the input whose removal brings a renderer's own material nearest to the reference."""
    small = [replace(scene, size=64) for scene in scenes]
    names = [each.getName() for each in surface_shader(shader.document, shader.element).getInputs()]
    # For each removed input, the largest difference from the reference. The key "" removes none.
    errors: dict[str, float] = {}
    for name in ("", *names):
        document = mx.createDocument()
        document.copyContentFrom(shader.document)
        surface_shader(document, shader.element).removeInput(name)
        with suppress(NotRun, DocumentError):
            [other] = host.compile(document, shader.element)
            pairs = ((host.picture(other, each), judge.picture(other, each)) for each in small)
            errors[name] = max(float(np.abs(difference(*pair)).max()) for pair in pairs)
    nearest = min(errors, key=errors.__getitem__, default="")
    if not nearest or "" not in errors or errors[nearest] > 0.5 * errors[""]:
        return Diagnosis((Cause(Kind.UNKNOWN, "no_input"),))
    sizes = errors[nearest], errors[""]
    return Diagnosis((Cause(Kind.DEFECT, "input_at_fault", (nearest,), sizes),))


def _judge_finite(place: Result, images: Sequence[Pixels], reason: str) -> Result:
    """The result for a material that the models do not cover. All pixels must be finite."""

    def measure(wrong: bool) -> Measurement:
        judged = [np.where(np.arange(3) == 0, np.nan, images[0])] if wrong else images
        wrong_pixels = sum((~np.isfinite(each)).any(axis=-1).sum() for each in judged)
        return Measurement(float(wrong_pixels), {})

    place = replace(place, check="finite", claim="Every pixel is finite.")
    tolerance = count_of(Quantity.PIXELS)
    result = judge(place, tolerance, measure, "one channel is not a number", Diagnosis)
    return replace(result, diagnosis=results.quoted(reason))


def _judge_match(
    place: Result, cases: Sequence[Shown], diagnose: Callable[[], Diagnosis]
) -> Result:
    """The result for a material that the models cover. All pixels must match the reference.

    The error and the tolerance belong to the picture with the largest ratio of error to tolerance.
    """
    errors = [_errors(case) for case in cases]
    allowed = [case.tolerance.value for case in cases]
    worst = int(np.argmax([each.max() / most for each, most in zip(errors, allowed, strict=True)]))
    case, error = cases[worst], float(errors[worst].max())
    tolerance, reference, mask = case.tolerance, case.expected.image, case.expected.judged
    row, column = np.argwhere(mask)[errors[worst].argmax()]
    point = {
        "row": [float(row)],
        "column": [float(column)],
        "measured": case.image[row, column].astype(float).tolist(),
        "expected": reference[row, column].tolist(),
    }

    def measure(wrong: bool) -> Measurement:
        if wrong:
            brighter = np.float32(3.0 * tolerance.value) * np.maximum(1.0, case.image)
            control = _errors(case._replace(image=case.image + brighter))
            return Measurement(float(control.max()), {})
        if error <= tolerance.value:
            return Measurement(error, point, (), "pixels")
        relative = [
            each * (tolerance.value / most) for each, most in zip(errors, allowed, strict=True)
        ]
        parts = (
            errors_of(each, tolerance.value, results.Region(shown.scene.name))
            for shown, each in zip(cases, relative, strict=True)
        )
        whole = errors_of(np.concatenate(relative), tolerance.value)
        return Measurement(error, point, (whole, *parts), "pixels")

    words = "the picture is brighter by three tolerances"
    result = judge(place, tolerance, measure, words, diagnose)
    measured = dict.fromkeys(name for each in cases for name in each.expected.measured)
    return replace(result, measured=tuple(measured))


def _errors(case: Shown) -> Pixels:
    mask = case.expected.judged
    wo, _ = _directions(case.scene, mask)
    measured, expected = (
        each[mask].astype(np.float64) for each in (case.image, case.expected.image)
    )
    return case.tolerance.metric(measured, expected) * wo[:, 2]


def _directions(scene: Scene, mask: NDArray[np.bool_]) -> tuple[Pixels, Pixels]:
    chosen = mask[sphere(scene.size).mask]
    wo, wi, _ = backends.picture_pairs(scene)
    return wo[chosen], wi[chosen]


def _front_lit(expected: ExpectedPicture, scene: Scene) -> ExpectedPicture:
    judged = expected.judged.copy()
    wo, wi = _directions(scene, judged)
    judged[judged] = (wo[:, :2] * wi[:, :2]).sum(axis=1) >= 0.0
    return replace(expected, judged=judged)


STUDIO_PICTURE = replace(STUDIO, size=320)
STUDIED = 4  # maximum number of materials per document with a studio picture


def studio_pictures(
    file: Path, host: Host, library: str, policy: Policy = DEFAULT
) -> tuple[Picture, ...]:
    """Presentation pictures of the first materials of a document, on a shader ball in a studio."""
    shaders, _, _ = _read(lambda: host.compile(file, library=library, policy=policy))
    metadata = {"version": mxeon.__version__, "document": str(file), "scene": STUDIO.name}
    pictures = []
    for shader in shaders[:STUDIED]:
        names = file.name, shader.element, host.name, library, STUDIO.name
        pictures.append(Picture(*names, still(host, shader, STUDIO_PICTURE), None, metadata))
    return tuple(pictures)


# --- documents on hosts without pictures: shaders are generated but not run -----------------------

DOCUMENT_KEY = "document"
DOCUMENT_CLAIM = "Shaders are generated from every material of the document."


def generate_document(
    file: Path, host: str, library: str, policy: Policy = DEFAULT
) -> tuple[tuple[Result, ...], tuple[Note, ...]]:
    """The result of generating a document's shaders for a host's target, and notes about files.

    Raise DocumentError if no shader can be generated from the document. Raise NotRun if the host
    reads no documents, or if this MaterialX has no generator for the target.
    """
    target = host_row(host).target
    if not target:
        raise NotRun(f"{host}: this renderer only has its own materials; it cannot read documents")
    if target not in TARGETS:
        raise NotRun(f"{host}: this MaterialX has no generator for {target}")
    shaders, _, reported = _read(lambda: generate(file, target, library=library, policy=policy))
    data = file.read_bytes()
    half = data[: len(data) // 2].decode(errors="replace")
    try:
        generate(half if "<" in half else "<", target, library=library)
        caught = False
    except DocumentError:
        caught = True
    about = DOCUMENT_KEY, DOCUMENT_CLAIM, file.name, host, library
    place = Result(*about, results.NOT_RUN, document=str(file))
    tolerance, words = count_of(Quantity.DOCUMENTS), "half of the document is cut off"

    def measure(wrong: bool) -> Measurement:
        return Measurement(float(caught if wrong else not shaders), {})

    result = judge(place, tolerance, measure, words, Diagnosis)
    return (result,), tuple((str(each), file.name) for each in reported)


# --- one material of each node, for the page that compares hosts ----------------------------------

PORTRAYED: samples.Values = {"color": (0.8, 0.4, 0.1), "roughness": 1.0}
PORTRAIT_SCENES = tuple(replace(scene, size=96) for scene in (SIDE, BACK))


def comparison_pictures(case: Case) -> tuple[Picture, ...]:
    """Pictures of a rough diffuse node in light from the side and from behind, with references.

    The result is empty for other nodes, for lobes of surface shaders, and for renderers in which
    each pixel shows one pair of directions. Pixels near the rim and the terminator are black in all
    pictures.
    """
    rough = isinstance(case.spec, DiffuseModelSpec) and not isinstance(case.spec, SurfaceLobe)
    if not rough or isinstance(case.backend, backends.Rendered):
        return ()
    pictures = []
    for scene in PORTRAIT_SCENES:
        wo, wi, judged, mask = case.backend.portrait(scene)
        if not judged.any():
            continue
        where = mask.copy()
        where[where] = judged
        batch = samples.Batch(wo[judged], wi[judged], samples.arrays(PORTRAYED), scene)
        image, expected = np.zeros((2, *where.shape, 3), np.float32)
        image[where], expected[where] = case.direct(batch), case.expected(batch)
        names = (results.PORTRAIT, case.spec.title, case.host.name, case.library, scene.name)
        keys = ("document", "element", "host", "library", "scene")
        metadata = dict(zip(keys, names, strict=True)) | {"version": mxeon.__version__}
        metadata |= {"points": case.host.name}  # the choice of points depends on the host
        pictures.append(Picture(*names, image, expected, metadata))
    return tuple(pictures)
