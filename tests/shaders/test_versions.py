# SPDX-License-Identifier: Apache-2.0
"""mxeon has no list of MaterialX versions, and accepts all versions with the required functions."""

import MaterialX as mx
import pytest

from mxeon.cli import main
from mxeon.errors import InterfaceError, NotRun
from mxeon.hosts import open_host
from mxeon.shaders import closure_calls, generation, generators, library
from mxeon.shaders.library import UntestedVersionWarning, load_library
from tests.support.command import PLASTER
from tests.support.documents import lobe, material
from tests.support.wrong_libraries import wrong_copy

CACHES = (library.read_library, generators._library_generator)
CACHES += (closure_calls._functions, closure_calls._signatures)


@pytest.fixture
def fresh():
    """Clear the caches of libraries and generators before and after the test."""
    for cache in CACHES:
        cache.cache_clear()
    yield
    for cache in CACHES:
        cache.cache_clear()


@pytest.fixture
def other_interface(fresh, monkeypatch, tmp_path):
    """Add a parameter to eonlib's oren_nayar_diffuse_bsdf that MaterialX does not pass."""
    old, new = "float weight, vec3 color", "float gain, float weight, vec3 color"
    wrong_copy(tmp_path, old, new, "genglsl/oren_nayar_diffuse_bsdf.glsl")
    monkeypatch.setattr(library, "data_folder", lambda: tmp_path)


@pytest.mark.parametrize("name", library.LIBRARIES)
def test_an_untested_version_runs_with_a_warning(fresh, monkeypatch, name):
    monkeypatch.setattr(mx, "getVersionString", lambda: "1.40.0")
    with pytest.warns(UntestedVersionWarning, match=r"^MaterialX 1.40.0 has not been tested with"):
        assert load_library(name).getNodeDef("ND_oren_nayar_diffuse_bsdf")


def test_a_version_that_lacks_a_method_is_refused_in_one_line(fresh, monkeypatch, capsys):
    monkeypatch.setattr(library, "REQUIRED", ((mx.Document, "setOtherLibrary"),))
    assert main(["check", PLASTER]) == 2
    words = f"{mx.getVersionString()} lacks Document.setOtherLibrary; install 1.39.3"
    assert capsys.readouterr().err.startswith(f"mxeon: MaterialX {words}")


def test_another_closure_interface_is_refused_for_its_node_and_target(other_interface):
    words = "^glsl: MaterialX .* does not call eonlib's function"
    with pytest.raises(InterfaceError, match=words):
        generation.generate(material(lobe()), "glsl")
    assert generation.generate(material(lobe()), "osl")
    assert generation.generate(material('<eon_diffuse_bsdf name="lobe" type="BSDF"/>'), "glsl")


def test_a_host_whose_target_this_version_lacks_is_not_run(monkeypatch):
    targets = tuple(target for target in generation.TARGETS if target != "slang")
    monkeypatch.setattr(generation, "TARGETS", targets)
    words = "slang: MaterialX must have a generator for slang; .* none: pip"
    with pytest.raises(NotRun, match=words):
        open_host("slang")
