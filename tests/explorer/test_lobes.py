# SPDX-License-Identifier: Apache-2.0
"""The page judges lobes by the pixels that the browser reads back. The layout stays the same."""

from dataclasses import replace

import pytest

from mxeon.explorer import page, page_data
from mxeon.io.files import write_text
from tests.explorer.browser import DRAWN, opened, show, until

# Expected verdicts on MaterialX's GLSL, as in docs/upstream. This test covers one lobe per family,
# because a software driver takes a second for each lobe. test_references.py covers all lobes on the
# gl host.
STOCK = {
    "shader": "wrong",
    "lobe/sheen_zeltner": "correct",  # the errors appear only in a layer or with a tilted normal
    "lobe/schlick": "differs",
    "lobe/film_dielectric": "differs",
    "lobe/hair": "wrong",
}
JUDGED = "![...document.querySelectorAll('.verdict')].some(e => e.classList.contains('measuring'))"
PLAIN = {"shape": "sphere", "surroundings": "none"}


def choose(sheet, key):
    """Compare both libraries on a material, in a view that renders quickly."""
    group = sheet.get_by_role("group", name="eonlib and stock MaterialX")
    group.locator(f"input[value='{key}/']").check(force=True)
    show(sheet, **PLAIN)


def kinds(sheet):
    sides = [sheet.locator(f".side.{side} .verdict") for side in ("left", "right")]
    return [each.get_attribute("class").split()[1] for each in sides]


@pytest.mark.parametrize(("key", "stock"), STOCK.items())
def test_a_lobe_is_judged_by_its_values(page, key, stock):
    choose(page, key)
    until(page, JUDGED)
    assert kinds(page) == ["correct", stock]


@pytest.fixture(scope="module")
def mistaken(tmp_path_factory):
    """URL of a page on which the reference values of sheen are one percent too bright."""
    data = page_data(pages="upstream/{}.html")
    sources = list(data.sources)
    for place, source in enumerate(sources):
        if source.id.startswith("lobe/sheen/"):
            values = tuple(1.01 * value for value in source.reference.direct)
            reference = replace(source.reference, direct=values, forms=())
            sources[place] = replace(source, reference=reference)
    file = tmp_path_factory.mktemp("mistaken") / "page.html"
    write_text(file, page(replace(data, sources=tuple(sources))))
    return file.as_uri()


SHEEN = "a=lobe/sheen/eonlib,0,exact&b=lobe/sheen/stock,0,exact&shape=sphere&surroundings=none"


def test_values_that_are_not_those_of_the_reference_are_found_out(browser, mistaken):
    with opened(browser, f"{mistaken}#{SHEEN}") as sheet:
        until(sheet, JUDGED)
        assert kinds(sheet) == ["differs", "differs"]


def test_nothing_is_called_correct_before_a_value_is_read_back(browser, address):
    with opened(browser, address, drawn=False) as sheet:
        assert sheet.locator(".verdict.correct").count() == 0
        assert "✓" not in sheet.locator(".values").inner_text()
    with opened(browser, address) as sheet:
        sheet.evaluate("mxeon.stage.evaluate = () => null")
        show(sheet, left={"source": "lobe/sheen/eonlib", "flag": True, "sampler": "exact"}, **PLAIN)
        until(sheet, DRAWN)
        assert kinds(sheet)[0] == "measuring"
        assert "measuring…" in sheet.locator(".values").inner_text()
        assert sheet.locator(".verdict.correct").count() == 0


DROP = """name => {
    const data = new DataTransfer();
    data.items.add(new File(["<materialx/>"], name));
    dispatchEvent(new DragEvent("drop", {dataTransfer: data, cancelable: true}));
}"""


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("wood.mtlx", "To see wood.mtlx, run: mxeon explore FILE"),
        ("sky.hdr", "To see sky.hdr, run: mxeon explore --environment FILE"),
        ("wood.png", "wood.png: drop a .mtlx document with its images"),
    ],
)
def test_a_file_that_is_dropped_gets_its_command(page, name, said):
    page.evaluate(DROP, name)
    until(page, "document.querySelector('.dropped') !== null")
    assert said in page.locator(".dropped").inner_text()
    page.get_by_role("button", name="Close").click()
    assert page.locator(".dropped").count() == 0
