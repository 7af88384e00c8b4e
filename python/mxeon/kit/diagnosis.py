# SPDX-License-Identifier: Apache-2.0
"""Nearest known models to a renderer's pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from mxeon.conformance.diagnosis.candidates import sentence
from mxeon.kit.expected import expected
from mxeon.kit.noise import ratio, tiles
from mxeon.models import table as reference

if TYPE_CHECKING:
    from mxeon.kit.questions import JudgedPicture

# Models nearer to another one than a renderer's noise: EON's quartic is off by 1e-3 at most.
TOO_NEAR = ("eon_approx",)


@dataclass(frozen=True)
class ModelDistance:
    """Distance of a known model or defect from the pictures of one question."""

    title: str
    distance: float  # rms of the tiles' mean errors, in units of pi f cos or of albedo
    ratio: float  # see `mxeon.kit.noise.ratio`; up to 1 the pictures agree


def candidates(pictures: Sequence[JudgedPicture], depth: float) -> list[ModelDistance]:
    """Every known model and defect, nearest first; models with the same values once."""
    rows = reference.KNOWN_DEFECTS + reference.MODELS + reference.PARAMETRIZATIONS
    rows = tuple(row for row in rows if row.name not in TOO_NEAR)
    if all(case.view.scene.light for case in pictures):
        rows = tuple({row.brdf: row for row in rows}.values())  # some differ in their albedo alone
    ranking = sorted(
        (_candidate(row, pictures, depth) for row in rows), key=lambda one: one.distance
    )
    # A roughness and its square are one at roughness 1, where the model has the first place.
    return [
        one
        for one, before in zip(ranking, [None, *ranking], strict=False)
        if before is None or one.distance != before.distance
    ]


def _candidate(
    row: reference.Model, pictures: Sequence[JudgedPicture], depth: float
) -> ModelDistance:
    errors = []
    for case in pictures:
        model = expected(row, case.view, depth)
        errors.append(tiles(case.values - model.value, model.slack, case.mask))
    means = np.concatenate([each.mean for each in errors])
    return ModelDistance(row.title, float(np.sqrt(np.mean(means**2))), ratio(errors))


def ranking_sentence(ranking: Sequence[ModelDistance]) -> str:
    """The nearest model and the second best, in words.

    Names the models that the pictures cannot tell from the nearest one, at the confidence of
    `mxeon.kit.noise`.
    """
    text = sentence([(one.title, one.distance) for one in ranking])
    if ranking[0].ratio > 1.0:
        return f"{text}; neither fits"
    also = [each.title for each in ranking[1:] if each.ratio <= 1.0]
    return f"{text}; cannot be told from {' and '.join(also)}" if also else text
