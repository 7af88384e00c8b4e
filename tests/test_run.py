# SPDX-License-Identifier: Apache-2.0
"""What `run` installs and starts, with programs that only say how they were called."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from mxeon.hosts import host_rows

ROOT = Path(__file__).parents[1]
SAY = '#!/bin/sh\necho "${0##*/} $*"\n'
PYTHON = """#!/bin/sh
[ "$2" = venv ] || exit 0
mkdir -p "$3/bin"
for name in pip mxeon python; do cp "$(dirname "$0")/say" "$3/bin/$name"; done
"""
INSTALLED = "#!/bin/sh\necho install ok installed\n"
DEMO = "mxeon check --host gl --report out/demo"
BOTH = "mxeon check --host gl --host cycles --report out/demo"


@pytest.fixture
def run(tmp_path):
    """A function that runs a job in a fresh checkout, and returns what it says, by line."""
    for name in ("run", "pyproject.toml"):
        shutil.copy(ROOT / name, tmp_path)
    (tmp_path / "bin").mkdir()
    for name, text in {"python": PYTHON, "say": SAY, "dpkg-query": INSTALLED}.items():
        (tmp_path / "bin" / name).write_text(text)
        (tmp_path / "bin" / name).chmod(0o755)
    path = {"PATH": f"{tmp_path / 'bin'}:/usr/bin:/bin", "PYTHON": str(tmp_path / "bin" / "python")}

    def job(*arguments):
        command = ["sh", str(tmp_path / "run"), *arguments]
        ended = subprocess.run(command, env=path, capture_output=True, text=True, check=True)
        return ended.stdout.splitlines()

    return job


def test_the_demo_says_first_what_it_installs_and_installs_that_alone(run):
    said, installed, checked, *hints = run("demo")
    assert said.startswith("demo: install 260 MB of packages (half a minute), check eonlib on gl ")
    assert installed.startswith("pip install ") and installed.endswith(" --editable .[report]")
    assert checked == DEMO
    failure, repaired, *hints = hints
    assert "stock MaterialX, and repaired by eonlib" in failure
    assert repaired == "mxeon check examples/plaster.mtlx --report out/demo/plaster"
    assert hints[0].endswith(" type: . .venv/bin/activate") and len(hints) == 4
    assert all(": mxeon " in hint for hint in hints[1:])
    said, checked, *_ = run("demo")
    assert said.startswith("demo: check eonlib on gl ") and checked == DEMO


def test_a_demo_that_fails_says_what_comes_next_and_fails(run, tmp_path):
    run("demo")
    mxeon = tmp_path / ".venv" / "bin" / "mxeon"
    mxeon.write_text("#!/bin/sh\nexit 3\n")
    with pytest.raises(subprocess.CalledProcessError) as ended:
        run("demo")
    assert ended.value.returncode == 3 and "activate" in ended.value.stdout


def test_cycles_joins_the_demo_once_it_was_asked_for(run):
    run("demo")
    said, installed, checked, *_ = run("demo", "--host", "cycles")
    assert "install Blender (1 GB)" in said and " bpy==" in installed and checked.startswith(BOTH)
    said, checked, *_ = run("demo")
    assert "on gl and cycles" in said and checked == BOTH


def test_the_tests_complete_the_environment_of_the_demo_which_keeps_it(run):
    run("demo")
    installed, before, tested, whole = run("test", "-x")
    assert installed.endswith(" --editable .[test]")
    assert re.match(r"python -m pytest -x$", tested)
    assert re.fullmatch(r"run test: set up in \d+:\d\d minutes", before)
    assert re.fullmatch(r"run test: \d+:\d\d minutes", whole)
    assert "pip" not in "".join(run("demo"))


def test_the_default_tests_find_no_program_that_their_job_does_not_install(run, tmp_path):
    run("test", "-x")  # installs
    python = tmp_path / ".venv" / "bin" / "python"
    python.write_text('#!/bin/sh\necho "$PATH"\n')
    _, path, _ = run("test")
    assert path == str(tmp_path / "out" / "bare")
    [engines] = re.findall(r'^engines="(.*)"', (ROOT / "run").read_text(), re.MULTILINE)
    assert "glslang-tools" in engines and shutil.which("glslangValidator", path=path) is None
    assert shutil.which("git", path=path) and shutil.which("sh", path=path)
    assert "/usr/bin" in run("test", "-x")[1]


def test_a_missing_job_is_answered_by_a_line_for_each(run):
    with pytest.raises(subprocess.CalledProcessError) as ended:
        run()
    jobs = re.findall(r"^  (\w+) ", ended.value.stderr, re.MULTILINE)
    assert ended.value.returncode == 2 and ended.value.stdout == ""
    assert jobs == re.findall(r"^([a-z]+)\)$", (ROOT / "run").read_text(), re.MULTILINE)


def test_all_tests_require_every_host_that_they_install():
    names = re.search(r"MXEON_REQUIRE=\$\{MXEON_REQUIRE-([\w,-]+)\}", (ROOT / "run").read_text())
    assert set(names[1].split(",")) == {
        "packages",
        *(row.name for row in host_rows() if not row.needs),
    } - {
        "eevee",  # its checks take minutes on a software driver
        "testrender",
    }
