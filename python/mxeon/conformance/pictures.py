# SPDX-License-Identifier: Apache-2.0
"""Compares pictures of documents' materials with the reference, and draws samples of nodes."""

import warnings
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import partial
from itertools import compress, product
from pathlib import Path
from typing import TypeAlias

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
COSINES = 256  # number of views tried to find a sheen's largest albedo

# Errors are weighted by cos(theta_o), since the normal changes by 1 / cos(theta_o) per pixel.
POINT_AND_VALUE = roundings(16, "of a pixel's point"), roundings(32, "in the value")
PLAIN = sum_in(Quantity.PICTURE, *POINT_AND_VALUE, exact=True)
# OpenGL requires this filtering precision; neighboring texels differ by at most 1.
TEXTURED = single(2.0**-8, Quantity.PICTURE, "a filter's weights of 8 bits")
CODES = f"filtered codes of sRGB, times its slope {SLOPE:.3g}"
ENCODED = single(SLOPE * TEXTURED.value, Quantity.PICTURE, CODES)
FITTED, SHADED = (
    Tolerance((each, microfacets.sum_over(256)), Quantity.FITTED_PICTURE, scaled, exact=True)
    for each in (
        microfacets.MEAN.term("the fits of microfacets"),
        surfaces.ALBEDO.term("all lobes of a surface shader"),
    )
)


def tolerance_of(shader: Shader, lobes: Iterable[ShownLobe], host: Host, scene: Scene) -> Tolerance:
    """Tolerance of a material's picture: errors of fits or image filters, plus those of some lobes.

    Hosts filter an image before they decode its colors.
    """
    nodes, lobes = list(inner_nodes(shader.document)), tuple(lobes)
    fitted = FITTED_NODES & {lobe.category for lobe in lobes}
    modes = {lobe.inputs.get("mode") for lobe in lobes if lobe.category == SHEEN}
    zeltner = fitted == {SHEEN} and modes == {"zeltner"}  # the albedo has a closed form
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
    rings = subsurface.RINGS.term("subsurface scattering in six circles")
    others = [rings] * (SUBSURFACE in inner_lobes(shader))
    others += utilities.BLACKBODY.terms * ("blackbody" in categories(nodes))
    sheens = [ZELTNER_VALUE.term("Zeltner's sheens"), ZELTNER_ALBEDO.term("their albedos")]
    others += sheens * zeltner
    others += _others(lobes, scene.environment is None)
    rounding = host_row(host.name).rounding
    others += [Term(rounding, "the pixels' own rounding")] * bool(rounding)
    if others:
        added = tolerance.plus(*others)
        return replace(added, quantity=Quantity.FITTED_PICTURE, metric=scaled)
    return tolerance


def _others(lobes: tuple[ShownLobe, ...], direct: bool) -> list[Term]:
    """Additional errors due to a film, an index below 1, and narrow lobes of hair and sheen."""

    def some(name: str, condition: Callable[[np.ndarray], np.ndarray], category: str = "") -> bool:
        """Whether an input satisfies a condition at any point, in all lobes or in one category."""
        own = (each.inputs for each in lobes if category in ("", each.category))
        return any(bool(np.any(condition(each[name]))) for each in own if name in each)

    trapped = microfacets.FILM_TRAPPED.term("a film of an index below 1.25")
    inside = microfacets.ERRORS["denser"].term("the throughput of an index below 1")
    others: list[Term] = []
    films = [each for each in lobes if np.any(each.inputs.get("thinfilm_thickness", 0.0) > 0.0)]
    # In direct light, a film's albedo only affects light that passes to other lobes or through it.
    if films and direct:
        others += microfacets.film_terms(max(np.max(each.inputs["roughness"]) for each in films))
    if films and not (direct and {each.category for each in lobes} == {"conductor_bsdf"}):
        others.append(microfacets.FILM_SHOWN.term("a film's albedo, times the cosine of the view"))
        others += [trapped] * some("thinfilm_ior", lambda value: value < microfacets.LEAST_FILM)
    others += [inside] * some("ior", lambda value: value < 1.0, "dielectric_bsdf")
    fibers = product((lobe.inputs for lobe in lobes if lobe.category == HAIR), ROUGHNESSES)
    hairs = [np.reshape(inputs[name], (-1, 2)).min(axis=0) for inputs, name in fibers]
    others += [microfacets.ANISOTROPIC] * _stretched(lobes)
    if hairs:
        others += hair.lobe_terms(*np.min(hairs, axis=0))
    sheens = (lobe for lobe in lobes if lobe.inputs.get("mode") == "conty_kulla")
    narrow = [np.ravel(lobe.inputs["roughness"]).min() for lobe in sheens]
    if narrow:
        mu = np.linspace(1e-3, 1.0, COSINES)
        excess = float((mu * (conty_kulla_albedo_dir(mu, min(narrow)) - 1.0)).max())
        if excess > 0.0:
            others.append(Term(excess, "what a narrow sheen returns beyond all light"))
    return others


