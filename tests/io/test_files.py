# SPDX-License-Identifier: Apache-2.0
"""Files are written completely or not at all. Images are read upright or refused."""

import os

import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.cli import main
from mxeon.errors import MISUSE, PASSED, ImageError
from mxeon.hosts.textures import irradiance, read_latlong, read_texture
from mxeon.io.files import write_text
from mxeon.io.images import ImageWarning, read_image, write_image
from mxeon.io.srgb import srgb_decoded, srgb_encoded
from tests.support.documents import textured, written
from tests.support.faults import room_for

PIXELS = np.arange(24.0, dtype=np.float32).reshape(2, 4, 3)


def test_row_0_is_at_the_top(tmp_path):
    write_image(tmp_path / "a.exr", PIXELS, {})
    assert read_image(tmp_path / "a.exr")[0, 0].tolist() == [0.0, 1.0, 2.0]


@pytest.mark.parametrize("name, data", [("text.exr", b"text"), ("a.txt", b"text")])
def test_a_file_that_is_no_image_is_refused_with_its_name_in_one_line(tmp_path, name, data):
    (tmp_path / name).write_bytes(data)
    rule = f"{name}: must be an image that OpenImageIO reads; ."
    with pytest.raises(ImageError, match=rule) as error:
        read_image(tmp_path / name)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("make", [os.mkfifo, os.mkdir, None], ids=["pipe", "folder", "none"])
def test_a_file_that_is_not_regular_is_refused_and_blocks_nobody(tmp_path, make):
    path = tmp_path / "a; b.exr"
    if make:
        make(path)
    reason = "not a regular file" if make else "No such file or directory"
    with pytest.raises(ImageError, match=f"b.exr: must be an image file; {reason}$") as error:
        read_image(path)
    assert error.value.reason == reason


def test_a_picture_that_is_cut_and_still_read_is_told(tmp_path):
    path = tmp_path / "a.jpg"
    codes = np.arange(64 * 64 * 3, dtype=np.uint32).astype(np.uint8).reshape(64, 64, 3)
    assert oiio.ImageBuf(codes).write(str(path))  # pixels are not compared, because JPEG is lossy
    path.write_bytes(path.read_bytes()[:-100])
    with pytest.warns(ImageWarning, match="a.jpg: is damaged; JPEG error: Premature end"):
        assert read_image(path).shape == (64, 64, 3)


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_an_environment_that_is_not_finite_is_refused_and_a_texture_is_told(tmp_path, value):
    path = tmp_path / "a.exr"
    pixels = PIXELS.copy()
    pixels[1, 2, 0] = value
    write_image(path, pixels, {})
    reason = f"a.exr: (must|should) hold finite numbers; got {value} at row 1, column 2, 1 in all"
    with pytest.raises(ImageError, match=reason):
        read_latlong(path)
    with pytest.warns(ImageWarning, match=reason):
        read_texture(path)


# Image files that a document names, each with 4 x 2 pixels, and the number of pixels that count
# towards the limit.
TOGETHER = {"one": (["a.exr"], 8), "two": (["a.exr", "b.exr"], 16), "same": (["a.exr"] * 3, 8)}


@pytest.mark.parametrize("command", (["render", "--size", "4"], ["explore"], ["check"]))
@pytest.mark.parametrize("files, texels", TOGETHER.values(), ids=TOGETHER)
def test_images_of_a_document_have_a_limit_together(tmp_path, capsys, command, files, texels):
    for name in set(files):
        write_image(tmp_path / name, PIXELS / 96.0, {})
    document = written(tmp_path, textured(files))
    host = [] if "explore" in command else ["--host", "reference" if "render" in command else "gl"]
    output = ["--output", str(tmp_path / ("o.html" if "explore" in command else "o.exr"))]
    line = [*command, str(document), "--workers", "0", *host]
    line += output if "check" not in command else []
    assert main([*line, "--maxTexels", str(texels - 1)]) == MISUSE
    rule = f"at most {texels - 1} pixels together; got {texels}: raise it with --maxTexels"
    assert capsys.readouterr().err == f"mxeon: {document}: images must have {rule}\n"
    if "check" not in command:
        assert main([*line, "--maxTexels", str(texels)]) == PASSED


def test_the_codes_of_srgb_are_decoded_to_what_was_encoded():
    codes = np.arange(256).repeat(3).reshape(256, 3)
    assert np.array_equal(srgb_encoded(srgb_decoded(codes / 255.0)), codes)


