# SPDX-License-Identifier: Apache-2.0
"""Hostile documents are refused with a one-line message that names a remedy."""

import warnings
from dataclasses import replace
from itertools import product
from pathlib import Path

import MaterialX as mx
import pytest

from mxeon import cli
from mxeon.errors import MISUSE, PASSED
from mxeon.shaders.document.notes import DocumentWarning
from mxeon.shaders.document.policy import DEFAULT, LIMITS, Policy
from mxeon.shaders.document.reading import read_document
from mxeon.shaders.generation import CodeWarning, generate
from tests.fuzz.cases import doubled, row
from tests.support.documents import connected, including, lobe, material, refusal, textured, written

TRUSTED = Policy(outside=True, code=True)
PART = material(lobe())
NODEDEF = '<nodedef name="ND_a" node="a"><output name="out" type="BSDF"/></nodedef>'
BROUGHT = NODEDEF + '<implementation name="IM_a" nodedef="ND_a" {}/><a name="lobe" type="BSDF"/>'
INLINE = (
    '<nodedef name="ND_t" node="t"><output name="out" type="color3"/></nodedef>'
    '<implementation name="IM_t" nodedef="ND_t" sourcecode="vec3(0.5)"/><t name="t" type="color3"/>'
) + connected(color='nodename="t"')
SOURCE = "void a(out BSDF r) { r = BSDF(vec3(0.0), vec3(1.0)); }"
BOMB = """<?xml version="1.0"?><!DOCTYPE materialx [<!ENTITY a "ha"><!ENTITY b "&a;&a;&a;&a;">]>
<materialx version="1.39"><constant name="&b;" type="float"/></materialx>"""
FETCH = BOMB.replace('"ha"', 'SYSTEM "../secret.mtlx"')


@pytest.fixture
def home(tmp_path):
    """Folder for a document, with a link to files outside the folder."""
    folder = tmp_path / "documents"
    folder.mkdir()
    (folder / "link").symlink_to(tmp_path)
    (folder / "tile.1001.png").symlink_to(tmp_path / "secret.png")
    (folder / "inside.png").touch()
    for name, text in {"secret.png": "", "secret.mtlx": PART, "secret.glsl": SOURCE}.items():
        (tmp_path / name).write_text(text)
    return folder


# --- files outside ------------------------------------------------------------------------------


NAMES = ("../secret", "link/secret", "{}/secret")
SETS = ("tile.&lt;UDIM&gt;", "../&lt;UDIM&gt;")
OUTSIDE = {
    "png": lambda name: textured([name]),
    "mtlx": including,
    "glsl": lambda name: material(BROUGHT.format(f'file="{name}" function="a"')),
}


@pytest.mark.parametrize(
    "ending, name", [*product(OUTSIDE, NAMES), *(("png", name) for name in SETS)]
)
def test_a_file_outside_needs_permission(home, ending, name):
    path = written(home, OUTSIDE[ending](f"{name.format(home.parent)}.{ending}"))
    assert "pass --allowOutside to permit it" in refusal(path, Policy(code=True))
    with warnings.catch_warnings(action="ignore", category=CodeWarning):
        assert generate(path, "glsl", policy=TRUSTED)


def test_files_inside_and_in_the_libraries_need_no_permission(home):
    library = f"{mx.getDefaultDataSearchPath().asString()}/libraries/targets/genglsl.mtlx"
    for name in ("inside.png", "link/documents/inside.png", library):
        assert read_document(written(home, textured([name])))


# --- code ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("how", ['file="own.glsl" function="a"', 'sourcecode="BSDF()"'])
def test_code_of_its_own_needs_permission_and_is_reported(home, how):
    (home / "own.glsl").write_text(SOURCE)
    path = written(home, material(BROUGHT.format(how)))
    assert 'implementation "IM_a" must not contain its own code' in refusal(path)
    with pytest.warns(CodeWarning, match=r"look.mtlx: contains its own code: IM_a"):
        assert generate(path, "glsl", policy=Policy(code=True))


def test_generating_reports_code_and_running_it_needs_the_option(home, capsys):
    path = str(written(home, material(INLINE)))
    out = str(home / "out")
    with warnings.catch_warnings(action="default"):
        assert cli.main(["generate", path, "--target", "glsl", "--outputPath", out]) == PASSED
    assert "warning: " in capsys.readouterr().err
    render = ["render", path, "--size", "4", "--output", f"{out}/a.png"]
    assert cli.main(render) == MISUSE
    assert "pass --allowCode to permit it" in capsys.readouterr().err
    with warnings.catch_warnings(action="default"):
        assert cli.main([*render, "--allowCode"]) == PASSED


# --- limits -------------------------------------------------------------------------------------

