# SPDX-License-Identifier: Apache-2.0
"""Images are read in the correct orientation or refused in one line; sRGB is decoded exactly."""

import os

import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.cli import main
from mxeon.errors import MISUSE, PASSED, ImageError
from mxeon.hosts.textures import read_latlong, read_texture
from mxeon.io.images import ImageWarning, read_image, write_image
from mxeon.io.srgb import srgb_decoded, srgb_encoded
from tests.support.documents import textured, written

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
    path = tmp_path / "a.exr"
    if make:
        make(path)
    reason = "not a regular file" if make else "No such file or directory"
    with pytest.raises(ImageError, match=f"a.exr: must be an image file; {reason}$"):
        read_image(path)


def test_a_picture_that_is_cut_and_still_read_is_told(tmp_path):
    path = tmp_path / "a.jpg"
    codes = np.arange(64 * 64 * 3, dtype=np.uint32).astype(np.uint8).reshape(64, 64, 3)
    assert oiio.ImageBuf(codes).write(str(path))  # JPEG is lossy, so pixels are not compared
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


# Image files of a document, with 4 x 2 pixels each, and the number of pixels that count.
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
    assert capsys.readouterr().err == (
        f"mxeon: {document}: images must have at most {texels - 1} pixels together; "
        f"got {texels}: raise it with --maxTexels\n"
    )
    if "check" not in command:
        assert main([*line, "--maxTexels", str(texels)]) == PASSED


def test_the_codes_of_srgb_are_decoded_to_what_was_encoded():
    codes = np.arange(256).repeat(3).reshape(256, 3)
    assert np.array_equal(srgb_encoded(srgb_decoded(codes / 255.0)), codes)
