# SPDX-License-Identifier: Apache-2.0
"""`mxeon explore` writes a page, and refuses invalid arguments."""

import json
import os
import re
import signal
import subprocess
import sys
from base64 import b64encode
from html import unescape
from urllib.error import HTTPError
from urllib.request import Request, urlopen

import numpy as np
import pytest
from pytest import approx

from mxeon import check
from mxeon.cli import main
from mxeon.cli.answer import answer
from mxeon.conformance import words
from mxeon.conformance.results import VISIBLE
from mxeon.errors import MISUSE
from mxeon.errors import PASSED as PASSED_STATUS
from mxeon.explorer import PARAGRAPH, TEXTS, documents, page, page_data
from mxeon.explorer.documents import document_sources
from mxeon.hosts.textures import read_texture
from mxeon.io.images import write_image, write_picture
from mxeon.report import html, to_json, to_junit
from mxeon.shaders.library import examples_folder
from mxeon.shaders.nodes import OREN_NAYAR, material_text
from mxeon.shaders.scene import sphere
from tests.explorer.browser import judged, opened, until
from tests.support.availability import package
from tests.support.documents import textured, written
from tests.support.verdicts import FAILED

Error = package("playwright.sync_api").Error
LARGEST = 2 * 2**20  # maximum size in bytes of a page without documents
CLAY = str(examples_folder() / "clay.mtlx")
NASTY = "</script><script>globalThis.hit = 1</script><!--"


def data_of(text):
    """Parse the data that is embedded in an explorer page, as a browser would."""
    data = json.loads(re.search(r'type="application/json">(.*?)</script>', text, re.DOTALL)[1])
    for each in data["sources"]:
        if each.get("reference") is not None:
            each["reference"] = data["references"][each["reference"]]
        for port in each.get("inputs", ()):
            if port["image"] is not None:
                port["image"] = data["images"][port["image"]]
        for name in filter(each.__contains__, TEXTS):
            each[name] = PARAGRAPH.join(data["texts"][place] for place in each[name])
    return data


def test_the_page_is_one_small_file_that_names_no_other():
    text = page(page_data())
    assert len(text.encode()) < LARGEST
    assert re.findall(r"(?:src|href)=[\"']?(?!data:)[\w/.:]+", text.split("<script")[0]) == []
    assert "default-src 'none'" in text and "%" not in text.split("<style>")[0]


def test_the_command_writes_documents_of_both_libraries(tmp_path, capsys):
    out = tmp_path / "new" / "page.html"
    assert main(["explore", CLAY, "--output", str(out)]) == PASSED_STATUS
    assert capsys.readouterr().out == f"{out}\n"
    sources = [each for each in data_of(out.read_text())["sources"] if each["group"] == "clay.mtlx"]
    assert [each["id"] for each in sources] == [
        f"document/0/{name}/{library}"
        for library in ("eonlib", "stock")
        for name in ("terracotta", "modeling_clay")
    ]
    for source in sources:
        assert source["actual"]["on"] == ("eon" if "eonlib" in source["id"] else "eon_clamped")


def test_code_of_a_document_needs_a_permission(tmp_path, capsys):
    text = material_text(OREN_NAYAR).replace(
        '<materialx version="1.39">',
        """<materialx version="1.39">
  <nodedef name="ND_mine" node="mine"><output name="out" type="color3"/></nodedef>
  <implementation name="IM_mine" nodedef="ND_mine" target="essl" sourcecode="vec3(0.5)"/>""",
    )
    file = written(tmp_path, text)
    out = str(tmp_path / "page.html")
    assert main(["explore", str(file), "--output", out]) == MISUSE
    assert "--allowCode" in capsys.readouterr().err
    assert main(["explore", str(file), "--allowCode", "--output", out]) == PASSED_STATUS


@pytest.fixture
def nasty(tmp_path):
    """Document in which every visible text tries to run a script."""
    file = tmp_path / "<img src=x onerror='globalThis.hit=1'>&quot;.mtlx"
    escaped = NASTY.replace("<", "&lt;").replace(">", "&gt;")
    text = material_text(OREN_NAYAR, {"color": (0.5, 0.5, 0.5)})
    text = text.replace('<input name="color"', f'<input name="color" uiname="{escaped}"')
    text = text.replace("<materialx ", f'<materialx doc="{escaped}" ')
    file.write_text(text)
    return file


