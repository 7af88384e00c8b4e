# SPDX-License-Identifier: Apache-2.0
"""The Python API accepts names and paths, summarizes runs, and runs the documented example."""

import pickle
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import mxeon
from mxeon import report
from mxeon.conformance.results import Picture, Refused
from mxeon.errors import CheckError
from mxeon.fit import fit_brdf, read_merl
from mxeon.models.diffuse import eon_brdf
from mxeon.shaders.document.policy import Policy
from tests.support.plans import keep_checks
from tests.support.results import caused, made, made_run
from tests.support.verdicts import DIFFERS, FAILED, NOT_RUN, PASSED

ROOT = Path(__file__).parents[1]
CLAY, LIBRARY = ROOT / "examples" / "clay.mtlx", ROOT / "libraries"
RUN = made_run(made())


def checked(**names):
    return mxeon.check(**{"files": CLAY, "hosts": "msl"} | names)


# Public parameters that accept names or paths: a call with the parameter, a valid value, and
# whether the parameter accepts several values.
NAMES = {
    "files": (lambda x: checked(files=x), CLAY, True),
    "hosts": (lambda x: checked(hosts=x), "msl", True),
    "libraries": (lambda x: checked(libraries=x), LIBRARY, True),
    "nodes": (lambda x: checked(nodes=x), "oren_nayar_diffuse_bsdf", True),
    "compared": (lambda x: checked(compared=x), "stock", True),
    "definitions": (lambda x: mxeon.load_library(definitions=x), None, True),
    "path": (lambda x: Policy(path=x), LIBRARY, True),
    "definitions of a policy": (lambda x: Policy(definitions=x), LIBRARY, True),
    "library": (mxeon.load_library, LIBRARY, False),
    "profile": (lambda x: mxeon.load_library(profile=x), "cycles", False),
    "document": (lambda x: mxeon.generate(x, "glsl"), CLAY, False),
    "target": (lambda x: mxeon.generate(CLAY, x), "glsl", False),
    "element": (lambda x: mxeon.generate(CLAY, "glsl", x), "terracotta", False),
    "library of generate": (lambda x: mxeon.generate(CLAY, "glsl", library=x), LIBRARY, False),
    "model": (mxeon.model, "eon", False),
    "model of check_brdf": (lambda x: mxeon.check_brdf(eon_brdf, x), "eon", False),
    "model of fit_brdf": (lambda x: fit_brdf(None, x), None, False),
    "path of read_merl": (read_merl, None, False),
    "folder of report.write": (lambda x: report.write(RUN, x), None, False),
}


@pytest.fixture
def short(monkeypatch, tmp_path):
    """Restrict runs to a single check, and enter an empty working folder."""
    keep_checks(monkeypatch, "document")
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("name", [name for name, row in NAMES.items() if row[1]])
def test_one_name_or_path_is_taken_and_several_where_there_may_be(short, name):
    call, right, several = NAMES[name]
    for each in (right, str(right), *((iter([right]), {right}) if several else ())):
        assert call(each)


@pytest.mark.parametrize("name", NAMES)
def test_anything_else_is_refused_in_a_sentence(short, name):
    wrong = [3, b"clay.mtlx", [3], [["eon"]]]
    if name not in ("files", "nodes", "profile", "element"):  # None is valid for these names
        wrong.append(None)
    if name in ("files", "hosts", "libraries", "nodes"):
        wrong.append([])
    for each in wrong:
        with pytest.raises(ValueError, match=r"^[^\n]*( must be |no model |no rough)[^\n]*$"):
            NAMES[name][0](each)


def test_an_argument_that_is_refused_names_the_parameter(short):
    for words, names in {
        "hosts must be a name or path, or several; got 3": {"hosts": 3},
        "each of nodes must be one name or path; got 3": {"nodes": ["mix", 3]},
        "files must be a name or path, or several; got none": {"files": []},
        "compared must differ from the judged libraries; got 'eonlib'": {"compared": "eonlib"},
    }.items():
        with pytest.raises(ValueError, match=f"^{words}$"):
            checked(**names)


# --- summaries of runs ------------------------------------------------------------------------


REFUSED = {"refused": (Refused("cut.mtlx", ("cut.mtlx: must be XML",)),)}
STOCK = {"compared": ("stock",)}
ALLOWED = "1 differs, but the specification allows it."
DIRECTIONS = caused("defect", "other_directions")
# Results and other fields of a run. Expected exit status, sentence of the summary, and error.
RUNS = (
    ([], {}, 3, "No check ran.", ""),
    ([made(NOT_RUN)], {}, 3, "No check ran.", ""),
    ([made(library="stock")], STOCK, 3, "No check ran. For comparison, 0 of 1 failed with stock.", ""),
    ([made()], {}, 0, "The check passed on gl with eonlib.", ""),
    ([made(), made(FAILED, library="stock")], STOCK, 0,
     "The check passed on gl with eonlib. For comparison, 1 of 1 failed with stock.", ""),
    ([made(), made(host="osl"), made(host="webgl")], {}, 0, "All 3 checks passed on gl, osl and webgl with eonlib.", ""),
    ([made(), made(DIFFERS)], {}, 0, f"1 of 2 checks passed on gl with eonlib; {ALLOWED}", ""),
    ([made(FAILED), made(FAILED, host="osl"), made(DIFFERS)], {}, 1,
     f"2 of 3 checks failed: 1 on gl with eonlib, 1 on osl with eonlib; {ALLOWED}", ""),
    ([made(FAILED, diagnosis=DIRECTIONS), made()], {}, 1, "1 of 2 checks failed on gl with eonlib.",
     "failed: gl with eonlib, value, .*in wrong directions"),
    ([made(FAILED), made(NOT_RUN), made(NOT_RUN, diagnosis=caused("follows"))], {}, 1,
     "1 of 3 checks failed on gl with eonlib; 1 did not run.", ""),
    ([made(), made(NOT_RUN, reason="no GPU")], {}, 3, "Nothing failed, but 1 of 2 checks did not run.",
     "not run: gl with eonlib, .*: no GPU"),
    ([made()], {"missing": ("gl, value",)}, 3, "", "not finished: 1 item is missing"),
    *((each, REFUSED, 2, "", "cut.mtlx: must be XML") for each in ([], [made()], [made(FAILED)])),
)  # fmt: skip


