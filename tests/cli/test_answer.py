# SPDX-License-Identifier: Apache-2.0
"""The summary and the progress lines that `mxeon check` prints."""

import json
import os
import re
import shutil
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from xml.etree import ElementTree

import pytest

from mxeon import check
from mxeon.cli import main
from mxeon.cli.answer import LONGEST, MANY, answer, summary_by_cause
from mxeon.cli.output import Line, wrapped
from mxeon.conformance.results import Refused
from mxeon.errors import LAST_OUTPUT, MISUSE
from mxeon.errors import NOT_RUN as DID_NOT_RUN
from mxeon.report import to_json
from tests.support.command import CLAY, PLASTER
from tests.support.documents import connected, image, material, textured
from tests.support.plans import keep_checks
from tests.support.results import (
    EON,
    Control,
    Difference,
    Region,
    Run,
    caused,
    made,
    made_run,
    quoted,
    shown,
)
from tests.support.verdicts import FAILED, NOT_RUN
from tests.support.wrong_libraries import copy_of_eonlib, copy_of_stock

NAME = "genglsl_clamped_dot"
PICTURE = shown("terracotta")


def stock(verdict=FAILED, **fields):
    return made(verdict, library="stock", **fields)


def wrong(largest, scene="back"):
    """Fields of a failed picture. A quarter of the pixels differ visibly from the reference."""
    difference = Difference(scene, largest, False, 0.25)
    return {"verdict": FAILED, "error": 0.1, "difference": difference}


SEEN = wrong(-0.05)
ZERO = Region("index_zero")
LOAD, NOTHING = "To fix it, load ", "Nothing to do for this material"
RIGHT = "the picture is right; the material's nodes are wrong for"
WITHIN = "up to 6.2 % of white too dark in light from behind, visible on 25 % of its pixels, within this check's"
CLOSE = {"difference": wrong(-0.0621)["difference"]}
FAR = 'input "a/roughness" must lie in [0, 1]; got 1.7'
IDLE, OWN = {"verdict": NOT_RUN, "error": None}, caused("input", "", "a/roughness")
BENT = stock(diagnosis=caused("not finite", region=ZERO))
LAYER = stock(key="layering", diagnosis=quoted("X"))
FIRST = f"0.37 (value)\ncause: gl with stock: {EON} "
# Each row has failed results with stock MaterialX, fields of the picture's result, an expected text
# in the summary, and the last line of the summary.
ANSWERS = (
    ((stock(),), {}, f"{RIGHT} other inputs.", NOTHING),
    ((BENT,), {}, f"{RIGHT} inputs that this material does not use.", NOTHING),
    ((stock(),), {}, "wrong for other inputs, 0.37 (value)", NOTHING),
    ((stock(key="finite"),), {}, f"{RIGHT} other inputs.", NOTHING),
    ((stock(),), CLOSE, WITHIN, LOAD),
    ((stock(),), CLOSE, "  wrong, 0.37 (value)", LOAD),
    ((LAYER, stock(diagnosis=quoted("Y"))), wrong(-0.1), f"{FIRST}(value)", LOAD),
    ((stock(diagnosis=quoted("Y")), LAYER), wrong(-0.1, "furnace"), f"{FIRST}(layering)", LOAD),
    ((), IDLE | {"reason": FAR, "diagnosis": OWN}, f"not judged: {FAR}.", "To fix it, correct input"),
    ((), IDLE | {"reason": "gl: no"}, "not judged: gl: no.", "All 2 checks"),
    ((), {"check": "finite", "diagnosis": quoted("fur")}, "no reference (fur); every pixel is finite.", "All 2"),
    ((), {"measured": ("a.color",)}, "looks as specified with eonlib and stock MaterialX 1.39.5; not checked: color, which comes", NOTHING),
    ((), {"check": "document"}, "shaders are generated, not run.", "All 2 checks"),
)  # fmt: skip


@pytest.mark.parametrize(("failures", "fields", "words", "last"), ANSWERS)
def test_an_answer_says_what_was_measured_and_ends_with_the_remedy(failures, fields, words, last):
    run = made_run(
        *(made(), PICTURE, *failures, replace(PICTURE, library="stock", **fields)),
        compared=("stock",),
        unreached={"a/clay.mtlx": {EON: (ZERO,)}},
    )
    lines = answer(run)
    assert "\n".join(lines).count(words) == 1
    assert lines[-1].startswith(last)


