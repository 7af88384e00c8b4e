# SPDX-License-Identifier: Apache-2.0
"""Commands never import Python files from the folders of documents."""

import subprocess
import sys
from importlib.metadata import packages_distributions

import pytest

from mxeon.hosts.cycles.process import interpreter
from mxeon.jobs import pool
from mxeon.jobs.pool import Outcome
from mxeon.shaders.library import examples_folder
from tests.support.availability import available
from tests.support.faults import square

# Names of modules that a process might import: the standard library, Blender's modules, and the
# modules that Python looks for at startup. Installed packages are added below.
NAMES = {*sys.stdlib_module_names, "bpy", "_cycles", "mathutils"}
NAMES |= {"sitecustomize", "usercustomize", "numpy", "mxeon"}
PLANT = "import os\nos.write(os.open({!r}, os.O_CREAT | os.O_WRONLY), __file__.encode())\n"
SCRIPT = """import sys  # pip writes this script
from mxeon.__main__ import main
if __name__ == "__main__":
    sys.exit(main())
"""

RENDER = "render in/plaster.mtlx --element ochre_plaster --size 16 --workers 1"
COMMANDS = {
    "generate": "generate in/plaster.mtlx --target osl --outputPath out --workers 1",
    "render": f"{RENDER} --output out/a.png",
    "cycles": f"{RENDER} --output out/a.exr --host cycles",
    "check": "check in/plaster.mtlx --host msl --workers 1 --report out",
    "kit export": "kit export out/kit --size 64",
    "kit check": "kit check out/kit",
}
STATUS = {"check": 3, "kit check": 3}  # no check runs with msl or with an empty kit


def plant(folder, names, text):
    """Write one module under several names, as hard links, which are faster than copies."""
    folder.mkdir(exist_ok=True)
    first, *others = (folder / f"{name}.py" for name in names)
    first.write_text(text)
    for path in others:
        path.hardlink_to(first)


def run(folder, command):
    """Run a command with the kind of script that pip installs, in a folder with a document."""
    (folder / "in").mkdir(exist_ok=True)
    (folder / "bin").mkdir(exist_ok=True)
    (folder / "bin" / "command").write_text(SCRIPT)
    document = (examples_folder() / "plaster.mtlx").read_text()
    (folder / "in" / "plaster.mtlx").write_text(document)
    line = [sys.executable, str(folder / "bin" / "command"), *command.split()]
    return subprocess.run(line, cwd=folder, capture_output=True, text=True, check=False)


@pytest.fixture(scope="module")
def hostile(tmp_path_factory):
    """Working folder in which the document folder and the output folder contain hostile modules."""
    report, hostile = (tmp_path_factory.mktemp(name) for name in ("report", "hostile"))
    assert run(report, COMMANDS["check"]).returncode == 3
    (hostile / "report").symlink_to(report / "out")
    names = [name for name in NAMES.union(packages_distributions()) if name.isidentifier()]
    for folder in (hostile, hostile / "in", hostile / "out"):
        plant(folder, names, PLANT.format(str(hostile / "RAN")))
    return hostile


@pytest.mark.parametrize("command", COMMANDS)
def test_no_command_imports_from_the_folders_it_works_in(hostile, command):
    if command == "cycles":
        with available("cycles"):
            interpreter()
    if command == "kit check":
        run(hostile, COMMANDS["kit export"])
    ended = run(hostile, COMMANDS[command])
    assert not (hostile / "RAN").exists(), (hostile / "RAN").read_text()
    assert ended.returncode == STATUS.get(command, 0), ended.stderr


def test_workers_of_an_interactive_parent_do_not_import_from_its_folder(hostile, monkeypatch):
    monkeypatch.chdir(hostile)
    monkeypatch.setattr("multiprocessing.process.ORIGINAL_DIR", str(hostile))
    monkeypatch.syspath_prepend("")
    assert dict(pool.run(square, [3], 1, 60.0)) == {0: Outcome(9)}
    assert not (hostile / "RAN").exists()


@pytest.mark.parametrize("way", [["-E", "bin/command"], ["-m", "mxeon"]], ids=" ".join)
def test_the_working_folder_is_off_the_path_whatever_starts_the_command(tmp_path, way):
    plant(tmp_path, ["pebble", "MaterialX", "numpy"], PLANT.format(str(tmp_path / "RAN")))
    run(tmp_path, "library")  # creates the script bin/command
    command = [sys.executable, *way, *COMMANDS["generate"].split()]
    subprocess.run(command, cwd=tmp_path, check=True, capture_output=True)
    assert not (tmp_path / "RAN").exists()
