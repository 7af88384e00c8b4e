# SPDX-License-Identifier: Apache-2.0
"""The Vulkan host: what is missing is said, and uniform blocks are laid out by std140."""

import struct

import numpy as np
import pytest

from mxeon.errors import NotRun
from mxeon.hosts import vulkan
from mxeon.hosts.base import TURN

BLOCK = """
    mat4 u_envMatrix;
    bool flag;
    vec3 view;
    float u_envLightIntensity;
    structure last;
"""


def test_a_missing_driver_is_not_run_and_names_the_remedy(monkeypatch):
    wgpu = pytest.importorskip("wgpu")
    monkeypatch.setattr(vulkan.shutil, "which", lambda program: program)
    monkeypatch.setattr(wgpu.gpu, "enumerate_adapters_sync", list)
    with pytest.raises(NotRun, match="no Vulkan device; .* install mesa-vulkan-drivers"):
        vulkan.Host()


def test_members_of_a_block_lie_where_std140_has_them():
    data = vulkan._std140(BLOCK)
    np.testing.assert_array_equal(struct.unpack_from("<16f", data), TURN.ravel())
    assert struct.unpack_from("<f", data, offset=64 + 16 + 12) == (1.0,)
    assert sum(data[64 + 16 + 16 :]) == 0