def _stretched(lobes: Iterable[ShownLobe]) -> bool:
    """Whether a microfacet lobe has two different alphas."""
    alphas = (each.inputs["roughness"] for each in lobes if each.category in MICROFACETS)
    return any(bool(np.ptp(np.reshape(each, (-1, 2)), axis=1).any()) for each in alphas)


Pixels: TypeAlias = NDArray[np.floating]
# A scene, the host's picture, the reference and the tolerance.
Shown: TypeAlias = tuple[Scene, Pixels, ExpectedPicture, Tolerance]
Pixel: TypeAlias = tuple[float, dict[str, list[float]], Pixels]
Note: TypeAlias = tuple[str, str]  # a warning, and its subject

MATCH = "Every pixel matches the reference."


def _read(
    file: Path, make: Callable[[], tuple[Shader, ...]]
) -> tuple[tuple[Shader, ...], dict[str, str], list[CodeWarning | notes.DocumentWarning]]:
    """Shaders of a document, their approximations by element, and other notes for readers."""
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
    """Compare a host's pictures of every material of a document with the reference.

    Raise DocumentError if no shader can be made from the document.
    """
    make = partial(host.compile, file, library=library, policy=policy)
    shaders, approximations, others = _read(file, make)
    found: list[Result] = []
    pictures: list[Picture] = []
    for shader in shaders:
        front_lit = shader.element in approximations
        values = HostValues(host, shader, library, policy)
        result, images = _judge_material(file, shader, host, judge, values, front_lit)
        found.append(result)
        pictures += images
    told = [(text, f"{file.name}: {element}") for element, text in approximations.items()]
    # Reasons why pictures cannot be correct, without duplicates.
    told += dict.fromkeys(
        (text, f"{file.name}: {shader.element}")
        for shader in shaders
        for scene in _scenes(host)
        for text in host.approximations(shader, scene)
    )
    # Omit range warnings if results already name the inputs.
    told_inputs = any(each.diagnosis.kind is Kind.INPUT for each in found)
    untold = (each for each in others if not (told_inputs and isinstance(each, notes.RangeWarning)))
    told += [(str(each), file.name) for each in untold]
    return tuple(found), tuple(pictures), tuple(told)


def _scenes(host: Host) -> tuple[Scene, ...]:
    """Scenes of a host; only those with a light if it has no environment."""
    scenes = host_row(host.name).scenes
    if host.active.environment == "none":
        scenes = tuple(each for each in scenes if each.environment is None)
    return scenes


def _judge_material(
    file: Path, shader: Shader, host: Host, judge: Reference, values: HostValues, front_lit: bool
) -> tuple[Result, tuple[Picture, ...]]:
    """Judge one material; if `front_lit`, the host has its model only for s >= 0."""
    scenes, library = _scenes(host), values.library
    subject = f"{file.name}: {shader.element}"
    place = Result("picture", MATCH, subject, host.name, library, results.NOT_RUN)
    try:
        images = [host.picture(shader, scene) for scene in scenes]
    except (NotRun, ShaderError) as error:
        return not_measured(place, error), ()
    identity = host.identity()

    def picture(
        scene: Scene, image: Pixels, expected: ExpectedPicture | None = None, judged: bool = True
    ) -> Picture:
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
        if expected is None or not judged:
            return Picture(*names, image, None, metadata)
        if expected.measured:
            metadata["from the host"] = ", ".join(expected.measured)
        reference, mask = np.asarray(expected.image, np.float32), expected.judged
        partly = mask.sum() < sphere(scene.size).mask.sum()
        where = mask[..., None].astype(np.float32) if partly else None
        return Picture(*names, image, reference, metadata, where)

    # Compare with the reference; pictures without a model only have to be finite.
    try:
        _assert_judged(shader, host)
        expected = [judge.expected(shader, scene, values) for scene in scenes]
        if front_lit:
            expected = list(map(_front_lit, expected, scenes))
    except OutsideModel as reason:
        return not_measured(place, reason), ()
    except NotRun as reason:
        return _judge_finite(place, images, str(reason)), tuple(map(picture, scenes, images))
    cases = list(zip(scenes, images, expected, strict=True))
    lobes = [lobe for each in expected for lobe in each.lobes]
    # A prefiltered environment supports only one alpha.
    rough = host.active.environment == "prefilter" and _stretched(lobes)
    judged = [not rough or scene.environment is None for scene in scenes]
    pictures = tuple(picture(*case, each) for case, each in zip(cases, judged, strict=True))

    def diagnose() -> Diagnosis:
        if known := _known(shader):
            return known
        if library == RENDERER_NODES:
            return _input_at_fault(shader, host, judge, scenes)
        if names := judge.other_node(shader, values):
            return Diagnosis((Cause(Kind.DEFECT, "other_node", names),))
        follows = tuple({lobe.category: None for lobe in lobes})
        return Diagnosis((Cause(Kind.FOLLOWS, names=follows),))

    shown = [
        (*case, tolerance_of(shader, lobes, host, case[0])) for case in compress(cases, judged)
    ]
    result = _judge_match(place, shown, diagnose)
    apart = filter(None, (each.difference for each in pictures))
    worst = max(apart, key=lambda each: abs(each.largest))
    return replace(result, difference=worst), pictures


