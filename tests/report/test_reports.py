# SPDX-License-Identifier: Apache-2.0
"""`report diff` finds regressions between two runs; `report field` summarizes several runs."""

import json
import math
import re
from collections import Counter
from dataclasses import replace
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest

from mxeon.cli import main
from mxeon.conformance.results import Cause, Diagnosis, Errors, Kind, Refused
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.results.records import make_converter
from mxeon.models import table as reference
from mxeon.report import to_json, write
from mxeon.report.diff import BETTER, LISTED, LOST, OTHER, WORSE, compare, read_results
from mxeon.shaders.library import examples_folder
from mxeon.survey.field import by_harm, read_field
from tests.support.availability import package
from tests.support.results import Control, Identity, Picture, Region, Result, Run, caused, quoted
from tests.support.verdicts import DIFFERS, FAILED, NOT_RUN, PASSED
from tests.support.wrong_libraries import wrong_stock_node

PLACE = "gl, eonlib, value, clay"


def made_run(
    verdict=PASSED, error=1e-7, device="llvmpipe", difference=1e-7, subject="clay", **fields
):
    """Run with a single invented result, which has the given fields."""
    pixels = np.zeros((4, 4, 3))
    picture = Picture("d", "clay", "gl", "eonlib", "side", pixels + difference, pixels, {})
    result = Result("value", "claim", subject, "gl", "eonlib", verdict, error, tolerance=1e-6)
    result = replace(result, **fields)
    return Run("1.0", {"Python": "3"}, (Identity("gl", "4.5", device),), (result,), (picture,))


def kept(run, folder):
    Path(folder).mkdir(exist_ok=True)
    Path(folder, "results.json").write_text(to_json(run))
    return str(folder)


def read(run):
    with TemporaryDirectory() as folder:
        return read_results(kept(run, folder))


def diff(folder, before, after, *options):
    return main(["report", "diff", kept(before, folder / "a"), kept(after, folder / "b"), *options])


def changes(before, after):
    found = compare(read(before), read(after))
    return [(each.kind, f"{each.item}: {each.before} -> {each.after}") for each in found]


GONE = replace(made_run(), results=())
REFUSED = replace(made_run(), refused=(Refused("clay.mtlx", ("no such node",)),))
TWO = replace(made_run(), documents=(Path("a.mtlx"), Path("b.mtlx")))
FEW = {"verdict": FAILED, "error": 1e-4, "samples": "a"}
FEW["errors"] = (Errors(7000, 5, 0, 1e-4, 5e-7),)
MANY = FEW | {"errors": (Errors(7000, 500, 0, 1e-4, 5e-6),)}
FAILURE = "value: passed at 1e-07 -> failed at 0.0001"
GPU = OTHER, "host gl: 4.5, llvmpipe -> 4.5, GPU"
CHANGES = [
    (made_run(), made_run(error=1.4e-7)),
    (made_run(FAILED), made_run(FAILED, error=1.4e-7)),
    (REFUSED, REFUSED),
    (made_run(), made_run(FAILED), (WORSE, "value: passed at 1e-07 -> failed at 1e-07")),
    (made_run(), made_run(NOT_RUN, None), (LOST, "value: passed at 1e-07 -> not run")),
    (made_run(), made_run(error=9e-7)),
    (made_run(), made_run(device="GPU"), GPU),
    (made_run(), made_run(**FEW), (WORSE, FAILURE)),
    (made_run(), made_run(**FEW, device="GPU"), GPU, (OTHER, FAILURE)),
    (made_run(), made_run(**MANY, device="GPU"), (WORSE, FAILURE), GPU),
    (made_run(), GONE, (LOST, "1 check: passed at 1e-07 -> none")),
    (made_run(FAILED), GONE, (LOST, "1 check: failed at 1e-07 -> none")),
    (GONE, made_run(), (OTHER, "1 check: none -> passed at 1e-07")),
    (GONE, made_run(FAILED), (WORSE, "1 check: none -> failed at 1e-07")),
    (made_run(), REFUSED, (WORSE, "clay.mtlx: not refused -> refused")),
    (REFUSED, made_run(), (BETTER, "clay.mtlx: refused -> not refused")),
    # Checks may be missing if their document was removed, but not if the document was moved.
    (
        TWO,
        replace(GONE, documents=TWO.documents[:1]),
        (OTHER, "b.mtlx: checked -> removed"),
        (OTHER, "1 check: passed at 1e-07 -> none"),
    ),
    (
        TWO,
        replace(GONE, documents=(Path("new/a.mtlx"), Path("new/b.mtlx"))),
        (LOST, "1 check: passed at 1e-07 -> none"),
    ),
]


