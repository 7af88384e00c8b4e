# SPDX-License-Identifier: Apache-2.0
"""Tolerances of the checks of microfacets under a thin film."""

from mxeon.conformance.accuracy.bsdf import ESS_FIT, MICROFACET_VALUE, SEEN_ESS
from mxeon.conformance.samples.measurement import absolute, root_mean_square, scaled
from mxeon.conformance.samples.tolerance import ROUNDING, SCALED, Tolerance, rounded_up

# Largest errors of the shader's thin film, for cosines from 0.1 on and up to 1000 nm: tools/fits/thin_film.py
# searches for each.
FILM_ORDERS = 8e-4  # orders that are summed, relative to the largest channel, of 1e-3 at least
FILM_AVERAGE = 1.9e-2  # F_ss in five cosines: of metals, 1.3e-2 of other substrates
FILM_VISIBLE = 5.9e-2  # mean over the visible facets in four cosines: of films of index from 1 on
FILM_SEEN = 6.1e-2  # that and F_ss, times the light that is lost
FILM_OILED = 3.7e-2  # the same of films of index 1.25 or more
FILM_FAINT_ORDERS = 8.7e-7  # orders that are not summed, of thin films at grazing, rms
SMOOTH_ESS_FIT = 1.5e-4  # the fit of E_ss at alpha 1e-3, of cosines from 0.1 to 0.2
SHARP_ESS_FIT = 2.8e-5  # of cosines from 0.3 on
FILM_SHARP_ORDERS = 2.4e-6  # the same of films from 200 nm and cosines from 0.3 on
FILM_SLOPE = 9.5  # slope of their curves in the logarithm of the path difference
FILM_WAVES = 2.0  # slope of the same curves in the cosines and sines of their phases, of any signs
FILM_KEPT = 0.65  # F (1 - F_ss) of the same films, by which a smooth lobe has an error of E_ss
FILM_PHASE = 71.0  # largest phase of a first order, in radian: 1000 nm of index 2.5
BARE_AVERAGE = 6.4e-4  # F_ss without a film: that in five cosines against the fit
FILM_VALUE = Tolerance(
    rounded_up(ESS_FIT * SEEN_ESS + FILM_AVERAGE * (SEEN_ESS - 1.0) + FILM_ORDERS),
    SCALED,
    scaled,
    "the sum of orders above 2^-21 of the mean reflectance, 8e-4 of the film's where that is next to 0, and the fit of E_ss, 5e-4, and F_ss in "
    "five cosines, 1.9e-2, as they enter a value, the first with 1.58 and the second with 0.58. Few films come near to it: thin metals at grazing have the first, "
    "indices far apart the second; `film_orders` and `film_average` judge them by themselves; rounded up",
)
FILM_ALBEDO = Tolerance(
    rounded_up(FILM_OILED + ESS_FIT),
    "albedo",
    absolute,
    "the mean over visible facets in four cosines, and F_ss in five, times the light that is lost, together "
    "3.7e-2 of films of index 1.25 or more; and the fit of E_ss, 5e-4. The first is of thick films at grazing, whose fringes "
    "few cosines do not see; `film_visible` judges it where they do; rounded up",
)
FILM_TRAPPED = Tolerance(
    FILM_SEEN - FILM_OILED,
    "albedo",
    absolute,
    "films of a lower index than 1.25, up to 6.1e-2: a metal of a lower one reflects totally below them, in fringes that "
    "few cosines do not see",
)
FILM_ALL_ORDERS = Tolerance(
    rounded_up(FILM_FAINT_ORDERS + SMOOTH_ESS_FIT),
    "reflectance, rms",
    root_mean_square,
    "the fit of E_ss, 1.5e-4 at roughness 1e-3 and cosines of 0.1 to 0.2, which an average counts; and the orders that are "
    "not summed, 8.7e-7 for 1024 films of 40 to 100 nm: the largest of 64 sets, by "
    "tools/fits/thin_film_sets.py; rounded up",
)
FILM_MEAN = Tolerance(
    2e-3,
    "reflectance, rms",
    root_mean_square,
    "F_ss in five cosines of 64 films of 50 to 1000 nm: the largest of 64 sets, by "
    "tools/fits/thin_film_sets.py",
)
FILM_SMOOTH_MEAN = Tolerance(
    2e-5,
    "reflectance, rms",
    root_mean_square,
    "F_ss of the same films in two cosines, times what a lobe of alpha 0.04 loses: the largest of 64 "
    "sets, by tools/fits/thin_film_sets.py, and roundings",
)
FILM_STEEP = Tolerance(
    3.7e-4,
    "reflectance, rms",
    root_mean_square,
    "the mean over visible facets in four cosines of 64 films of 50 to 100 nm on rough lobes: the "
    "largest of 64 sets, by tools/fits/thin_film_sets.py",
)
FILM_GLOSSY = Tolerance(
    7.4e-4,
    "reflectance, rms",
    root_mean_square,
    "the mean over visible facets in two cosines, or in four, of 64 films of 50 to 100 nm on lobes of alpha "
    "0.03 to 0.1: the largest of 64 sets, by tools/fits/thin_film_sets.py",
)
FILM_CURVE = Tolerance(
    rounded_up(FILM_SHARP_ORDERS + FILM_KEPT * SHARP_ESS_FIT + (10 * FILM_SLOPE + 16) * ROUNDING),
    "reflectance",
    absolute,
    "the sum of orders above 2^-21 of the mean reflectance, under films from 200 nm and cosines from 0.3 on, 2.4e-6; "
    "the fit of E_ss at roughness 1e-3, 2.8e-5, times F (1 - F_ss), 0.65 at most; ten roundings of "
    "float32, 2^-24 each, in a phase, times the slope of the curve in its logarithm, 9.5; and 16 "
    "beside them; rounded up; and 2.0 times the error of the engine's own cosine and sine",
)
FILM_SUM = Tolerance(
    rounded_up(2 * (10 * FILM_SLOPE + 16) * ROUNDING),
    SCALED,
    scaled,
    "two values by the same text, of which an engine may round each in another order, as in `film_curve`; "
    "rounded up",
)
FILM_LIMIT = Tolerance(
    rounded_up(BARE_AVERAGE * (SEEN_ESS - 1.0)),
    SCALED,
    scaled,
    "F_ss in five cosines under a film that changes nothing, against the fit of it without one, 6.4e-4, as "
    "it enters a value, with 0.58; E_ss is the same with a film and without; rounded up",
)
FILM_ENERGY = Tolerance(
    MICROFACET_VALUE.value,
    SCALED,
    scaled,
    "the fits of the compensation, of which a mirror has another share than a film",
)
