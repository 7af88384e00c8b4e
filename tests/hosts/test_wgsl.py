# SPDX-License-Identifier: Apache-2.0
"""The WGSL host: MaterialX's text reaches naga unchanged, and its integers are booleans again."""

from types import SimpleNamespace

import numpy as np
import pytest

from mxeon.conformance.nodes.diffuse import SUBJECTS
from mxeon.errors import NotRun
from mxeon.hosts import fragment, vulkan, wgsl
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import FLAG

PAIR = np.array([[0.6, 0.0, 0.8]])
BEHIND = np.array([[-0.6, 0.0, 0.8]])


@pytest.fixture(scope="module")
def host(hosts):
    return hosts("wgsl")


def test_no_compiler_of_its_own_is_needed(monkeypatch):
    monkeypatch.setattr(vulkan.shutil, "which", lambda program: None)
    monkeypatch.setattr(vulkan, "wgpu", SimpleNamespace(gpu=SimpleNamespace()))
    monkeypatch.setattr(vulkan.wgpu.gpu, "enumerate_adapters_sync", list, raising=False)
    with pytest.raises(NotRun, match="wgsl: no Vulkan device"):
        wgsl.Host()


def test_the_text_is_evaluated_as_it_was_generated():
    shader = generate(SUBJECTS[0].document(), "wgsl")[0]
    text, _ = fragment.bsdf_evaluation(shader, PAIR, PAIR, {}, "direct")
    head, body = shader.stages["pixel"].split("\n", 1)
    assert text.startswith(head) and body in text


def test_an_integer_of_the_text_is_the_boolean_that_it_was(host):
    shader = generate(SUBJECTS[0].document(), "wgsl")[0]
    inputs = {"color": np.ones((1, 3)), "roughness": np.ones(1)}
    on, off = (
        host.evaluate(shader, PAIR, BEHIND, {**inputs, FLAG: flag}, "direct")
        for flag in (True, False)
    )
    assert (on > off + 0.01).all()
