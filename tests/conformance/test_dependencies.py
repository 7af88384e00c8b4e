# SPDX-License-Identifier: Apache-2.0
"""A run can only be resumed with unchanged files, options and graphics drivers."""

import re
from pathlib import Path

import pytest

from mxeon import check
from mxeon.errors import InputError
from mxeon.shaders.document.policy import Policy
from tests.support.command import PLASTER
from tests.support.plans import keep_checks
from tests.support.wrong_libraries import copy_of_eonlib

CODE = Policy(code=True)
FILE = '<image name="i{}" type="color3"><input name="file" type="filename" value="{}"{}/></image>'
# Files in a document's folder, and the XML element by which the document names each file.
NAMES = {
    "grid.png": FILE.format(1, "grid.png", ""),
    "images/grid.png": FILE.format(2, "images/grid.png", ""),
    "images/wood.png": FILE.format(3, "wood.png", ' fileprefix="images/"'),
    "set.1001.png": FILE.format(4, "set.&lt;UDIM&gt;.png", ""),
    "other.1001.png": FILE.format(5, "other.<UDIM>.png", ""),
    "oak.png": FILE.format(6, "[which].png", ""),
    "own.glsl": '<implementation name="i" file="own.glsl"/>',
    "part.mtlx": '<xi:include xmlns:xi="http://www.w3.org/2001/XInclude" href="part.mtlx"/>',
}


def run_of(folder, *named):
    """Check a document that names other files. Return the run's folder and the document's path."""
    text = Path(PLASTER).read_text(encoding="utf-8")
    file = folder / "plaster.mtlx"
    file.write_text(text.replace("</materialx>", f"{''.join(named)}</materialx>"), encoding="utf-8")
    check([file], folder=folder / "run", policy=CODE)
    return folder / "run", file


@pytest.fixture
def run(tmp_path, monkeypatch):
    """Folder and document of a run with two tasks. The document names a texture."""
    keep_checks(monkeypatch, "lambert", "picture")
    (tmp_path / "grid.png").write_bytes(b"pixels")
    return run_of(tmp_path, '<token name="t" type="string" value="grid.png"/>')


def refusal(folder, files, **options):
    """The list of changes in the error message with which `check` refuses to resume a run."""
    with pytest.raises(InputError, match="holds another run") as error:
        check(files or None, folder=folder, resume=True, **{"policy": CODE} | options)
    _, _, changed = str(error.value).partition("another run (")
    return changed.removesuffix("); use a new folder, or omit --resume")


def test_what_a_document_names_is_a_dependency(tmp_path, monkeypatch):
    keep_checks(monkeypatch, "host")
    for name in NAMES:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text('<?xml version="1.0"?><materialx version="1.39"/>')
    folder, file = run_of(tmp_path, *NAMES.values())
    for name in NAMES:
        path = tmp_path / name
        text = path.read_text()
        path.write_text(f"{text}\n")
        assert refusal(folder, [file]) == str(path)
        path.write_text(text)


def test_an_option_that_changed_is_named(run):
    folder, file = run
    changed = refusal(folder, [file], policy=Policy(size=10**6))
    assert changed.startswith("--allowCode (True, now False), --maxSize (")


def test_a_driver_that_changed_is_named_once_its_tasks_go_on(run):
    """The test renames the driver in the journal and deletes the last finished task."""
    folder, file = run
    [path] = folder.rglob("*.jsonl")
    lines = path.read_text(encoding="utf-8").splitlines(keepends=True)[:-1]
    path.write_text(re.sub('"device": "[^"]*"', '"device": "another"', "".join(lines)))
    assert re.fullmatch(r"host gl \(.*, another, now .*\)", refusal(folder, [file]))


def test_a_folder_that_is_a_library_is_a_dependency(tmp_path, monkeypatch):
    keep_checks(monkeypatch, "host")
    library = copy_of_eonlib(tmp_path)
    options = {"hosts": ["msl"], "libraries": [library], "policy": CODE}
    check(None, folder=tmp_path / "run", **options)
    source = tmp_path / "genglsl" / "lib" / "eon.glsl"
    source.write_text(f"{source.read_text()}\n")
    assert refusal(tmp_path / "run", (), **options) == str(source)
