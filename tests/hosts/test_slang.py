# SPDX-License-Identifier: Apache-2.0
"""The Slang host: what is missing is said."""

import subprocess
import sys

import pytest

OPEN = """
import sys
from mxeon.errors import NotRun
from mxeon.hosts.slang import Host
try:
    Host()
except NotRun as reason:
    print(reason)
print("torch" in sys.modules)
"""


def test_a_missing_compiler_is_not_run_and_names_the_remedy(tmp_path):
    pytest.importorskip("slangpy")
    done = subprocess.run(
        [sys.executable, "-c", OPEN], env={"PATH": str(tmp_path)}, capture_output=True, text=True
    )
    assert done.stdout.startswith("slang: no kernel for the CPU; ")
    assert "apt-get install g++" in done.stdout
    assert done.stdout.endswith("\nFalse\n")  # slangpy would import PyTorch, in two seconds