def test_hostile_words_stay_words(browser, nasty, tmp_path):
    out = tmp_path / "page.html"
    assert main(["explore", str(nasty), "--workers", "0", "--output", str(out)]) == PASSED_STATUS
    text = out.read_text()
    assert text.count("</script>") == 2 and "<img" not in text
    with opened(browser, out.as_uri(), drawn=False) as page:
        assert page.evaluate("globalThis.hit === undefined")
        assert page.evaluate("[...document.images].every(each => each.src.startsWith('data:'))")
        groups = page.get_by_label("Material A").locator("optgroup")
        assert [each for each in groups.all() if each.get_attribute("label") == nasty.name]
        [own, *_] = (each for each in data_of(text)["sources"] if each["id"][:9] == "document/")
        assert NASTY in [port["label"] for port in own["inputs"]]


def test_a_document_is_shown_with_its_own_values_and_inputs(browser, tmp_path):
    out = tmp_path / "page.html"
    assert main(["explore", CLAY, "--workers", "0", "--output", str(out)]) == PASSED_STATUS
    with opened(browser, out.as_uri()) as page:
        view = page.evaluate("mxeon.state()")
        assert view["color"] == [0.43, 0.15, 0.07] and view["roughness"] == 0.6
        assert view["right"]["source"] == "document/0/terracotta/stock"
        judged(page, "left", "EON")
        sums = "mxeon.stage.read('left').reduce((sum, x, k) => sum + (k % 4 < 3 ? x : 0), 0)"
        before = page.evaluate(sums)
        weight = page.get_by_label("weight, number")
        assert (weight.get_attribute("min"), weight.get_attribute("max")) == ("0", "1")
        weight.fill("0.25")
        weight.blur()
        until(page, "Object.keys(mxeon.state().inputs).length > 0")
        inputs = page.evaluate("mxeon.state().inputs")
        for library in ("eonlib", "stock"):
            own = inputs[f"document/0/terracotta/{library}"]
            assert own["terracotta_lobe_weight"] == 0.25
        until(page, f"before => {sums} < 0.5 * before", before)
        judged(page, "left", "material")


SHOWN = ("brick", "openpbr_rough_base", "standard_surface_rough_base", "tempered_steel")


@pytest.mark.parametrize(
    "name", [SHOWN[0], *(pytest.param(each, marks=pytest.mark.whole) for each in SHOWN[1:])]
)
def test_one_difference_is_shown_everywhere(browser, tmp_path, name):
    out, document = tmp_path / "page.html", str(examples_folder() / f"{name}.mtlx")
    assert main(["explore", document, "--workers", "0", "--output", str(out)]) == PASSED_STATUS
    run = check([document], ["gl"], "eonlib", compared="stock", workers=0)
    terminal, report, junit = " ".join(answer(run)), unescape("".join(html(run))), to_junit(run)
    report = report.replace("\N{NO-BREAK SPACE}", " ")
    entries = [each for each in json.loads(to_json(run))["results"] if each["check"] == "picture"]
    found = [each for each in run.results if each.check == "picture"]
    own = [each for each in data_of(out.read_text())["sources"] if each["id"][:9] == "document/"]
    titles = "With eonlib", "Stock MaterialX"
    for result, entry, title, source in zip(found, entries, titles, own, strict=True):
        # Compare the pixels of each picture with the reference, and keep the largest difference.
        sizes = {}
        for each in run.pictures:
            place = each.library, each.document
            if place == (result.library, f"{name}.mtlx") and each.reference is not None:
                image, reference = np.float64(each.image), np.float64(each.reference)
                apart = np.abs(image - reference) / np.maximum(1.0, np.abs(reference))
                seen = np.mean(apart[sphere(len(image)).mask].max(axis=-1) > VISIBLE)
                sizes[each.scene] = apart.max(), seen
        worst, size = max(sizes, key=lambda scene: sizes[scene][0]), result.difference
        assert (size.scene, abs(size.largest), size.visible) == (worst, *map(approx, sizes[worst]))
        # Every output of the run states the largest difference of all pictures.
        sentence, look = words.difference(size), words.look(result)
        assert (entry["library"], entry["difference"]) == (result.library, vars(size))
        assert f"<b>{title}</b> on gl: {look}" in report
        wrong = result.verdict == FAILED
        kind = "wrong" if wrong else "within" if size.is_visible else "correct"
        assert source["checked"] == {"kind": kind, "text": f"mxeon check: {look}."}
        assert bool(source["pages"]) == wrong
        if size.is_visible:
            assert f"{100.0 * sizes[worst][0]:.2g} %" in sentence
            assert all(sentence in place for place in (terminal, look))
        if wrong:
            assert f"<td>{words.size(size)}</td>" in report and sentence in junit
    with opened(browser, out.as_uri(), drawn=False) as page:
        for side, result in zip(("left", "right"), found, strict=True):
            passed = "within tolerance" if result.difference.is_visible else "correct"
            judged(page, side, "wrong" if result.verdict == FAILED else passed)