ROW = material(row(8, ("in1",)))
SMALL = material(lobe())
TOKEN = '<token name="a" type="string" value="b"/>'

# A row has the name of a limit, a document, and the smallest limit that accepts the document.
LIMITED = (
    ("size", SMALL, len(SMALL)),
    ("length", SMALL, len("oren_nayar_diffuse_bsdf") - 10),
    ("depth", SMALL, 3),
    ("elements", SMALL, 6),
    ("attributes", SMALL, 13),
    ("inputs", SMALL, 1),
    ("tokens", SMALL.replace("</surface>", f"{TOKEN}</surface>"), 1),
    ("shaders", SMALL, 1),
    ("ports", SMALL, 5 + 4 + 3),
    ("nodes", ROW, 11),
    ("chain", ROW, 11),
    ("depth", material(doubled(4)), 6),  # the count includes the graph of eon_diffuse_bsdf
)


@pytest.mark.parametrize("name, text, least", LIMITED, ids=[f"{n}-{k}" for n, _, k in LIMITED])
def test_a_limit_is_kept_and_names_its_option(name, text, least):
    assert generate(text, "glsl", policy=replace(DEFAULT, **{name: least}))
    low = replace(DEFAULT, **{name: least - 1})
    message = refusal(text, low)
    assert f"at most {least - 1} " in message
    assert f"raise it with --max{name.capitalize()}" in message


def test_includes_in_a_row_are_limited(tmp_path):
    for number in range(4):
        (tmp_path / f"{number}.mtlx").write_text(including(f"{number + 1}.mtlx"))
    (tmp_path / "4.mtlx").write_text(PART)
    assert read_document(tmp_path / "0.mtlx", policy=Policy(includes=4)).content.getNode("lobe")
    assert "--maxIncludes" in refusal(tmp_path / "0.mtlx", Policy(includes=3))


def test_a_document_that_includes_itself_is_refused_at_once(tmp_path):
    for one, other in ("ab", "ba"):
        (tmp_path / f"{one}.mtlx").write_text(including(f"./../{tmp_path.name}/{other}.mtlx"))
    assert "must not lead back to the same document" in refusal(tmp_path / "a.mtlx")


@pytest.mark.parametrize("name", LIMITS)
def test_the_page_on_security_has_every_limit_and_its_default(name):
    page = Path(__file__).parents[2] / "docs" / "security.md"
    row = f"| `--max{name.capitalize()}` | {getattr(DEFAULT, name):,} | {LIMITS[name]} |"
    assert row in page.read_text(encoding="utf-8")


# --- text and names -----------------------------------------------------------------------------


@pytest.mark.parametrize("text", [BOMB, FETCH], ids=["entities", "file"])
def test_entities_are_refused(text):
    assert "must have no document type" in refusal(text)


@pytest.mark.parametrize("kind", ["filename", "geomname"])
@pytest.mark.parametrize("outer", ["{}", '<nodegraph name="graph">{}</nodegraph>'])
def test_a_token_that_would_end_the_process_is_refused(kind, outer):
    token = outer.format(f'<token name="odd" type="{kind}" value="a"/>')
    message = refusal(SMALL.replace("</materialx>", f"{token}</materialx>"))
    rule = f"must not have the type {kind}, which crashes MaterialX: give it the type string"
    assert rule in message


@pytest.mark.parametrize("character", ["\x7f", "\x85", "\u202e"])
def test_control_characters_are_refused(character):
    text = SMALL.replace("look", f"lo{character}ok")
    assert "surfacematerial must have no control characters in 'name'" in refusal(text)


def test_an_element_that_materialx_ignores_is_named():
    twice = SMALL.replace("</materialx>", '<nodegraph name="look"/></materialx>')
    with pytest.warns(
        DocumentWarning, match="nodegraph 'look' must have a name that no sibling has"
    ):
        assert generate(twice, "glsl")


@pytest.mark.parametrize("name", ["../look", "/look", "look.", "lo ok", "l" * 200, "..", "ng/look"])
def test_names_are_no_paths(name):
    message = refusal(SMALL.replace('"look"', f'"{name}"'))
    assert "must be a name of letters" in message or "name of at most 128 characters" in message


def test_the_name_of_a_file_steers_no_terminal(tmp_path, capsys):
    path = tmp_path / "a\x1b[31m\nb\u202e.mtlx"
    path.write_text(SMALL)
    out = tmp_path / "out"
    options = ["--target", "osl", "--outputPath", str(out), "--workers", "0"]
    assert cli.main(["generate", str(path), *options]) == 0
    assert [each.name.isprintable() for each in out.iterdir()] == [True]
    path.write_text("")
    cli.main(["generate", str(path), *options])
    assert capsys.readouterr().err.rstrip("\n").isprintable()
