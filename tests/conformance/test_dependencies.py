# SPDX-License-Identifier: Apache-2.0
"""What a run depends on: a run is resumed with the same files, options and drivers only."""

import pytest

from mxeon.cli import main
from mxeon.conformance.run import check, read_run
from mxeon.conformance.run.journal import JOURNAL
from mxeon.hosts.base import Identity
from mxeon.hosts.gl import Host
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.document.references import digests
from mxeon.shaders.library import examples_folder
from tests.support.plans import keep_checks

INCLUDE = '<xi:include xmlns:xi="http://www.w3.org/2001/XInclude" href="{}"/>'
FILE = '<input name="file" type="filename" value="{}"/>'


def document(path, *parts, root=""):
    path.parent.mkdir(parents=True, exist_ok=True)
    text = f'<?xml version="1.0"?><materialx version="1.39" {root}>{"".join(parts)}</materialx>'
    path.write_text(text, encoding="utf-8")
    return path


def texture(path):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(b"pixels")
    return path


@pytest.mark.parametrize(
    "parts, root, name",
    [
        ([FILE.format("grid.png")], "", "grid.png"),
        ([FILE.format("images/grid.png")], "", "images/grid.png"),
        ([FILE.format("grid.png")], 'fileprefix="images/"', "images/grid.png"),
        ([FILE.format("set.&lt;UDIM&gt;.png")], "", "set.1001.png"),
        ([FILE.format("set.<UDIM>.png")], "", "set.1001.png"),
        ([FILE.format("[which].png")], "", "wood.png"),
        (['<implementation name="i" file="own.glsl"/>'], "", "own.glsl"),
        ([INCLUDE.format("part.mtlx")], "", "part.mtlx"),
    ],
)
def test_what_a_document_names_is_a_dependency(tmp_path, parts, root, name):
    file = document(tmp_path / "a.mtlx", *parts, root=root)
    before = digests([file], Policy())
    texture(tmp_path / name)
    after = digests([file], Policy())
    assert {path for path, _ in before.items() ^ after.items()} == {str(tmp_path / name)}


@pytest.fixture
def run(tmp_path, monkeypatch):
    """A folder with a short run on the gl host, and its document."""
    keep_checks(monkeypatch, "curve", "picture")
    texture(tmp_path / "grid.png")
    token = '<token name="t" type="string" value="grid.png"/></materialx>'
    text = (examples_folder() / "plaster.mtlx").read_text(encoding="utf-8")
    file = tmp_path / "plaster.mtlx"
    file.write_text(text.replace("</materialx>", token), encoding="utf-8")
    check([file], folder=tmp_path / "run")
    return tmp_path / "run", file


def test_a_texture_that_changed_is_named_and_the_run_not_resumed(run, capsys):
    folder, file = run
    (file.parent / "grid.png").write_bytes(b"other")
    command = ["check", str(file), "--library", "eonlib", "--report", str(folder), "--resume"]
    assert main(command) == 2
    error = capsys.readouterr().err
    assert error.endswith(f"changed: {file.parent / 'grid.png'}\n") and error.count("\n") == 1


def test_an_option_that_changed_is_named(run):
    folder, file = run
    with pytest.raises(ValueError, match=r"changed: --allowCode \(False, now True\), --maxSize \("):
        options = {"policy": Policy(code=True, size=10**6)}
        check([file], folder=folder, resume=True, **options)


def test_a_driver_that_changed_is_named_once_its_tasks_go_on(run, monkeypatch):
    folder, file = run
    path = folder / JOURNAL
    path.write_bytes(b"".join(path.read_bytes().splitlines(keepends=True)[:-1]))
    monkeypatch.setattr(Host, "identity", lambda self: Identity("gl", "5.0", "another"))
    with pytest.raises(ValueError, match=r"changed: host gl \(.*, now 5.0, another\)$"):
        check([file], folder=folder, resume=True)
    assert read_run(folder).missing


def test_a_folder_that_is_a_library_is_a_dependency(tmp_path):
    source = texture(tmp_path / "library" / "genglsl" / "brick.glsl")
    found = digests([], Policy(), ["eonlib", str(tmp_path / "library")])
    assert found.keys() - digests([], Policy(), ["eonlib"]).keys() == {str(source)}