@pytest.mark.parametrize("row", CHANGES)
def test_each_kind_of_change_is_told(row):
    before, after, *expected = row
    assert changes(before, after) == expected


def test_documents_of_one_name_are_compared_by_their_folders():
    def run(root, **verdicts):
        results = (
            replace(
                made_run(verdict, subject="m.mtlx: look").results[0],
                document=f"{root}/{name}/m.mtlx",
            )
            for name, verdict in verdicts.items()
        )
        return replace(GONE, results=tuple(results))

    before = run("old", x=PASSED, y=FAILED)
    added = [(OTHER, "value: none -> passed at 1e-07")]
    assert changes(before, run("new", w=PASSED, x=PASSED, y=FAILED)) == added
    worse = [(WORSE, "value, in x: passed at 1e-07 -> failed at 1e-07")]
    assert changes(before, run("new", x=FAILED, y=FAILED)) == worse


QON, FON = (
    caused("model", name, rms=1e-9, distances={name: 1e-9, "EON": 1.0}) for name in ("QON", "FON")
)
FAR = caused("unknown", "no_model", distances={"QON": 0.04, "EON": 0.2})
ALL = Errors(1000, 100, 0, 0.3, 0.05)


def errors(*regions, samples="a", **changes):
    """Error fields of a result, in total and by region. The changes replace fields of ALL."""
    whole, *parts = ({**changes}, *regions)
    found = (replace(ALL, **whole), *(replace(ALL, **{**changes, **each}) for each in parts))
    return {"errors": found, "samples": samples}