def test_every_section_has_a_longest_length_and_counts_what_it_leaves_out():
    names = ("burley_diffuse", "translucent", "subsurface", "conductor", "chiang_hair")
    titles = (EON, *(f"{name}_bsdf" for name in names))
    results = [made()]
    for each in titles:
        results.append(stock(subject=each, diagnosis=quoted(each)))
        results.append(shown(each, FAILED, CLAY, library="stock", diagnosis=quoted(each)))
    run = replace(made_run(*results, compared=("stock",)), contents={CLAY: titles})
    lines = answer(run)
    assert len(lines) == LONGEST["material"] + LONGEST["node"] + LONGEST["cause"] + 3
    assert lines[-2] == "2 more materials, 3 more nodes, 3 more causes: --full"
    assert len(answer(run, full=True)) == 6 + 1 + 6 + 1 + 6 + 1


def test_a_check_whose_control_passed_comes_after_wrong_values():
    uncaught = {"error": 0.0, "control": Control("no color", 0.0, False)}
    rows = [made(FAILED, "energy", **uncaught, diagnosis=caused("control")), made(FAILED, "frame")]
    _verdict, first, second = map(str, answer(replace(made_run(*rows), contents={})))
    assert "(frame)" in first and "(energy)" in second


def test_one_check_is_one_check_if_something_is_not_judged():
    run = made_run(made(), unjudged=(("a lobe", "no model"),))
    assert run.sentence == "1 check passed and none failed on gl with eonlib."


GLASS = "dielectric_bsdf, scatter_mode R"


def test_what_fails_for_other_inputs_than_the_documents_comes_last():
    results = (
        made(key="value", subject=GLASS),
        made(FAILED, "finite", GLASS, diagnosis=caused("not finite", region=ZERO)),
        made(FAILED, "layer", GLASS, "stock", diagnosis=caused("model", "X"), pages=(NAME,)),
        made(FAILED, "value", GLASS, "stock", diagnosis=caused("fault", "weight_ignored")),
    )
    contents, unreached = (
        dict.fromkeys(("a.mtlx", "b.mtlx"), (GLASS,)),
        {"a.mtlx": {GLASS: (ZERO,)}},
    )
    run = Run("1", {}, (), results, contents=contents, unreached=unreached)
    # The inputs of document `a` never result in an index of refraction of 0.
    assert run.is_elsewhere(results[1], "a.mtlx") and not run.is_elsewhere(results[1])
    [entry] = json.loads(to_json(run))["elsewhere"]
    place = {"check": "finite", "subject": GLASS, "host": "gl", "library": "eonlib"}
    assert entry == {"document": "a.mtlx", **place}
    lines = answer(replace(run, contents={"a.mtlx": (GLASS,)}))
    assert any("wrong for other inputs" in line and "wrong, 0.37 (value)" in line for line in lines)
    causes = [line for line in lines if line.startswith("failed")]
    page = f"docs/upstream/{NAME}.md"
    expected = ["fault: the weight is ignored", page, "for inputs that no document uses"]
    assert [each in line for each, line in zip(expected, causes, strict=True)] == [True] * 3


def test_a_lobe_that_a_document_lacks_makes_no_combination_wrong_for_it():
    layer = stock(key="states", subject="layer", pages=("genglsl_zeltner_normal",))
    sheen, metal = "sheen_bsdf, mode zeltner", "conductor_bsdf"
    for lobe, elsewhere in ((metal, True), (sheen, False)):
        run = replace(made_run(layer), contents={"a.mtlx": ("layer", lobe)})
        assert run.is_elsewhere(layer) == elsewhere
    named = replace(layer, pages=(), diagnosis=caused("defect", "throughput_of_lobes", sheen))
    assert replace(run, contents={"a.mtlx": ("layer", metal)}).is_elsewhere(named)
    # A defect concerns every document if the defect has no page, or if the cause names no lobe.
    for counts in (replace(layer, pages=("genglsl_add_throughput",)), replace(layer, pages=())):
        assert not replace(run, contents={"a.mtlx": ("layer", metal)}).is_elsewhere(counts)


def test_a_copy_of_eonlib_is_not_referred_to_eonlib(tmp_path):
    stock, own = copy_of_stock(tmp_path / "stock", "pbrlib"), copy_of_eonlib(tmp_path / "own")
    for library, referred in ((str(stock), True), (str(own), False)):
        picture = replace(PICTURE, library=library, **SEEN)
        files = {library: {"folder": ()}}
        lines = answer(made_run(made(FAILED, library=library), picture, libraries=files))
        assert lines[-1].endswith("check with --library eonlib") == referred


