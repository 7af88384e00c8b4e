# SPDX-License-Identifier: Apache-2.0
"""Images that are small files and much work: what a document with them costs, in seconds and memory."""

import os
import struct
import subprocess
import sys
import tempfile
import zlib
from functools import cache
from itertools import product
from pathlib import Path

import numpy as np
import OpenImageIO as oiio

from tests.support.documents import textured

SECONDS, MEBIBYTES = 15.0, 2816  # of a processor, and of memory, as docs/security.md has them
LARGEST_PAGE = 32 * 2**20  # bytes
BIT, RGB = (1, 0, 1), (8, 2, 24)  # bits and kind of color of a PNG file, and bits of a pixel
SIDE = 8192  # of an image that has as many pixels as a document may have
# Images by name, of zeros or of NaN: width, height, and what they hold.
IMAGES = {
    "bit": (SIDE, SIDE, BIT),
    "rgb": (SIDE, SIDE, RGB),
    **{f"quarter{number}": (SIDE // 2, SIDE // 2, RGB) for number in range(4)},
    **{f"bomb{number}": (2 * SIDE, 2 * SIDE, BIT) for number in range(4)},
    "line": (SIDE**2 - 1, 1, BIT),
    "column": (8, SIDE**2 // 8, BIT),
    "nan": (SIDE, SIDE, ("R", "G", "B")),
    "deep": (1024, 1024, tuple(f"c{number}" for number in range(150))),
    **{f"small{number}": (256, 256, RGB) for number in range(300)},
}
SMALL = [f"small{number}" for number in range(300)]
# Images whose sum is the color of a document's material.
DOCUMENTS = {
    "bit": ["bit"],
    "rgb": ["rgb"],
    "four": [f"quarter{number}" for number in range(4)],
    "eight uses": ["rgb"] * 8,
    "nan": ["nan"],
    "line": ["line"],
    "column": ["column"],
    "deep": ["deep"],
    "one bomb": ["bomb0"],
    "four bombs": [f"bomb{number}" for number in range(4)],
    "600 uses": ["small0"] * 600,
    "300 images": SMALL,
}
COMMANDS = {
    "render": ("--host", "gl", "--size", "16", "--output", "out.png"),
    "explore": ("--output", "out.html"),
    "check": ("--host", "gl"),
}


def rows():
    """Commands and documents; of `check`, which judges nodes for a minute besides, a few."""
    yield from product(("render", "explore"), DOCUMENTS)
    yield from product(["check"], ("rgb", "four bombs"))


def weighed(row):
    """Exit status of a command on such a document, what was wrong, its seconds and mebibytes."""
    command, name = row
    with tempfile.TemporaryDirectory(prefix="mxeon-bombs-") as folder:
        document, files = Path(folder, "a.mtlx"), [_image(each) for each in DOCUMENTS[name]]
        for file in set(files):
            Path(folder, file.name).hardlink_to(file)
        document.write_text(textured([file.name for file in files]))
        process = subprocess.Popen(
            [sys.executable, "-P", "-m", "mxeon", command, str(document), *COMMANDS[command]]
            + ["--workers", "1"],
            cwd=folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        errors = process.stderr.read()
        _, status, usage = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        page = Path(folder, "out.html")
        size = page.stat().st_size if page.exists() else 0
    seconds, mebibytes = usage.ru_utime + usage.ru_stime, usage.ru_maxrss // 1024
    faults = [f"said {line!r}" for line in errors.splitlines() if not line.startswith("mxeon: ")]
    faults += [f"ended with {process.returncode}"] * (process.returncode not in (0, 1, 2, 3))
    if command == "check":
        seconds = 0.0
    faults += [f"took {seconds:.1f} s"] * (seconds > SECONDS)
    faults += [f"took {mebibytes} MiB"] * (mebibytes > MEBIBYTES)
    faults += [f"wrote {size} bytes"] * (size > LARGEST_PAGE)
    return process.returncode, "; ".join(faults), seconds, mebibytes


@cache
def _folder():
    return tempfile.TemporaryDirectory(prefix="mxeon-bombs-")


@cache
def _image(name):
    """Path of an image, made once in a process."""
    width, height, form = IMAGES[name]
    if form in (BIT, RGB):
        path = Path(_folder().name, f"{name}.png")
        path.write_bytes(_png(width, height, form))
        return path
    path = Path(_folder().name, f"{name}.exr")
    spec = oiio.ImageSpec(width, height, len(form), oiio.HALF)
    spec.channelnames = form
    spec.attribute("compression", "zip")
    file = oiio.ImageOutput.create(str(path))
    file.open(str(path), spec)
    rows = np.full((16, width, len(form)), np.nan, np.float32)
    for row in range(0, height, 16):
        file.write_scanlines(row, row + 16, 0, rows)
    file.close()
    return path


def _png(width, height, form):
    """A PNG file of zeros, whose rows are compressed one by one."""
    depth, kind, bits = form
    row = bytes(1 + (width * bits + 7) // 8)
    press = zlib.compressobj(1)
    data = b"".join(press.compress(row) for _ in range(height)) + press.flush()
    header = struct.pack(">IIBBBBB", width, height, depth, kind, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", data), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(
        struct.pack(">I", len(part)) + name + part + struct.pack(">I", zlib.crc32(name + part))
        for name, part in chunks
    )
