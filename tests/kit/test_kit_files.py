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
from tests.kit.conftest import (
    SIZE,
    read,
    render,
    result_of,
    spoiled,
    write_kit,
)


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


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_numbers_that_are_not_finite_are_refused(kit, value):
    result = spoiled(kit, "true_side", planted(value))
    assert result.verdict == "failed"
    assert "must be finite numbers" in result.diagnosis and "row 32, column 32" in result.diagnosis


def test_a_wrong_size_is_refused(kit):
    result = spoiled(kit, "true_side", lambda image: image[:32])
    assert result.diagnosis == "true_side.exr: must be 64 x 64 pixels; got 64 x 32"


def test_eight_bits_in_a_float_file_are_refused(kit):
    result = spoiled(kit, "true_side", lambda image: np.rint(image * 255.0) / 255.0)
    assert "never rounded to eight bits" in result.diagnosis


def test_one_bright_pixel_does_not_look_like_eight_bits(kit):
    write_exr(render(kit, "true_side"), planted(3e38)(read(render(kit, "true_side"))), {})
    assert not [each for each in check_kit(kit).results if each.check == "file"]


def test_a_damaged_picture_costs_no_other(kit):
    path = render(kit, "true_side")
    path.write_bytes(path.read_bytes().replace(b"\0chlist\0", b"\0\xffhlist\0", 1))
    run = check_kit(kit)
    assert r"\xffhlist" in result_of(run, "file", "true_side").diagnosis
    assert [each.check for each in run.results].count("file") == 1


def test_an_eight_bit_file_is_refused(kit):
    render(kit, "true_side").unlink()
    path = kit / "renders" / "true_side.png"
    image = oiio.ImageBuf(oiio.ImageSpec(SIZE, SIZE, 3, oiio.UINT8))
    assert image.write(str(path))
    assert "got uint8" in result_of(check_kit(kit), "file", "true_side").diagnosis


def test_two_files_of_a_name_are_refused(kit):
    (kit / "renders" / "true_side.csv").write_text("")
    assert "must be one file" in result_of(check_kit(kit), "file", "true_side").diagnosis


def test_a_file_that_is_no_image_is_refused(kit):
    render(kit, "true_side").write_text("nothing")
    assert "must be an EXR or CSV file" in result_of(check_kit(kit), "file", "true_side").diagnosis


def write_channels(kit, name, image, names, **place):
    spec = oiio.ImageSpec(SIZE, SIZE, len(names), oiio.FLOAT)
    spec.channelnames = names
    for attribute, value in place.items():
        setattr(spec, attribute, value)
    file = oiio.ImageOutput.create(str(render(kit, name)))
    assert file.open(str(render(kit, name)), spec) and file.write_image(image)
    file.close()


def test_red_green_and_blue_are_found_by_name(kit):
    image = read(render(kit, "true_side"))
    layers = np.concatenate([np.ones_like(image), image[..., ::-1]], axis=-1, dtype=np.float32)
    names = [f"depth.{each}" for each in "XYZ"] + [f"beauty.{each}" for each in "BGR"]
    write_channels(kit, "true_side", layers, names)
    assert {result.verdict for result in check_kit(kit).results} == {"passed"}


@pytest.mark.parametrize("names", ["XYZ", ["a.R", "a.G", "a.B", "b.R", "b.G", "b.B"]])
def test_channels_that_are_no_one_red_green_and_blue_are_refused(kit, names):
    image = np.ones((SIZE, SIZE, len(names)), dtype=np.float32)
    write_channels(kit, "true_side", image, list(names))
    message = result_of(check_kit(kit), "file", "true_side").diagnosis
    assert f"must hold one R, G and B; got channels {', '.join(names)}" in message


def test_a_picture_beside_its_place_is_refused(kit):
    image = read(render(kit, "true_side")).astype(np.float32)
    write_channels(kit, "true_side", image, list("RGB"), x=5, y=9)
    message = result_of(check_kit(kit), "file", "true_side").diagnosis
    assert "must begin at the display window's corner; got (5, 9)" in message


def test_half_a_file_is_refused(kit):
    path = render(kit, "true_side")
    path.write_bytes(path.read_bytes()[:900])
    assert "true_side.exr: must be" in result_of(check_kit(kit), "file", "true_side").diagnosis


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


def test_values_may_come_as_csv(kit):
    as_csv(kit, "true_side")
    assert {result.verdict for result in check_kit(kit).results} == {"passed"}


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("row,column", "x,y", "must begin with row,column,red,green,blue; got x,y"),
        ("5,5,", "64,5,", "must hold row and column of a pixel, of 64 x 64"),
        ("5,5,", "-59,5,", "must hold row and column of a pixel, of 64 x 64"),
        ("5,5,", "5,5,none,", "and three numbers"),
        ("32,32,", "31,32,", "that no line before it has"),
        ("32,32,.*\n", "", "must be finite numbers"),
        ("5,5,", f"5,5,{'9' * 200_000},", "must be CSV in UTF-8; field larger"),
    ],
)
def test_a_wrong_csv_is_refused(kit, old, new, message):
    path = as_csv(kit, "true_side")
    path.write_text(re.sub(f"(?m)^{old}", new, path.read_text(), count=1))
    assert message in result_of(check_kit(kit), "file", "true_side").diagnosis


def test_csv_may_have_a_byte_order_mark_and_empty_lines(kit):
    path = as_csv(kit, "true_side")
    path.write_text("\ufeff" + path.read_text() + "\n\n", encoding="utf-8")
    assert {result.verdict for result in check_kit(kit).results} == {"passed"}


@pytest.mark.parametrize("data", [b"", b"row\xff", "row".encode("utf-16")])
def test_csv_that_is_none_costs_its_picture_alone(kit, data):
    as_csv(kit, "true_side").write_bytes(data)
    run = check_kit(kit)
    assert "true_side.csv: must be" in result_of(run, "file", "true_side").diagnosis
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


@pytest.mark.parametrize("suffix", [".exr", ".csv"])
@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir], ids=["pipe", "folder"])
def test_what_is_no_regular_file_is_no_picture(kit, suffix, make):
    render(kit, "true_side").unlink()
    make(render(kit, "true_side").with_suffix(suffix))
    assert "; not a regular file" in result_of(check_kit(kit), "file", "true_side").diagnosis


def test_a_pipe_in_place_of_a_description_blocks_nobody(tmp_path):
    os.mkfifo(tmp_path / "kit.json")
    with pytest.raises(
        ValueError, match="kit.json: must be a kit's description; not a regular file"
    ):
        check_kit(tmp_path)
