# SPDX-License-Identifier: Apache-2.0
"""Outputs that would replace what is read, or files that nobody named."""

import pytest

from mxeon.cli import main
from mxeon.errors import MISUSE
from tests.support.documents import lobe, material


@pytest.mark.parametrize(
    "arguments", (["explore"], ["doc"], ["render", "--host", "gl"]), ids=lambda each: each[0]
)
@pytest.mark.parametrize("output", ("same", "link"))
def test_an_output_that_is_the_input_is_refused(arguments, output, tmp_path, capsys):
    file, link = tmp_path / "same.exr", tmp_path / "link.exr"
    file.write_text("text")
    link.symlink_to(file)
    assert main([*arguments, str(file), "--output", str(tmp_path / f"{output}.exr")]) == MISUSE
    assert "output must be another file" in capsys.readouterr().err
    assert file.read_text() == "text"


def test_a_kit_is_written_over_a_kit_alone(tmp_path, monkeypatch, capsys):
    (tmp_path / "README.md").write_text("mine")
    monkeypatch.chdir(tmp_path)
    for folder in (".", ""):
        assert main(["kit", "export", folder]) == MISUSE
    assert "must be new, empty or a kit" in capsys.readouterr().err
    assert [each.name for each in tmp_path.iterdir()] == ["README.md"]


def generated(folder):
    """Generate a shader into a folder; return the exit status."""
    file = folder.parent / "a.mtlx"
    file.write_text(material(lobe(roughness=0.5)))
    return main(
        ["generate", str(file), "--target", "osl", "--workers", "0", "--outputPath", str(folder)]
    )


def checked(folder):
    """Check that shader's text with a report in a folder; return the exit status."""
    file = folder.parent / "a.mtlx"
    file.write_text(material(lobe(roughness=0.5)))
    return main(["check", str(file), "--host", "msl", "--workers", "0", "--report", str(folder)])


def exported(folder):
    """Export a kit into a folder; return the exit status."""
    return main(["kit", "export", str(folder), "--size", "64"])


# What writes a folder that it was told, and names in it under which a link may lie.
FOLDERS = {
    "generate": (generated, ("a.look.osl",)),
    "kit export": (exported, ("kit.json", "README.md", "sphere.obj", "materials", "renders")),
    "check --report": (
        checked,
        ("results.json", "junit.xml", "report.html", "journal", "journal/items.jsonl", ".journal.lock"),
    ),
}  # fmt: skip


LINKS = [(command, name, False) for command, (_, names) in FOLDERS.items() for name in names]
LINKS += [(command, names[0], True) for command, (_, names) in FOLDERS.items()]


@pytest.mark.parametrize("command, name, dangling", LINKS)
def test_nothing_is_written_through_a_link_in_a_folder(command, name, dangling, tmp_path, capsys):
    write, _ = FOLDERS[command]
    other, link, folder = tmp_path / "other", tmp_path / "out" / name, tmp_path / "out"
    write(folder)
    assert link.exists()
    link.rename(tmp_path / "moved")
    link.symlink_to(other)
    if not dangling:
        other.write_text("mine")
    capsys.readouterr()
    assert write(folder) == MISUSE
    assert capsys.readouterr().err == (
        f"mxeon: {link}: must not be a link, which leads to another file; remove it\n"
    )
    assert other.exists() is not dangling and (dangling or other.read_text() == "mine")


def test_a_folder_that_is_a_link_is_written_to(tmp_path):
    (tmp_path / "there").mkdir()
    (tmp_path / "out").symlink_to("there")
    assert generated(tmp_path / "out") == 0 and (tmp_path / "there" / "a.look.osl").exists()