def test_a_failing_picture_is_printed_by_itself_or_with_the_lobe_that_fails():
    lobe = made(FAILED, subject="sheen_bsdf, mode zeltner")
    causes = (
        caused("follows", "", "sheen_bsdf"),
        caused("defect", "other_node", "normalmap", "bump"),
    )
    pictures = [replace(PICTURE, **SEEN, diagnosis=each) for each in causes]
    lines = answer(replace(made_run(lobe, *pictures), contents={}))
    assert any("1 picture of sheen_bsdf: clay.mtlx: terracotta" in line for line in lines)
    assert any("up to 5 % of white too dark" in line and "normalmap" in line for line in lines)


@pytest.mark.parametrize(
    "documents", (["a: b.mtlx", "c.mtlx"], ["x/m.mtlx", "y/m.mtlx"], ["./x/m.mtlx", "y//m.mtlx"])
)
def test_a_material_belongs_to_one_document_whatever_the_names_of_files(documents):
    right, bad = (shown("look", document=str(Path(each))) for each in documents)
    run = made_run(made(), right, replace(bad, **SEEN), documents=documents)
    first, second, *_ = answer(run)
    names = documents if "m.mtlx" in documents[0] else [Path(each).name for each in documents]
    assert first.startswith(f"{names[1]}: look: with eonlib, up to 5 %")
    assert second == f"{names[0]}: look: looks as specified with eonlib."
    _, failed, passed = summary_by_cause(run)
    assert failed.endswith(f"({documents[1]})") and passed.endswith(f"({documents[0]})")


def test_every_document_appears_those_that_look_wrong_first():
    documents = [f"{number}.mtlx" for number in range(20)]
    pictures = [shown(f"look{each[0]}", document=each) for each in documents[:-1]]
    pictures[7] = replace(pictures[7], **SEEN)
    lines = answer(made_run(made(), *pictures, documents=documents))
    assert len(lines) <= 10 and lines[0].startswith("7.mtlx: look7: with eonlib, up to 5 %")
    assert "18.mtlx: look1: looks as specified with eonlib" in lines[1]
    assert all(any(each in line for line in lines) for each in documents)


# --- judged and refused documents -----------------------------------------------------------------


def test_a_document_alone_has_its_nodes_judged_and_no_others(monkeypatch):
    keep_checks(monkeypatch, "value", "source", "twins", "picture")
    run = check([PLASTER])
    nodes = [each.subject for each in run.results if each.check != "picture"]
    assert nodes == [EON] and run.contents == {PLASTER: (EON,)}
    assert [each.check for each in run.results] == ["picture", "value"]


def test_unreadable_documents_are_said_before_any_other_work(monkeypatch, capsys):
    keep_checks(monkeypatch, "value")
    said = []

    def progress(tasks, total):
        said.append(total)
        return tasks

    check(["nosuch.mtlx", PLASTER], refuse=said.append, progress=progress)
    line = "document must be a readable file; got 'nosuch.mtlx'"
    assert said == [line, 1]
    assert main(["check", "nosuch.mtlx", PLASTER, "--workers", "0"]) == MISUSE
    printed = capsys.readouterr()
    assert printed.err == f"mxeon: {line}\n"
    assert printed.out.startswith("nosuch.mtlx was not checked: 1 error. The check passed on gl")


def test_a_file_that_is_no_image_is_refused_before_any_check(tmp_path, monkeypatch, capsys):
    keep_checks(monkeypatch, "value")
    (tmp_path / "wood.png").write_text("no image")
    (tmp_path / "bad.mtlx").write_text(textured(["wood.png"]))
    assert main(["check", str(tmp_path / "bad.mtlx"), "--workers", "0"]) == MISUSE
    printed = capsys.readouterr()
    assert "wood.png: must be an image that OpenImageIO reads" in printed.err
    assert "has 1 error; nothing was checked" in printed.out


