# SPDX-License-Identifier: Apache-2.0
"""The documentation: a site without dead links that needs no network, and a README that works."""

import os
import re
import runpy
import subprocess
import sys
from html.parser import HTMLParser
from importlib.util import find_spec
from pathlib import Path
from pkgutil import resolve_name
from urllib.parse import unquote, urldefrag

import pytest
import yaml
from playwright.sync_api import sync_playwright

from mxeon import albedo, inversion, models, sampling
from mxeon.hosts import HOSTS
from mxeon.hosts.webgl import program

ROOT = Path(__file__).resolve().parents[1]
PROSE = ("README.md", "CHANGELOG.md", "CONTRIBUTING.md", "tools/fits/README.md")
QUIET = os.environ | {"NO_MKDOCS_2_WARNING": "1"}
# Attributes whose files a browser loads by itself.
LOADED = {"script": "src", "img": "src", "iframe": "src", "source": "src", "link": "href"}
LINK = re.compile(r"\]\(([^)\s]+)\)")
FOLDERS = r"docs|tests|tools|examples|genglsl|genosl|python/mxeon"  # `libraries` is MaterialX's too
PATH = re.compile(rf"`((?:{FOLDERS})/[^`<\s]*[^`<\s:.])(?::\d+)?`")  # without placeholders
SCRIPT = re.compile(r"python -m ((?:tests|tools)[\w.]*\w)")
NAME = re.compile(r"`(mxeon(?:\.\w+)+)")
PLACE = re.compile(r"`([\w/]+)\.py:([\w.]+)`")  # of a name, below the package


def prose():
    """Text of all pages, by their file; the changelog names what is gone."""
    files = [ROOT / name for name in PROSE if name != "CHANGELOG.md"]
    files += sorted((ROOT / "docs").rglob("*.md"))
    return {file: file.read_text(encoding="utf-8") for file in files}


