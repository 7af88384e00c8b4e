# SPDX-License-Identifier: Apache-2.0
"""What one changes stands in few files: a tolerance in its spec, an input in its shaders, its model and its spec."""

import re
from pathlib import Path

import pytest

import mxeon
from mxeon.models.microfacet import NODES
from mxeon.shaders.library import load_library

ROOT = Path(__file__).resolve().parents[2]
DIELECTRIC, SPECS = "dielectric_bsdf", "python/mxeon/conformance/specs"
NODEDEF = load_library("stock").getNodeDef(f"ND_{DIELECTRIC}")
PORTS = {each.getName() for each in NODEDEF.getActiveInputs()} - {"weight", "normal", "tangent"}
SHADERS = {f"genglsl/{DIELECTRIC}.glsl", f"genosl/{DIELECTRIC}.osl"}
# Words, and the only files that have all of them.
PLACES = {
    "the tolerance of sheen's albedo": ({"CONTY_KULLA_ALBEDO"}, {f"{SPECS}/sheen.py"}),
    "the inputs of the dielectric": (PORTS, {f"{SPECS}/microfacets.py", *SHADERS}),
}
APART = (
    "conformance/checks/",
    "genglsl/path/",
    ".json",
    "__pycache__",
)  # ask about single inputs, or are copies


@pytest.mark.parametrize("name", PLACES)
def test_what_one_changes_stands_in_its_own_files(name):
    words, places = PLACES[name]
    folders = (ROOT / name for name in ("python/mxeon", "libraries", "genglsl", "genosl"))
    files = (file for folder in folders for file in folder.rglob("*.*") if file.is_file())
    texts = {file.relative_to(ROOT).as_posix(): file.read_text("utf-8", "ignore") for file in files}
    found = {name for name, text in texts.items() if words <= set(re.findall(r"\w+", text))}
    assert {name for name in found if not any(each in name for each in APART)} == places


def test_a_model_takes_inputs_and_defaults_from_one_row():
    _, colors, numbers = NODES[DIELECTRIC]
    row = {each.name: each.default for each in mxeon.model("dielectric").parameters}
    assert row == {**colors, **numbers, "roughness": (0.05, 0.05)} and {*row} <= PORTS