ROUGH, SMOOTH = (Region("roughness", "value", **end) for end in ({"low": 0.5}, {"high": 0.5}))
HALVES = {"region": SMOOTH}, {"region": ROUGH}
PAGE, TWO_PAGES = {"pages": ("a",)}, {"pages": ("a", "b")}
PERMITTED = {"verdict": DIFFERS}
SEED = {"samples": "b", "of": 900}  # another seed, and fewer samples than in other results
INVALID = {"error": math.inf, "tolerance": 0.0, "quantity": Quantity.VALUES}
# Result before, result after, kind of the change, and part of the printed line.
GATE = {
    # Regressions that leave the largest error unchanged.
    "light is lost below half of the layers": (errors(), errors(wrong=200, rms=0.1), WORSE, "10 % -> 20 % of"),
    "a page explains it no longer": (errors() | PAGE, errors(), WORSE, "a no longer explains it"),
    "the best match is far, although the page stays": (
        PAGE | errors() | {"diagnosis": QON}, PAGE | errors(rms=0.0505) | {"diagnosis": FAR}, WORSE, "1e-09 -> 0.04",
    ),
    "darker in front light alone": (errors(), errors(wrong=100, rms=0.06), WORSE, "rms error is 0.05 -> 0.06"),
    "brighter for small weights": (
        errors() | {"diagnosis": QON}, errors(rms=0.0501) | {"diagnosis": replace(FAR, distances={"QON": 2.2e-3})},
        WORSE, "best match is 1e-09 -> 0.0022",
    ),
    "wrong beside NaN": (
        {"error": math.inf} | errors(not_finite=9), {"error": math.inf} | errors(not_finite=9, wrong=960, rms=0.4),
        WORSE, "10 % -> 96 % of the samples are wrong",
    ),
    "more NaN": (
        {"error": math.inf} | errors(not_finite=9), {"error": math.inf} | errors(not_finite=12),
        WORSE, "0.9 % -> 1.2 % of the samples are not finite",
    ),
    "smaller, but unexplained": (errors() | PAGE, errors(rms=0.01, largest=0.1), WORSE, "a no longer explains it"),
    "worse in a half of the samples, better in the other": (
        errors(*HALVES), errors({"region": SMOOTH, "rms": 0.01}, {"region": ROUGH, "rms": 0.06}),
        WORSE, "0.05 -> 0.06 with roughness 0.5 or above",
    ),
    "larger": (errors(), errors(largest=0.6), WORSE, "largest error is 0.3 -> 0.6"),
    "one input more is dead": (
        {"error": 1.0, "tolerance": 0.0, "quantity": Quantity.INPUTS},
        {"error": 2.0, "tolerance": 0.0, "quantity": Quantity.INPUTS}, WORSE, "2 times larger",
    ),
    "permitted no longer": (PERMITTED | errors(), errors(rms=0.01), WORSE, "the specification no longer allows it"),
    "a permitted reading with a larger error": (PERMITTED | errors(), PERMITTED | errors(largest=0.6), WORSE, "largest"),
    "does not compile": ({}, {"error": None}, WORSE, "failed at 0.3 -> failed"),
    "no samples, and larger": ({}, {"error": 0.9}, WORSE, "failed at 0.3 -> failed at 0.9; 3 times larger"),
    # The second result is better than the first.
    "another permitted reading, nearer": (
        PERMITTED | errors() | {"diagnosis": QON}, PERMITTED | errors(rms=0.06, largest=0.2) | {"diagnosis": FON},
        "", "",
    ),
    "one of two defects is repaired": (errors() | TWO_PAGES, errors(rms=0.02) | PAGE, BETTER, "0.05 -> 0.02"),
    "fewer NaN": (errors(not_finite=9), errors(not_finite=3), BETTER, "0.9 % -> 0.3 %"),
    "a defect is repaired, and little is left": (
        PAGE | errors() | {"diagnosis": QON}, errors(rms=1e-4) | {"diagnosis": replace(QON, distances={"EON": 1e-9})},
        BETTER, "0.05 -> 0.0001",
    ),
    "a page is found": (errors(), errors() | PAGE, BETTER, "a explains it"),
    "smaller": ({"error": 0.9}, {}, BETTER, "3 times smaller"),
    # The second result equals the first up to the noise of the samples.
    "the same": (errors(*HALVES), errors(*HALVES), "", ""),
    "another driver": (errors(), errors(rms=0.0505, largest=0.4, wrong=101), "", ""),
    "another seed": (
        PAGE | errors({"region": SMOOTH}, largest=1.5),
        errors({"region": replace(SMOOTH, high=0.51), "wrong": 400}, rms=0.06, largest=1.5, wrong=110, **SEED), "", "",
    ),
    "another seed, and a regression": (errors(), errors(wrong=300, rms=0.2, **SEED), WORSE, "10 % -> 33.3 % of the samples"),
    "a change within the tolerance": (
        errors(largest=5e-6, rms=1e-6), errors(largest=5.9e-6, rms=9e-6, wrong=300), "", "",
    ),
    "another name of the same error": (errors() | {"diagnosis": QON}, errors() | {"diagnosis": FON}, "", ""),
    "other edges that are not finite": (INVALID | {"error": 376.0}, INVALID | {"error": 380.0}, "", ""),
    # Checks that did not run in one of the two compared runs.
    "lost": ({}, {"verdict": NOT_RUN, "reason": "timed out"}, LOST, "failed at 0.3 -> not run; timed"),
    "found": ({"verdict": NOT_RUN, "reason": "timed out"}, {}, WORSE, "not run -> failed at 0.3"),
    "implied": ({"verdict": NOT_RUN, "diagnosis": caused("follows")}, {}, OTHER, "not run -> failed"),
    "caused": ({"verdict": PASSED, "error": 0.0}, {"diagnosis": quoted("no roughness")}, WORSE, "0.3; no roughness"),
    "permitted": ({"verdict": PASSED, "error": 0.0}, {"verdict": DIFFERS, "diagnosis": quoted("no roughness")}, WORSE,
                  "differs at 0.3; no roughness"),
    "uncaught": ({"verdict": PASSED}, {"error": 0.0, "control": Control("s clamped", 0.0, False)}, WORSE,
                 "failed at 0; the negative control is not caught: s clamped, 0"),
}  # fmt: skip


