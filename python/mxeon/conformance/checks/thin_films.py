# SPDX-License-Identifier: Apache-2.0
"""Checks of microfacets under a thin film."""

from mxeon.conformance.accuracy import diffuse as tolerances
from mxeon.conformance.accuracy import thin_films as film_tolerances
from mxeon.conformance.accuracy.engine import widen_for_waves
from mxeon.conformance.checks import measures
from mxeon.conformance.checks.check import Check
from mxeon.conformance.checks.controls import pass_all, scale_cosine, with_inputs
from mxeon.conformance.checks.film_measures import (
    brighter,
    diagnose_average,
    diagnose_visible,
    film_average,
    film_curve,
    film_energy,
    film_limit,
    film_orders,
    film_smooth,
    film_sum,
    film_visible,
    thicker,
)
from mxeon.conformance.diagnosis import inputs as input_diagnosis
from mxeon.conformance.diagnosis.comparisons import ALBEDO, THROUGHPUT, VALUE
from mxeon.conformance.nodes.thin_films import FILM_MODELS, LAYERED

CHECKS = (
    Check(
        "film",
        "The value under a thin film has the film's Airy reflectance.",
        FILM_MODELS,
        VALUE,
        thicker,
        open=True,
    ),
    Check(
        "film_curve",
        "A smooth lobe under a film reflects the Airy reflectance at the cosine of the view.",
        FILM_MODELS,
        film_curve,
        thicker,
        film_tolerances.FILM_CURVE,
        lit=True,
        open=True,
        adapt=widen_for_waves,
    ),
    Check(
        "film_orders",
        "At grazing a thin film has the sum of all orders.",
        FILM_MODELS,
        film_orders,
        thicker,
        film_tolerances.FILM_ALL_ORDERS,
        open=True,
    ),
    Check(
        "film_limit",
        "A film of index 1, or below, and one next to nothing, leave the lobe as it is.",
        FILM_MODELS,
        film_limit,
        with_inputs("every film has an index of 1.5", thinfilm_ior=1.5),
        film_tolerances.FILM_LIMIT,
        lit=True,
        open=True,
    ),
    Check(
        "film_energy",
        "No film reflects more than a lobe that reflects everything.",
        FILM_MODELS,
        film_energy,
        brighter,
        film_tolerances.FILM_ENERGY,
        lit=True,
    ),
    Check(
        "film_environment",
        "The environment branch has the film's directional albedo.",
        FILM_MODELS,
        ALBEDO,
        thicker,
        lit=True,
        open=True,
    ),
    Check(
        "film_average",
        "The compensation has the average of the film's curve over the hemisphere.",
        FILM_MODELS,
        film_average,
        thicker,
        film_tolerances.FILM_MEAN,
        lit=True,
        diagnose=diagnose_average,
        open=True,
    ),
    Check(
        "film_smooth",
        "The compensation of a lobe that loses little has that average too.",
        FILM_MODELS,
        film_smooth,
        thicker,
        film_tolerances.FILM_SMOOTH_MEAN,
        lit=True,
        diagnose=diagnose_average,
        open=True,
    ),
    Check(
        "film_visible",
        "The albedo has the mean of the film's curve over the facets that are seen and lit.",
        FILM_MODELS,
        film_visible,
        thicker,
        film_tolerances.FILM_STEEP,
        lit=True,
        diagnose=diagnose_visible,
        open=True,
    ),
    Check(
        "film_sum",
        "A lobe under a film has its own averages beside another lobe.",
        FILM_MODELS,
        film_sum,
        thicker,
        film_tolerances.FILM_SUM,
    ),
    Check(
        "film_throughput",
        "The throughput of a layer under a film is 1 - E of the film.",
        LAYERED,
        THROUGHPUT,
        pass_all,
        lit=True,
    ),
    Check(
        "film_finite",
        "No value of a film at the edges of the domain is infinite or not a number.",
        FILM_MODELS,
        measures.finite(),
        scale_cosine("the value is divided by cos(theta_o)", -1),
        tolerances.count_of("values"),
        lit=True,
        diagnose=input_diagnosis.diagnose_finite,
    ),
)