@pytest.mark.parametrize("results, fields, status, sentence, words", RUNS)
def test_a_run_passes_only_if_all_that_was_asked_ran_and_nothing_failed(
    results, fields, status, sentence, words
):
    run = made_run(*results, **fields)
    assert (run.passed, run.exit_status) == (status == 0, status)
    assert sentence in ("", run.sentence)
    assert status == 2 or run.verdict == {0: PASSED, 1: FAILED, 3: NOT_RUN}[status]
    if run.passed:
        return run.raise_for_failure()
    with pytest.raises(CheckError, match=words or None) as failed:
        run.raise_for_failure()
    assert str(failed.value).startswith(run.sentence)
    copy = pickle.loads(pickle.dumps(failed.value))
    assert copy.status == failed.value.status == status and copy.args == failed.value.args


def test_a_node_that_no_host_judges_has_not_passed_beside_one_that_has(monkeypatch):
    keep_checks(monkeypatch, "value", "host")
    run = mxeon.check(libraries="stock", nodes=["oren_nayar_diffuse_bsdf", "eon_diffuse_bsdf"])
    [lost] = [each for each in run.results if each.subject == "eon_diffuse_bsdf"]
    assert lost.verdict == NOT_RUN and lost.reason.endswith(": eon_diffuse_bsdf with stock")
    assert not run.passed


def test_no_repr_prints_arrays_or_text_of_shaders(monkeypatch):
    pixels = np.zeros((64, 64, 3))
    [shader, *_] = mxeon.generate(CLAY, "glsl")
    for each in (
        Picture("a.mtlx", "clay", "gl", "eonlib", "side", pixels, pixels, {"device": "x"}),
        made(FAILED, diagnosis=DIRECTIONS, worst={"wo": [0.0, 0.0, 1.0]}),
        made_run(*[made()] * 20),
        shader,
    ):
        assert "array" not in repr(each) and len(repr(each)) < 300, repr(each)


# --- public names -----------------------------------------------------------------------------


def test_dir_shows_public_names_alone_and_defaults_are_plain():
    assert dir(mxeon) == sorted(mxeon.__all__)
    assert mxeon.model_names()[:1] == ("lambert",)
    for function in (mxeon.check, mxeon.generate, mxeon.load_library):
        defaults = [*(function.__defaults__ or ()), *(function.__kwdefaults__ or {}).values()]
        assert {type(each) for each in defaults} <= {type(None), str, int, float, bool, tuple}


# --- the example in docs/api/conformance.md ---------------------------------------------------

PAGE = (ROOT / "docs/api/conformance.md").read_text("utf-8")
[GATE] = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)


def test_the_gate_of_the_page_passes_good_materials_and_stops_others(tmp_path, monkeypatch, capsys):
    keep_checks(monkeypatch, "picture", "value")
    names = {"__name__": "gate"}
    exec(compile(GATE, "gate.py", "exec"), names)
    (tmp_path / "clay.mtlx").write_text(CLAY.read_text())
    assert names["gate"](tmp_path) == 0 and names["require"](tmp_path).passed
    assert "For comparison, " in capsys.readouterr().out
    (tmp_path / "cut.mtlx").write_text("<materialx")
    assert names["gate"](tmp_path) == 2 and "refused: " in capsys.readouterr().out
    with pytest.raises(SystemExit, match="not published: .*cut.mtlx was not checked: "):
        names["require"](tmp_path)


MISTAKES = {
    'result.verdict == "failed"': ('result.verdict == "faild"', "comparison-overlap"),
    'hosts="gl"': ("hosts=3", "arg-type"),
    "run.exit_status": ("run.exit_code", "attr-defined"),
}


@pytest.mark.whole
def test_a_type_checker_passes_the_gate_and_finds_mistakes_in_it(tmp_path):
    """mypy checks the example strictly and without the checkout's settings, like a user's file."""
    wrong = GATE
    for right, (mistake, _) in MISTAKES.items():
        wrong = wrong.replace(right, mistake)
    (tmp_path / "gate.py").write_text(GATE)
    (tmp_path / "wrong.py").write_text(wrong)
    command = [sys.executable, "-m", "mypy", "--strict", "--follow-imports=silent"]
    command += ["--cache-dir", str(tmp_path / "mypy"), "gate.py", "wrong.py"]
    environment = {"MYPYPATH": str(ROOT / "python"), "PATH": ""}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    found = re.findall(r"^(.*?):\d+: error: .*\[(.*)\]$", done.stdout, re.MULTILINE)
    assert {file for file, _ in found} == {"wrong.py"}, done.stdout
    assert {code for _, code in found} >= {code for _, code in MISTAKES.values()}, done.stdout
