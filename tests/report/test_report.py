# SPDX-License-Identifier: Apache-2.0
"""Reports lose no result, escape all text, and are written completely."""

import json
import math
import re
import sys
from base64 import b64encode
from dataclasses import replace
from hashlib import sha256
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.conformance.results import Refused, node_of
from mxeon.conformance.results.quantities import Quantity
from mxeon.io.srgb import srgb_encoded
from mxeon.models import eon_brdf
from mxeon.report import html, to_json, to_junit, write
from mxeon.shaders.scene import sphere
from tests.support import results
from tests.support.results import Control, Picture, Run, caused, quoted
from tests.support.verdicts import FAILED, NOT_RUN, PASSED

HOSTILE = "<script>alert('\x08')</script>\"><img src=x onerror=y>&{{ 7 * 7 }}$"
SIZE = 16


def made_result(verdict, **changes):
    ran = results.Result(
        check="value",
        claim="The shader returns the reference value.",
        subject="oren_nayar_diffuse_bsdf, compensated",
        host="gl",
        library="eonlib",
        verdict=verdict,
        error=1.25e-7,
        quantity=Quantity.RADIANCE,
        tolerance=2e-6,
        derivation="Two roundings of 6e-8 each.",
        worst={"wo": [0.0, 0.6, 0.8], "roughness": [1.0]},
        control=Control("s clamped", 0.35, caught=True),
        seconds=1.5,
    )
    return replace(ran, **changes)


FAILURE = made_result(FAILED, library="stock", error=math.inf, diagnosis=caused("model", "QON"))
MISSING = made_result(
    NOT_RUN, host="cycles", error=None, control=None, worst={}, reason="Blender is not here"
)
ATTACK = made_result(
    FAILED, error=math.nan, subject=HOSTILE, diagnosis=quoted(HOSTILE), claim=HOSTILE,
    derivation=HOSTILE, worst={HOSTILE: [1.0]}, control=Control(HOSTILE, 0.0, caught=False),
)  # fmt: skip


def made_picture(element, host="gl", **changes):
    normal = sphere(SIZE).normal.astype(np.float32)
    reference = np.maximum(normal[..., 2:], 0.0) * np.float32([0.5, 0.25, 0.125])
    metadata = {"version": "0.1.0", "host": host, "device": "test", "element": element}
    image = reference * np.float32(1.5)
    made = Picture("a/clay.mtlx", element, host, "eonlib", "side", image, reference, metadata)
    return replace(made, **changes)


@pytest.fixture(scope="module")
def run():
    return Run(
        version="0.1.0",
        software={"MaterialX": "1.39.5"},
        hosts=(
            results.Identity("gl", "OpenGL 4.5", "llvmpipe"),
            results.Identity("cycles", "5.0", HOSTILE),
        ),
        results=(made_result(PASSED), FAILURE, MISSING, ATTACK),
        pictures=(
            made_picture("clay"),
            made_picture("Clay"),
            made_picture(HOSTILE, reference=None, metadata={"element": HOSTILE}),
        ),
        notes=(HOSTILE, "cycles cannot express QON"),
        documents=(Path("a/clay.mtlx"),),
        refused=(Refused("a.mtlx", (f"a.mtlx: {HOSTILE}", "a.mtlx: 2")),),
    )


class Page(HTMLParser):
    """Tags, attributes and text of an HTML page."""

    def __init__(self, html):
        super().__init__()
        self.tags, self.attributes, self.words = [], [], []
        self.feed(html)
        self.text = " ".join(" ".join(self.words).split())

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs

    def handle_data(self, data):
        self.words.append(data)

    def values(self, *names):
        return [value for name, value in self.attributes if name in names]


def page_of(run):
    return "".join(html(run))


@pytest.fixture(scope="module")
def page(run):
    return Page(page_of(run))


