# SPDX-License-Identifier: Apache-2.0
"""Each patch for an upstream repository belongs to a page of docs/upstream, and applies cleanly."""

import json
import re
import subprocess
from pathlib import Path

import MaterialX as mx
import pytest

from mxeon.conformance.results.known_issues import issues
from mxeon.errors import NotRun
from mxeon.survey.browser import packages_folder
from tests.hosts.test_cycles_kernel import kernel
from tests.support.availability import available
from tests.support.wheels import MAIN, git
from tools.site import versions
from tools.site.ledger import ROOT, patches, patches_of

ISSUES = issues()
MATERIALX = patches("materialx")
FILES = {page: files for page in ISSUES if (files := patches_of(page))}
INSTALLED = Path(mx.__file__).parent
MODULES = packages_folder() / "node_modules"
# Upstream projects, and the host that installs the files of each project.
HOSTS = {"three.js": "three", "blender": "cycles"}


def source(project, name):
    """Installed file that corresponds to a file in a project's repository."""
    if project == "openpbr":  # MaterialX contains the graph of OpenPBR
        return INSTALLED / "libraries" / "bxdf" / Path(name).name
    if project == "blender":
        return kernel() / name.removeprefix("intern/cycles/kernel/")
    return INSTALLED / name if project == "materialx" else MODULES / project.split(".js")[0] / name


def repository(folder, project, files):
    """Create a git repository with the installed files of a project, tagged `release`."""
    git(folder, "init", "--quiet")
    for file in files:
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        (folder / file).write_bytes(source(project, file).read_bytes())
    git(folder, "add", ".")
    git(folder, "commit", "--quiet", "--message", "release")
    git(folder, "tag", "release")
    return folder


def changed(*files):
    text = "".join(path.read_bytes().decode() for path in files)
    return sorted(set(re.findall(r"^--- a/(.*)$", text, re.MULTILINE)))


@pytest.mark.parametrize(
    "project", sorted({path.parent.name for path in ROOT.glob("patches/*/*.patch")})
)
def test_the_patches_of_a_project_are_from_pages_and_apply_to_its_release(project, tmp_path):
    found = patches(project)
    assert set(found) <= set(ISSUES)
    with available(HOSTS.get(project, project if project.startswith("three") else "gl")):
        try:
            folder = repository(tmp_path, project, changed(*found.values()))
        except FileNotFoundError as error:
            raise NotRun(f"{project}: {error}") from error
    git(folder, "am", "--quiet", *found.values())
    # A patch states the git hash of each file after patching. The repository must have each hash.
    for text in (path.read_bytes().decode() for path in found.values()):
        for name in re.findall(r"^index \w+\.\.(\w{40})", text, re.MULTILINE):
            git(folder, "cat-file", "-e", name)


@pytest.fixture(scope="module")
def materialx(tmp_path_factory):
    """Repository with the MaterialX files that patches change, tagged `release` and `main`."""
    files = changed(*MATERIALX.values(), MAIN)
    folder = repository(tmp_path_factory.mktemp("repository"), "materialx", files)
    git(folder, "apply", "--index", MAIN)
    git(folder, "commit", "--quiet", "--message", "main")
    git(folder, "tag", "main")
    return folder


def applied(folder, tag, *pages):
    """Check out a tag of a repository, and apply the patches of the given pages."""
    git(folder, "checkout", "--quiet", "--detach", tag)
    try:
        git(folder, "am", "--quiet", *(MATERIALX[page] for page in pages))
    except subprocess.CalledProcessError:
        git(folder, "am", "--abort")
        raise


def test_main_is_upstreams(materialx):
    """The files at the tag `main` have the same hashes as on MaterialX's main branch."""
    names = re.findall(r"^index \w+\.\.(\w{40})", MAIN.read_text(), re.MULTILINE)
    listed = git(materialx, "ls-tree", "-r", "main")
    assert [name for name in names if name not in listed] == []


def test_all_patches_but_those_that_main_has_apply_to_it(materialx):
    applied(materialx, "main", *(page for page in MATERIALX if not ISSUES[page].pull))


@pytest.mark.parametrize("page", MATERIALX)
def test_a_patch_applies_alone(materialx, page):
    """Each patch applies to the release, and to main if the defect still exists there."""
    for tag in ("release", "main")[: 1 if ISSUES[page].pull else 2]:
        applied(materialx, tag, page)


def test_a_repair_that_upstream_merged_is_cited_by_its_page_and_patch():
    for page, issue in ISSUES.items():
        merged = [str(issue.pull)] if issue.pull else re.findall(r"#(\d+)$", issue.kind)
        for text in (issue.text, *(each.read_text() for each in FILES.get(page, ()))):
            assert all(number in text for number in merged), page


KNOWN = json.loads(versions.RECORD.read_text())


@pytest.mark.parametrize("page", KNOWN["pages"])
def test_a_page_whose_checks_pass_in_main_names_what_repaired_it(page):
    assert not KNOWN["pages"][page]["main"]["passed"] or ISSUES[page].pull