@pytest.mark.parametrize("row", GATE)
def test_the_rules_tell_a_regression_from_noise_and_from_a_repair(row, tmp_path, capsys):
    before, after, kind, text = GATE[row]
    runs = [made_run(**{"verdict": FAILED, "error": 0.3} | each) for each in (before, after)]
    status = {WORSE: 1, LOST: 3}.get(kind, 0)
    assert diff(tmp_path, *runs) == status
    if not kind:
        assert capsys.readouterr().out == "no difference\n"
        return
    heading, subject, line, count = capsys.readouterr().out.splitlines()
    assert (heading, subject, count) == (f"{kind}: gl with eonlib", "  clay", f"1 {kind}")
    assert text in line and line.startswith("    value: ")
    assert diff(tmp_path, *runs, "--json") == status
    [found] = json.loads(capsys.readouterr().out)
    assert (found["kind"], found["place"]) == (kind, PLACE)


def test_what_the_later_run_leaves_out_is_counted_if_it_is_much(tmp_path, capsys):
    titles = [f"node {number}" for number in range(2 * LISTED)]
    rows = tuple(made_run(subject=each).results[0] for each in titles)
    whole = replace(TWO, results=rows)
    assert diff(tmp_path, whole, replace(TWO, results=rows[:1], documents=TWO.documents[:1])) == 0
    counts = f"not in the later run: 1 document, {2 * LISTED - 1} nodes and materials"
    assert capsys.readouterr().out == f"{counts}\n{2 * LISTED} other\n"


SCHLICK = "generalized_schlick_bsdf"
ROUGH_NODE = "oren_nayar_diffuse_bsdf, energy_compensation true"
LIGHT = "bsdf.response = diffuse *"
# Regressions of MaterialX's GLSL: check, node title, file, original code and replacement. Most of
# the regressions leave the largest error unchanged.
PLANTED = {
    "a fifth of the light lost below half of the layers": (
        "layering", f"{SCHLICK}, scatter_mode R", SCHLICK, "= vec3(1.0 - avgDirAlbedo * weight);",
        "= vec3(1.0 - avgDirAlbedo * weight) * (weight > 0.5 ? 0.8 : 1.0);",
    ),
    "Burley 1 % darker when rough": (
        "value", "burley_diffuse_bsdf", "burley_diffuse_bsdf", "bsdf.response *=",
        "bsdf.response *= (roughness > 0.9 ? 0.99 : 1.0) *",
    ),
    "darker in front light": (
        "value", ROUGH_NODE, "oren_nayar_diffuse_bsdf", LIGHT, f"{LIGHT} (LdotV > 0.5 ? 0.8 : 1.0) *",
    ),
    "twice as bright for small weights": (
        "value", ROUGH_NODE, "oren_nayar_diffuse_bsdf", LIGHT, f"{LIGHT} (weight < 0.1 ? 2.0 : 1.0) *",
    ),
    "transmission tinted by color0": (
        "transmitted", f"{SCHLICK}, scatter_mode T", SCHLICK, "fd, vec3(1.0)) * weight",
        "fd, vec3(1.0)) * safeColor0 * weight",
    ),
    "dark hair for some cuticles": (
        "value", "chiang_hair_bsdf", "chiang_hair_bsdf", "bsdf.response = F *",
        "bsdf.response = F * (cuticle_angle > 0.52 ? 0.7 : 1.0) *",
    ),
    "another range of blackbodies": (
        "output", "blackbody", "blackbody", "clamp(temperatureKelvin, 800.0", "clamp(temperatureKelvin, 1667.0",
    ),
    "a thicker film on smooth metal": (
        "value", "conductor_bsdf, thin film", "conductor_bsdf", "thinfilm_thickness, thinfilm_ior);",
        "thinfilm_thickness * (roughness.x < 0.3 ? 1.5 : 1.0), thinfilm_ior);",
    ),
}  # fmt: skip


