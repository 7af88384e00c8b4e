# SPDX-License-Identifier: Apache-2.0
"""Copies of eonlib for people without Python: a folder, or a zip archive of one."""

import os
import shutil
from pathlib import Path
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import mxeon
from mxeon.errors import InputError
from mxeon.io.files import AnyPath, replacing
from mxeon.shaders.library import SOURCES, data_folder

README = """eonlib {version}, a MaterialX data library.

Load the folder `eonlib` before the libraries of MaterialX, which ignores later definitions of a name.
`eonlib/diffuse` can be loaded alone; it changes rough diffuse nodes only. For Blender's Cycles, load
`profiles/cycles` before `eonlib`. MaterialX must be 1.39.3 or later.

    C++             mx::loadLibraries({{ "FOLDER/eonlib", "libraries" }}, mx::getDefaultDataSearchPath(), library);
    Python          mx.loadLibraries(["FOLDER/eonlib", "libraries"], mx.getDefaultDataSearchPath(), library)
    generateshader  generateshader.py --library FOLDER/eonlib --target glsl FILE
    MaterialXView   MaterialXView --library FOLDER/eonlib
    USD             export PXR_MTLX_PLUGIN_SEARCH_PATHS=FOLDER/eonlib

License: Apache-2.0, see LICENSE.
"""


def export_library(path: AnyPath) -> Path:
    """Write eonlib, with its sources, profiles and license, to a new folder or a zip archive.

    Parameters
    ----------
    path : path-like
        A folder that does not exist or is empty. What ends in ".zip" becomes an archive of a folder of
        that name; a file already there is replaced.

    Returns
    -------
    Path
        What was written, whole.

    Raises
    ------
    InputError
        If there is something else than an empty folder.
    OSError
        If it cannot be written; nothing half-written stays behind.
    """
    target = Path(os.path.realpath(path))
    if target.suffix == ".zip":
        _write_archive(target)
    else:
        _write_folder(target)
    return target


def _content() -> dict[str, bytes]:
    """Files of the copy, by their paths in it."""
    data = data_folder()
    files = [path for name in ("eonlib", "profiles") for path in sorted((data / name).rglob("*.*"))]
    content = {
        path.relative_to(data).as_posix(): path.read_bytes()
        for path in [*files, data / "LICENSE"]
        if path.suffix in SOURCES or path.name == "LICENSE"
    }
    return content | {"README.txt": README.format(version=mxeon.__version__).encode()}


def _write_archive(target: Path) -> None:
    with replacing(target) as beside, ZipFile(beside, "w") as archive:
        for name, data in _content().items():
            entry = ZipInfo(f"{target.stem}/{name}")  # of 1980: the same archive each time
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data, ZIP_DEFLATED)


def _write_folder(target: Path) -> None:
    if target.exists() and not (target.is_dir() and not any(target.iterdir())):
        raise InputError(f"{target}: must be a new or empty folder, or end in .zip")
    target.parent.mkdir(parents=True, exist_ok=True)
    beside = target.with_name(f".{os.getpid()}.{target.name}")
    try:
        for name, data in _content().items():
            (beside / name).parent.mkdir(parents=True, exist_ok=True)
            (beside / name).write_bytes(data)
        os.replace(beside, target)
    finally:
        shutil.rmtree(beside, ignore_errors=True)