def test_nothing_says_of_a_refused_document_that_it_passed(tmp_path, monkeypatch, capsys):
    keep_checks(monkeypatch, "value", "picture")
    shutil.copy(PLASTER, tmp_path / "good.mtlx")
    (tmp_path / "bad.mtlx").write_text(textured(["no.png"]))
    # The missing texture is named in a node definition, so only rendering reports the texture.
    inner = image("no.png") + '<output name="out" type="color3" nodename="image"/>'
    graph = '<nodedef name="ND_t" node="t"><output name="out" type="color3"/></nodedef>'
    graph += f'<nodegraph name="NG_t" nodedef="ND_t">{inner}</nodegraph><t name="t" type="color3"/>'
    (tmp_path / "late.mtlx").write_text(material(graph + connected(color='nodename="t"')))
    options = ["--report", str(tmp_path / "out"), "--workers", "0"]
    assert main(["check", str(tmp_path), *options]) == MISUSE
    printed = capsys.readouterr()
    names = [str(tmp_path / "bad.mtlx"), str(tmp_path / "late.mtlx")]
    first, *rest = printed.out.splitlines()
    assert first.startswith(f"{', '.join(names)} were not checked: 2 errors. ")
    assert "0 of 0" not in first
    assert not [line for line in rest if any(name in line for name in names)]
    assert [line.split(": ")[1] for line in printed.err.splitlines()] == names
    report = tmp_path / "out"
    found = json.loads((report / "results.json").read_text())
    assert found["verdict"] == "not run" and found["refused"] == names
    page = (report / "report.html").read_text().replace("\xa0", " ")
    assert f"<p>{first}</p>" in page
    [suite] = ElementTree.parse(report / "junit.xml").iterfind("testsuite[@name='documents']")
    assert [(case.get("name"), case[0].tag) for case in suite] == [
        (each, "error") for each in names
    ]


def test_a_document_that_one_library_lacks_is_refused_in_its_column(tmp_path, monkeypatch, capsys):
    keep_checks(monkeypatch, "value", "picture")
    file = tmp_path / "eon.mtlx"
    other = '<oren_nayar_diffuse_bsdf name="b" type="BSDF"/><add name="lobe" type="BSDF">'
    other += '<input name="in1" type="BSDF" nodename="a"/><input name="in2" type="BSDF" nodename="b"/></add>'
    file.write_text(material('<eon_diffuse_bsdf name="a" type="BSDF"/>' + other))
    libraries = ["--library", "eonlib", "--library", "stock"]
    assert main(["check", str(file), *libraries, "--workers", "0"]) == MISUSE
    printed = capsys.readouterr()
    assert printed.out.startswith(f"{file} with stock was not checked: 1 error. ")
    assert "with stock MaterialX" in printed.out and "refused" in printed.out
    assert printed.err.endswith("(with stock)\n")
    # Stock MaterialX runs only for comparison, so eonlib's results decide the verdict.
    assert main(["check", str(file), "--workers", "0"]) == 0
    printed = capsys.readouterr()
    assert printed.err == "" and "not judged" in printed.out and "(with stock)" in printed.out


@pytest.mark.parametrize("host", ["three", "mitsuba"])
def test_a_host_on_which_nothing_is_measured_did_not_run(host, capsys):
    node = ["--node", "oren_nayar_diffuse_bsdf"]
    for options in ([], node):
        status = main(["check", CLAY, "--host", host, *options, "--workers", "0"])
        assert status == DID_NOT_RUN
        printed = capsys.readouterr().out
        assert "passed" not in printed and "For comparison" not in printed


# --- progress and names ---------------------------------------------------------------------------


@pytest.mark.parametrize("ends, shown", [(os.openpty, True), (os.pipe, False)])
def test_progress_is_shown_on_a_terminal_and_not_in_a_pipe(ends, shown, capsys, monkeypatch):
    other, end = ends()
    with open(other, "rb") as read, open(end, "w") as written:
        monkeypatch.setattr(sys, "stderr", written)
        assert main(["check", PLASTER, "--host", "msl", "--workers", "0"]) == DID_NOT_RUN
        print(file=written, flush=True)
        seen = read.readline()
    assert "not run: msl with eonlib, 1 check: msl: running it needs" in capsys.readouterr().out
    shows, leaves = b"mxeon check: 1 of ", b"\r\x1b[K\r\n"
    assert (shows in seen and seen.endswith(leaves)) if shown else seen == b"\n"


@pytest.mark.parametrize("arguments", [[], ["kit"], ["report"]])
def test_without_a_command_there_is_help(arguments, capsys):
    assert main(arguments) == MISUSE
    printed = capsys.readouterr()
    program = " ".join(["mxeon", *arguments])
    assert f"\nusage: {program} [options] " in printed.out
    assert printed.err == f"{program}: choose a command\n"


