# SPDX-License-Identifier: Apache-2.0
"""Surface shaders as a whole: what eonlib keeps, what stock MaterialX does not, and dead inputs."""

import numpy as np
import pytest

from mxeon.conformance.accuracy import surface_shaders as tolerances
from mxeon.conformance.checks.application import applies, judge_check
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.nodes import kinds
from mxeon.conformance.nodes.surface_shaders import FREE_PATHS, SHADERS
from mxeon.conformance.probes.surface_shaders import SurfaceShaderProbe
from mxeon.conformance.results import FAILED, PASSED
from mxeon.conformance.results.known_issues import with_pages
from mxeon.shaders.library import load_library
from tests.support.wrong_libraries import wrong_copy
from tools.fits import surface_shaders as fit

ROWS = {check.key: check for check in CHECKS if SHADERS[0].model in check.models}
# Long shaders take seconds to compile: the shortest stands for all, and the rest for their sums.
SHORT = SHADERS[-1]
# By kinds of values and the end of their names in `tools.fits.surface_shaders`.
FITTED = {
    (("values",), ""): tolerances.FITTED_VALUE,
    (("albedos",), ""): tolerances.FITTED_ALBEDO,
    (("values", "albedos"), " in the mean"): tolerances.FITTED_MEAN,
}
LOBE = "genglsl/lib/microfacet_lobe.glsl"
STOCK = {*ROWS} - {"reach"}  # what fails there


def judged(host, shader, library, keys=tuple(ROWS)):
    """Results of checks of a surface shader."""
    probe = SurfaceShaderProbe(host, shader, library)
    assert all(applies(ROWS[key], shader, kinds.SURFACE_SHADER, host.name) for key in keys)
    return {key: with_pages(judge_check(ROWS[key], probe)) for key in keys}


def test_eonlib_passes_every_check_of_a_surface_shader(gl):
    results = judged(gl, SHORT, "eonlib")
    assert {result.verdict for result in results.values()} == {PASSED}
    assert all(result.control.caught for result in results.values())


def test_eonlib_sums_the_lobes_of_open_pbr(gl):
    [result] = judged(gl, SHADERS[1], "eonlib", ("lobes",)).values()
    assert result.verdict == PASSED and result.control.caught


def test_stock_has_its_known_departures_and_no_others(gl):
    results = judged(gl, SHORT, "stock")
    failed = {key for key, result in results.items() if result.verdict == FAILED}
    assert failed == STOCK
    assert all("genglsl_microfacet_throughput" in results[key].pages for key in failed)


def test_two_thousandths_of_light_that_every_layer_gains_are_seen_in_the_mean(gl, tmp_path):
    text = "bsdf.throughput = max(1.0 - lobe.albedo"
    library = wrong_copy(tmp_path, text, text.replace("1.0", "1.002"), LOBE)
    [result] = judged(gl, SHORT, library, ("lobes_mean",)).values()
    assert result.verdict == FAILED


def test_the_fits_of_all_lobes_are_as_near_as_the_tolerances_say():
    found = [fit.largest(shader, sets=2) for shader in SHADERS]
    for name, most in FITTED.items():
        error = max(each[f"{kind}{name[1]}"] for each in found for kind in name[0])
        assert 0.4 * most < error <= most


def test_a_wrong_lobe_is_named():
    class Coated(SurfaceShaderProbe):
        """A host whose coat is left out."""

        def direct(self, batch):
            return self.expected(batch.altered(coat=np.zeros(len(batch.wo))))

    probe = Coated(None, SHADERS[0], "eonlib")
    assert ROWS["lobes"].explain(probe).text == "the layer equation holds without the coat"


@pytest.mark.parametrize("shader", SHADERS, ids=lambda shader: shader.node)
def test_every_input_of_a_shader_is_asked_for_or_of_no_lobe(shader):
    definitions = load_library("stock").getMatchingNodeDefs(shader.node)
    ports = [{port.getName() for port in each.getActiveInputs()} for each in definitions]
    names = max(ports, key=len)
    assert set(shader.inputs) <= names
    words = ("emiss", "opacity", "alpha", "occlusion")
    rest = names - set(shader.inputs) - set(FREE_PATHS)
    assert all(any(word in name for word in words) for name in rest)
