# SPDX-License-Identifier: Apache-2.0
"""The benchmarks on tiny sizes: every value right, every result kept; no time asserted."""

import os
from functools import cache

import numpy as np
import pytest

from mxeon.models import eon_brdf
from mxeon.models.sampling import SAMPLERS
from mxeon.shaders.library import examples_folder
from tests.support.availability import available
from tools.benchmarks import __main__ as command
from tools.benchmarks import (
    check,
    cycles,
    lights,
    models,
    noise,
    record,
    registers,
    shaders,
    shares,
    tool,
)  # fmt: skip
from tools.benchmarks.rounds import Check, Figure, Group, figure, interleave, ratio


def assert_right(group):
    assert [check for check in group.checks if not check.passed] == []
    assert all(np.isfinite([f.median, f.low, f.high]).all() for f in group.figures)


def test_rivals_take_turns_and_the_first_round_is_dropped():
    order = []
    found = interleave({name: lambda name=name: order.append(name) for name in "ab"}, rounds=2)
    assert "".join(order) == "ababab"
    assert [len(seconds) for seconds in found.values()] == [2, 2]


def test_ratio_is_the_median_of_the_ratios_of_the_rounds():
    found = ratio("a / b", [1.0, 9.0, 4.0], [1.0, 3.0, 2.0])
    assert (found.median, found.low, found.high) == (2.0, 1.5, 2.5)


@pytest.mark.parametrize(("at_least", "reached"), [(False, False), (True, True)])
def test_goal_is_a_bound_from_above_or_from_below(at_least, reached):
    assert figure("x", "x", [2.0], goal=1.0, at_least=at_least).reached is reached


def test_error_that_is_no_number_fails_its_check():
    assert not Check("x", float("nan"), 1.0).passed


# Each group at its smallest size: its arguments.
SMALLEST = {
    "shaders": {"rounds": 1, "invocations": 1024, "calls": 2},
    "noise": {
        "rounds": 1, "invocations": 256, "calls": 4, "size": 16, "pictures": 2, "spokes": 2,
    },
    "materials": {"processes": 1, "size": 32, "nodes": ("oren_nayar", "dielectric_bsdf")},
    "instructions": {"nodes": ("oren_nayar",)},
    "registers": {"nodes": ("oren_nayar",)},
    "shares": {"nodes": ("conductor_bsdf",), "parts": ("nothing", "the film")},
    "cycles": {"rounds": 1, "size": 32, "samples": (64,)},
    "models": {"rounds": 1, "pairs": (1000,)},
    "values": {"rounds": 1, "pairs": 1000, "calls": 20},
    "tool": {"rounds": 1, "counts": (1, 2), "documents": 1},
}  # fmt: skip


@pytest.mark.parametrize("name", [*SMALLEST, "check"])
def test_each_group_is_measured_and_written(gl, tmp_path, monkeypatch, name):
    small = SMALLEST | {"check": {"rounds": 1, "files": TEXTS, "whole": False}}
    memory = cache(models.extra_memory)  # one process, not one for each way
    monkeypatch.setattr(models, "extra_memory", lambda way, count: memory("naive", count))
    monkeypatch.setattr(tool, "TARGETS", ("glsl", "osl"))
    monkeypatch.setattr(cycles, "processor_seconds", lambda pid: 0.0)  # less than a tick
    monkeypatch.setattr(command, "QUICK", small)
    host = {"cycles": "cycles", "registers": "registers", "shares": "registers"}.get(name, "gl")
    with available(host):
        if host == "registers":
            registers.driver()
        environment = dict(os.environ)
        assert command.main([name, "--quick", "--output", str(tmp_path)]) == 0
    assert os.environ == environment  # or what runs afterwards has no cache of shaders either
    ((group, _),) = record.read(tmp_path / "performance.json")
    assert group.name == name and group.figures
    assert_right(group)
    assert record.table(group) in (tmp_path / "performance.md").read_text(encoding="utf-8")