def build(configuration, site):
    command = [sys.executable, "-m", "mkdocs", "build", "--config-file"]
    command += [str(configuration), "--site-dir", str(site)]
    return subprocess.run(command, capture_output=True, text=True, env=QUIET, timeout=300)


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Folder of the built site."""
    folder = tmp_path_factory.mktemp("docs") / "site"
    built = build(ROOT / "mkdocs.yml", folder)
    assert built.returncode == 0, built.stdout + built.stderr
    return folder


class Page(HTMLParser):
    """Links, anchors and loaded resources of a page."""

    def __init__(self, file):
        super().__init__()
        self.links, self.anchors, self.loaded = [], set(), []
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag, attributes):
        named = dict(attributes)
        self.anchors.add(named.get("id"))
        if tag == "a" and "href" in named:
            self.links.append(named["href"])
        canonical = tag == "link" and named.get("rel") in ("canonical", "prev", "next")
        if LOADED.get(tag) in named and not canonical:
            self.loaded.append(named[LOADED[tag]])


@pytest.fixture(scope="module")
def pages(site):
    """Page by file of the site."""
    return {file: Page(file) for file in site.rglob("*.html")}


def is_remote(address):
    return re.match(r"(?:[a-z]+:)?//", address) is not None


def test_site_loads_nothing_from_elsewhere(site, pages):
    assert len(pages) > 30
    loaded = {address for page in pages.values() for address in page.loaded}
    assert [address for address in loaded if is_remote(address)] == []
    styles = "".join(file.read_text(encoding="utf-8") for file in site.rglob("*.css"))
    assert re.findall(r"(?:url\(|@import )[\"']?(?:https?:)?//", styles) == []


def test_search_works_from_a_folder_without_a_network(site):
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(
            executable_path=program(), chromium_sandbox=os.geteuid() != 0
        )
        page, requests, errors = browser.new_page(), [], []
        page.on("request", lambda request: requests.append(request.url))
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.goto((site / "index.html").as_uri())
        page.locator("input[name=query]").press_sequentially("albedo")  # listens to keys
        page.wait_for_selector(".md-search-result__item")
        browser.close()
    assert [url for url in requests if not url.startswith(("file:", "data:"))] == []
    assert errors == []


def dead(file, address, pages):
    """Whether an address on the page `file` of the site leads nowhere."""
    path, anchor = urldefrag(unquote(address))
    target = (file.parent / path).resolve() if path else file
    if target in pages:
        return bool(anchor) and anchor not in pages[target].anchors
    return not target.is_file()


def test_every_link_of_the_site_leads_somewhere(pages):
    found = [
        (file.name, link)
        for file, page in pages.items()
        for link in (*page.links, *page.loaded)
        if not is_remote(link)
        and not link.startswith("data:")
        and file.name != "404.html"
        and dead(file, link, pages)
    ]
    assert found == []


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """Folder of a site of one page that builds."""
    folder = tmp_path_factory.mktemp("home")
    settings = yaml.safe_load((ROOT / "mkdocs.yml").read_text(encoding="utf-8"))
    settings |= {"docs_dir": "docs", "nav": ["index.md"], "plugins": ["search"], "hooks": []}
    (folder / "docs").mkdir()
    (folder / "mkdocs.yml").write_text(yaml.safe_dump(settings))
    (folder / "docs" / "index.md").write_text("# Home\n")
    assert build(folder / "mkdocs.yml", folder / "site").returncode == 0
    return folder


@pytest.mark.parametrize("link", ["nowhere.md", "index.md#nowhere", "/absolute.md"])
def test_a_dead_link_fails_the_build(link, home):
    (home / "docs" / "index.md").write_text(f"# Home\n[dead]({link})\n")
    assert build(home / "mkdocs.yml", home / "site").returncode != 0


def test_every_public_function_of_the_models_is_on_a_page():
    text = "".join(page.read_text(encoding="utf-8") for page in (ROOT / "docs/api").glob("*.md"))
    functions = re.findall(r"^::: mxeon\.[\w.]+\.(\w+)$", text, re.MULTILINE)
    assert {name for name in models.__all__ if name.islower()} - set(functions) == set()


@pytest.mark.parametrize("module", [albedo, inversion, sampling], ids=lambda m: m.__name__)
def test_every_public_function_is_in_the_reference(module):
    name = module.__name__.rpartition(".")[2]
    text = (ROOT / "docs" / "api" / f"{name}.md").read_text(encoding="utf-8")
    functions = re.findall(rf"^::: mxeon\.{name}\.(\w+)$", text, re.MULTILINE)
    assert set(functions) - {"Sampler"} == {
        name for name in vars(module) if name in models.__all__ and name.islower()
    }


@pytest.mark.parametrize("name", PROSE)
def test_every_link_of_the_prose_leads_to_a_file(name):
    links = LINK.findall((ROOT / name).read_text(encoding="utf-8"))
    files = {urldefrag(link)[0] for link in links if not is_remote(link)} - {""}
    assert [link for link in files if not (ROOT / name).parent.joinpath(link).exists()] == []


def test_every_path_that_the_prose_names_exists():
    paths = {path for text in prose().values() for path in PATH.findall(text)}
    assert len(paths) > 50
    assert [path for path in sorted(paths) if not any(ROOT.glob(path))] == []


def test_every_module_that_the_prose_names_exists():
    text = "\n".join(prose().values())
    scripts, names = set(SCRIPT.findall(text)), set(NAME.findall(text))
    assert "tests.fuzz" in scripts and "mxeon.models" in names
    assert [script for script in scripts if find_spec(script) is None] == []
    assert all(resolve_name(name) for name in names)


def test_the_design_begins_with_a_table_of_places_that_exist():
    page = (ROOT / "docs" / "design.md").read_text(encoding="utf-8")
    start, section, *_ = page.split("\n## ")
    assert start == "# Design\n" and section.startswith("Where to find\n")
    rows = [line for line in section.splitlines() if line.startswith("| ")][1:]
    assert len(rows) >= 4
    places = PLACE.findall(section)
    assert len(places) > len(rows)
    for file, name in places:
        assert resolve_name(f"mxeon.{file.replace('/', '.')}:{name}") is not None


def test_the_page_on_hosts_says_what_each_host_is_asked():
    lines = (ROOT / "docs" / "hosts.md").read_text(encoding="utf-8").splitlines()
    rows = {line.split("`")[1]: line for line in lines if line.startswith("| `")}  # the last one
    for host in HOSTS:
        if host.module:
            scenes = ", ".join(f"`{scene.name}`" for scene in host.scenes) or "none"
            target = f"`{host.target}`" if host.target else "none"
            assert rows[host.name].split(" | ")[1] == target
            assert scenes in rows[host.name].rsplit("|", 2)[1]
            assert ("surface shaders" in rows[host.name]) == host.surfaces


def test_the_python_example_of_the_readme_runs(tmp_path):
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    [example] = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    (tmp_path / "example.py").write_text(example)
    command = [sys.executable, str(tmp_path / "example.py")]
    run = subprocess.run(command, capture_output=True, text=True, cwd=ROOT, timeout=300)
    assert run.returncode == 0, run.stderr
    assert "void main" in run.stdout


def test_the_gallery_page_is_the_one_that_its_script_writes():
    gallery = runpy.run_path(str(ROOT / "tools" / "site" / "gallery.py"))
    assert (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8") == gallery["page"]()
    documents = gallery["EXAMPLES"].glob("*.mtlx")
    materials = {name for file in documents for name in gallery["materials"](file)}
    assert {file.stem for file in gallery["PICTURES"].glob("*.webp")} == materials


def test_the_page_on_the_specification_has_every_node():
    script = runpy.run_path(str(ROOT / "tools" / "site" / "specification.py"))
    text = script["PAGE"].read_text(encoding="utf-8")
    headings = re.findall(r"^##+ (\w+)$", text, re.MULTILINE)
    judged = [name for name in headings if name in script["NODES"]]
    marks = re.findall(r"<!-- measured (\w+) -->", text)
    assert [*judged, "targets"] == marks
    assert set(judged) == set(script["NODES"])


def test_prose_has_american_spelling():
    british = re.compile(r"colou|\bgrey|behaviour|\bcentre|neighbour|normalis|rasteris", re.I)
    files = [ROOT / name for name in PROSE] + sorted((ROOT / "docs").rglob("*.md"))
    named = {file.name: british.findall(file.read_text(encoding="utf-8")) for file in files}
    assert {name: words for name, words in named.items() if words and name != "CHANGELOG.md"} == {}


def test_files_that_commands_write_are_marked_as_generated():
    marked = (ROOT / ".gitattributes").read_text(encoding="utf-8")
    patterns = re.findall(r"^(\S+) linguist-generated$", marked, re.M)
    assert patterns and all(any(ROOT.glob(pattern)) for pattern in patterns)
