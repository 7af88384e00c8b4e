# SPDX-License-Identifier: Apache-2.0
"""A host without a working engine is not run, and the message says in one line what to install."""

import os
import sys

import pytest

import mxeon
from mxeon.conformance.results import NOT_RUN
from mxeon.errors import NotRun
from mxeon.hosts import open_engine
from mxeon.survey import browser
from tests.support.availability import package

BLENDER, NOWHERE = "MXEON_CYCLES_PYTHON", "/nowhere/python"
DISPLAY = (  # Messages if the display or the renderer is missing.
    "(no display: .* no Xvfb|MaterialX's renderer does not load .*); "
    "on Debian: apt-get install libgl1 libsm6 libx11-6 xvfb$"
)
NPM = f"npm ci --prefix {browser.packages_folder()}$"
ENVIRONMENTS = [  # Host, environment variables that hide the engine, and words of the message.
    ("cycles", {BLENDER: NOWHERE}, f"no interpreter {NOWHERE}; in a checkout: ./run"),
    ("cycles", {BLENDER: sys.executable}, ".*No module named 'bpy'"),
    ("storm", {BLENDER: NOWHERE}, f"no interpreter {NOWHERE}; in a checkout: ./run"),
    ("storm", {BLENDER: sys.executable}, "no package bpy; pip install bpy==.* in the env"),
    ("mitsuba", {"MXEON_MITSUBA_PYTHON": NOWHERE}, r"not installed: pip install '\.\[mitsuba\]'"),
    ("three", {browser.MODULES: "/nowhere"}, f"no package three in /nowhere; {NPM}"),
    ("babylon", {browser.MODULES: "/nowhere"}, f"no package @babylonjs/core in /nowhere; {NPM}"),
    ("three-gpu-pathtracer", {browser.MODULES: "/nowhere"}, f"no package .* in /nowhere; {NPM}"),
    ("webgl", {"MXEON_CHROMIUM": "none"}, "no program 'none'; .* apt-get install chromium"),
    ("webgl", {"MXEON_CHROMIUM": "true"}, "the browser failed; "),
    ("materialx", {"DISPLAY": "", "PATH": ""}, DISPLAY),
]
MODULES = [  # Host, attribute that refers to a Python package, and words of the message.
    ("webgl", "webgl.sync_api", r"Playwright is not installed; pip install '\.\[webgl\]'"),
    ("vulkan", "vulkan.wgpu", r"wgpu is not installed; pip install '\.\[vulkan\]'"),
    ("wgsl", "vulkan.wgpu", "wgpu is not installed"),
    ("hlsl", "vulkan.wgpu", "wgpu is not installed"),
    ("naga", "vulkan.wgpu", "wgpu is not installed"),
    ("dxc", "translated.dxc", r"compushady is not installed; pip install '\.\[dxc\]'"),
    ("shadewire", "shadewire.mtlx", r"the package is not installed; pip install '\.\[shadewire\]'"),
    ("slang", "slang.slangpy", r"slangpy is not installed; pip install '\.\[slang\]'"),
]


def assert_not_run(name, words):
    with pytest.raises(NotRun, match=f"^{name}: {words}") as caught, open_engine(name) as host:
        host.identity()
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name, environment, words", ENVIRONMENTS)
def test_what_is_missing_is_named_with_its_remedy(monkeypatch, name, environment, words):
    if name == "webgl":
        package("playwright")
    for variable, value in environment.items():
        monkeypatch.setenv(variable, value)
    assert_not_run(name, words)


@pytest.fixture
def no_library(tmp_path):
    """Folder with a MaterialX whose renderer lacks a system library, as on a minimal system."""
    folder = tmp_path / "MaterialX"
    folder.mkdir()
    (folder / "__init__.py").write_text("getDefaultDataSearchPath, Exception = str, ValueError\n")
    for name in ("PyMaterialXGenGlsl", "PyMaterialXGenShader"):
        (folder / f"{name}.py").touch()
    reason = "libICE.so.6: cannot open shared object file: No such file or directory"
    (folder / "PyMaterialXRender.py").write_text(f"raise ImportError({reason!r})\n")
    return tmp_path


def test_missing_libraries_of_a_display_are_named_in_one_line(monkeypatch, no_library):
    monkeypatch.setenv("MXEON_MATERIALX", str(no_library))
    words = r"MaterialX's renderer does not load \(libICE.so.6: .*\); on Debian: "
    assert_not_run("materialx", words)


def test_a_display_that_is_not_there_ends_the_renderer(hosts, monkeypatch):
    hosts("materialx")
    monkeypatch.setenv("DISPLAY", ":4711")
    assert_not_run("materialx", "(ended by|exit status) .*; last output: ")


@pytest.mark.parametrize("name, package, words", MODULES)
def test_a_missing_package_is_named_with_its_remedy(monkeypatch, name, package, words):
    monkeypatch.setattr(f"mxeon.hosts.{package}", None)
    assert_not_run(name, words)


def test_a_missing_compiler_is_named_with_its_remedy(monkeypatch):
    monkeypatch.setattr("mxeon.hosts.vulkan.wgpu", object())
    monkeypatch.setenv("PATH", "/nowhere")
    assert_not_run("vulkan", "no program 'glslangValidator'; .* install glslang-tools")


@pytest.mark.parametrize("name", ["vulkan", "wgsl"])  # `wgsl` needs no glslangValidator
def test_a_missing_vulkan_driver_is_named_with_its_remedy(monkeypatch, name):
    wgpu = package("wgpu")
    if name == "vulkan":
        monkeypatch.setattr("shutil.which", lambda program: program)
    else:
        monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.setattr(wgpu.gpu, "enumerate_adapters_sync", list)
    assert_not_run(name, "no Vulkan( or Metal or D3D12)? device; .* install mesa-vulkan-drivers")


def test_a_missing_driver_is_named_with_its_remedy(hosts, monkeypatch):
    hosts("storm")
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_FILENAMES", os.devnull)
    assert_not_run("storm", "no OpenGL 4.5 through EGL .*; on Debian: apt-get")


@pytest.mark.parametrize("workers", [0, 1])
def test_checks_of_a_missing_renderer_are_not_run(monkeypatch, workers):
    """Checks that need the missing renderer are reported as not run, with and without workers."""
    monkeypatch.setenv("MXEON_CHROMIUM", "none")
    run = mxeon.check(None, "three-gpu-pathtracer", "stock", nodes="common", workers=workers)
    own = [each for each in run.results if each.check in ("density", "samples")]
    assert len(own) == 2 and {each.verdict for each in own} == {NOT_RUN}
