# SPDX-License-Identifier: Apache-2.0
"""The model that a renderer's pictures show: the nearest known one, and the second best."""

from dataclasses import dataclass

import numpy as np

from mxeon.conformance.diagnosis import sentence
from mxeon.kit.expected import expected
from mxeon.kit.noise import ratio, tiles
from mxeon.models import table as reference

# Models nearer to another than a renderer's noise: EON's quartic is off by 1e-3 at most.
TOO_NEAR = ("eon_approx",)


@dataclass(frozen=True)
class Candidate:
    """A known model or defect against the pictures of one question.

    Attributes
    ----------
    title : str
    distance : float
        Root mean square of the tiles' mean errors, in units of pi f cos or of albedo.
    ratio : float
        See `mxeon.kit.noise.ratio`; up to 1 the pictures may be this model's.
    """

    title: str
    distance: float
    ratio: float


def candidates(pictures, depth):
    """Every known model and defect, nearest first, those with the same values once.

    Parameters
    ----------
    pictures : sequence of mxeon.kit.questions.Case
    depth : float
        Of the mesh.

    Returns
    -------
    list of Candidate
    """
    rows = [row for row in reference.KNOWN_DEFECTS + reference.MODELS if row.name not in TOO_NEAR]
    if all(case.shot.scene.light for case in pictures):
        rows = {row.brdf: row for row in rows}.values()  # some differ in their albedo alone
    return sorted((_candidate(row, pictures, depth) for row in rows), key=lambda one: one.distance)


def _candidate(row, pictures, depth):
    found = []
    for case in pictures:
        model = expected(row, case.shot, depth)
        found.append(tiles(case.values - model.value, model.slack, case.mask))
    means = np.concatenate([each.mean for each in found])
    return Candidate(row.title, float(np.sqrt(np.mean(means**2))), ratio(found))


def named(ranking):
    """The nearest model and the second best, in words.

    What the pictures cannot tell from the nearest one, at the confidence of `mxeon.kit.noise`, is
    said to fit as well.
    """
    text = sentence([(one.title, one.distance) for one in ranking])
    if ranking[0].ratio > 1.0:
        return f"{text}; neither is it"
    also = [each.title for each in ranking[1:] if each.ratio <= 1.0]
    return f"{text}; cannot be told from {' and '.join(also)}" if also else text
