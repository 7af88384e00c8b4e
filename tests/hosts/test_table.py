# SPDX-License-Identifier: Apache-2.0
"""The table of hosts: a host is one module and one row, and says which verbs it lacks."""

from importlib import import_module

import numpy as np
import pytest

from mxeon import hosts
from mxeon.conformance.pictures import generate_document
from mxeon.conformance.results import SHADER_FUNCTIONS
from mxeon.conformance.run import check
from mxeon.errors import NotRun
from mxeon.hosts import base
from mxeon.models import table
from mxeon.shaders.library import examples_folder
from mxeon.shaders.nodes import EON
from tests.support.plans import keep_checks

ENGINES = [row for row in hosts.host_rows() if row.module]


class Host(base.Host):
    """A toy host: EON itself, whatever the shader."""

    name, target = "toy", "glsl"

    def identity(self):
        return base.Identity(self.name, "1", "paper")

    def evaluate(self, shader, wo, wi, inputs, branch, **options):
        rho = np.broadcast_to(inputs["color"], wo.shape)
        above = wi * np.where(wi[:, 2:] < 0.0, [1.0, 1.0, -1.0], 1.0)
        brdf = table.model("eon").brdf(wo, above, rho, np.minimum(inputs["roughness"], 1.0))
        factor = np.maximum(inputs.get("weight", 1.0), 0.0) * inputs.get("occlusion", 1.0)
        return brdf * np.clip(wi[:, 2:], 0.0, 1.0) * np.reshape(factor, (-1, 1))


@pytest.fixture
def toy(monkeypatch):
    """The toy host in a row of its own."""
    row = hosts.Row("toy", "glsl", __name__, "pairs")
    monkeypatch.setattr(hosts, "HOSTS", (*hosts.HOSTS, row))


def test_a_new_host_is_one_module_and_one_row(toy, monkeypatch):
    keep_checks(monkeypatch, "value", "twins")
    run = check([examples_folder() / "clay.mtlx"], ["toy"], workers=0, nodes=["common"])
    assert [each.device for each in run.hosts] == ["paper"]
    results = {(each.check, each.subject): each for each in run.results if each.host == "toy"}
    assert results["value", EON].verdict == "passed"
    reason = results["twins", SHADER_FUNCTIONS].reason
    assert reason == "toy: this host has no calls of a shader function; use gl"


def test_a_document_is_not_run_on_a_renderer():
    with pytest.raises(NotRun, match="^mitsuba: this renderer .*; it reads no documents$"):
        generate_document(examples_folder() / "clay.mtlx", "mitsuba", "eonlib")


@pytest.mark.parametrize("row", ENGINES, ids=lambda row: row.name)
def test_a_row_is_that_of_its_module(row):
    host = import_module(row.module).Host
    assert issubclass(host, base.Engine) and issubclass(host, base.Host) == bool(row.target)
    assert (host.name, getattr(host, "target", "")) == (row.name, row.target)
