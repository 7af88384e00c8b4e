# SPDX-License-Identifier: Apache-2.0
"""Materials from documents: their pictures on a host against the reference's, pixel by pixel."""

import warnings

import numpy as np

import mxeon
from mxeon.conformance.checks.measures import absolute
from mxeon.conformance.checks.probes import picture_pairs
from mxeon.conformance.checks.table import ROUNDING
from mxeon.conformance.results import FAILED, NOT_RUN, PASSED, Control, Picture, Result
from mxeon.errors import NotRun, OutsideModel, ShaderError
from mxeon.shaders.document.notes import DocumentWarning, MissingFileWarning
from mxeon.shaders.document.policy import DEFAULT
from mxeon.shaders.generation import ApproximationWarning, CodeWarning, generate
from mxeon.shaders.hosts import host_row
from mxeon.shaders.scene import sphere

# Errors are taken times cos(theta_o): the normal changes by its inverse from pixel to pixel.
UNIT = "pi f cos, times cos(theta_o)"
PLAIN = (
    48 * ROUNDING,
    "16 roundings of float32, 2^-24 each, in the place of a pixel's point, and 32 in the value",
)
TEXTURED = (
    2.0**-8,
    "a filter's weights have 8 bits after the point, the least OpenGL asks for, and texels differ "
    "by 1 at most",
)


MATCH = "The picture is the reference's in every pixel."
FINITE = "No pixel is infinite or not a number."


def judge_document(file, host, judge, library, policy=DEFAULT):
    """Pictures of every material of a document on a host, and whether they are the reference's.

    Parameters
    ----------
    file : path-like
    host, judge : host
        Who is judged, and the reference.
    library : str
        Name of the data library.
    policy : Policy
        What the document may do, and how large it may be.

    Returns
    -------
    tuple of Result, tuple of Picture, tuple of (str, str)
        The last are what the host approximates, and where.

    Raises
    ------
    DocumentError
        If no shader can be made from the document.
    """
    options = {"library": library, "profile": host.profile, "lights": True}
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        warnings.simplefilter("error", MissingFileWarning)
        shaders = generate(file, host.target, policy=policy, **options)
    said = [each.message for each in caught]
    approximations = [each for each in said if isinstance(each, ApproximationWarning)]
    approximated = {each.element: each.approximation for each in approximations}
    results, pictures = [], []
    for shader in shaders:
        front_lit = shader.element in approximated
        result, shown = _judge_material(file, shader, host, judge, library, front_lit)
        results.append(result)
        pictures += shown
    notes = [(text, f"{file.name}: {place}") for place, text in approximated.items()]
    others = (CodeWarning, DocumentWarning)
    notes += [(str(each), file.name) for each in said if isinstance(each, others)]
    return tuple(results), tuple(pictures), tuple(notes)


def _judge_material(file, shader, host, judge, library, front_lit):
    """One material; `front_lit` where the host has its model for s >= 0 only."""
    scenes = host_row(host.name).scenes
    subject = f"{file.name}: {shader.element}"
    place = {"subject": subject, "host": host.name, "library": library}
    try:
        images = [host.picture(shader, scene) for scene in scenes]
    except NotRun as reason:
        return Result("picture", MATCH, **place, verdict=NOT_RUN, reason=str(reason)), ()
    except ShaderError as error:
        return Result("picture", MATCH, **place, verdict=FAILED, diagnosis=str(error)), ()
    try:
        references = [judge.picture(shader, scene) for scene in scenes]
    except OutsideModel as reason:
        return Result("picture", MATCH, **place, verdict=NOT_RUN, reason=str(reason)), ()
    except NotRun as reason:
        references = [None] * len(scenes)
        result = _judge_finite(place, images, str(reason))
    else:
        cases = list(zip(scenes, images, references, strict=True))
        result = _judge_match(place, cases, TEXTURED if _textured(shader) else PLAIN, front_lit)
    identity = host.identity()
    made = {"version": mxeon.__version__, "host": f"{host.name} {identity.version}"}
    made |= {"device": identity.device, "library": library, "document": str(file)}
    return result, tuple(
        Picture(
            file.name,
            shader.element,
            host.name,
            library,
            scene.name,
            image,
            reference,
            made | {"element": shader.element, "scene": scene.name},
        )
        for scene, image, reference in zip(scenes, images, references, strict=True)
    )


def _textured(shader):
    return any(each.type == "filename" and each.value for each in shader.inputs)


def _judge_finite(place, images, reason):
    """A material that the models do not cover: all one can ask is numbers."""
    planted = [np.where(np.arange(3) == 0, np.nan, images[0])]
    bad, caught = _not_finite(images), _not_finite(planted)
    return Result(
        "finite",
        FINITE,
        **place,
        verdict=PASSED if bad == 0 < caught else FAILED,
        error=bad,
        unit="pixels",
        tolerance=0,
        derivation="a count",
        diagnosis=reason,
        control=Control("one channel is not a number", caught, caught > 0),
    )


def _not_finite(images):
    return float(sum((~np.isfinite(image)).any(axis=-1).sum() for image in images))


def _judge_match(place, cases, tolerance, front_lit):
    limit, derivation = tolerance
    error, worst, light = max(
        ((*_worst_pixel(*case, front_lit), case[0].name) for case in cases),
        key=lambda found: found[0],
    )
    scene, image, expected = cases[0]
    brighter, _ = _worst_pixel(scene, image + np.float32(3.0 * limit), expected, front_lit)
    return Result(
        "picture",
        MATCH,
        **place,
        verdict=PASSED if error <= limit < brighter else FAILED,
        error=error,
        unit=UNIT,
        tolerance=limit,
        derivation=derivation,
        worst=worst,
        diagnosis="" if error <= limit else f"most in the picture of the scene {light}",
        control=Control("the picture is brighter by three tolerances", brighter, brighter > limit),
    )


def _worst_pixel(scene, image, reference, front_lit):
    """Largest error times cos(theta_o), and the pixel where it is."""
    mask = sphere(scene.size).mask
    wo, wi, _ = picture_pairs(scene)
    error = absolute(image[mask], reference[mask]) * wo[:, 2]
    if front_lit:
        error = np.where((wo[:, :2] * wi[:, :2]).sum(axis=1) >= 0.0, error, 0.0)
    worst = int(error.argmax())
    row, column = np.argwhere(mask)[worst]
    return float(error[worst]), {
        "row": [float(row)],
        "column": [float(column)],
        "measured": image[row, column].astype(float).tolist(),
        "expected": reference[row, column].tolist(),
    }
