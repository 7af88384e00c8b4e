# SPDX-License-Identifier: Apache-2.0
"""Shader sources of documents may include some files. Other files are refused with a message."""

import os
from pathlib import Path

import MaterialX as mx
import pytest

from mxeon.errors import DocumentError, InputError
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.generation import TARGETS, generate
from mxeon.shaders.generators import context_of, generator_of
from mxeon.shaders.library import load_library
from tests.support.documents import connected, material

CODE = Policy(code=True)
TRUSTED = Policy(code=True, outside=True)
NODEDEF = '<nodedef name="ND_own" node="own"><output name="out" type="color3"/></nodedef>'
IMPLEMENTATION = '<implementation name="IM_own{0}" nodedef="ND_own" file="{1}" {2}/>'
USE = '<own name="own" type="color3"/>' + connected(color='nodename="own"')
BODY = "void own(out vec3 result) { result = vec3(0.123); }\n"
OTHER = "float other(float x) { return 2.0 * x; }\n"
SECRET = "// canary\n"
# MaterialX warns about documents that contain their own code.
pytestmark = pytest.mark.filterwarnings("ignore")


@pytest.fixture
def home(tmp_path):
    """A folder with a document, a shader source, and links that lead outside the folder."""
    folder = tmp_path / "documents"
    (folder / "lib").mkdir(parents=True)
    (folder / "link").symlink_to(tmp_path)
    (folder / "linked.glsl").symlink_to(tmp_path / "secret.glsl")
    (folder / "other.glsl").write_text(OTHER)
    (tmp_path / "secret.glsl").write_text(SECRET)
    write(folder, "own.glsl", 'function="own"')
    return folder


def write(folder, file, attributes="", more=""):
    """Write a document with a node that a shader file implements."""
    node = NODEDEF + IMPLEMENTATION.format("", file, attributes) + more + USE
    (folder / "look.mtlx").write_text(material(node))


def including(home, *names, text=BODY):
    """Write a shader source that includes the named files."""
    lines = "".join(f'#include "{name}"\n' for name in names)
    (home / "own.glsl").write_text(lines + text)


def code(home, target="glsl", policy=CODE):
    return generate(home / "look.mtlx", target, policy=policy)[0].stages["pixel"]


def refusal(home, policy=CODE):
    with pytest.raises(DocumentError) as refused:
        code(home, policy=policy)
    return str(refused.value)


# --- permitted files ----------------------------------------------------------------------------


@pytest.mark.parametrize("target", sorted({"glsl", "essl", "vulkan", "msl"} & set(TARGETS)))
def test_a_source_includes_others_of_its_folder_and_of_the_libraries(home, target):
    (home / "lib" / "deep.glsl").write_text('#include "../other.glsl"\nfloat deep;\n')
    library = "libraries/pbrlib/genglsl/lib/mx_microfacet.glsl"
    including(home, "lib/deep.glsl", "other.glsl", library)
    text = code(home, target)
    for line, count in {"float deep;": 1, OTHER: 1, "0.123": 1}.items():
        assert text.count(line) == count
    assert "mx_ggx_dir_albedo(" in text


# --- forbidden files ----------------------------------------------------------------------------


@pytest.mark.parametrize("depth", [0, 1, 5])
@pytest.mark.parametrize(
    "name", ["../secret.glsl", "link/secret.glsl", "linked.glsl", "{}/secret.glsl", "/dev/zero"]
)
def test_an_include_of_a_file_outside_is_refused_at_any_depth(home, name, depth):
    for number in range(depth):
        (home / f"{number}.glsl").write_text(f'#include "{number + 1}.glsl"\n')
    name = name.format(home.parent)
    (home / f"{depth}.glsl").write_text(f'float x;\n#include "{name}"\n')
    including(home, "0.glsl")
    message = refusal(home)
    assert message.startswith(f"{home / f'{depth}.glsl'}: include must name a file in {home}, on ")
    assert message.endswith(": pass --allowOutside to permit it")


def test_with_permission_a_source_includes_files_outside(home):
    including(home, "../secret.glsl")
    assert SECRET in code(home, policy=TRUSTED)


@pytest.mark.parametrize(
    "line", ['// #include "{}"', 'x #include "{}" y', '#include "{}" // "of', '\t#include"{}"\r']
)
def test_every_line_that_materialx_takes_for_an_include_is_judged(home, line):
    (home / "own.glsl").write_text(line.format("../secret.glsl") + "\n" + BODY, newline="")
    with pytest.raises(DocumentError):
        code(home)


@pytest.mark.parametrize("kind", ["pipe", "device", "folder", "bytes", "mark"])
@pytest.mark.parametrize("included", [False, True])
def test_a_source_is_a_regular_file_of_text(home, kind, included):
    path = home / ("part.glsl" if included else "own.glsl")
    if included:
        including(home, "part.glsl")
    make = {
        "pipe": os.mkfifo,
        "device": lambda path: path.symlink_to("/dev/zero"),
        "folder": Path.mkdir,
        "bytes": lambda path: path.write_bytes(b"// caf\xe9\n"),
        "mark": lambda path: path.write_bytes(b"\xff\xfe//"),
    }
    make[kind](path)
    said = {"bytes": "text in UTF-8; byte 6 is not", "mark": "text in UTF-8; byte 0 is not"}
    rule = said.get(kind, "readable; not a regular file")
    message = refusal(home, TRUSTED if kind == "device" else CODE)
    assert message == f"{home / 'look.mtlx'}: source {path}: must be {rule}"