@pytest.fixture(scope="module")
def folder(run, tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    write(run, folder)
    return folder


def test_page_runs_its_own_script_alone_and_escapes_what_it_was_given(page, run):
    assert not {"iframe", "object", "link", "base", "form"} & set(page.tags)
    assert page.tags.count("script") == 1
    (script,) = re.findall(r"<script>(.*?)</script>", page_of(run), re.DOTALL)
    (allowed,) = re.findall(r"script-src 'sha256-(.*?)'", page_of(run))
    assert allowed == b64encode(sha256(script.encode()).digest()).decode()
    assert not [name for name, _ in page.attributes if name.startswith("on")]
    assert page.text.count("<script>alert(") > 8
    assert "49" not in re.findall(r"&(\d+)\$", page.text)


def test_page_loads_nothing(page, run):
    assert all(value.startswith("data:image/png;") for value in page.values("src"))
    assert all(value.startswith("#") for value in page.values("href", "xlink:href"))
    assert not re.findall(r"url\((?!#)|@import", page_of(run))


def test_page_has_unique_identifiers_and_no_loose_link(page):
    identifiers = page.values("id")
    assert len(identifiers) == len(set(identifiers))
    assert {link[1:] for link in page.values("href", "xlink:href")} <= set(identifiers)


@pytest.mark.parametrize(
    "words",
    [
        "2 of 4 checks failed",
        "The shader returns the reference value.",
        "Error and tolerance; unit: radiance",
        "1.25e-7 ≤ 2e-6",
        "inf > 2e-6",
        "With eonlib on gl: no reference",
        "Two roundings of 6e-8 each.",
        "wo (0, 0.6, 0.8)",
        "best match: QON",
        "s clamped; its error of 0.35 is caught",
        "not caught",
        "Blender is not here",
        "Refused: a.mtlx: <script>alert(",
        "cycles cannot express QON",
        "llvmpipe",
        "1.39.5",
    ],
)
def test_page_says(page, words):
    assert words in page.text


def test_an_unfinished_run_says_what_is_missing(run):
    missing = ("gl, value, clay, eonlib",)
    started = replace(run, results=(made_result(PASSED),), missing=missing, refused=())
    text = Page(page_of(started)).text
    assert "The run is not finished: 1 item is missing." in text
    assert "gl, value, clay, eonlib" in text
    assert json.loads(to_json(started))["missing"] == ["gl, value, clay, eonlib"]
    assert json.loads(to_json(started))["verdict"] == NOT_RUN


EXACT = made_picture("clay").reference
BRIGHT = "up to 25 % of white too bright in light from the side, visible on"
FINITE = {"check": "finite", "diagnosis": quoted("no model of fur")}


@pytest.mark.parametrize(
    "result, picture, words",
    [
        ({}, {"image": EXACT}, "looks as specified."),
        ({"measured": ("a.color",)}, {"image": EXACT}, "as specified; not checked: color, which"),
        ({}, {}, BRIGHT),
        ({"verdict": FAILED}, {}, BRIGHT),
        ({"verdict": FAILED}, {"image": EXACT + np.inf}, "has pixels that are infinite or not a"),
        (FINITE, {"reference": None}, "no reference (no model of fur); every pixel is finite."),
    ],
)
def test_a_sentence_says_how_a_material_looks(run, result, picture, words):
    shown = made_picture("clay", **picture)
    about = {
        "check": "picture",
        "document": "a/clay.mtlx",
        "element": "clay",
        "difference": shown.difference,
    }
    error = {FAILED: 1.0}.get(result.get("verdict"), 1e-7)
    judged = replace(made_result(PASSED), **{"error": error, **about, **result})
    one = replace(run, results=(judged,), pictures=(shown,))
    text = page_of(one)
    assert words in Page(text).text
    # The page marks a visible difference as "within the tolerance", without a check mark.
    assert ('aria-label="within the tolerance"' in text) == (
        words.startswith("up to") and not result
    )


def test_documents_of_one_name_in_two_folders_are_two_materials(run):
    names = "x/m.mtlx", "y/m.mtlx"
    pictures = tuple(
        made_picture("look", document="m.mtlx", metadata={"document": each}, **fields)
        for each, fields in zip(names, ({"image": EXACT}, {}), strict=True)
    )
    about = {"check": "picture", "subject": "m.mtlx: look", "element": "look", "error": 1.0}
    judged = [
        made_result(
            verdict, document=each.metadata["document"], difference=each.difference, **about
        )
        for each, verdict in zip(pictures, (PASSED, FAILED), strict=True)
    ]
    shown = replace(run, results=(*judged,), pictures=pictures)
    text = Page(page_of(shown)).text
    assert "looks as specified." in text and BRIGHT in text
    listed = json.loads(to_json(shown))["pictures"]
    assert len({each["reference"] for each in listed}) == 2


def test_the_worst_light_is_first_and_its_scale_reaches_its_largest_difference(run):
    image = EXACT + 0.009
    image[SIZE // 2, 8] += 0.004
    pictures = (
        made_picture("clay", image=EXACT),
        made_picture("clay", image=image, scene="back"),
    )
    about = {
        "check": "picture",
        "document": "a/clay.mtlx",
        "element": "clay",
        "error": 0.013,
        "tolerance": 0.012,
    }
    shown = replace(run, results=(made_result(PASSED, **about),), pictures=pictures)
    text = Page(page_of(shown)).text
    places = ("Light from behind, gl", "≥ 1.3 % of white", "Light from the side, gl")
    assert sorted(places, key=text.index) == [*places]
    assert text.count("1 passed") == 2  # the header and the row of the check contain this text


def test_documents_open_with_the_worst_in_the_studio_and_libraries_with_causes(run):
    studio = [
        made_picture(name, library=library, scene="studio", reference=None)
        for name in ("good", "bad")
        for library in ("eonlib", "stock")
    ]
    spheres = [made_picture(each.element, library=each.library) for each in studio]
    judged = [
        made_result(
            PASSED, check="picture", document="a/clay.mtlx", element=each.element, library=each.library,
            difference=results.Difference("side", {"bad": 0.5, "good": 0.0}[each.element], False, 0.5),
        )
        for each in spheres
    ]  # fmt: skip
    known = [replace(FAILURE, check=key, pages=("genglsl_clamped_dot",)) for key in "ab"]
    shown = replace(run, results=(FAILURE, *known, *judged), pictures=(*spheres, *studio))
    orders = ({"a/clay.mtlx": ()}, ["pictures", "failed"]), ({}, ["causes", "failed", "pictures"])
    for contents, order in orders:
        page = Page(page_of(replace(shown, contents=contents)))
        assert [each for each in page.values("id") if each in order] == order
    title = "EON in GLSL is wrong for light from behind"
    assert page.text.count(title) == 3  # once as a cause, and once for each check
    node = node_of(FAILURE.subject)
    assert f"Checks {title} {node} 2 best match: QON {node} 1 " in page.text
    alts = page.values("alt")
    assert alts[:3] == [f"{title}: bad, in a studio" for title in (
        "Stock MaterialX", "With eonlib", "Difference of the two")]  # fmt: skip
    assert len(alts) == 2 * (3 + 5)


def test_the_examples_of_the_page_on_checking_run(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "my_renderer", SimpleNamespace(my_brdf=eon_brdf))
    monkeypatch.chdir(tmp_path)
    text = (Path(__file__).parents[2] / "docs/check.md").read_text()
    examples = re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    assert len(examples) == 3
    exec("\n".join(examples), {})
    assert (tmp_path / "out/my_report/report.html").is_file()


def test_json_is_strict_and_has_the_documented_keys(run):
    # JSON does not allow NaN and infinity.
    data = json.loads(to_json(run), parse_constant=pytest.fail)
    documented = re.findall(r"(?:- |; )([$\w]+):", to_json.__doc__.split("Keys:")[1])
    assert set(data) == set(documented)
    assert data["results"][1]["error"] == "Infinity"
    assert data["results"][3]["error"] == "NaN"
    assert data["results"][2]["control"] is None


def test_json_names_the_pictures_that_are_written(run, folder):
    text = (folder / "results.json").read_text(encoding="utf-8")
    data = json.loads(text, parse_constant=pytest.fail)
    named = [folder / one[kind] for one in data["pictures"] for kind in ("exr", "png")]
    assert len({str(path).lower() for path in named}) == 2 * len(run.pictures)
    assert all(path.is_file() for path in named)
    assert data["pictures"][0]["difference"]["largest"] > 0.0
    assert data["pictures"][2]["difference"] is None


def test_junit_counts_and_explains(run):
    *suites, documents = ElementTree.fromstring(to_junit(run)).findall("testsuite")
    first, second = documents.find("testcase[@name='a.mtlx']/error").text.splitlines()
    assert documents.get("errors") == "1" and second == "a.mtlx: 2"
    assert first == f"a.mtlx: {HOSTILE}".replace("\x08", "\N{REPLACEMENT CHARACTER}")
    counts = {suite.get("name"): suite.get("failures") + suite.get("skipped") for suite in suites}
    assert counts == {"gl with eonlib": "10", "gl with stock": "10", "cycles with eonlib": "01"}
    assert [suite.get("time") for suite in suites] == ["3.000", "1.500", "1.500"]
    assert suites[2].find("testcase/skipped").get("message") == "Blender is not here"
    failure = suites[1].find("testcase/failure")
    assert failure.get("message").endswith("inf > 2e-06 radiance")
    assert failure.text == "best match: QON\nworst point: wo (0, 0.6, 0.8), roughness 1"


KNOWN = {"pages": ("genglsl_clamped_dot",), "worst": {}}
SYNTAX = {"error": None, "diagnosis": quoted("GLSL: no"), "worst": {}}


@pytest.mark.parametrize(
    "fields, kind, message, text",
    [
        (SYNTAX, "new", "reference value. GLSL: no", "GLSL: no"),
        (KNOWN, "known", "1.25e-07 > 2e-08 radiance", "see upstream/genglsl_clamped_dot.md"),
    ],
)
def test_a_failure_in_junit_is_known_or_new_and_has_no_path(run, fields, kind, message, text):
    names = {"/builds/7/libraries-1.39": "libraries-1.39", "/a/stock": "/a/stock", "stock": "stock"}
    results = [made_result(FAILED, library=each, tolerance=2e-8, **fields) for each in names]
    root = ElementTree.fromstring(to_junit(replace(run, results=tuple(results), refused=())))
    assert [suite.get("name") for suite in root] == [f"gl with {each}" for each in names.values()]
    case = root[0].find("testcase")
    assert case.get("classname") == "mxeon.gl.libraries-1.39.value"
    assert (case[0].get("type"), case[0].text) == (kind, text)
    assert case[0].get("message").endswith(message)


def test_junit_replaces_what_xml_cannot_hold(run):
    case = ElementTree.fromstring(to_junit(run)).findall("testsuite/testcase")[1]
    assert case.get("name") == HOSTILE.replace("\x08", "\N{REPLACEMENT CHARACTER}")


def test_pictures_are_float_exr_and_eight_bit_png_that_say_what_made_them(run, folder):
    stem = folder / "pictures" / "clay-clay-gl-eonlib-side"
    exr, png = oiio.ImageBuf(f"{stem}.exr"), oiio.ImageBuf(f"{stem}.png")
    np.testing.assert_array_equal(exr.get_pixels(oiio.FLOAT), run.pictures[0].image)
    np.testing.assert_array_equal(png.get_pixels(oiio.UINT8), srgb_encoded(run.pictures[0].image))
    for key, value in run.pictures[0].metadata.items():
        assert exr.spec()[f"mxeon:{key}"] == png.spec()[f"mxeon:{key}"] == value
    assert exr.spec()["oiio:ColorSpace"] == "lin_rec709_scene"
    assert png.spec()["oiio:ColorSpace"] == "srgb_rec709_scene"


@pytest.mark.parametrize("library", ["jinja2", "matplotlib"])
def test_without_the_report_extra_all_but_the_page_is_written(run, tmp_path, monkeypatch, library):
    for name in ("mxeon.report.page", "mxeon.report.pieces"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(ImportError, match=rf"{library}: pip install '\.\[report\]'"):
        write(run, tmp_path)
    written = sorted(path.name for path in tmp_path.iterdir())
    assert written == ["junit.xml", "pictures", "results.json"]
