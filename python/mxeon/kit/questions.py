# SPDX-License-Identifier: Apache-2.0
"""The questions put to a renderer's pictures, and how each is answered.

A question passes if the pictures are the model's but for noise, pixel and mesh, and if a wrong
variant, made from the same noisy pictures, would have failed.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from mxeon.conformance.results import FAILED, NOT_RUN, PASSED, Control, Result
from mxeon.kit.diagnosis import candidates, named
from mxeon.kit.encoding import fault
from mxeon.kit.expected import expected, judged, pixel_means
from mxeon.kit.noise import CONFIDENCE, ratio, tiles
from mxeon.kit.views import BLACK, FALSE, HALF, LAMBERT, TRUE, WHITE
from mxeon.models import table as reference

FLAG = "energy_compensation"
UNIT = "allowances for noise, pixel and mesh"
DERIVATION = (
    "Student's t of each tile's mean error over its noise, Bonferroni over all tiles, channels and "
    f"questions: {1.0 - CONFIDENCE:.1g} is the false rate of a whole kit; added are a pixel's mean "
    "against its center, the depth of the mesh, and rounding to half"
)


@dataclass(frozen=True)
class Question:
    """Pictures that are judged together, and what they have to be.

    Attributes
    ----------
    key, claim : str
        One word, and the sentence that is tested.
    materials : tuple of Material
    lit : bool
        By a distant light, else by an environment: a rasterizer has a formula for each.
    variant : str
        What the control does wrong.
    wrong : callable (View) -> ndarray, shape (N, 3)
        What the variant gives for the judged pixels.
    """

    key: str
    claim: str
    materials: tuple
    lit: bool
    variant: str
    wrong: Callable

    @property
    def title(self):
        """Subject of the result."""
        material = self.materials[0]
        flagged = f"{FLAG} {str(material.energy_compensation).lower()}"
        name = flagged if self.key == "model" else material.name
        return f"{name}, {'distant light' if self.lit else 'environment'}"

    def includes(self, view):
        """Whether a view belongs to the question."""
        return view.material in self.materials and (view.scene.light is not None) == self.lit


@dataclass(frozen=True)
class Case:
    """A picture's judged pixels.

    Attributes
    ----------
    view : View
    mask : ndarray of bool, shape (size, size)
    values : ndarray, shape (N, 3)
    """

    view: object
    mask: np.ndarray
    values: np.ndarray


def _of(name, factor=1.0):
    """A variant: values of a model, times a factor."""
    return lambda view: factor * pixel_means(reference.model(name), view)


SETUP_RIGHT = "Lambert under a distant light is right: light, orientation and encoding."
IS_MODEL = "The pictures are the model's, but for noise and the depth of a mesh."
BLACK_IS = "A black surface reflects nothing."
WHITE_IS = "A white surface in a white environment cannot be seen."
DROPPED, STUCK = "the flag is dropped", "the flag is stuck"
QUESTIONS = (
    Question("setup", SETUP_RIGHT, (LAMBERT,), True, "5 % more light", _of("lambert", 1.05)),
    Question("model", IS_MODEL, (TRUE, HALF), True, DROPPED, _of("qon")),
    Question("model", IS_MODEL, (TRUE,), False, DROPPED, _of("qon")),
    Question("model", IS_MODEL, (FALSE,), True, STUCK, _of("eon")),
    Question("model", IS_MODEL, (FALSE,), False, STUCK, _of("eon")),
    Question("black", BLACK_IS, (BLACK,), True, "a white lobe is added", _of("fon_white_lobe")),
    Question("white", WHITE_IS, (WHITE,), False, "the second lobe is dropped", _of("fon")),
)


def answer(question, views, images, depth, place, obstacle=""):
    """The result of a question.

    Parameters
    ----------
    question : Question
    views : sequence of View
        Of the whole kit.
    images : mapping of str to ndarray
        The usable pictures by name.
    depth : float
        How far the surface may lie below the unit sphere.
    place : mapping
        Host and library of the result.
    obstacle : str
        Why nothing can be judged, if so.

    Returns
    -------
    Result
    str
        What the pictures show, in words; "" if that is not asked or not known.
    """
    asked = [view for view in views if question.includes(view)]
    place = {"check": question.key, "claim": question.claim, "subject": question.title, **place}
    missing = [view.name for view in asked if view.name not in images]
    if obstacle or missing:
        reason = obstacle or f"no usable picture: {', '.join(missing)}"
        return Result(**place, verdict=NOT_RUN, reason=reason), ""
    masks = [judged(view.scene) for view in asked]
    cases = [
        Case(view, mask, images[view.name][mask]) for view, mask in zip(asked, masks, strict=True)
    ]
    models = [expected(reference.model(view.material.model), view, depth) for view in asked]
    found = _tiles(cases, models)
    error = _ratio(found)
    wrong = _ratio(_tiles(cases, models, [question.wrong(view) for view in asked]))
    noise = float(np.sqrt(np.mean([each.pixel_noise**2 for each in found])))
    if max(error, wrong) <= 1.0:
        reason = f"too noisy to notice if {question.variant}: {noise:.2g} rms a pixel; more samples"
        return Result(**place, verdict=NOT_RUN, reason=reason), ""
    ranking = candidates(cases, depth) if question.key == "model" else []
    words = named(ranking) if ranking else ""
    if question.key == "setup" and error > 1.0:
        words = _fault(cases[0], models[0], images)
    return Result(
        **place,
        verdict=PASSED if error <= 1.0 < wrong else FAILED,
        error=error,
        unit=UNIT,
        tolerance=1.0,
        derivation=DERIVATION,
        worst={"noise of a pixel, rms": [noise]},
        diagnosis=words if error > 1.0 else "",
        distances={each.title: each.distance for each in ranking},
        control=Control(question.variant, wrong, wrong > 1.0),
    ), words


def _fault(case, model, images):
    """What is wrong with the light, in words."""
    words = fault(images[case.view.name], model, case.mask)
    return f"{case.view.name} is {words}" if words else ""


def _ratio(found):
    return ratio(found, share=1.0 / len(QUESTIONS))


def _tiles(cases, models, wrong=None):
    """Tiles of the errors; with what the renderer would give if it had the wrong model."""
    wrong = wrong or [model.value for model in models]
    return [
        tiles(case.values + other - 2.0 * model.value, model.slack, case.mask)
        for case, model, other in zip(cases, models, wrong, strict=True)
    ]
