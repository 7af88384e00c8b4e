# SPDX-License-Identifier: Apache-2.0
"""Files are written completely or not at all, even if the disk is full."""

import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.io.files import write_text
from mxeon.io.images import write_image
from tests.support.faults import room_for

NOISE = np.random.default_rng(1).random((33, 33, 3))
IMAGES = {".exr": np.float32(NOISE), ".png": np.uint8(255.0 * NOISE)}
# Room on the disk in bytes: none, less than a header, half of the file, and all but one byte.
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