# Regressions that darken samples in which stock MaterialX is too bright. A repair of such a
# regression increases the errors of the samples.
HIDING = ("transmission tinted by color0", "dark hair for some", "another range of blackbodies")


@pytest.mark.whole
@pytest.mark.parametrize("row", PLANTED)
def test_a_planted_regression_is_worse_and_its_repair_is_not(judged, tmp_path, row):
    check, title, *edit = PLANTED[row]

    def judge(library):
        result = replace(judged(check, title, "gl", library), library="stock")
        return read(replace(made_run(), results=(result,)))

    before, after = judge("stock"), judge(wrong_stock_node(tmp_path, *edit))
    assert [each.kind for each in compare(before, after)] == [WORSE]
    if not row.startswith(HIDING):
        assert WORSE not in {each.kind for each in compare(after, before)}


def test_missing_and_new_checks_are_a_line_for_a_subject_or_a_host():
    results = tuple(
        made_run(check=check, subject=subject).results[0]
        for subject in ("clay", "slate")
        for check in ("value", "black", "energy", "frame")
    )
    vulkan = tuple(replace(each, host="vulkan") for each in results)
    full, short = (replace(made_run(), results=each) for each in (results + vulkan, results[4:]))
    assert changes(full, short) == [
        (LOST, "value, black, energy and 1 more: passed at 1e-07 -> none"),
        (LOST, "8 checks: passed at 1e-07 -> none"),
    ]
    assert changes(short, full) == [
        (OTHER, "value, black, energy and 1 more: none -> passed at 1e-07"),
        (OTHER, "8 checks: none -> passed at 1e-07"),
    ]


def test_a_check_with_a_baseline_is_one_command(tmp_path, capsys):
    document = str(examples_folder() / "clay.mtlx")
    check = ["check", document, "--host", "msl", "--library", "eonlib", "--workers", "0"]
    out, old = str(tmp_path / "out"), tmp_path / "old"
    # Shaders for msl are generated but not run.
    assert main([*check, "--report", out, "--annotations"]) == 3
    assert "\n::warning title=mxeon check::not run" in capsys.readouterr().out
    passed = {"verdict": PASSED, "error": 0.0, "tolerance": 1.0, "reason": ""}
    for name, change, status, text in (
        ("same", {}, 0, "no difference"),
        ("passed", passed, 3, "1 not run any longer"),
        ("stale", {"format": 3}, 2, ""),
    ):
        content = json.loads(Path(out, "results.json").read_text())
        row = next(each for each in content["results"] if each["verdict"] == NOT_RUN)
        (content if name == "stale" else row).update(change)
        counts = Counter(each["verdict"] for each in content["results"])
        content["counts"] = {each: counts[each] for each in content["counts"]}
        old.with_suffix(".json").write_text(json.dumps(content))
        options = ["--baseline", str(old.with_suffix(".json")), "--report", out]
        assert main([*check, *options, "--annotations"]) == status
        printed = capsys.readouterr()
        assert text in printed.out and ("\n::warning title=not run" in printed.out) == (status == 3)
    assert "format must be 5; got 3" in printed.err
    assert not Path(out, "junit.xml").exists() and Path(out, "previous_run", "junit.xml").exists()