def test_materials_that_were_measured_stay_when_the_next_one_fails(gl, tmp_path, monkeypatch):
    sizes = {"processes": 1, "size": 16, "nodes": ("oren_nayar", "no_such_node")}
    monkeypatch.setattr(command, "QUICK", {"materials": sizes})
    with pytest.raises(KeyError):
        command.main(["materials", "--quick", "--output", str(tmp_path)])
    ((group, _),) = record.read(tmp_path / "performance.json")
    assert {each.name.split(", ")[1] for each in group.figures} == {"oren_nayar"}


def test_a_shader_has_every_part_whose_share_is_measured(gl):
    texts = [shares.sources(node)["eonlib"]["pixel"] for node in shares.NODES]
    for part, found in shares.PARTS.items():
        assert all(any(there in text for text in texts) for there, _ in found), part


def test_check_of_shaders_tells_fon_from_eon(gl):
    device = shaders.Device(1024)
    rivals = {each.name: each for each in shaders.RIVALS}
    kernel = device.kernel(rivals["FON"].statement)
    assert not shaders.checked(device, rivals["EON, eonlib"], kernel).passed


# Nothing but texts is checked, of one node.
TEXTS = (
    str(examples_folder() / "clay.mtlx"),
    *("--node", "oren_nayar_diffuse_bsdf", "--host", "msl"),
)


def test_check_whose_results_fail_is_wrong():
    assert 0.0 < check.job(*TEXTS, "--node", "common", "--library", "stock").wrong < np.inf


def test_the_rows_of_check_have_their_goals_and_a_cache_of_their_own(monkeypatch):
    asked = []

    def job(*options, cache=None, longest=None):
        asked.append((cache, options))
        wrong = float(any("eonlib" in each for each in options))
        return check.Job(3.0, 100.0, wrong, stopped=bool(longest) and "gl" in options)

    monkeypatch.setattr(check, "job", job)
    kept = []
    group = check.measure(rounds=1, keep=kept.append)
    assert len(kept) == 5 and kept[-1] == group
    goals = {each.name: (each.median, each.goal) for each in group.figures if each.goal}
    assert goals["gl, two libraries / one"] == (1.0, 1.6)
    assert goals["gl, beyond that with --report"] == (0.0, 2.0)
    assert {"field, hosts, stopped", "field, renderers"} < {each.name for each in group.figures}
    assert goals["field, eonlib and stock, 2 workers"] == (6.0, 90.0)
    assert len(goals) == 15 and all(np.isfinite([each for each, _ in goals.values()]))
    assert [each.name for each in group.checks if not each.passed] == []
    assert all(cache and not os.path.exists(cache) for cache, _ in asked)
    cold = [asked[0], next(each for each in asked if "all" in each[1])]
    assert cold[0][0] != cold[1][0]  # both with an empty cache


def test_a_run_that_takes_too_long_is_stopped():
    found = check.job("--workers", "0", longest=0.1)
    assert found.stopped and found.seconds >= 0.1


def test_results_of_other_groups_and_of_other_machines_are_kept(tmp_path):
    group = Group("models", "Title", (figure("a", "ns", [1.0]),), (Check("a", 0.0, 1.0),))
    for each, kind in ((group, ""), (Group("tool", "Tool"), ""), (Group("tool", "Tool"), "narrow")):
        record.write(tmp_path / "performance.json", each, kind)
    found = [each for each, _ in record.read(tmp_path / "performance.json")]
    assert found[0] == group
    assert [each.title for each in found] == ["Title", "Tool", "Tool; narrow"]


def test_a_missed_goal_and_a_wrong_value_are_shown():
    group = Group("tool", "T", (Figure("f", "x", 2.0, 2.0, 2.0, 1.0),), (Check("c", 2.0, 1.0),))
    text = record.table(group)
    assert "**missed**" in text
    assert "0 of 1 within tolerance" in text
    assert "| T | 0 of 1 | f (2 x, goal 1) |" in record.goals([group])


