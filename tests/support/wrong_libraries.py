# SPDX-License-Identifier: Apache-2.0
"""Libraries with one wrong text: a copy of eonlib, or one node of stock MaterialX or of eonlib alone."""

import re
import shutil
from pathlib import Path

import MaterialX as mx

from mxeon.shaders.library import data_folder, eonlib_folder, standard_folders


def copy_of_eonlib(folder):
    """Folder of a copy of eonlib in a folder, with its profiles beside it."""
    for name in ("eonlib", "profiles"):
        shutil.copytree(data_folder() / name, folder / name)
    return folder / "eonlib"


def replace_text(folder, old, new, *files):
    """Replace a text wherever it stands in these files of a copy; one of them must have it."""
    texts = {folder / file: (folder / file).read_text(encoding="utf-8") for file in files}
    assert any(old in text for text in texts.values())
    for path, text in texts.items():
        path.write_text(text.replace(old, new), encoding="utf-8")


def wrong_copy(folder, old, new, *files):
    """Path of a copy of eonlib that has one text in place of another in these files."""
    library = copy_of_eonlib(folder)
    replace_text(folder, old, new, *files)
    return str(library)


def wrong_stock_node(folder, name, old, new):
    """Path of a library of a stock node in GLSL, by its name or that of its file, with another text."""
    [sources] = [
        path for each in standard_folders() if (path := each / "pbrlib" / "genglsl").is_dir()
    ]
    rows = sources / "pbrlib_genglsl_impl.mtlx"
    library = _node_alone(folder, name, rows, sources)
    [file] = folder.glob("*.glsl")
    text = file.read_text(encoding="utf-8")
    text = text.replace('#include "lib/', '#include "libraries/pbrlib/genglsl/lib/')
    file.write_text(text, encoding="utf-8")
    replace_text(folder, old, new, file.name)
    return library


def wrong_eonlib_node(folder, name, old, new):
    """Path of a library of one of eonlib's other nodes of pbrlib in GLSL, with another text."""
    rows = eonlib_folder() / "pbrlib" / "eonlib_pbrlib_genglsl_impl.mtlx"
    library = _node_alone(folder, f"{name}.glsl", rows, eonlib_folder() / "genglsl")
    replace_text(folder, old, new, f"{name}.glsl")
    return library


def _node_alone(folder, name, rows, sources):
    """Path of a library of one node, with the file that implements it and those that this includes."""
    document, alone = mx.createDocument(), mx.createDocument()
    mx.readFromXmlFile(document, str(rows))
    [row] = [
        each
        for each in document.getImplementations()
        if name in (each.getNodeDefString().removeprefix("ND_"), Path(each.getFile()).name)
    ]
    file = Path(row.getFile()).name
    text = shutil.copy(sources / file, folder / file).read_text(encoding="utf-8")
    for name in re.findall(r'^#include "(\w+\.glsl)"', text, re.MULTILINE):
        shutil.copy(sources / name, folder / name)
    alone.addImplementation(row.getName()).copyContentFrom(row)
    alone.getImplementation(row.getName()).setFile(file)
    mx.writeToXmlFile(alone, str(folder / "implementations.mtlx"))
    return str(folder)