def test_lines_name_host_and_library_once_and_come_largest_first(tmp_path, capsys):
    def run(late):
        rows = (("value", "slate", 4.0), ("black", "clay", 2.0), ("value", "clay", 8.0))
        fields = ({"check": check, "subject": subject} for check, subject, _ in rows)
        runs = (
            made_run(FAILED, 0.01 * row[2] ** late, **each)
            for row, each in zip(rows, fields, strict=True)
        )
        return replace(made_run(), results=tuple(each.results[0] for each in runs))

    before, after = run(0), run(1)
    assert diff(tmp_path, before, before) == 0
    assert capsys.readouterr().out == "no difference\n"
    assert diff(tmp_path, before, after) == 1
    assert [each.split(": ")[0].strip() for each in capsys.readouterr().out.splitlines()] == (
        ["worse", "clay", "value", "black", "slate", "value", "3 worse"]
    )


@pytest.mark.parametrize(
    "text, words",
    [
        ("[", "must be the results.json of a report; "),
        ("{}", "must be the results.json of a report; lacks 'format'"),
        ('{"format": 5}', "must be the results.json of a report; lacks "),
        ('{"format": 1}', "format must be 5; got 1; run the check again with this mxeon"),
        ('{"format": 5, "$schema": "x"}', "$schema must be urn:mxeon:results:5; got 'x'"),
        ("[]", "must be the results.json of a report; it must be an object"),
    ],
)
def test_what_is_no_report_is_one_line(tmp_path, capsys, text, words):
    (tmp_path / "results.json").write_text(text)
    assert words in refusal_of(tmp_path, capsys)
    assert main(["report", "field", str(tmp_path), "--output", str(tmp_path / "f.html")]) == 2
    assert words in capsys.readouterr().err


# Error messages for rules that the JSON schema cannot express.
TOGETHER = re.compile("counts must be |must have a tolerance|must be at least 0|inhomogeneous")


def replacements(value, replace_it):
    """Copies of a JSON value in which an inner value is replaced, or a key removed or added."""
    for other in (None, True, 7.5, "text", [[]], [True], {"more": [[]]}):
        yield replace_it(other)
    is_list = isinstance(value, list)
    for place in value if isinstance(value, dict) else range(len(value)) if is_list else ():

        def replace_inner(other, place=place):
            inner = value.copy()
            inner[place] = other
            return replace_it(inner)

        yield from replacements(value[place], replace_inner)
    if isinstance(value, dict):
        yield from (replace_it({k: v for k, v in value.items() if k != key}) for key in value)
        yield replace_it(value | {"more": 1})


def test_the_schema_and_the_reader_accept_the_same_reports(tmp_path, capsys, monkeypatch):
    jsonschema = package("jsonschema")
    assert main(["report", "schema"]) == 0
    valid = jsonschema.Draft202012Validator(json.loads(capsys.readouterr().out)).is_valid
    cause = Cause(Kind.REGION, "key", ("a",), (1.0,), "b", Region("a", "b", 0.5, 1.0, ("r",)), 1, 2)
    fields = {"measured": ("a",), "pages": ("a",), "seconds": 1.0}
    fields |= {"worst": {"a": [math.nan]}, "errors": (replace(ALL, region=ROUGH),)}
    diagnosis = Diagnosis((replace(cause, rms=math.inf, point={"a": [1.0]}),), {"a": 0.5})
    run = made_run(FAILED, diagnosis=diagnosis, control=Control("a", 1.0, True), **fields)
    run = replace(run, libraries={"a": {"folder": ("b",)}}, seconds=1.0)
    content = json.loads(to_json(run))
    content["elsewhere"] = [dict.fromkeys(("document", "check", "subject", "host", "library"), "a")]
    monkeypatch.setattr("mxeon.report.diff.make_converter", cache(make_converter))
    file, accepted = tmp_path / "results.json", []
    for changed in (content, *replacements(content, lambda other: other)):
        file.write_text(json.dumps(changed))
        try:
            read_results(file)
            accepted.append(True)
        except ValueError as error:
            accepted.append(False)
            if TOGETHER.search(str(error)):
                continue
        assert valid(changed) == accepted[-1], changed
    assert accepted[0] and accepted.count(True) > 50 and accepted.count(False) > 500