def test_command_fails_where_a_value_is_wrong(tmp_path, monkeypatch):
    wrong = Group("tool", "T", checks=(Check("c", 2.0, 1.0),))
    monkeypatch.setattr(tool, "measure", lambda: wrong)
    assert command.main(["tool", "--output", str(tmp_path)]) == 1
    assert "T" in (tmp_path / "performance.md").read_text()


NORMAL = np.array([-0.3, 0.4, np.sqrt(0.75)])  # of a pixel that all these lights reach
PICKED = ("overcast sky", "half space", "window", "horizon band", "retro lamp")
SAMPLES = 50_000
ERRORS = 4.0  # standard errors: by chance, one of the 15 variances exceeds them in 1 of 1000 seeds


def radiance(title, wi):
    """Radiance of one of PICKED from directions of the world, by its description."""
    x, y, z = wi.T
    ahead = 0.6 * z - 0.8 * x
    across = np.maximum(np.abs(0.6 * x + 0.8 * z), np.abs(y))
    return {
        "overcast sky": np.where(y > 0.0, (1.0 + 2.0 * y) / 3.0, 0.0),
        "half space": 1.0 * (x > 0.0),
        "window": 1.0 * (across < np.tan(np.radians(15.0)) * ahead),
        "horizon band": 1.0 * ((y > 0.0) & (y < np.sin(np.radians(10.0)))),
        "retro lamp": 1.0 * (z > np.cos(np.radians(10.0))),
    }[title]


@pytest.mark.parametrize("title", PICKED)
@pytest.mark.parametrize("name", noise.SAMPLERS)
def test_variance_by_quadrature_is_that_of_random_samples(title, name):
    light = next(each for each in lights.LIGHTS if each.title == title)
    quadrature = noise.pixel_variances(light, NORMAL, 1.0)[name]
    wo = np.repeat(lights.local(NORMAL, np.array([[0.0, 0.0, 1.0]])), SAMPLES, axis=0)
    sampler = next(each for each in SAMPLERS if each.name == noise.TRACED[name])
    options = {"rho": noise.REFLECTANCE} if name == "exact" else {}
    u = np.random.default_rng(7).random((SAMPLES, 2))
    wi, pdf = sampler.sample(wo, u, np.ones(SAMPLES), **options)
    value = eon_brdf(wo, wi, noise.REFLECTANCE, 1.0)[:, 0] * wi[:, 2] / pdf
    value = value * radiance(title, wi @ lights.local(NORMAL, np.eye(3)).T)
    squares = (value - value.mean()) ** 2
    error = squares.std() / np.sqrt(SAMPLES)
    assert abs(quadrature - squares.mean()) <= ERRORS * error


@pytest.mark.parametrize("light", lights.LIGHTS, ids=lambda light: light.title)
def test_density_of_a_light_integrates_to_one(light):
    # The sun takes its solid angle from the even sky, 2 pi (1 - cos) of 4 pi.
    assert abs(light.pdf @ light.solid_angle - 1.0) <= 1.0 - lights.SUN


def test_noise_under_a_uniform_light_is_all_but_gone_by_exact_sampling():
    uniform = noise.variances(lights.LIGHTS[0], lights.points(rings=3, spokes=4))
    # What is left is the error of the quadrature, 1 / 8192 of the squared mean at most.
    assert uniform["exact"] < 1.0 / len(lights.LIGHTS[0].wi)
    assert uniform["exact"] < uniform["CLTC"] < uniform["cosine"]


def test_equal_noise_times_are_relative_to_the_best_sampler_alone(gl):
    group = noise.measure(rounds=1, invocations=256, calls=4, size=16, pictures=2, spokes=2)
    found = {each.name: each.median for each in group.figures}
    for light in (*(each.title for each in lights.LIGHTS), noise.SCENE):
        assert min(found[f"{noise.PATHS}: {light}: {name}"] for name in noise.SAMPLERS) == 1.0
