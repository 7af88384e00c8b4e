# SPDX-License-Identifier: Apache-2.0
"""The checks of a renderer's pictures, called questions.

A question passes if the pictures equal the model up to noise, pixel size and mesh, and a wrong
variant with the same noise fails.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance import results, words
from mxeon.conformance.results.quantities import Quantity
from mxeon.errors import assert_known
from mxeon.kit.encoding import fault
from mxeon.kit.expected import Expected, expected, judged, pixel_means
from mxeon.kit.noise import CONFIDENCE, Tiles, ratio, tiles
from mxeon.kit.views import (
    BLACK_MATERIAL,
    FALSE,
    HALF,
    LAMBERT,
    TRUE,
    WHITE_MATERIAL,
    Material,
    View,
)
from mxeon.models import table as reference
from mxeon.shaders.nodes import FLAG

# Noise hides the difference of these models from others: EON's quartic differs by at most 1e-3.
TOO_NEAR = ("eon_approx",)


@dataclass(frozen=True)
class ModelDistance:
    """Distance of a known model or defect from the pictures of a question."""

    title: str
    distance: float  # rms of the tiles' mean errors, in units of pi f cos or of albedo
    ratio: float  # see `mxeon.kit.noise.ratio`; the pictures agree if it is at most 1


def candidates(pictures: Sequence[JudgedPicture], depth: float) -> list[ModelDistance]:
    """All known models and defects, nearest first, without duplicates."""
    rows = reference.KNOWN_DEFECTS + reference.DIFFUSE_MODELS + reference.PARAMETRIZATIONS
    rows = tuple(row for row in rows if row.name not in TOO_NEAR)
    if all(case.view.scene.light for case in pictures):
        # Drop models that differ only in the albedo.
        rows = tuple({row.brdf_of: row for row in rows}.values())
    ranking = []
    for row in rows:
        models = [expected(row, case.view, depth) for case in pictures]
        errors = _tiles(pictures, models)
        rms = float(np.sqrt(np.mean(np.concatenate([each.mean for each in errors]) ** 2)))
        ranking.append(ModelDistance(row.title, rms, ratio(errors)))
    ranking.sort(key=lambda one: one.distance)
    # At roughness 1, models of roughness and of its square coincide; keep the first.
    return [
        one
        for one, before in zip(ranking, [None, *ranking], strict=False)
        if before is None or one.distance != before.distance
    ]


def nearest(ranking: Sequence[ModelDistance]) -> results.Diagnosis:
    """The nearest model, and models that the pictures do not distinguish from it."""
    causes = [results.Cause(results.Kind.MODEL, ranking[0].title, rms=ranking[0].distance)]
    also = tuple(each.title for each in ranking[1:] if each.ratio <= 1.0)
    if ranking[0].ratio > 1.0:
        causes.append(results.Cause(results.Kind.DEFECT, "neither_fits"))
    elif also:
        causes.append(results.Cause(results.Kind.DEFECT, "cannot_be_told_from", also))
    return results.Diagnosis(tuple(causes), {each.title: each.distance for each in ranking})


DERIVATION = (
    "Student's t of each tile's mean error over its noise, Bonferroni over all tiles, channels and "
    f"questions: a kit of correct pictures fails with probability {1.0 - CONFIDENCE:.1g}; added are "
    "a pixel's mean against its center, the depth of the mesh, and rounding to half"
)


@dataclass(frozen=True)
class Question:
    """A check of one or more pictures, and its negative control."""

    key: str
    claim: str
    materials: tuple[Material, ...]
    lit: bool  # distant light; False for an environment, for which rasterizers have other formulas
    variant: str  # describes the negative control
    wrong: Callable[[View], NDArray[np.float64]]  # the control's values (N, 3)
    model: str = ""  # required model; "" for the model of each material

    @property
    def title(self) -> str:
        material = self.materials[0]
        flagged = self.model.upper() or f"{FLAG} {str(material.energy_compensation).lower()}"
        name = flagged if self.key == "model" else material.name
        return f"{name}, {'distant light' if self.lit else 'environment'}"

    def row(self, view: View) -> reference.Model:
        return reference.diffuse_model(self.model or view.material.model)

    def includes(self, view: View) -> bool:
        return view.material in self.materials and (view.scene.light is not None) == self.lit


@dataclass(frozen=True)
class JudgedPicture:
    view: View
    mask: NDArray[np.bool_]
    values: NDArray[np.float64]  # (N, 3), at the pixels of the mask


def _of(name: str, factor: float = 1.0) -> Callable[[View], NDArray[np.float64]]:
    """Values of a model times a factor, for a negative control."""
    return lambda view: factor * pixel_means(reference.diffuse_model(name), view)


SETUP_RIGHT = "Lambert under a distant light has the right light, orientation and encoding."
IS_MODEL = "The pictures equal the model, up to noise and the depth of a mesh."
BLACK_IS = "A black surface reflects nothing."
WHITE_IS = "A white surface in a white environment is invisible."
DROPPED, STUCK = "the flag is dropped", "the flag is stuck"
QUESTIONS = (
    Question("setup", SETUP_RIGHT, (LAMBERT,), True, "5 % more light", _of("lambert", 1.05)),
    Question("model", IS_MODEL, (TRUE, HALF), True, DROPPED, _of("qon")),
    Question("model", IS_MODEL, (TRUE,), False, DROPPED, _of("qon")),
    Question("model", IS_MODEL, (FALSE,), True, STUCK, _of("eon")),
    Question("model", IS_MODEL, (FALSE,), False, STUCK, _of("eon")),
    Question(
        "black", BLACK_IS, (BLACK_MATERIAL,), True, "a white lobe is added", _of("fon_white_lobe")
    ),
    Question("white", WHITE_IS, (WHITE_MATERIAL,), False, "the second lobe is dropped", _of("fon")),
)

CLAIMS = ("eon", "qon", "fon", "lambert")


def questions(claim: str = "") -> tuple[Question, ...]:
    """Questions for a renderer that claims one model; for "", for one that supports the flag."""
    if not claim:
        return QUESTIONS
    assert_known("claims", claim, CLAIMS)
    # Choose materials with the model's roughness.
    rough = (FALSE,) if claim == "qon" else (TRUE, HALF)
    dropped, acts = ("roughness is dropped", _of("lambert")), ("roughness acts", _of("eon"))
    control = (*(acts if claim == "lambert" else dropped), claim)
    setup, *_, black, white = QUESTIONS
    return (
        setup,
        Question("model", IS_MODEL, rough, True, *control),
        Question("model", IS_MODEL, rough[:1], False, *control),
        black,
        *([white] if claim in ("eon", "lambert") else []),
    )


def one_model(
    posed: Sequence[Question],
    views: Sequence[View],
    images: Mapping[str, NDArray[np.float64]],
    depth: float,
) -> str:
    """Title of the model that explains all pictures of rough materials; "" if none does."""
    rough = [each for each in posed if each.key == "model"]
    chosen = [view for view in views if any(each.includes(view) for each in rough)]
    if any(view.name not in images for view in chosen):
        return ""
    nearest = candidates(_judged(chosen, images), depth)[0]
    return nearest.title if nearest.ratio <= 1.0 else ""


def answer(
    question: Question,
    views: Sequence[View],
    images: Mapping[str, NDArray[np.float64]],
    depth: float,
    place: Mapping[str, Any],
    obstacle: results.Diagnosis = results.NO_DIAGNOSIS,
) -> tuple[results.Result, results.Diagnosis]:
    """Answer a question: its result, and the model or fault that the pictures show.

    An `obstacle` prevents the answer, and becomes its reason.
    """
    chosen = [view for view in views if question.includes(view)]
    place = {"check": question.key, "claim": question.claim, "subject": question.title, **place}
    missing = [view.name for view in chosen if view.name not in images]
    if obstacle.causes or missing:
        reason = words.diagnosis(obstacle) or f"no usable picture: {', '.join(missing)}"
        return results.Result(**place, verdict=results.NOT_RUN, reason=reason), results.NO_DIAGNOSIS
    cases = _judged(chosen, images)
    models = [expected(question.row(view), view, depth) for view in chosen]
    errors = _tiles(cases, models)
    share = 1.0 / len(QUESTIONS)
    error = ratio(errors, share)
    wrong = ratio(_tiles(cases, models, [question.wrong(view) for view in chosen]), share)
    noise = float(np.sqrt(np.mean([each.pixel_noise**2 for each in errors])))
    if max(error, wrong) <= 1.0:
        reason = (
            f"too noisy to detect that {question.variant}: {noise:.2g} rms per pixel; "
            "render with more samples"
        )
        return results.Result(**place, verdict=results.NOT_RUN, reason=reason), results.NO_DIAGNOSIS
    ranking = candidates(cases, depth) if question.key == "model" else []
    shown = nearest(ranking) if ranking else results.Diagnosis()
    if question.key == "setup" and error > 1.0:
        name = cases[0].view.name
        shown = fault(name, images[name], models[0], cases[0].mask)
    return results.Result(
        **place,
        verdict=results.PASSED if error <= 1.0 < wrong else results.FAILED,
        error=error,
        quantity=Quantity.KIT,
        tolerance=1.0,
        derivation=DERIVATION,
        worst={"noise of a pixel, rms": [noise]},
        diagnosis=shown if error > 1.0 else results.Diagnosis(distances=shown.distances),
        control=results.Control(question.variant, wrong, wrong > 1.0),
    ), shown


def _judged(
    chosen: Sequence[View], images: Mapping[str, NDArray[np.float64]]
) -> list[JudgedPicture]:
    masks = [judged(view.scene) for view in chosen]
    return [
        JudgedPicture(view, mask, images[view.name][mask])
        for view, mask in zip(chosen, masks, strict=True)
    ]


def _tiles(
    cases: Sequence[JudgedPicture],
    models: Sequence[Expected],
    wrong: Sequence[NDArray[np.float64]] | None = None,
) -> list[Tiles]:
    """Tiles of the errors; for `wrong` values, their difference from the model is added."""
    wrong = wrong or [model.value for model in models]
    return [
        tiles(case.values + other - 2.0 * model.value, model.slack, case.mask)
        for case, model, other in zip(cases, models, wrong, strict=True)
    ]
