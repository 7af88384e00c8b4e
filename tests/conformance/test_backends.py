# SPDX-License-Identifier: Apache-2.0
"""What each way of asking an engine supports and takes, and how it draws its samples."""

import pytest

from mxeon.conformance import specs
from mxeon.conformance.backends import backend_of
from mxeon.hosts import HOSTS

SPECS = {spec.title: spec for spec in specs.ALL}


# By host: nodes of which it has no values, and one of a kind that it has.
UNSUPPORTED = {
    "gl": ((), "surface, an EDF alone"),
    "osl": (("open_pbr_surface", "surface, an EDF alone"), "standard_surface, every lobe"),
    # Storm takes the default of an enumerated input; a solid's picture has light that enters and leaves it.
    "storm": (
        ("sheen_bsdf, mode zeltner", "dielectric_bsdf, scatter_mode RT", "uniform_edf", "mix"),
        "sheen_bsdf, mode conty_kulla",
    ),
    "materialx": (("layer", "subsurface_bsdf", "chiang_hair_bsdf"), "sheen_bsdf, mode zeltner"),
    "cycles": (("open_pbr_surface", "chiang_hair_bsdf", "subsurface_bsdf"), "absorption_vdf"),
    "testrender": (("uniform_edf", "blackbody", "conductor_bsdf, thin film"), "subsurface_bsdf"),
    "msl": (SPECS, None),
}


@pytest.mark.parametrize("host", UNSUPPORTED)
def test_a_host_is_asked_for_what_it_has(host):
    absent, present = UNSUPPORTED[host]
    assert {title for title in absent if backend_of(host, SPECS[title])} == set()
    assert present is None or backend_of(host, SPECS[present])


def test_a_host_that_evaluates_is_asked_for_every_node():
    rows = [row.name for row in HOSTS if row.way == "pairs"]
    assert len(rows) == 5
    assert all(backend_of(name, spec) for name in rows for spec in specs.ALL)


@pytest.mark.parametrize("spec", specs.ALL, ids=lambda spec: spec.title)
def test_every_error_is_a_sum_of_terms_in_words(spec):
    for quantity, error in spec.errors.items():
        assert error.terms and all(term.words and term.value >= 0.0 for term in error.terms)
        total = sum(term.value for term in error.terms)
        assert total <= error.value <= 2.0 * total, quantity
        assert all(term.words in error.derivation for term in error.terms)