# --- limits -------------------------------------------------------------------------------------


def test_sources_in_a_row_are_limited(home):
    for number in range(3):
        (home / f"{number}.glsl").write_text(f'#include "{number + 1}.glsl"\n')
    (home / "3.glsl").write_text("float last;\n")
    including(home, "0.glsl")
    assert "float last;" in code(home, policy=Policy(code=True, includes=4))
    assert "--maxIncludes" in refusal(home, Policy(code=True, includes=3))


def test_a_path_that_grows_by_a_link_is_a_row_too(home):
    (home / "again").symlink_to(home)
    (home / "part.glsl").write_text('#include "again/part.glsl"\n')
    including(home, "part.glsl")
    assert "--maxIncludes" in refusal(home)


def test_all_sources_of_a_document_are_limited_in_size(home):
    (home / "part.glsl").write_text("/" * 1000)
    including(home, "part.glsl")
    least = 1000 + (home / "own.glsl").stat().st_size
    assert code(home, policy=Policy(code=True, size=least))
    message = refusal(home, Policy(code=True, size=least - 1))
    assert f"must have at most {least - 1} bytes, with all sources of its document" in message
    assert message.endswith("raise it with --maxSize")


def test_different_includes_of_a_document_are_limited_in_number(home):
    missing = [f"missing{number}.glsl" for number in range(15)]
    including(home, *["other.glsl"] * 50, *missing)
    most = len(["own.glsl", "other.glsl", *missing])
    refused = refusal(home, Policy(code=True, elements=most - 1))
    assert f"at most {most - 1} includes in its sources" in refused
    accepted = refusal(home, Policy(code=True, elements=most))
    assert accepted.endswith("Could not find include file: 'missing0.glsl'")


def test_text_in_all_shaders_is_limited(home):
    including(home, "other.glsl")
    least = len(OTHER) + (home / "own.glsl").stat().st_size
    assert code(home, policy=Policy(code=True, text=least))
    assert "--maxText" in refusal(home, Policy(code=True, text=least - 1))


# --- libraries ----------------------------------------------------------------------------------


@pytest.fixture
def folder(tmp_path):
    """Folder of a library with one node. The node's shader source lies in the same folder."""
    folder = tmp_path / "library"
    folder.mkdir()
    node = NODEDEF + IMPLEMENTATION.format("", "own.glsl", 'function="own"')
    (folder / "own.mtlx").write_text(f'<materialx version="1.39">{node}</materialx>')
    (folder / "own.glsl").write_text(BODY)
    return folder


def test_a_library_may_name_any_file(folder, tmp_path):
    (tmp_path / "secret.glsl").write_text(SECRET)
    including(folder, "../secret.glsl")
    shader = generate(material(USE), "glsl", library=str(folder))[0]
    assert SECRET in shader.stages["pixel"]


@pytest.mark.parametrize("name", ["own.glsl", "part.glsl", "part.mtlx"])
@pytest.mark.parametrize("kind", ["pipe", "device", "bytes"])
def test_every_file_of_a_library_is_a_regular_one_of_text(folder, kind, name):
    part = '<xi:include href="part.mtlx"/>' if name == "part.mtlx" else ""
    text = (folder / "own.mtlx").read_text().replace("</materialx>", f"{part}</materialx>")
    xinclude = 'xmlns:xi="http://www.w3.org/2001/XInclude" version'
    (folder / "own.mtlx").write_text(text.replace("version", xinclude, 1))
    if name == "part.glsl":
        including(folder, "part.glsl")
    path = folder / name
    path.unlink(missing_ok=True)
    if kind == "bytes":
        path.write_bytes(b"<!-- caf\xe9 -->")
    else:
        os.mkfifo(path) if kind == "pipe" else path.symlink_to("/dev/zero")
    with pytest.raises(InputError, match=f"{name}: must be (readable; not a |text in UTF-8; by)"):
        generate(material(USE), "glsl", library=str(folder))


def test_files_of_a_library_are_limited_in_size(folder):
    with (folder / "own.glsl").open("a") as file:
        file.truncate(17 * 2**20)
    with pytest.raises(InputError, match="own.glsl: must have at most 16777216 bytes"):
        load_library(str(folder))


def test_the_generated_text_is_the_one_that_materialx_makes(home):
    including(home, "other.glsl", "libraries/pbrlib/genglsl/lib/mx_microfacet.glsl")
    document = mx.createDocument()
    mx.readFromXmlFile(document, str(home / "look.mtlx"))
    document.setDataLibrary(load_library())
    generator = generator_of(document, "glsl", "eonlib", None)
    context = context_of(document, "glsl", generator, "eonlib", False, ())
    expected = generator.generate("look", document.getDescendant("look"), context)
    assert code(home) == expected.getSourceCode("pixel")
