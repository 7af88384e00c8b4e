# SPDX-License-Identifier: Apache-2.0
"""What each way of asking an engine supports and takes, and how it draws its samples."""

import numpy as np
import pytest

from mxeon.conformance import backends, specs
from mxeon.conformance.backends import backend_of
from mxeon.conformance.samples import LOBE_RIM, RIM
from mxeon.conformance.specs.diffuse import DIFFUSE
from mxeon.hosts import HOSTS, host_row
from mxeon.hosts.base import Host, Identity
from mxeon.hosts.pairs import visible

SPECS = {spec.title: spec for spec in specs.ALL}
DIELECTRIC = SPECS["dielectric_bsdf, scatter_mode R"]
EON, QON, _ = DIFFUSE


class Nowhere(Host):
    """A host that is asked for nothing."""

    name = "cycles"
    target = "osl"

    def identity(self):
        return Identity(self.name, "", "")


def samples(backend, spec):
    return backend(Nowhere(), spec, "stock").samples()


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


def test_a_closure_gets_few_samples_no_negative_weight_and_some_index_0():
    drawn = samples(backends.Closures, DIELECTRIC)
    assert all(np.all(batch.inputs.get("weight", 1.0) >= 0.0) for batch in drawn.batches)
    assert any(np.any(batch.inputs["ior"] == 0.0) for batch in drawn.batches)
    assert all(len(batch.wo) <= backends.SOME for batch in drawn.batches[1:])
    assert len(drawn.turned.wo) == len(drawn.edges.wo) == backends.SOME


@pytest.mark.parametrize("backend", [backends.Rendered, backends.Traced])
@pytest.mark.parametrize("spec", specs.PLAIN_LOBES, ids=lambda spec: spec.title)
def test_a_renderer_gets_pairs_that_a_camera_sees_and_inputs_that_it_takes(backend, spec):
    drawn = samples(backend, spec)
    for batch in (*drawn.batches, *drawn.views, drawn.edges, drawn.integrated[0]):
        assert "occlusion" not in batch.inputs and np.all(batch.inputs.get("weight", 1.0) >= 0.0)
        rough = batch.inputs.get("roughness", np.ones(1))
        assert rough.max() <= 1.0 and (spec.model == "burley" or rough.min() >= 0.1)
    for batch in (*drawn.batches, drawn.edges):
        assert min(batch.wo[:, 2].min(), np.abs(batch.wi[:, 2]).min()) >= RIM
        assert visible(batch.wo, batch.wi).all()


def test_a_pair_that_a_camera_hides_is_moved_until_it_is_seen():
    wo = np.tile([0.6, 0.0, 0.8], (3, 1))
    wi = np.array([[0.6, 0.0, 0.8], [-0.6, 0.0, -0.8], [0.0, 0.6, 0.8]])
    assert visible(wo, wi).tolist() == [False, False, True]
    moved = backends.apart(wo, wi)
    assert visible(wo, moved).all() and (moved[2] == wi[2]).all()
    assert np.abs(moved - wi).max() < 0.1


def test_a_lobe_below_others_is_asked_far_from_the_rim():
    for backend in (backends.RenderedLobes, backends.LobePictures):
        for batch in samples(backend, SPECS["open_pbr_surface"]).batches:
            assert min(batch.wo[:, 2].min(), batch.wi[:, 2].min()) >= LOBE_RIM


def test_cycles_shows_the_points_for_which_it_has_a_closure():
    assert host_row("cycles").front_lit == ("qon",)
    for spec in (EON, QON):
        behind = any(
            np.any((batch.wo * batch.wi)[:, :2].sum(axis=1) < 0.0)
            for batch in samples(backends.CyclesPictures, spec).batches
        )
        assert behind == (spec is EON)


def test_a_node_that_transmits_is_drawn_in_light_from_below():
    drawn = samples(backends.Drawn, SPECS["translucent_bsdf"])
    assert len(drawn.batches) and all(batch.wi[:, 2].max() <= -RIM for batch in drawn.batches)


@pytest.mark.parametrize(
    "backend, title, name",
    [
        (backends.Half, "conductor_bsdf", "retroreflective"),  # later than Storm's MaterialX
        (backends.Closures, "standard_surface, every lobe", "coat_normal"),
    ],
)
def test_inputs_that_an_engine_cannot_set_are_known(backend, title, name):
    unset = backend(Nowhere(), SPECS[title], "stock").unset
    assert name in unset and "roughness" not in unset


@pytest.mark.parametrize("spec", specs.ALL, ids=lambda spec: spec.title)
def test_every_error_is_a_sum_of_terms_in_words(spec):
    for quantity, error in spec.errors.items():
        assert error.terms and all(term.words and term.value >= 0.0 for term in error.terms)
        total = sum(term.value for term in error.terms)
        assert total <= error.value <= 2.0 * total, quantity
        assert all(term.words in error.derivation for term in error.terms)
