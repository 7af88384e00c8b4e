# SPDX-License-Identifier: Apache-2.0
"""MaterialX finds eonlib's implementations in every load order, mode and client."""

import re
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import MaterialX as mx
import pytest

from mxeon.errors import InputError
from mxeon.hosts.cycles.process import interpreter
from mxeon.shaders import library, library_tree
from mxeon.shaders.generation import generate
from mxeon.shaders.library_export import export_library
from mxeon.shaders.nodes import EON, NODEDEFS, OREN_NAYAR
from tests.support.availability import available
from tests.support.command import output
from tests.support.documents import connected, image, lobe, material, written
from tests.support.verdicts import FAILED, PASSED, Verdicts
from tests.support.wrong_libraries import copy_of_eonlib, replace_text

SCRIPTS = Path(mx.__file__).parent / "_scripts"
STOCK = mx.getDefaultDataLibraryFolders()
OURS = str(library.eonlib_folder())
BOTH = (
    lobe(OREN_NAYAR, "first") + lobe(EON, "second") + '<add name="lobe" type="BSDF">'
    '<input name="in1" type="BSDF" nodename="first"/>'
    '<input name="in2" type="BSDF" nodename="second"/></add>'
)

# Functions that the generated shaders call for two nodes, by target.
CALLS = {
    "glsl": ("oren_nayar_diffuse_bsdf(closureData, ", "eon_diffuse_bsdf(closureData, "),
    "osl": ('"energy_compensation", first_energy_compensation)', '"energy_compensation", 1)'),
    "mdl": ("multiscatter_tint: first_energy_compensation", "multiscatter_tint: second_color"),
}


USD = """
import sys
import bpy
from pathlib import Path
bundled = Path(bpy.utils.resource_path("LOCAL"), "python", "lib")
sys.path += map(str, bundled.glob("python*/site-packages"))
from pxr import Sdr
registry = Sdr.Registry()
for name in sys.argv[1:]:
    node = registry.GetShaderNodeByIdentifier(name)
    print("found", name, node and node.GetResolvedDefinitionURI())
"""


def loaded(folders):
    """Document into which the libraries of several folders are loaded in order."""
    document = mx.createDocument()
    mx.loadLibraries(folders, mx.getDefaultDataSearchPath(), document)
    return document


def listed(folders):
    """Pairs of nodedef and target that the folders implement, read from the folders' XML."""
    files = [path for each in folders for path in each.rglob("*.[mx]*l*")]
    elements = [each for file in files for each in ElementTree.parse(file).getroot()]
    return {
        (each.get("nodedef"), each.get("target", ""))
        for each in elements
        if each.tag in ("implementation", "nodegraph") and each.get("nodedef")
    }


EONLIB = library.eonlib_folder()


@pytest.mark.parametrize(
    "name, profile, folders",
    [
        ("diffuse", None, [library.documents_folder("diffuse")]),
        ("eonlib", None, [EONLIB]),
        ("eonlib", "cycles", [EONLIB, library.source_folder("eonlib") / "genosl" / "cycles"]),
    ],
)
def test_all_that_eonlib_ships_is_found_on_every_target_that_takes_it(name, profile, folders):
    document = library.load_library(name, profile)
    pairs = {each[:2] for each in library.implementations(document, name, profile)}
    assert {(node, target) for node, target in listed(folders) if target} <= pairs
    for node, target in listed(folders):
        heirs = {"genglsl": {"essl", "genmsl", "genslang"}, "": set(library.TARGETS)}
        assert {(node, heir) for heir in heirs.get(target, ())} <= pairs


def test_whatever_is_missing_of_eonlib_is_named():
    document, count = loaded([OURS, *STOCK]), 0
    standard = library_tree.standard_folders()[0].resolve()
    for each in (*document.getImplementations(), *document.getNodeGraphs()):
        folders = Path(each.getSourceUri()).resolve().parents
        if library.data_folder() not in folders or standard in folders:
            continue
        count += 1
        node, target = each.getNodeDefString(), each.getTarget()
        each.removeAttribute("nodedef")
        with pytest.raises(library.LibraryError, match=f"implementation of {node} for {target}"):
            library.assert_eonlib(document)
        each.setNodeDefString(node)
    assert count == len(listed([EONLIB]))


@pytest.mark.parametrize("folders", [(OURS, *STOCK), (*STOCK, OURS)], ids=["first", "last"])
def test_eons_graph_serves_only_the_targets_without_an_implementation_of_their_own(folders):
    document = loaded(folders)
    definition = document.getNodeDef("ND_eon_diffuse_bsdf")
    targets = [each.getName() for each in document.getTargetDefs()]
    found = {each: definition.getImplementation(each) for each in targets}
    graphs = {target for target, each in found.items() if each.isA(mx.NodeGraph)}
    assert graphs == {"genoslnetwork"} and {"genglsl", "genosl", "genmdl"} < found.keys()
    for each in document.getImplementations():
        if each.getNodeDefString() == definition.getName():
            each.removeAttribute("nodedef")
    assert all(definition.getImplementation(target).isA(mx.NodeGraph) for target in found)


