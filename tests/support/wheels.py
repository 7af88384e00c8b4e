# SPDX-License-Identifier: Apache-2.0
"""Runs modules with other versions of MaterialX by putting folders first on Python's path.

Each version is downloaded once and stored in `out/materialx`, which git ignores.
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
# Patch that turns the data of MaterialX's release into the data of its main branch.
MAIN = ROOT / "tests" / "materialx_main" / "libraries.patch"


def wheel(version):
    """Folder of a MaterialX version; "main" is the installed version with the main branch's data.

    `./run test --all` installs the other versions. If a version is not available, the test is
    skipped.
    """
    if version == mx.getVersionString():
        return ROOT  # a folder without MaterialX, so Python imports the installed version
    name = f"main-{sha256(MAIN.read_bytes()).hexdigest()[:12]}" if version == "main" else version
    folder = KEPT / name
    if not folder.is_dir():
        if version != "main" and PACKAGES not in required():
            pytest.skip(f"no wheel of MaterialX {version}: ./run test --all downloads it")
        KEPT.mkdir(parents=True, exist_ok=True)
        beside = mkdtemp(dir=KEPT)
        try:
            _main(Path(beside)) if version == "main" else install(version, beside)
            os.replace(beside, folder)
        except (subprocess.SubprocessError, OSError):
            if not folder.is_dir():  # another test process may have created the folder
                raise
        finally:
            shutil.rmtree(beside, ignore_errors=True)
    return folder


def _main(folder):
    """Create links to the installed MaterialX, but write the main branch's data as files."""
    package = linked(Path(mx.__file__).parent, folder / "MaterialX")
    for file in re.findall(r"^--- a/(.*)$", MAIN.read_text(), re.MULTILINE):
        data = (package / file).read_bytes()
        (package / file).unlink()  # removes only the link
        (package / file).write_bytes(data)
    git(package, "apply", MAIN)


def git(folder, *arguments):
    """Output of git in a folder. The user's settings and enclosing repositories have no effect."""
    user = {"user.name": "tests", "user.email": "tests@mxeon.invalid", "core.autocrlf": "false"}
    options = [word for name, value in user.items() for word in ("-c", f"{name}={value}")]
    env = os.environ | {"GIT_CONFIG_GLOBAL": os.devnull, "GIT_CONFIG_NOSYSTEM": "1"}
    env["GIT_CEILING_DIRECTORIES"] = str(Path(folder).resolve().parent)
    command = ["git", "-C", folder, *options, *arguments]
    return subprocess.run(command, check=True, capture_output=True, text=True, env=env).stdout


def install(version, folder):
    command = [sys.executable, "-m", "pip", "install", "--quiet", "--no-deps", "--target", folder]
    command += ["--timeout", "30", f"materialx=={version}"]
    subprocess.run(command, check=True, capture_output=True, timeout=300.0)  # a download of 25 MB


def run(folder, *arguments, module="mxeon"):
    """Run a module with the MaterialX in `folder`, and return the finished process."""
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
    done = run(wheel(version), *map(str, arguments), module=module)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout
