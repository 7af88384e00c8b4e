# SPDX-License-Identifier: Apache-2.0
"""Files of a kit that are missing, damaged or of another form: each costs itself alone."""

import json
import os
import re
import sys

import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.cli import main
from mxeon.errors import MISUSE, PASSED
from mxeon.io.images import write_exr
from mxeon.kit.check import check_kit
from tests.kit.conftest import SIZE, read, render, result_of, write_kit


def test_a_kit_without_pictures_is_one_line(tmp_path, capsys):
    write_kit(tmp_path)
    assert main(["kit", "check", str(tmp_path)]) == 3
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.count("\n") == 1
    assert "none of the 12 pictures is there" in printed.err


def test_a_missing_picture_is_not_run(kit):
    render(kit, "true_back").unlink()
    run = check_kit(kit)
    assert "true_back.exr: must be in" in result_of(run, "file", "true_back").reason
    assert result_of(run, "model", "energy_compensation true, distant").verdict == "not run"


def planted(value):
    def change(image):
        image = image.copy()
        image[SIZE // 2, SIZE // 2, 1] = value
        return image

    return change


def changed(change):
    """What writes a picture again with other pixels."""
    return lambda path: write_exr(path, change(read(path)), {})


def replaced(change):
    """What writes the bytes of a picture again."""
    return lambda path: path.write_bytes(change(path.read_bytes()))


def write_channels(path, image, names, **place):
    spec = oiio.ImageSpec(SIZE, SIZE, len(names), oiio.FLOAT)
    spec.channelnames = list(names)
    for attribute, value in place.items():
        setattr(spec, attribute, value)
    file = oiio.ImageOutput.create(str(path))
    assert file.open(str(path), spec) and file.write_image(image)
    file.close()


def channels(*names, **place):
    """What writes a picture of ones with these channels."""
    ones = np.ones((SIZE, SIZE, len(names)), dtype=np.float32)
    return lambda path: write_channels(path, ones, names, **place)


def write_png(path):
    path.unlink()
    image = oiio.ImageBuf(oiio.ImageSpec(SIZE, SIZE, 3, oiio.UINT8))
    assert image.write(str(path.with_suffix(".png")))


LAYERS = ("a.R", "a.G", "a.B", "b.R", "b.G", "b.B")
SPOILED = {  # picture: what makes it unusable, and how that is diagnosed
    "true_front": (changed(planted(np.nan)), "must be finite numbers; got .* row 32, column 32"),
    "true_side": (changed(lambda image: image[:32]), "must be 64 x 64 pixels; got 64 x 32"),
    "true_back": (
        changed(lambda image: np.rint(image * 255.0) / 255.0),
        "never rounded to eight bits",
    ),
    "true_furnace": (
        replaced(lambda data: data.replace(b"\0chlist\0", b"\0\xffhlist\0", 1)),
        r"\\xffhlist",
    ),
    "half_side": (write_png, "got uint8"),
    "false_front": (lambda path: path.with_suffix(".csv").write_text(""), "must be one file"),
    "false_side": (lambda path: path.write_text("nothing"), "must be an EXR or CSV file"),
    "false_back": (channels(*"XYZ"), "must hold one R, G and B; got channels X, Y, Z"),
    "false_furnace": (channels(*LAYERS), f"one R, G and B; got channels {', '.join(LAYERS)}"),
    "black_side": (channels(*"RGB", x=5, y=9), r"display window's corner; got \(5, 9\)"),
    "white_furnace": (replaced(lambda data: data[:900]), "must be"),
}


def test_each_unusable_picture_costs_itself_alone_and_is_diagnosed(kit):
    for name, (spoil, _) in SPOILED.items():
        spoil(render(kit, name))
    run = check_kit(kit)
    for name, (_, words) in SPOILED.items():
        result = result_of(run, "file", name)
        assert result.verdict == "failed" and re.search(f"{name}.*{words}", result.diagnosis)
    assert [each.check for each in run.results].count("file") == len(SPOILED)
    assert result_of(run, "setup", "lambert").verdict == "passed"


def test_one_bright_pixel_does_not_look_like_eight_bits(kit):
    changed(planted(3e38))(render(kit, "true_side"))
    assert not [each for each in check_kit(kit).results if each.check == "file"]


def test_red_green_and_blue_are_found_by_name(kit):
    image = read(render(kit, "true_side"))
    layers = np.concatenate([np.ones_like(image), image[..., ::-1]], axis=-1, dtype=np.float32)
    names = [f"depth.{each}" for each in "XYZ"] + [f"beauty.{each}" for each in "BGR"]
    write_channels(render(kit, "true_side"), layers, names)
    assert {result.verdict for result in check_kit(kit).results} == {"passed"}


@pytest.mark.parametrize("renderer", ["", " ", "two\nlines", "\x1b[31m", "\udcff"])
def test_a_renderer_has_a_name_that_can_be_printed(kit, renderer):
    with pytest.raises(ValueError, match="renderer must be a name on one line"):
        check_kit(kit, renderer)


def as_csv(kit, name):
    image = read(render(kit, name))
    rows = [",".join(map(str, (*place, *image[place]))) for place in np.ndindex(SIZE, SIZE)]
    render(kit, name).unlink()
    path = kit / "renders" / f"{name}.csv"
    path.write_text("\n".join(["row,column,red,green,blue", *rows]) + "\n")
    return path


def test_values_may_come_as_csv_with_a_byte_order_mark_and_empty_lines(kit):
    as_csv(kit, "true_front")
    path = as_csv(kit, "true_side")
    path.write_text("\ufeff" + path.read_text() + "\n\n", encoding="utf-8")
    assert {result.verdict for result in check_kit(kit).results} == {"passed"}


WRONG_CSV = {  # picture: the lines that begin so, what they become, and the diagnosis
    "true_front": ("row,column", "x,y", "must begin with row,column,red,green,blue; got x,y"),
    "true_side": ("5,5,", "64,5,", "must hold row and column of a pixel, of 64 x 64"),
    "true_back": ("5,5,", "-59,5,", "must hold row and column of a pixel, of 64 x 64"),
    "true_furnace": ("5,5,", "5,5,none,", "and three numbers"),
    "half_side": ("32,32,", "31,32,", "that no line before it has"),
    "false_front": ("32,32,.*\n", "", "must be finite numbers"),
    "false_side": ("5,5,", f"5,5,{'9' * 200_000},", "must be CSV in UTF-8; field larger"),
}
NO_CSV = {"false_back": b"", "false_furnace": b"row\xff", "black_side": "row".encode("utf-16")}


def test_each_wrong_csv_costs_its_picture_alone_and_is_diagnosed(kit):
    for name, (old, new, _) in WRONG_CSV.items():
        path = as_csv(kit, name)
        path.write_text(re.sub(f"(?m)^{old}", new, path.read_text(), count=1))
    for name, data in NO_CSV.items():
        as_csv(kit, name).write_bytes(data)
    run = check_kit(kit)
    for name, (_, _, words) in WRONG_CSV.items():
        assert words in result_of(run, "file", name).diagnosis
    for name in NO_CSV:
        assert f"{name}.csv: must be" in result_of(run, "file", name).diagnosis
    assert result_of(run, "setup", "lambert").verdict == "passed"


def test_what_the_check_lacks_is_said_with_the_export_and_before_the_pictures(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.setitem(sys.modules, "scipy.special", None)
    said = "kit check needs scipy: pip install '.[kit]' in a checkout of mxeon\n"
    assert main(["kit", "export", str(tmp_path), "--size", "64"]) == PASSED
    assert capsys.readouterr().err == f"mxeon: warning: {said}"
    assert main(["kit", "check", str(tmp_path)]) == MISUSE
    assert capsys.readouterr().err == f"mxeon: {said}"


def test_a_folder_that_is_no_kit_is_refused(tmp_path, capsys):
    assert main(["kit", "check", str(tmp_path)]) == 2
    assert "folder must hold kit.json" in capsys.readouterr().err


@pytest.mark.parametrize(
    "text", ["", "[]", "{}", '{"format": 0, "size": 64}', '{"format": 1, "size": "64"}', 9999 * "["]
)
def test_a_description_of_another_format_is_refused(tmp_path, text):
    (tmp_path / "kit.json").write_text(text)
    with pytest.raises(ValueError, match="must be"):
        check_kit(tmp_path)


@pytest.mark.parametrize(
    "key, value, words",
    [
        ("format", True, "format must be 1; got True"),
        ("format", 1.0, "format must be 1; got 1.0"),
        ("size", None, "size must be a whole number; got None"),
        ("size", 64.0, "size must be a whole number; got 64.0"),
        ("size", True, "size must be a whole number; got True"),
        ("size", 10**400, r"size must lie in \[64, 2048\]"),
        ("size", -1, r"size must lie in \[64, 2048\]"),
        ("camera", {}, "camera must be as kit export writes it: export it again"),
        ("sphere", None, "sphere must be as kit export writes it"),
        ("materials", {"clay": 1}, "materials must be as kit export writes it"),
        ("pictures", [3], "pictures must be as kit export writes it"),
    ],
)
def test_an_edited_description_is_refused(tmp_path, capsys, key, value, words):
    write_kit(tmp_path)
    content = json.loads((tmp_path / "kit.json").read_text())
    (tmp_path / "kit.json").write_text(json.dumps(content | {key: value}))
    assert main(["kit", "check", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert re.search(f"kit.json: {words}", error) and error.count("\n") == 1


def test_what_is_no_regular_file_is_no_picture(kit):
    cases = {
        "true_front": (".exr", os.mkfifo),
        "true_side": (".csv", os.mkfifo),
        "true_back": (".exr", os.mkdir),
        "half_side": (".csv", os.mkdir),
    }
    for name, (suffix, make) in cases.items():
        render(kit, name).unlink()
        make(render(kit, name).with_suffix(suffix))
    run = check_kit(kit)
    for name in cases:
        assert "; not a regular file" in result_of(run, "file", name).diagnosis


def test_a_pipe_in_place_of_a_description_blocks_nobody(tmp_path):
    os.mkfifo(tmp_path / "kit.json")
    with pytest.raises(
        ValueError, match="kit.json: must be a kit's description; not a regular file"
    ):
        check_kit(tmp_path)