def test_a_baseline_without_later_fields_is_read(tmp_path, capsys):
    content = json.loads(to_json(made_run()))
    for result in content["results"]:
        del result["document"], result["element"]
    old = tmp_path / "old.json"
    old.write_text(json.dumps(content))
    assert main(["report", "diff", str(old), kept(made_run(), tmp_path)]) == 0
    assert capsys.readouterr().out == "no difference\n"


def refusal_of(folder, capsys):
    """Assert that `report diff` refuses a report with a one-line message. Return the message."""
    assert main(["report", "diff", str(folder), str(folder)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and error.startswith("mxeon: ")
    return error


VERDICTS = "verdict must be one of passed, differs, failed, not run"


@pytest.mark.parametrize(
    "key, value, words",
    [
        ("error", 10**400, "must be a number below 1.8e308; got one of 401 digits"),
        ("error", "1e-7", "must be a number; got '1e-7'"),
        ("tolerance", None, "an error must have a tolerance; got 1e-07 and none"),
        ("error", -1.0, "error and tolerance must be at least 0; got -1.0 and 1e-06"),
        ("verdict", "maybe", f"{VERDICTS}; got 'maybe'"),
        ("more", 1, "more"),
    ],
)
def test_a_value_that_no_report_has_is_named_with_its_place(tmp_path, capsys, key, value, words):
    content = json.loads(to_json(made_run()))
    content["results"][0][key] = value
    (tmp_path / "results.json").write_text(json.dumps(content))
    assert words in refusal_of(tmp_path, capsys)


def test_names_in_a_report_cannot_steer_the_terminal(tmp_path, capsys):
    assert diff(tmp_path, *(made_run(subject=f"\x1b[2Jclay {name}\n") for name in "ab")) == 3
    printed = capsys.readouterr().out
    assert "\x1b" not in printed and printed.count("\n") == 7


def run_with(*folders, verdict=PASSED):
    """Run with invented results for libraries in folders. `verdict` applies to the last folder."""
    runs = [made_run(library=folder) for folder in folders[:-1]]
    runs.append(made_run(verdict, library=folders[-1]))
    libraries = {folder: {"folder": ("a.mtlx",)} for folder in folders}
    results = tuple(each.results[0] for each in runs)
    return replace(made_run(), results=results, libraries=libraries)


@pytest.mark.parametrize(
    "before, after",
    [
        (["/old/eonlib"], ["/new/eonlib"]),
        (["/old/a", "/old/b"], ["/new/b", "/new/a"]),  # libraries are matched by name, in any order
        # Libraries with unmatched names are matched by position.
        (["/old/a", "/same/b"], ["/new/c", "/same/b"]),
    ],
)
def test_a_library_that_lies_elsewhere_is_the_same_one(before, after):
    assert changes(run_with(*before), run_with(*after)) == []
    [worse] = compare(read(run_with(*before)), read(run_with(*after, verdict=FAILED)))
    assert (worse.kind, worse.library) == (WORSE, after[-1])


EON = "oren_nayar_diffuse_bsdf, energy_compensation true"
TITLE = reference.diffuse_model("eon").title
TOLERANCE = 1e-6


def made(check, error, **changes):
    """Result with invented values, as if a check had judged the EON node on gl."""
    verdict = PASSED if error <= TOLERANCE else FAILED
    result = Result(
        check, "claim.", EON, "gl", "stock", verdict, error, Quantity.DIFFERENCE, TOLERANCE,
        worst={"roughness": [0.875], "color": [0.2, 0.5, 0.8]}, control=Control("wrong", 1.0, True),
    )  # fmt: skip
    return replace(result, **changes)


WRONG = (
    made("value", 0.4, diagnosis=QON, pages=("a",)),
    made("environment", 1e-7),
    made("furnace", 1e-7),
    made("integral", 0.3, pages=("a", "b")),
    made("black", 0.0),
    # Results of other nodes reveal nothing about a rough diffuse model.
    made("value", 0.4, subject="sheen_bsdf, mode zeltner"),
)
RUN = Run("0.1.0", {}, (Identity("gl", "OpenGL 4.5", "llvmpipe"),), WRONG)


def written(folder, **changes):
    """Write the report of RUN with changed fields; return the summary of the run's node."""
    write(replace(RUN, **changes), folder)
    (entry,) = read_field([folder])
    return entry


def test_a_row_has_the_claimed_model_the_model_that_is_there_and_the_pages(tmp_path):
    entry = written(tmp_path)
    assert (entry.host, entry.version, entry.device) == ("gl", "OpenGL 4.5", "llvmpipe")
    assert (entry.claimed, entry.found, entry.found_around) == (TITLE, "QON", TITLE)
    assert entry.verdict == FAILED and entry.pages == ("a", "b")
    errors = {column: cell.error for column, cell in entry.cells.items()}
    assert errors == {
        "direct": 0.4, "surroundings": 1e-7, "energy": 1e-7, "color": 0.3, "black": 0.0
    }  # fmt: skip


def test_a_node_whose_renderer_did_not_run_has_the_claim_of_this_renderer(tmp_path):
    """EEVEE's node `Diffuse BSDF`, unlike Cycles' node with this title, claims to be Lambert."""
    place = {"host": "cycles-native", "subject": "Diffuse BSDF", "claimed": ""}
    stopped = replace(WRONG[0], **place, verdict=NOT_RUN, error=None, tolerance=None, control=None)
    assert written(tmp_path, results=(stopped,)).claimed == TITLE


def test_a_portrait_is_not_judged_if_its_check_did_not_run(tmp_path):
    stopped = replace(WRONG[0], verdict=NOT_RUN, error=None, tolerance=None, control=None)
    pixels = np.zeros((96, 96, 3))
    back = Picture("portrait", EON, "gl", "stock", "back", pixels + 1e-3, pixels, {})
    entry = written(tmp_path, results=(stopped, *WRONG[1:]), pictures=(back,))
    assert entry.cells["direct"].verdict == NOT_RUN and "back" not in entry.cells


def test_rows_are_by_renderer_and_cause_with_the_most_harmful_first(tmp_path):
    entry = written(tmp_path)
    tiny = {name: replace(cell, error=0.1, verdict=FAILED) for name, cell in entry.cells.items()}
    right = {name: replace(cell, verdict=PASSED) for name, cell in entry.cells.items()}
    mild, other = replace(entry, host="a", cells=tiny), replace(entry, node="b", library="own")
    good = replace(entry, cells=right)
    assert (entry.harm, mild.harm, good.harm) == (0.4, 0.1, 0.0)
    assert by_harm([mild, good, entry, other]) == [[entry, other], [good], [mild]]


def test_the_command_writes_the_page_of_reports(tmp_path, capsys):
    page = tmp_path / "page.html"
    written(tmp_path / "gl")
    assert main(["report", "field", str(tmp_path), "--output", str(page)]) == 0
    assert capsys.readouterr().out == f"field: {page}, nodes: 1\n"
    assert "docs/upstream/a.md" in page.read_text()
