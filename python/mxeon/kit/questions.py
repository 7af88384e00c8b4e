# SPDX-License-Identifier: Apache-2.0
"""The checks of a renderer's pictures, which are called questions.

A question passes if the pictures equal the model up to noise, pixel size and mesh, and a wrong
variant with the same noise fails.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from mxeon.conformance import results, words
from mxeon.conformance.results.quantities import Quantity
from mxeon.errors import assert_known
from mxeon.io.srgb import srgb_decoded
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

# Models that noise makes indistinguishable from other models. EON's quartic approximation differs
# from EON by at most 1e-3.
TOO_NEAR = ("eon_approx",)
Images: TypeAlias = Mapping[str, NDArray[np.float64]]  # usable pictures by name of the view


# --- faults of a picture --------------------------------------------------------------------------
# All models have equal values for the Lambert material under a distant light. The picture of this
# material reveals a wrong encoding, orientation or scale, whatever the model.

MISFIT = 0.02  # largest relative rms error, without noise, of a picture that a fault explains
SAME_SCALE = 0.005  # a factor closer to 1 is due to noise or a mesh


def _without_tone_mapping(image: NDArray[np.float64]) -> NDArray[np.float64]:
    """The inverse of x / (1 + x) for values below 1, and infinity for other values."""
    return np.divide(image, 1.0 - image, out=np.full_like(image, np.inf), where=image < 1.0)


# Keys of faults in `mxeon.conformance.words.DEFECTS`, and functions that undo the faults.
FAULTS = (
    ("scaled", lambda image: image),
    ("srgb", lambda image: srgb_decoded(np.clip(image, 0.0, None))),
    ("power", lambda image: np.clip(image, 0.0, None) ** 2.2),
    ("tone_mapped", _without_tone_mapping),
    ("upside_down", lambda image: image[::-1]),
    ("mirrored", lambda image: image[:, ::-1]),
    ("rotated", lambda image: image[::-1, ::-1]),
)


def fault(
    name: str, image: NDArray[np.float64], model: Expected, mask: NDArray[np.bool_]
) -> results.Diagnosis:
    """The fault that explains the picture `name`, or a symptom such as a clipped picture."""

    def found(key: str, *factors: float) -> results.Diagnosis:
        cause = results.Cause(results.Kind.DEFECT, f"picture_{key}", (name,), factors)
        return results.Diagnosis((cause,))

    if not image[mask].any():
        return found("black")
    fits = {key: _fit(undo(image)[mask], model, mask) for key, undo in FAULTS}
    key = min(fits, key=lambda each: fits[each][1])
    factor, misfit = fits[key]
    if misfit <= MISFIT:
        if abs(factor - 1.0) > SAME_SCALE:
            return found(key, factor)
        return results.NO_DIAGNOSIS if key == "scaled" else found(key)
    # A picture is clipped if many pixels have the largest value but different expected values.
    top = image[mask] >= image[mask].max() - 1e-6
    clipped = top.sum() > 20 and np.ptp(model.value[top]) > 0.02
    return found("clipped" if clipped else "unknown")


def _fit(
    values: NDArray[np.float64], model: Expected, mask: NDArray[np.bool_]
) -> tuple[float, float]:
    """Best scale factor of the model, and the relative rms misfit without noise (or infinity)."""
    if not np.isfinite(values).all() or (values * model.value).sum() <= 0.0:
        return 0.0, np.inf
    factor = (values * model.value).sum() / (model.value**2).sum()
    fitted = factor * model.value
    error = values - fitted
    noise = tiles(error, model.slack, mask).pixel_noise
    misfit = np.sqrt(max(0.0, np.mean(error**2) - noise**2))
    return factor, misfit / np.sqrt(np.mean(fitted**2))


# --- models ---------------------------------------------------------------------------------------


@dataclass(frozen=True)
class ModelDistance:
    """Distance of a known model or defect from the pictures of a question."""

    title: str
    distance: float  # rms of the mean errors of tiles, in units of pi f cos or of albedo
    ratio: float  # `mxeon.kit.noise.ratio`, at most 1 if the pictures show the model


def candidates(views: Sequence[View], images: Images, depth: float) -> list[ModelDistance]:
    """All known models and defects, nearest first, without duplicates."""
    rows = reference.KNOWN_DEFECTS + reference.DIFFUSE_MODELS + reference.PARAMETRIZATIONS
    rows = tuple(row for row in rows if row.name not in TOO_NEAR)
    if all(view.scene.light for view in views):
        # Models that differ only in the albedo are equal in direct light. The last model is kept.
        rows = tuple({row.brdf_of: row for row in rows}.values())
    ranking = []
    for row in rows:
        errors = _tiles(views, images, [expected(row, view, depth) for view in views])
        rms = float(np.sqrt(np.mean(np.concatenate([each.mean for each in errors]) ** 2)))
        ranking.append(ModelDistance(row.title, rms, ratio(errors)))
    distinct: dict[float, ModelDistance] = {}
    for each in sorted(ranking, key=lambda model: model.distance):
        # At roughness 1, a variant that squares the roughness equals the original model. Whichever
        # comes first in the table is kept.
        distinct.setdefault(each.distance, each)
    return list(distinct.values())


def nearest(ranking: Sequence[ModelDistance]) -> results.Diagnosis:
    """The nearest model, and all models that the pictures do not distinguish from that model."""
    causes = [results.Cause(results.Kind.MODEL, ranking[0].title, rms=ranking[0].distance)]
    also = tuple(each.title for each in ranking[1:] if each.ratio <= 1.0)
    if ranking[0].ratio > 1.0:
        causes.append(results.Cause(results.Kind.DEFECT, "neither_fits"))
    elif also:
        causes.append(results.Cause(results.Kind.DEFECT, "cannot_be_told_from", also))
    return results.Diagnosis(tuple(causes), {each.title: each.distance for each in ranking})


DERIVATION = (
    "Student's t of each tile's mean error divided by its noise, with Bonferroni's correction for "
    "all tiles, channels and questions: a kit of correct pictures fails with probability "
    f"{1.0 - CONFIDENCE:.1g}; plus the difference between a pixel's mean and its center, the depth "
    "of the mesh, and rounding to half"
)


@dataclass(frozen=True)
class Question:
    """A check of one or more pictures, with a negative control."""

    key: str
    claim: str
    materials: tuple[Material, ...]
    lit: bool  # True for a distant light, False for an environment
    variant: str  # describes the negative control
    wrong: Callable[[View], NDArray[np.float64]]  # values of the negative control, (N, 3)
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


def control(name: str, factor: float = 1.0) -> Callable[[View], NDArray[np.float64]]:
    """A function that returns the values of a model times a factor, for a negative control."""
    return lambda view: factor * pixel_means(reference.diffuse_model(name), view)


SETUP = "The Lambert picture has the right brightness, orientation and encoding."
MODEL = "The pictures equal the model, up to noise and errors of a mesh."
BLACK = "A black surface reflects nothing."
WHITE = "A white surface in a white environment is invisible."
DROPPED, STUCK = "the flag is dropped", "the flag is stuck"
ADDED, MISSING = "a white lobe is added", "the second lobe is dropped"
QUESTIONS = (
    Question("setup", SETUP, (LAMBERT,), True, "5 % more light", control("lambert", 1.05)),
    Question("model", MODEL, (TRUE, HALF), True, DROPPED, control("qon")),
    Question("model", MODEL, (TRUE,), False, DROPPED, control("qon")),
    Question("model", MODEL, (FALSE,), True, STUCK, control("eon")),
    Question("model", MODEL, (FALSE,), False, STUCK, control("eon")),
    Question("black", BLACK, (BLACK_MATERIAL,), True, ADDED, control("fon_white_lobe")),
    Question("white", WHITE, (WHITE_MATERIAL,), False, MISSING, control("fon")),
)

CLAIMS = ("eon", "qon", "fon", "lambert")


def questions(claim: str = "") -> tuple[Question, ...]:
    """Questions for a renderer with the model `claim` or, if `claim` is "", with EON and QON."""
    if not claim:
        return QUESTIONS
    assert_known("claims", claim, CLAIMS)
    # Only the materials `rough` have a roughness with the meaning that the claimed model needs.
    rough = (FALSE,) if claim == "qon" else (TRUE, HALF)
    variant = "roughness is dropped", control("lambert"), claim
    if claim == "lambert":
        variant = "roughness acts", control("eon"), claim
    setup, *_, black, white = QUESTIONS
    return (
        setup,
        Question("model", MODEL, rough, True, *variant),
        Question("model", MODEL, rough[:1], False, *variant),
        black,
        *([white] if claim in ("eon", "lambert") else []),
    )


def one_model(
    posed: Sequence[Question], views: Sequence[View], images: Images, depth: float
) -> str:
    """Title of the model that explains all pictures of rough materials, or "" if no model does."""
    rough = [each for each in posed if each.key == "model"]
    chosen = [view for view in views if any(each.includes(view) for each in rough)]
    if any(view.name not in images for view in chosen):
        return ""
    best = candidates(chosen, images, depth)[0]
    return best.title if best.ratio <= 1.0 else ""


def answer(
    question: Question,
    views: Sequence[View],
    images: Images,
    depth: float,
    place: Mapping[str, Any],
    obstacle: results.Diagnosis,
) -> tuple[results.Result, results.Diagnosis]:
    """The result of a question, and the model or fault that the pictures show.

    If there is an `obstacle`, the question is not answered, and the obstacle is the reason.
    """
    chosen = [view for view in views if question.includes(view)]
    place = {"check": question.key, "claim": question.claim, "subject": question.title, **place}
    missing = [view.name for view in chosen if view.name not in images]
    if obstacle.causes or missing:
        reason = words.diagnosis(obstacle) or f"no usable picture: {', '.join(missing)}"
        return results.Result(**place, verdict=results.NOT_RUN, reason=reason), results.NO_DIAGNOSIS
    models = [expected(question.row(view), view, depth) for view in chosen]
    errors = _tiles(chosen, images, models)
    share = 1.0 / len(QUESTIONS)
    error = ratio(errors, share)
    wrong = ratio(_tiles(chosen, images, models, [question.wrong(view) for view in chosen]), share)
    noise = float(np.sqrt(np.mean([each.pixel_noise**2 for each in errors])))
    if max(error, wrong) <= 1.0:
        reason = (
            f"too noisy to detect that {question.variant}: {noise:.2g} rms per pixel; "
            "render with more samples"
        )
        return results.Result(**place, verdict=results.NOT_RUN, reason=reason), results.NO_DIAGNOSIS
    found = results.NO_DIAGNOSIS
    if question.key == "model":
        found = nearest(candidates(chosen, images, depth))
    elif question.key == "setup" and error > 1.0:
        found = fault(chosen[0].name, images[chosen[0].name], models[0], judged(chosen[0].scene))
    return results.Result(
        **place,
        verdict=results.PASSED if error <= 1.0 < wrong else results.FAILED,
        error=error,
        quantity=Quantity.KIT,
        tolerance=1.0,
        derivation=DERIVATION,
        worst={"noise of a pixel, rms": [noise]},
        diagnosis=found if error > 1.0 else results.Diagnosis(distances=found.distances),
        control=results.Control(question.variant, wrong, wrong > 1.0),
    ), found


def _tiles(
    views: Sequence[View],
    images: Images,
    models: Sequence[Expected],
    wrong: Sequence[NDArray[np.float64]] | None = None,
) -> list[Tiles]:
    """Errors of pictures in tiles, plus the errors of the `wrong` values, if given."""
    wrong = wrong or [model.value for model in models]
    found = []
    for view, model, other in zip(views, models, wrong, strict=True):
        mask = judged(view.scene)
        error = images[view.name][mask] + other - 2.0 * model.value
        found.append(tiles(error, model.slack, mask))
    return found