# Ten times the error h^2 / 12 of the midpoint rule for a cosine on 64 x 128 pixels. A pixel spans
# the angle h = pi / 64.
SUM = 10.0 * (np.pi / 64.0) ** 2 / 12.0


def test_an_environment_without_colors_is_refused(tmp_path):
    path = tmp_path / "gray.exr"
    oiio.ImageBuf(np.ones((4, 8, 1), np.float32)).write(str(path))
    with pytest.raises(ValueError, match="gray.exr: must have red, green and blue; got 1 channels"):
        read_latlong(path)


@pytest.mark.parametrize("shape", [(64, 128), (128, 256), (640, 5), (3, 700)])
def test_a_sky_over_a_black_ground_lights_what_faces_it(shape):
    rows, columns = shape
    radiance = np.zeros((rows, columns, 3), dtype=np.float32)
    radiance[: rows // 2] = 1.0
    found = irradiance(radiance)
    assert found.shape == (32, 64, 3) and np.isfinite(found).all()
    assert found[0].min() > found[-1].max()
    if rows % 2 == 0 and rows < 640:  # the exact irradiance is (1 + cos(theta)) / 2
        polar = np.pi * (np.arange(32) + 0.5) / 32
        expected = 0.5 * (1.0 + np.cos(polar))
        np.testing.assert_allclose(found[:, 0, 0], expected, rtol=0.0, atol=SUM)


NOISE = np.random.default_rng(1).random((33, 33, 3))
IMAGES = {".exr": np.float32(NOISE), ".png": np.uint8(255.0 * NOISE)}
# Free disk space in bytes, as a function of the size of the file to write.
ROOM = {
    "nothing": lambda size: 0,
    "little": lambda size: 100,
    "half": lambda size: size // 2,
    "nearly all": lambda size: size - 1,
}

with_room = pytest.mark.parametrize("room", ROOM.values(), ids=ROOM)


def files(folder):
    return sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())


@with_room
@pytest.mark.parametrize("ending", IMAGES)
@pytest.mark.parametrize("side", [2, 33])
def test_an_image_that_finds_no_room_is_an_error_and_nothing_stays(
    tmp_path, capfd, ending, side, room
):
    path, pixels = tmp_path / f"a{ending}", np.ascontiguousarray(IMAGES[ending][:side, :side])
    write_image(path, pixels, {})
    size = path.stat().st_size
    path.unlink()
    with room_for(room(size)), pytest.raises(OSError) as error:
        write_image(path, pixels, {})
    assert error.value.filename == str(path) and ".mxeon" not in error.value.strerror
    assert not files(tmp_path) and capfd.readouterr() == ("", "")


@pytest.mark.parametrize("ending", IMAGES)
def test_an_image_is_kept_as_it_is(tmp_path, ending):
    pixels = IMAGES[ending].copy()
    if ending == ".exr":
        pixels[0, 0] = np.nan, np.inf, -0.0
    write_image(tmp_path / f"a{ending}", pixels, {"mxeon:host": "gl"})
    image = oiio.ImageInput.open(str(tmp_path / f"a{ending}"))
    assert image.read_image(oiio.UNKNOWN).tobytes() == pixels.tobytes()
    assert image.spec().get_string_attribute("mxeon:host") == "gl"


def test_text_that_finds_no_room_leaves_the_old_file(tmp_path):
    write_text(tmp_path / "a", "old")
    with room_for(100), pytest.raises(OSError, match="File too large"):
        write_text(tmp_path / "a", "new" * 100)
    assert (tmp_path / "a").read_text() == "old" and files(tmp_path) == ["a"]


@pytest.mark.parametrize("planted", ["link", "file"])
def test_a_temporary_name_that_exists_is_neither_followed_nor_replaced(
    tmp_path, monkeypatch, planted
):
    monkeypatch.setattr("mxeon.io.files.token_hex", lambda _: "guessed")
    other, beside = tmp_path / "other", tmp_path / ".mxeon-guessed.txt"
    other.write_text("mine")
    beside.symlink_to(other) if planted == "link" else beside.write_text("mine")
    with pytest.raises(FileExistsError):
        write_text(tmp_path / "a.txt", "text")
    assert other.read_text() == "mine" and not (tmp_path / "a.txt").exists()