@pytest.mark.parametrize(
    "old, new, noticed",
    [
        ("", "", set()),
        ('type="boolean" value="true"', 'type="boolean" value="false"', {"value", "environment"}),
        ('interfacename="weight"', 'value="1.0"', {"inputs", "value"}),
        ('interfacename="color"', 'value="0.18, 0.18, 0.18"', {"inputs", "value", "environment"}),
        ('interfacename="roughness"', 'value="0.0"', {"inputs", "value"}),
        ('interfacename="normal"', 'value="0.0, 0.0, 1.0"', {"inputs"}),
    ],
)
def test_eons_graph_is_eon_and_the_checks_notice_each_change_of_it(old, new, noticed, tmp_path):
    """EON's GLSL is removed, so the checks run EON's graph, in which `old` is replaced."""
    copy = copy_of_eonlib(tmp_path)
    replace_text(copy, ' nodedef="ND_eon_diffuse_bsdf"', "", "diffuse/eonlib_genglsl_impl.mtlx")
    graph = copy / "diffuse" / "eonlib_ng.mtlx"
    graph.write_text(graph.read_text().replace(old, new, 1))  # EON's graph comes first in the file
    judge = Verdicts()
    keys = ("inputs", "value", "environment")
    verdicts = {key: judge(key, EON, library=str(copy)).verdict for key in keys}
    assert {key for key, verdict in verdicts.items() if verdict == FAILED} >= noticed
    assert noticed or {*verdicts.values()} == {PASSED}


def test_the_wrong_order_raises_with_node_target_and_remedy():
    with pytest.raises(library.LibraryError) as raised:
        library.assert_eonlib(loaded([*STOCK, OURS]))
    message = str(raised.value)
    assert "\n" not in message
    assert re.search(r"ND_\w+ for gen\w+ must be eonlib's; got ", message)
    assert re.search(r"/pbrlib_gen\w+_impl.mtlx", message)
    assert message.endswith(f"load {OURS} before the standard libraries")


@pytest.mark.parametrize("target", CALLS)
def test_generateshader_finds_the_library_by_its_absolute_folder(tmp_path, target):
    file = written(tmp_path, material(BOTH))
    options = "--library", OURS, "--target", target, "--outputPath", tmp_path
    output(sys.executable, SCRIPTS / "generateshader.py", *options, file, cwd=tmp_path)
    [text] = [each for each in tmp_path.glob(f"look.{target}*") if each.suffix != ".vert"]
    assert [call in text.read_text() for call in CALLS[target]] == [True, True]


def test_generateshader_takes_the_profile_before_the_library(tmp_path):
    file = written(tmp_path, material(BOTH))
    copy = export_library(tmp_path / "eonlib")
    [profile] = (copy / "genosl" / "cycles").glob("*.xml")
    profile.rename(profile.with_suffix(".mtlx"))
    folders = profile.parent, copy / "documents"
    options = "--library", *folders, "--target", "osl", "--outputPath", tmp_path
    output(sys.executable, SCRIPTS / "generateshader.py", *options, file, cwd=tmp_path)
    assert "oren_nayar_diffuse_bsdf_cycles(first_" in (tmp_path / "look.osl").read_text()


def test_usd_finds_the_library_by_its_plugin_search_path(monkeypatch):
    with available("cycles"):  # Blender contains USD, which loads MaterialX
        python = interpreter()
    monkeypatch.setenv("PXR_MTLX_PLUGIN_SEARCH_PATHS", OURS)
    done = subprocess.run([python, "-c", USD, *NODEDEFS], capture_output=True, text=True)
    definitions = library.documents_folder("diffuse") / "eonlib_defs.mtlx"
    found = [f"found {node} {definitions}" for node in NODEDEFS]
    assert re.findall("found .*", done.stdout) == found and done.returncode == 0
    assert "MaterialX" not in done.stderr


# --- folders as libraries -------------------------------------------------------------------------

BRICK = """<materialx version="1.39">
  <nodedef name="ND_brick" node="brick"><output name="out" type="color3"/></nodedef>
  <nodegraph name="NG_brick" nodedef="ND_brick">
    <constant name="red" type="color3"><input name="value" type="color3" value="0.8, 0.2, 0.1"/>
    </constant><output name="out" type="color3" nodename="red"/>
  </nodegraph>
</materialx>"""
BRICKS = '<brick name="bricks" type="color3"/>' + connected(color='nodename="bricks"')


def test_a_folder_is_loaded_before_the_standard_libraries(tmp_path):
    (tmp_path / "brick.mtlx").write_text(BRICK)
    [shader] = generate(material(BRICKS), "glsl", library=tmp_path)
    assert "0.8" in shader.stages["pixel"]
    with pytest.raises(library.LibraryError, match="must be eonlib's"):
        library.assert_eonlib(library.load_library(str(tmp_path)))


def test_materials_in_a_folder_do_not_replace_nodes_of_other_documents(tmp_path):
    (tmp_path / "brick.mtlx").write_text(BRICK)
    constant = '<constant name="own" type="color3"><input name="value" type="color3" value="{}"/></constant>'
    own = connected(color='nodename="own"')
    (tmp_path / "materials.mtlx").write_text(material(image("own.png", "own") + own))
    [shader] = generate(material(constant.format("0.7, 0, 0") + own), "glsl", library=tmp_path)
    assert not any(port.type == "filename" for port in shader.inputs)
    children = library.load_library(tmp_path).getChildren()
    assert mx.Node not in {type(each) for each in children}


@pytest.mark.parametrize("text", ["<materialx", '<materialx version="1.39">text</materialx>'])
def test_a_folder_with_a_broken_document_is_one_line(tmp_path, text):
    (tmp_path / "brick.mtlx").write_text(text)
    with pytest.raises(InputError, match=f"^library {tmp_path}: "):
        library.load_library(str(tmp_path))
