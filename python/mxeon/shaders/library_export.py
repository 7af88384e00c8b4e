# SPDX-License-Identifier: Apache-2.0
"""Copies of eonlib for use without Python: a folder or a zip archive."""

import os
import shutil
from pathlib import Path
from secrets import token_hex
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

import mxeon
from mxeon.errors import InputError
from mxeon.io.files import TEMPORARY, AnyPath, check_output, naming, replacing
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.document.references import files_read
from mxeon.shaders.library import SOURCE_FOLDERS, data_folder, documents_folder, source_folder

README = """eonlib {version}, a MaterialX data library.

Load this folder, FOLDER below, before the libraries of MaterialX, which ignores later definitions of a
name. FOLDER/documents/diffuse can be loaded alone; it changes rough diffuse nodes only. MaterialX must be 1.39.3 or
later. Blender's Cycles needs other implementations in OSL. They lie in FOLDER/genosl/cycles in a document that
ends in .xml, so that loading FOLDER leaves them out. Other programs can load that folder before
FOLDER/documents once the document is renamed to end in .mtlx.

{recipes}

License: Apache-2.0, see LICENSE.
"""
CLIENTS = {
    "Python": 'mx.loadLibraries(["{}", "libraries"], mx.getDefaultDataSearchPath(), library)',
    "C++": 'mx::loadLibraries({{"{}", "libraries"}}, mx::getDefaultDataSearchPath(), library);',
    "generateshader": "generateshader --library {} --target glsl FILE",
    "MaterialX's viewer": "MaterialXView --library {}",
    "USD": "export PXR_MTLX_PLUGIN_SEARCH_PATHS={0}:{1}/genglsl/environment",
    "Blender's Cycles": "mxeon generate --library {} --profile cycles --target osl --outputPath DIR FILE",
}


def recipes(folder: AnyPath, sources: AnyPath = "") -> str:
    """Instructions for loading a folder of eonlib, with one line for each renderer.

    `sources` is the folder that contains `genglsl`; by default, it is found next to the documents.
    """
    sources = sources or source_folder(os.fspath(folder))
    return "\n".join(f"{name:<21} {text.format(folder, sources)}" for name, text in CLIENTS.items())


def export_library(path: AnyPath) -> Path:
    """Write eonlib, with its sources and license, to a new or empty folder or to a zip archive.

    A path ending in ".zip" becomes an archive that contains a single folder of the same name. The
    archive replaces an existing file. After an error, no partial output remains.
    """
    target = Path(os.path.realpath(path))
    names = [] if target.suffix == ".zip" else ["*"]
    in_the_way = target.exists() and not (target.is_dir() and not any(target.iterdir()))
    if os.fspath(path) and names and in_the_way:
        raise InputError(f"{target}: must be a new or empty folder, or end in .zip")
    check_output(path, files_read([], Policy()).values(), replaced=names)
    if target.suffix == ".zip":
        with replacing(target) as temporary, ZipFile(temporary, "w") as archive:
            for name, data in _content().items():
                entry = ZipInfo(f"{target.stem}/{name}")  # the fixed date makes archives equal
                entry.external_attr = 0o644 << 16
                archive.writestr(entry, data, ZIP_DEFLATED)
        return target
    target.parent.mkdir(parents=True, exist_ok=True)
    temporary = target.with_name(f"{TEMPORARY}{token_hex(8)}")
    with naming(target):
        temporary.mkdir()
        try:
            for name, data in _content().items():
                (temporary / name).parent.mkdir(parents=True, exist_ok=True)
                (temporary / name).write_bytes(data)
            os.replace(temporary, target)
        finally:
            shutil.rmtree(temporary, ignore_errors=True)
    return target


def _content() -> dict[str, bytes]:
    """The content of the files in a copy of eonlib, keyed by relative path."""
    folders = {name: source_folder("eonlib") / name for name in SOURCE_FOLDERS}
    content = {
        f"{name}/{path.relative_to(folder).as_posix()}": path.read_bytes()
        for name, folder in {"documents": documents_folder(), **folders}.items()
        for path in sorted(folder.rglob("*.*"))
    }
    text = README.format(version=mxeon.__version__, recipes=recipes("FOLDER", "FOLDER"))
    return content | {
        "LICENSE": (data_folder() / "LICENSE").read_bytes(),
        "README.txt": text.encode(),
    }
