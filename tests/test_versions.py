# SPDX-License-Identifier: Apache-2.0
"""Other versions of MaterialX: refused, or judged each in an environment of its own."""

import sys

import MaterialX as mx
import pytest

from mxeon import generation, hosts, versions
from mxeon.cli import main
from mxeon.conformance import check
from mxeon.hosts import NotRun, open_host
from mxeon.library import VERSIONS, examples_folder, load_library
from mxeon.results import PASSED

HERE = mx.getVersionString()
EXAMPLE = str(examples_folder() / "plaster.mtlx")
KNOWN = f"materialx must be one of {', '.join(VERSIONS)}; got '1.39.2'"


@pytest.fixture
def environments(tmp_path, monkeypatch):
    """A place for environments where the MaterialX that is here stands ready."""
    monkeypatch.setenv("MXEON_ENVIRONMENTS", str(tmp_path))
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    ready = tmp_path / f"materialx-{HERE}-{python}"
    ready.mkdir()
    (ready / "MaterialX").symlink_to(mx.__path__[0])
    return tmp_path


@pytest.mark.parametrize("version", ["1.38.10", "1.39.2", "1.39.6", "1.40.0"])
def test_a_version_with_another_interface_is_refused(monkeypatch, capsys, version):
    monkeypatch.setattr(mx, "getVersionString", lambda: version)
    with pytest.raises(ImportError, match=f"MaterialX must be one of .*; got {version}: pip"):
        load_library.__wrapped__("stock")
    assert main(["check", EXAMPLE]) == 2
    assert capsys.readouterr().err.startswith("mxeon: MaterialX must be one of ")


def test_an_unknown_version_lists_the_known_ones(environments, capsys):
    assert main(["check", EXAMPLE, "--materialx", "1.39.2"]) == 2
    assert capsys.readouterr().err == f"mxeon: {KNOWN}\n"


def test_a_version_that_cannot_be_installed_is_not_run_and_leaves_nothing(environments, monkeypatch):
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    before = set(environments.iterdir())
    other = next(version for version in VERSIONS if version != HERE)
    with pytest.raises(NotRun, match=f"^MaterialX {other}: pip cannot install it; ") as error:
        versions.environment(other)
    assert "\n" not in str(error.value)
    assert [path.suffix for path in set(environments.iterdir()) - before] == [".lock"]


def test_a_folder_that_holds_a_pip_installs_nothing_and_is_not_imported(tmp_path, monkeypatch):
    (tmp_path / "pip.py").write_text("open('RAN', 'w')")
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.chdir(tmp_path)
    with pytest.raises(NotRun, match="pip cannot install it"):
        versions.install(HERE, tmp_path / "new")
    assert not (tmp_path / "RAN").exists()


def test_a_run_with_another_version_is_the_run_of_that_version(environments, tmp_path):
    run = versions.check([HERE], [EXAMPLE], tmp_path / "report")
    assert {each.library for each in run.results} == {f"eonlib, MaterialX {HERE}"}
    assert {each.verdict for each in run.results} == {PASSED}
    assert run.software["MaterialX"] == HERE and not run.missing
    assert [each.figure for each in run.results] == [each.figure for each in check([EXAMPLE]).results]


def test_a_refused_document_costs_itself_alone_and_the_report_can_be_made_again(
    environments, tmp_path, capsys
):
    wrong = tmp_path / "wrong.mtlx"
    wrong.write_text("<materialx")
    report = str(tmp_path / "report")
    assert main(["check", EXAMPLE, str(wrong), "--materialx", HERE, "--report", report]) == 2
    assert f"MaterialX {HERE}: {wrong}: must be a MaterialX document" in capsys.readouterr().err
    assert main(["report", "make", report, "--json"]) == 2
    assert f"eonlib, MaterialX {HERE}" in capsys.readouterr().out


def test_runs_of_two_versions_become_one():
    run = check([EXAMPLE])
    both = versions.merged({"1.39.4": run, "1.39.5": run})
    assert len(both.results) == 2 * len(run.results) and both.hosts == run.hosts
    assert both.software["MaterialX"] == "1.39.4, 1.39.5"
    assert {picture.library for picture in both.pictures} == {
        "eonlib, MaterialX 1.39.4",
        "eonlib, MaterialX 1.39.5",
    }


def test_what_is_refused_with_a_version_is_refused_here(environments, tmp_path):
    with pytest.raises(ValueError, match=f"^MaterialX {HERE}: host must be one of .*; got 'none'"):
        versions.check([HERE], [EXAMPLE, "--host", "none"], tmp_path / "report")


def test_a_host_whose_target_this_version_lacks_is_not_run(monkeypatch):
    targets = tuple(target for target in generation.TARGETS if target != "slang")
    monkeypatch.setattr(hosts, "TARGETS", targets)
    with pytest.raises(NotRun, match="slang: MaterialX must have a generator for slang; .* none: pip"):
        open_host("slang")
