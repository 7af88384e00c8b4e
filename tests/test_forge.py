# SPDX-License-Identifier: Apache-2.0
"""Workflows of the project on a forge, and the action that other projects can use."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from mxeon.shaders.library_export import export_library
from tests.support.availability import package

yaml = package("yaml")
ROOT = Path(__file__).parents[1]
WORKFLOW = ROOT / ".github" / "workflows" / "ci.yml"
ACTION = ROOT / "action.yml"
SCHEMAS = {WORKFLOW: "vendor.github-workflows", ACTION: "vendor.github-actions"}
TOOLS = Path(sys.executable).parent


@pytest.mark.parametrize("path", SCHEMAS)
def test_the_forge_can_read_the_file_and_the_linter_finds_nothing(path):
    package("check_jsonschema")
    for command in (
        ["check-jsonschema", "--builtin-schema", SCHEMAS[path]],
        ["zizmor", "--offline", "--strict-collection", "--no-config"],
    ):
        subprocess.run([TOOLS / command[0], *command[1:], path], check=True)


@pytest.mark.parametrize("path", [ACTION, ROOT / "docs" / "ci.md"])
def test_the_action_and_the_container_install_the_driver_that_run_installs(path):
    [driver] = re.findall(r'^driver="(.*)"', (ROOT / "run").read_text(), re.MULTILINE)
    assert f"--no-install-recommends {driver}\n" in path.read_text()


def test_the_six_lines_of_the_page_call_the_action():
    [lines] = re.findall(r"```yaml\n(.*?)```", (ROOT / "docs" / "ci.md").read_text(), re.DOTALL)
    *_, step = yaml.safe_load(lines)["steps"]
    inputs = yaml.safe_load(ACTION.read_text())["inputs"]
    assert len(lines.splitlines()) == 6 and "/mxeon@" in step["uses"]
    assert set(step["with"]) <= set(inputs)


LINES = "--node oren_nayar_diffuse_bsdf\n--host gl  --workers\n0"


def ended(library, folder, options=LINES, command=TOOLS / "mxeon", documents="", baseline=""):
    """Run the action's step that checks a node, in the same way as a forge."""
    # The action installs the command at this path.
    (folder / "mxeon" / "bin").mkdir(parents=True)
    (folder / "mxeon" / "bin" / "mxeon").symlink_to(command)
    # The step `Check` of the action runs this script.
    steps = yaml.safe_load(ACTION.read_text())["runs"]["steps"]
    [script] = [step["run"] for step in steps if step.get("name") == "Check"]
    (folder / "script.sh").write_text(script)
    variables = {
        "RUNNER_TEMP": str(folder),
        "GITHUB_STEP_SUMMARY": str(folder / "summary.md"),
        "DOCUMENTS": documents,
        "LIBRARY": str(library),
        "REPORT": str(folder / "report"),
        "OPTIONS": options,
        "MATERIALX": "",
        "BASELINE": baseline,
    }
    command = ["bash", "--noprofile", "--norc", "-e", "-o", "pipefail", folder / "script.sh"]
    return subprocess.run(command, env=os.environ | variables, capture_output=True, text=True)


@pytest.mark.whole
@pytest.mark.parametrize(("wrong", "status"), [(False, 0), (True, 1)])
def test_the_action_fails_where_the_library_does_and_keeps_the_report(wrong, status, tmp_path):
    library = export_library(tmp_path / "libraries")
    if wrong:
        source = library / "genglsl" / "lib" / "eon.glsl"
        source.write_text(source.read_text().replace("0.5 - 2.0 / (3.0", "0.4 - 2.0 / (3.0"))
    done = ended(library, tmp_path)
    assert done.returncode == status, done.stdout + done.stderr
    assert (tmp_path / "report" / "report.html").is_file()
    sentence = done.stdout.splitlines()[0]
    assert f"on gl with {library}" in sentence and ("none failed" not in sentence) == wrong
    assert (tmp_path / "summary.md").read_text().startswith(f"    {sentence}\n")


@pytest.mark.parametrize(
    "text, words",
    [
        ("", []),
        ("\n--full\n", ["--full"]),
        ("--node a\n\n--node  b c.mtlx", ["--node", "a", "--node", "b", "c.mtlx"]),
        ("'a b.mtlx' \"$HOME/*\"\nc\\ d", ["a b.mtlx", "$HOME/*", "c d"]),
    ],
)
def test_the_action_takes_every_line_of_its_options(text, words, tmp_path):
    echo = tmp_path / "echo"
    echo.write_text('#!/bin/sh\nprintf "%s\\n" "$@"\n')
    echo.chmod(0o755)
    done = ended("library", tmp_path, text, echo, "look.mtlx 'my looks'")
    report = ["--report", str(tmp_path / "report")]
    expected = ["check", "--annotations", *report, "look.mtlx", "my looks", *words]
    assert done.stdout.splitlines() == [*expected, "--library", "library"]


@pytest.mark.parametrize("status", range(4))
def test_the_action_with_a_baseline_ends_as_the_command_and_leaves_annotations_to_the_log(
    status, tmp_path
):
    made = tmp_path / "made"
    made.write_text(f'#!/bin/sh\necho "$@"\necho ::error::worse\nexit {status}\n')
    made.chmod(0o755)
    done = ended("library", tmp_path, "", made, baseline="old")
    command, annotation = done.stdout.splitlines()
    assert (done.returncode, annotation) == (status, "::error::worse")
    assert command.endswith("--library library --baseline old")
    assert (tmp_path / "summary.md").read_text() == f"    {command}\n"


@pytest.mark.whole
def test_the_action_judges_documents_without_a_library_as_the_command_does(tmp_path):
    options = "--host gl --workers 0"
    done = ended("", tmp_path, options, documents=str(ROOT / "examples" / "plaster.mtlx"))
    assert done.returncode == 0, done.stdout + done.stderr
    assert "with stock MaterialX" in done.stdout.splitlines()[0]