SMALL = 64  # picture size in pixels, enough to find the input at fault


def _input_at_fault(
    shader: Shader, host: Host, judge: Reference, scenes: Sequence[Scene]
) -> Diagnosis:
    """The input whose removal brings a renderer's own material closest to the reference."""
    small = [replace(scene, size=SMALL) for scene in scenes]
    names = [each.getName() for each in surface_shader(shader.document, shader.element).getInputs()]
    left: dict[str, float] = {}
    for name in ("", *names):
        document = mx.createDocument()
        document.copyContentFrom(shader.document)
        surface_shader(document, shader.element).removeInput(name)
        with suppress(NotRun, DocumentError):
            [other] = host.compile(document, shader.element)
            shown = ((host.picture(other, each), judge.picture(other, each)) for each in small)
            left[name] = max(float(np.abs(difference(*each)).max()) for each in shown)
    nearest = min(left, key=left.__getitem__, default="")
    if not nearest or "" not in left or left[nearest] > 0.5 * left[""]:
        return Diagnosis((Cause(Kind.UNKNOWN, "no_input"),))
    sizes = left[nearest], left[""]
    return Diagnosis((Cause(Kind.DEFECT, "input_at_fault", (nearest,), sizes),))


def _known(shader: Shader) -> Diagnosis | None:
    """A known error of MaterialX that the shader's document triggers, or None."""
    element = shader.document.getDescendant(shader.element)
    if names := notes.same_names(element):
        return diagnosis.defect("same_names", names[0])
    graph = element.getImplementation() if element.isA(mx.Node) else None
    defined = element.getType() == "material" and graph and graph.isA(mx.NodeGraph)
    return diagnosis.defect("material_graph") if defined else None


def _assert_judged(shader: Shader, host: Host) -> None:
    """Raise NotRun if the host renders another material, or closures that have separate checks."""
    if reason := host.unread(shader):
        raise NotRun(f"{host.name}: {reason}: the picture is shown and only has to be finite")
    own = sorted(categories(inner_nodes(shader.document)) & set(BSDF_NODES))
    if own and host.language == "osl":
        raise NotRun(
            f"{host.name} has its own closures for {', '.join(own)}: their picture is shown and "
            "only has to be finite"
        )


def _judge_finite(place: Result, images: Sequence[Pixels], reason: str) -> Result:
    """Result for a material that the models do not cover: its pixels must be finite."""

    def measure(wrong: bool) -> Measurement:
        shown = [np.where(np.arange(3) == 0, np.nan, images[0])] if wrong else images
        wrong_pixels = sum((~np.isfinite(each)).any(axis=-1).sum() for each in shown)
        return Measurement(float(wrong_pixels), {})

    place = replace(place, check="finite", claim="Every pixel is finite.")
    none = count_of(Quantity.PIXELS)
    result = judge(place, none, measure, "one channel is not a number", Diagnosis)
    return replace(result, diagnosis=results.quoted(reason))