def test_inputs_have_the_ranges_of_their_definitions():
    (source, *_) = document_sources(str(examples_folder() / "standard_surface_rough_base.mtlx"))
    ports = {port.path.rpartition("/")[2]: port for port in source.inputs}
    assert (ports["base"].min, ports["base"].max, ports["base"].label) == (0.0, 1.0, "Base")
    # The range of a control extends from `uimin` to `uisoftmax`.
    assert (ports["specular_IOR"].min, ports["specular_IOR"].max) == (0.0, 3.0)
    assert ports["base_color"].value == (0.5, 0.24, 0.13)
    assert source.meant is None and source.controls.color == ""


def test_images_are_read_once_and_smaller_the_more_a_page_has_of_them(tmp_path, monkeypatch):
    reads, names = [], [f"{number}.png" for number in range(4)]
    for name, side in zip(names, (64, 8, 64, 64), strict=True):
        write_image(tmp_path / name, np.full((side, side, 1), side, np.uint8), {})
    (tmp_path / "a.mtlx").write_text(textured(names * 3))
    monkeypatch.setattr(documents, "ALL_IMAGES", 4 * 32**2)

    def read(path):
        reads.append(path)
        return read_texture(path)

    monkeypatch.setattr(documents, "read_texture", read)
    [source, _] = document_sources(str(tmp_path / "a.mtlx"))
    assert {port.image.width for port in source.inputs if port.image} == {8, 32} and len(reads) == 4


# JavaScript that drops files on the page. Each file has a name and its content in base64.
DROP = """files => {
    const data = new DataTransfer();
    for (const [name, text] of files) {
        const bytes = Uint8Array.from(atob(text), each => each.charCodeAt(0));
        data.items.add(new File([bytes], name));
    }
    dispatchEvent(new DragEvent("drop", {dataTransfer: data, cancelable: true}));
}"""


def drop(page, *files):
    page.evaluate(DROP, [[each.name, b64encode(each.read_bytes()).decode()] for each in files])


def shown(page, expression):
    """Wait until an expression is true, and return its value. The page may reload meanwhile."""
    page.wait_for_load_state()
    for _ in range(600):
        try:
            return until(page, expression)
        except Error:  # the page was reloading
            page.wait_for_timeout(100)
    raise AssertionError(expression)


@pytest.fixture
def server():
    """Network address that a running `mxeon explore` prints."""
    command = [sys.executable, "-m", "mxeon", "explore", "--workers", "0"]
    env = os.environ | {"BROWSER": "true"}  # a command that succeeds without opening a browser
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=env) as process:
        yield process.stdout.readline().split()[0]
        process.send_signal(signal.SIGINT)
        assert process.wait() == PASSED_STATUS


def test_dropped_files_are_shown_by_the_command(browser, server, tmp_path):
    write_image(tmp_path / "red.png", np.full((8, 8, 3), (200, 10, 10), np.uint8), {})
    (tmp_path / "tiles.mtlx").write_text(textured(["red.png"]))
    (tmp_path / "bad.mtlx").write_text("<materialx")
    write_picture(str(tmp_path / "sky.exr"), np.ones((8, 16, 3), np.float32), {})
    for path, host in (("files/../a.mtlx", None), ("other/a.mtlx", None), ("files/a", "evil.org")):
        headers = {"Host": host} if host else {}
        with pytest.raises(HTTPError, match="403"):
            urlopen(Request(server + path, b"", headers, method="PUT"))
    allowed = ["Failed to load resource"]
    with opened(browser, server, allowed, drawn=False) as page:
        drop(page, tmp_path / "tiles.mtlx", tmp_path / "red.png")
        shown(page, "globalThis.mxeon?.state().left.source.startsWith('document/')")
        source = "mxeon.data.sources.find(each => each.id.startsWith('document/'))"
        [image] = page.evaluate(f"{source}.inputs.flatMap(port => port.image ?? [])")
        assert image["width"] == 8
        drop(page, tmp_path / "bad.mtlx")
        shown(page, "document.querySelector('.dropped')?.innerText.startsWith('bad.mtlx: must')")
        drop(page, tmp_path / "sky.exr")
        shown(page, "globalThis.mxeon?.state().surroundings === 'own'")
        assert page.get_by_label("yours").is_checked()
        assert page.evaluate("mxeon.state().left.source.startsWith('document/')")