@pytest.mark.parametrize("color", [True, False])
def test_an_answer_is_as_wide_as_the_terminal_and_in_color_unless_it_is_not_wanted(
    color, monkeypatch
):
    monkeypatch.setenv("COLUMNS", "40")
    monkeypatch.setenv("NO_COLOR", "" if color else "1")
    monkeypatch.setattr(sys, "stdout", SimpleNamespace(isatty=lambda: True))
    path = "/" + 50 * "x"
    lines = [
        Line(f"failed: {12 * 'word '}{path}", FAILED),
        *map(Line, ("  a row of a table", "plain")),
    ]
    shown = wrapped(lines)
    assert ("\033[31m" in shown, "\033[0m" in shown) == (color, color)
    plain = re.sub(r"\033\[\d+m", "", shown).splitlines()
    assert [each for each in plain if len(each) > 40] == [f"  {path}"]
    assert " ".join(" ".join(plain).split()) == " ".join(" ".join(lines).split())
    assert plain[-2:] == lines[-2:]


def test_a_reason_why_checks_did_not_run_stands_once():
    missing = [make(NOT_RUN, reason="no driver") for make in (made, stock)]
    found = [line for line in answer(made_run(*missing)) if line.startswith("not run")]
    assert found == ["not run: gl with eonlib, gl with stock, 2 checks: no driver"]


# --- folders of documents -------------------------------------------------------------------------


def test_a_folder_stands_for_the_documents_in_it_and_below_it(tmp_path):
    for name in ("b.mtlx", "sub/a.mtlx", "notes.txt"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).write_text("")
    single = str(tmp_path / "b.mtlx")
    run = check([tmp_path, single], ["msl"])  # the folder contains no MaterialX document
    assert {*map(str, run.refused)} == {single, str(tmp_path / "sub" / "a.mtlx")}


RUN = made_run(
    shown("look"),
    shown("other"),
    shown(
        "look",
        document="a/glass.mtlx",
        key="finite",
        diagnosis=quoted("reference: there is no model for 'x/y'"),
    ),
    shown("look", document="b/noise.mtlx", measured=("lobe.color",)),
    made(FAILED, subject="noise.mtlx: node"),
    documents=("a/clay.mtlx", "a/glass.mtlx", "b/noise.mtlx"),
    refused=(Refused("light.mtlx", ('light.mtlx: must contain a renderable element; got "a"',)),),
)


def test_documents_whose_workers_crash_alike_share_a_line():
    reasons = [f"worker process crashed (SIGSEGV){LAST_OUTPUT}line {n}" for n in "12"]
    crashed = [
        shown("look", NOT_RUN, f"{n}.mtlx", reason=each)
        for n, each in zip("12", reasons, strict=True)
    ]
    _, line = summary_by_cause(made_run(*crashed, documents=("1.mtlx", "2.mtlx")))
    assert line == "     2 not run: worker process crashed (SIGSEGV) (1.mtlx and 1 more)"


def test_a_document_that_one_library_lacks_counts_once():
    run = replace(
        RUN, refused=(Refused("a/clay.mtlx", ("a/clay.mtlx: no x (with stock)",), "stock"),)
    )
    first, *rows = summary_by_cause(run)
    assert first.startswith("3 documents, 1 ")
    assert rows[0] == "     1 refused: no x (with stock) (a/clay.mtlx)"


def test_a_document_whose_name_reads_like_a_refusal_is_itself():
    run = replace(RUN, refused=(Refused("clay with stock", ("a fault of an included file",)),))
    assert "1 refused: a fault of an included file (clay with stock)" in summary_by_cause(run)[1]


def test_causes_count_documents_the_worst_first():
    first, *rows = (each.strip() for each in summary_by_cause(RUN))
    assert first.startswith("4 documents, 2 ")
    assert rows == [
        "1 refused: must contain a renderable element; got ... (light.mtlx)",
        "1 no reference: there is no model for ... (a/glass.mtlx)",
        "1 passed: matches the reference (a/clay.mtlx)",
        "1 passed: matches the reference, with inputs that the host computed (b/noise.mtlx)",
    ]


def test_a_bad_document_of_a_folder_is_one_line_and_the_run_goes_on(tmp_path, capsys):
    for number in range(MANY):
        (tmp_path / f"bad{number}.mtlx").write_text("<materialx")
    shutil.copy(CLAY, tmp_path)
    options = ["--workers", "0", "--node", "conical_edf"]
    assert main(["check", str(tmp_path), *options]) == MISUSE
    output, error = capsys.readouterr()
    assert len(error.splitlines()) == MANY
    assert f"{MANY + 1} documents" in output and f"\n    {MANY} refused" in output