def _judge_match(
    place: Result, cases: Sequence[Shown], diagnose: Callable[[], Diagnosis]
) -> Result:
    """Result for a material that the models cover: its pixels must match the reference.

    Error and tolerance are from the picture with the largest error relative to its tolerance.
    """
    pixels = [_worst_pixel(case) for case in cases]
    allowed = [case[3].value for case in cases]
    largest = int(np.argmax([each[0] / most for each, most in zip(pixels, allowed, strict=True)]))
    error, worst, _ = pixels[largest]
    scene, image, expected, tolerance = cases[largest]

    def measure(wrong: bool) -> Measurement:
        if not wrong:
            scaled_errors = [
                each[2] * (tolerance.value / most)
                for each, most in zip(pixels, allowed, strict=True)
            ]
            parts = [
                errors_of(each, tolerance.value, results.Region(case[0].name))
                for case, each in zip(cases, scaled_errors, strict=True)
            ]
            whole = errors_of(np.concatenate(scaled_errors), tolerance.value)
            errors = (whole, *parts) if error > tolerance.value else ()
            return Measurement(error, worst, errors, "pixels")
        brighter = image + np.float32(3.0 * tolerance.value) * np.maximum(1.0, image)
        return Measurement(_worst_pixel((scene, brighter, expected, tolerance))[0], {})

    words = "the picture is brighter by three tolerances"
    result = judge(place, tolerance, measure, words, diagnose)
    measured = dict.fromkeys(name for case in cases for name in case[2].measured)
    return replace(result, measured=tuple(measured))


def _worst_pixel(case: Shown) -> Pixel:
    """Largest error times cos(theta_o), the pixel where it occurs, and all errors."""
    scene, image, (reference, mask) = case[0], case[1], (case[2].image, case[2].judged)
    wo, _ = _directions(scene, mask)
    measured, expected = (each[mask].astype(np.float64) for each in (image, reference))
    error = case[3].metric(measured, expected) * wo[:, 2]
    worst = int(error.argmax())
    row, column = np.argwhere(mask)[worst]
    point = {
        "row": [float(row)],
        "column": [float(column)],
        "measured": image[row, column].astype(float).tolist(),
        "expected": reference[row, column].tolist(),
    }
    return float(error[worst]), point, error


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
STUDIED = 4  # maximum materials drawn per document


def studio_pictures(
    file: Path, host: Host, library: str, policy: Policy = DEFAULT
) -> tuple[Picture, ...]:
    """Presentation pictures of a document's first materials: a shader ball in a studio."""
    shaders, _, _ = _read(file, lambda: host.compile(file, library=library, policy=policy))
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
    """Result of generating a document's shaders for a host's target, and notes with their location.

    Raise DocumentError if no shader can be made from the document; NotRun if the host reads no
    documents, or this MaterialX has no generator for its target.
    """
    target = host_row(host).target
    if not target:
        raise NotRun(f"{host}: this renderer only has its own materials; it reads no documents")
    if target not in TARGETS:
        raise NotRun(f"{host}: this MaterialX has no generator for {target}")
    shaders, _, told = _read(file, lambda: generate(file, target, library=library, policy=policy))
    data = file.read_bytes()
    half = data[: len(data) // 2].decode(errors="replace")
    try:
        generate(half if "<" in half else "<", target, library=library)
        caught = False
    except DocumentError:
        caught = True
    place = Result(DOCUMENT_KEY, DOCUMENT_CLAIM, file.name, host, library, results.NOT_RUN)
    none, words = count_of(Quantity.DOCUMENTS), "half of the document is cut off"
    faults = {False: not shaders, True: caught}
    result = judge(place, none, lambda x: Measurement(float(faults[x]), {}), words, Diagnosis)
    return (result,), tuple((str(each), file.name) for each in told)


# --- one material of each node, for the page that compares hosts ----------------------------------

PORTRAYED: samples.Values = {"color": (0.8, 0.4, 0.1), "roughness": 1.0}
PORTRAIT_SCENES = tuple(replace(scene, size=96) for scene in (SIDE, BACK))


def comparison_pictures(case: Case) -> tuple[Picture, ...]:
    """Pictures of a rough node in light from the side and from behind, and the same pictures of
    its model.

    Empty for a surface shader's lobe, and for renderers in which each pixel shows one pair. Rim
    and terminator are black in both pictures.
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
        image, expected = (np.zeros((*where.shape, 3), np.float32) for _ in range(2))
        image[where], expected[where] = case.direct(batch), case.expected(batch)
        names = (results.PORTRAIT, case.spec.title, case.host.name, case.library, scene.name)
        keys = ("document", "element", "host", "library", "scene")
        metadata = dict(zip(keys, names, strict=True)) | {"version": mxeon.__version__}
        metadata |= {"points": case.host.name}  # a host may implement only part of the model
        pictures.append(Picture(*names, image, expected, metadata))
    return tuple(pictures)
