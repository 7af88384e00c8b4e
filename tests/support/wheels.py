# SPDX-License-Identifier: Apache-2.0
"""Other versions of MaterialX, each in a folder that comes first on Python's path.

A version is downloaded once and kept in `out/materialx`, which git ignores.
"""

import os
import re
import shutil
import subprocess
import sys
from hashlib import sha256
from pathlib import Path
from tempfile import mkdtemp

import MaterialX as mx
import pytest

from tests.support.availability import PACKAGES, required
from tools.site.ledger import linked

ROOT = Path(__file__).resolve().parents[2]
KEPT = ROOT / "out" / "materialx"
DOWNLOAD = 300.0  # seconds for 25 MB
# Changes of MaterialX's data from the release to the main branch.
MAIN = ROOT / "tests" / "materialx_main" / "libraries.patch"


def wheel(version):
    """Folder of a version of MaterialX, "main" for the installed one with the data of its main branch.

    `./run test --all` installs other versions; the test is skipped if one is not available.
    """
    if version == mx.getVersionString():
        return ROOT  # contains no MaterialX, so the installed one is found
    folder = KEPT / (_main_name() if version == "main" else version)
    if not folder.is_dir():
        if version != "main" and PACKAGES not in required():
            pytest.skip(f"no wheel of MaterialX {version}: ./run test --all downloads it")
        KEPT.mkdir(parents=True, exist_ok=True)
        beside = mkdtemp(dir=KEPT)
        try:
            _main(Path(beside)) if version == "main" else install(version, beside)
            os.replace(beside, folder)
        except (subprocess.SubprocessError, OSError):
            if not folder.is_dir():  # another worker may have been faster
                raise
        finally:
            shutil.rmtree(beside, ignore_errors=True)
    return folder


def _main_name():
    return f"main-{sha256(MAIN.read_bytes()).hexdigest()[:12]}"


def _main(folder):
    """Link to the installed MaterialX, with the data of the main branch."""
    package = linked(Path(mx.__file__).parent, folder / "MaterialX")
    for file in re.findall(r"^--- a/(.*)$", MAIN.read_text(), re.MULTILINE):
        data = (package / file).read_bytes()
        (package / file).unlink()  # a link
        (package / file).write_bytes(data)
    git(package, "apply", MAIN)


def git(folder, *arguments):
    """The output of git in a folder, without settings of the user or of enclosing folders."""
    who = {"user.name": "tests", "user.email": "tests@mxeon.invalid", "core.autocrlf": "false"}
    options = [word for name, value in who.items() for word in ("-c", f"{name}={value}")]
    alone = {
        "GIT_CONFIG_GLOBAL": os.devnull,
        "GIT_CONFIG_NOSYSTEM": "1",
        "GIT_CEILING_DIRECTORIES": str(Path(folder).resolve().parent),
    }
    return subprocess.run(
        ["git", "-C", folder, *options, *arguments],
        check=True,
        capture_output=True,
        text=True,
        env=os.environ | alone,
    ).stdout


def install(version, folder):
    """Install a version of MaterialX, and nothing else, into a new folder."""
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", folder]
    command += ["--timeout", "30", f"materialx=={version}"]
    subprocess.run(command, check=True, capture_output=True, timeout=DOWNLOAD)


def run(folder, *arguments, module="mxeon"):
    """Run a module as a command with the MaterialX in a folder; returns the finished process."""
    paths = [str(folder), *map(str, (ROOT, ROOT / "python"))]
    if os.environ.get("PYTHONPATH"):
        paths.append(os.environ["PYTHONPATH"])
    return subprocess.run(
        [sys.executable, "-P", "-m", module, *arguments],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        capture_output=True,
        text=True,
    )


def run_with(version, module, *arguments):
    """The output of a module with a version of MaterialX; asserts success."""
    done = run(wheel(version), *map(str, arguments), module=module)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout
