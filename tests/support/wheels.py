# SPDX-License-Identifier: Apache-2.0
"""Other versions of MaterialX, each a folder that comes first on the path of Python.

A version is downloaded once and kept in `out/materialx`, which git ignores.
"""

import json
import os
import shutil
import subprocess
from tempfile import mkdtemp

import MaterialX as mx
import pytest

from tests.reliability.versions import ROOT, install, run
from tests.support.availability import required

KEPT = ROOT / "out" / "materialx"
# What the data of MaterialX's main branch has over those of the release.
MAIN = ROOT / "tests" / "materialx_main" / "libraries.patch"


def wheel(version):
    """Folder of a version of MaterialX; the test is skipped where it cannot be had."""
    folder = KEPT / version
    if version == mx.getVersionString():
        return ROOT  # which has none, so that the installed one is found
    if not folder.is_dir():
        KEPT.mkdir(parents=True, exist_ok=True)
        beside = mkdtemp(dir=KEPT)
        try:
            install(version, beside)
            os.replace(beside, folder)
        except (subprocess.CalledProcessError, OSError) as error:
            if not folder.is_dir() and not required():  # another worker may have been faster
                pytest.skip(f"no wheel of MaterialX {version}: {error}")
        finally:
            shutil.rmtree(beside, ignore_errors=True)
    return folder


def git(folder, *arguments):
    """The output of git in a folder, with no settings of its user."""
    who = (
        "-c",
        "user.name=tests",
        "-c",
        "user.email=tests@mxeon.invalid",
        "-c",
        "core.autocrlf=false",
    )
    plain = {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_NOSYSTEM": "1"}
    return subprocess.run(
        ["git", "-C", folder, *who, *arguments],
        check=True,
        capture_output=True,
        text=True,
        env=os.environ | plain,
    ).stdout


def run_with(version, module, *arguments):
    """The output of a module with a version of MaterialX; it has to succeed."""
    done = run(wheel(version), *map(str, arguments), module=module)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def verdicts_with(version, library):
    """Verdicts on the microfacet nodes of a library with a version of MaterialX."""
    return json.loads(run_with(version, "tests.support.microfacets", library))
