# SPDX-License-Identifier: Apache-2.0
"""The site has no dead link and needs no network, and names in the documentation exist."""

import os
import re
import shlex
import subprocess
import sys
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from pkgutil import resolve_name
from urllib.parse import urldefrag

import MaterialX as mx
import numpy as np
import pytest

from mxeon import models
from mxeon.cli import parser
from tests.support.availability import package
from tools.site.__main__ import made

ROOT = Path(__file__).resolve().parents[1]
PROSE = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "tools/fits/README.md")
QUIET = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
# Elements that make a browser load a file from another site.
LOADED = re.compile(
    r"""<(?:script|img|iframe|source)\b[^>]*\ssrc=["']?(?:\w+:)?//"""
    r"""|<link\b(?![^>]*\brel=["']?(?:canonical|prev|next))[^>]*\shref=["']?(?:\w+:)?//"""
)
IMPORTED = re.compile(r"(?:url\(|@import )[\"']?(?:https?:)?//")
LINK = re.compile(r"\]\(([^)\s]+)\)")
FOLDERS = (
    "docs|tests|tools|examples|libraries|genglsl|genosl|python|models|shaders|hosts|conformance"
)
# Paths with a placeholder, such as `tests/<name>.py`, do not match this pattern.
PATH = re.compile(rf"`((?:{FOLDERS})/[^`<\s:]*[^`<\s:.])(?::([\w.]+))?`")
SCRIPT = re.compile(r"python -m ((?:tests|tools)[\w.]*\w)")
NAME = re.compile(r"`(mxeon(?:\.\w+)+)")


def prose():
    """Contents of all pages by file, without the changelog, which names removed features."""
    files = [ROOT / name for name in PROSE if name != "CHANGELOG.md"]
    files += sorted((ROOT / "docs").rglob("*.md"))
    return {file: file.read_text(encoding="utf-8") for file in files}


def build(configuration, site):
    command = [sys.executable, "-m", "mkdocs", "build", "--config-file"]
    command += [str(configuration), "--site-dir", str(site)]
    return subprocess.run(command, capture_output=True, text=True, env=QUIET)


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    package("mkdocs")
    folder = tmp_path_factory.mktemp("docs") / "site"
    built = build(ROOT / "mkdocs.yml", folder)
    assert built.returncode == 0, built.stdout + built.stderr
    return folder


def test_the_site_has_no_dead_link_and_loads_nothing_from_elsewhere(site):
    """The fixture `site` fails for a dead link, because mkdocs.yml makes the build strict."""
    pages = [file.read_text(encoding="utf-8") for file in site.rglob("*.html")]
    styles = [file.read_text(encoding="utf-8") for file in site.rglob("*.css")]
    assert len(pages) > 30 and all("<script" in page for page in pages)
    assert [found[0] for page in pages for found in LOADED.finditer(page)] == []
    assert [found for style in styles for found in IMPORTED.findall(style)] == []


def test_every_public_function_of_the_models_is_on_a_page():
    text = "".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs/api").glob("*.md"))
    functions = re.findall(r"^::: mxeon\.(?:[\w.]+\.)?(\w+)$", text, re.MULTILINE)
    assert {name for name in models.__all__ if name.islower()} - set(functions) == set()


@pytest.mark.parametrize("name", PROSE)
def test_every_link_of_the_prose_leads_to_a_file(name):
    links = LINK.findall((ROOT / name).read_text(encoding="utf-8"))
    files = {urldefrag(link)[0] for link in links if "//" not in link} - {""}
    assert [link for link in files if not (ROOT / name).parent.joinpath(link).exists()] == []


def test_every_path_that_the_prose_names_exists_and_has_the_name_behind_the_colon():
    paths = {place for text in prose().values() for place in PATH.findall(text)}
    assert len(paths) > 50
    # Pages on defects name files of MaterialX, and pages on the design name files of the package.
    folders = (ROOT, Path(mx.__file__).parent, ROOT / "python/mxeon")
    found = {place: [file for each in folders for file in each.glob(place[0])] for place in paths}
    assert sorted(place for place, files in found.items() if not files) == []
    for (path, name), [file, *_] in found.items():
        name = name.split(".")[-1]
        named = not name or name.isdigit() or name in file.read_text("utf-8")
        assert named, f"{path}:{name}"


def test_every_module_that_the_prose_names_exists():
    text = "\n".join(prose().values())
    scripts, names = set(SCRIPT.findall(text)), set(NAME.findall(text))
    assert "tests.fuzz" in scripts and "mxeon.models" in names
    assert [script for script in scripts if find_spec(script) is None] == []
    assert all(resolve_name(name) for name in names)


def test_every_generated_file_is_that_of_today():
    """The files that `python -m tools.site` writes are up to date, except for last digits."""
    number = re.compile(r"-?\d+(?:\.\d+)?(?:e-?\d+)?")
    files = made()
    for path, text in files.items():
        old = path.read_text(encoding="utf-8")
        assert number.sub("", old) == number.sub("", text), path
        figures = (np.array(number.findall(each), dtype=np.float64) for each in (old, text))
        np.testing.assert_allclose(*figures, rtol=1e-2, atol=1e-6, err_msg=str(path))


def test_the_python_example_of_the_readme_runs(tmp_path):
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    [example] = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    for other in re.findall(r'"(\w+)"', example.partition("# or ")[2]):
        exec(example.replace('"eon"', f'"{other}"'), {})
    (tmp_path / "example.py").write_text(example)
    command = [sys.executable, str(tmp_path / "example.py")]
    run = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    assert run.returncode == 0, run.stderr
    [stated] = re.findall(r"# weight: \[(.*?)\]", example)
    printed, stated = (np.fromstring(each.strip("[] \n"), sep=" ") for each in (run.stdout, stated))
    np.testing.assert_allclose(printed, stated, atol=5e-4)


COMMAND = re.compile(r"^(?:\$ |.* IMAGE )?mxeon (\w.*?)(?: \|\| .*| [|>] .*|\\)?$", re.MULTILINE)
FENCE = re.compile(r"^```(?:sh|console)\n(.*?)^```", re.MULTILINE | re.DOTALL)
FENCES = [fence for text in prose().values() for fence in FENCE.findall(text)]


@pytest.mark.parametrize("line", dict.fromkeys(COMMAND.findall("\n".join(FENCES))))
def test_a_command_line_of_the_pages_is_one_that_mxeon_takes(tmp_path, monkeypatch, line):
    monkeypatch.chdir(tmp_path)
    words = shlex.split(line, comments=True)
    for option, folder in pairwise(words):
        if option in ("--materialx", "--definitions", "--path"):
            Path(folder, "MaterialX").mkdir(parents=True, exist_ok=True)
            Path(folder, "MaterialX", "__init__.py").touch()
    assert parser().parse_args(words).run
