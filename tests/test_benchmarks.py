# SPDX-License-Identifier: Apache-2.0
"""The benchmarks on tiny sizes: every value that is timed is right, and the results are written."""

import numpy as np
import pytest

from mxeon.shaders.library import examples_folder
from tests.support.availability import available
from tools.benchmarks import __main__ as command
from tools.benchmarks import rounds, tool
from tools.benchmarks.rounds import Check, Group

pytestmark = pytest.mark.whole

CLAY = str(examples_folder() / "clay.mtlx")
SMALLEST = {
    "shaders": {"rounds": 1, "invocations": 1024, "calls": 2},
    "sampling": {"rounds": 1, "size": 16, "pictures": 2, "spokes": 2},
    "materials": {"processes": 1, "size": 32, "nodes": ("dielectric_bsdf",)},
    "registers": {"nodes": ("oren_nayar",)},
    "models": {"rounds": 1, "pairs": (1000,), "values_of": 1000},
    "tool": {"rounds": 1, "counts": (1, 2), "documents": 1},
    "check": {
        "rounds": 1,
        "files": (CLAY, "--node", "oren_nayar_diffuse_bsdf", "--host", "msl"),
        "whole": False,
    },
}


@pytest.mark.parametrize("name", command.QUICK)
def test_each_group_is_measured_and_written(gl, tmp_path, monkeypatch, name):
    monkeypatch.setattr(tool, "TARGETS", ("glsl", "osl"))
    monkeypatch.setattr(command, "QUICK", SMALLEST)
    with available("gl"):
        assert command.main([name, "--quick", "--output", str(tmp_path)]) == 0
        if not (tmp_path / "performance.json").exists():
            pytest.skip(f"{name} cannot run here")
    ((group, _),) = rounds.read(tmp_path / "performance.json")
    assert group.name == name and group.figures
    assert all(np.isfinite([f.median, f.low, f.high]).all() for f in group.figures)
    assert rounds.table(group) in (tmp_path / "performance.md").read_text(encoding="utf-8")


def test_command_fails_where_a_value_is_wrong(tmp_path, monkeypatch):
    wrong = Group("tool", "T", checks=(Check("c", float("nan"), 1.0),))
    monkeypatch.setattr(tool, "measure", lambda: wrong)
    assert command.main(["tool", "--output", str(tmp_path)]) == 1
    assert "0 of 1 within tolerance" in (tmp_path / "performance.md").read_text()
