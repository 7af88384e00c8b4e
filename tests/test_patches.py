# SPDX-License-Identifier: Apache-2.0
"""The patches for upstream repositories: they are those of the pages, and apply."""

import re
import subprocess
from functools import cache

import pytest

from tests.support.availability import available
from tests.support.wheels import MAIN, git
from tools.site.upstream import ledger, patches, pictures

MATERIALX, *_ = patches.PROJECTS
ROWS = {row.page: row for row in ledger.rows()}
PAGES = list(patches.topics(MATERIALX))
FILES = sorted({change.file for change in MATERIALX.changes})
of_each_project = pytest.mark.parametrize("project", patches.PROJECTS, ids=lambda each: each.name)


@cache
def made(project):
    """The patches of a project as its pages and changes have them now."""
    hosts = {"materialx": "gl", "openpbr": "gl", "three.js": "three", "blender": "cycles"}
    with available(hosts.get(project.name, project.name)):
        return patches.patches(project)


@of_each_project
def test_the_patches_are_those_of_the_pages_and_changes(project):
    """`python -m tools.site.upstream.patches` writes them."""
    folder = patches.PATCHES / project.name
    assert {path.name: path.read_text() for path in folder.iterdir()} == made(project)


def test_the_index_has_the_patches():
    text = ledger.INDEX.read_text()
    assert text == patches.index_text(text)
    assert [page for page in PAGES if f"]({page}.md) | " not in text] == []


@pytest.mark.parametrize("page", pictures.PAGES)
def test_a_picture_is_on_its_page_with_its_figures(page):
    text = (ledger.FOLDER / f"{page}.md").read_text()
    [block] = pictures.BLOCK.findall(text)
    assert f"(pictures/{page}.webp)" in block and "is white" in block
    assert ROWS[page].patch


def test_every_picture_is_of_a_page():
    assert {path.stem for path in pictures.PICTURES.iterdir()} == set(pictures.PAGES)


def test_every_folder_is_of_a_project():
    folders = {path.name for path in patches.PATCHES.iterdir() if path.is_dir()}
    assert folders == {each.name for each in patches.PROJECTS}


@of_each_project
def test_a_message_has_a_subject_and_a_width(project):
    for name, text in made(project).items():
        head, body = text.split("\n---\n")[0].split("\n\n", 1)
        subject = re.search(r"^Subject: \[PATCH\] (.*)$", head, re.MULTILINE)[1]
        assert len(subject) <= patches.WIDTH and not subject.endswith("."), name
        prose = [line for line in body.splitlines() if line[:1] not in "| " and line]
        assert max(map(len, prose)) <= patches.WIDTH, name


def test_a_change_of_a_text_that_is_not_there_is_refused():
    change = MATERIALX.changes[0]
    with pytest.raises(ValueError, match=r"mx_oren_nayar_diffuse_bsdf.glsl must hold 'float LdotV"):
        patches.changed("another text", [change])


# --- MaterialX's repository ---------------------------------------------------------------------


@pytest.fixture(scope="module")
def repository(tmp_path_factory):
    """A repository with the files that patches change: tags `release` and `main`."""
    folder = tmp_path_factory.mktemp("repository")
    git(folder, "init", "--quiet")
    for file in sorted({*FILES, *re.findall(r"^--- a/(.*)$", MAIN.read_text(), re.MULTILINE)}):
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        (folder / file).write_bytes((MATERIALX.root() / file).read_bytes())
    git(folder, "add", ".")
    git(folder, "commit", "--quiet", "--message", "release")
    git(folder, "tag", "release")
    git(folder, "apply", "--index", MAIN)
    git(folder, "commit", "--quiet", "--message", "main")
    git(folder, "tag", "main")
    return folder


def paths(*pages):
    """Files of the patches of pages."""
    names = sorted(made(MATERIALX))
    return [patches.PATCHES / MATERIALX.name / names[PAGES.index(page)] for page in pages]


def applied(repository, tag, *pages):
    """Apply the patches of pages, on top of a tag of the repository."""
    git(repository, "checkout", "--quiet", "--detach", tag)
    try:
        git(repository, "am", "--quiet", *paths(*pages))
    except subprocess.CalledProcessError:
        git(repository, "am", "--abort")
        raise


def test_main_is_upstreams(repository):
    """Its files have the names that git gave them there."""
    names = re.findall(r"^index \w+\.\.(\w{40})", MAIN.read_text(), re.MULTILINE)
    listed = git(repository, "ls-tree", "-r", "main")
    assert [name for name in names if name not in listed] == []


@pytest.mark.parametrize("tag", ["release", "main"])
def test_all_patches_apply_and_are_the_changes_of_the_tests(repository, tag):
    pages = [page for page in PAGES if tag == "release" or not ROWS[page].pull]
    applied(repository, tag, *pages)
    changes = [change for change in MATERIALX.changes if change.page in pages]
    for file in FILES:
        before = git(repository, "show", f"{tag}:{file}")
        after = patches.changed(before, [each for each in changes if each.file == file])
        assert (repository / file).read_bytes().decode() == after, file
    subjects = git(repository, "log", "--reverse", "--format=%s", f"{tag}..HEAD").splitlines()
    assert subjects == [ROWS[page].patch.subject for page in pages]


@pytest.mark.parametrize("page", PAGES)
def test_a_patch_applies_alone(repository, page):
    """Or with those that it needs: to main, or to the release if main has it."""
    needed = {page}
    while more := {each for found in needed for each in ROWS[found].patch.needs} - needed:
        needed |= more
    tag = "release" if ROWS[page].pull else "main"
    applied(repository, tag, *(each for each in PAGES if each in needed))


def test_a_patch_of_what_main_has_repaired_is_refused_there(repository):
    repaired = [page for page in PAGES if ROWS[page].pull]
    assert repaired
    for page in repaired:
        with pytest.raises(subprocess.CalledProcessError):
            applied(repository, "main", page)


def test_a_pull_request_of_a_page_is_one_of_main():
    commits = (MAIN.parent / "commits.txt").read_text()
    cited = [row.pull for row in ROWS.values() if row.pull]
    assert [pull for pull in cited if f"(#{pull})" not in commits] == []
