# SPDX-License-Identifier: Apache-2.0
"""Libraries with one wrong text: copies of eonlib, and of all or some of MaterialX's libraries."""

import re
import shutil

from mxeon.shaders.functions import source_file
from mxeon.shaders.library import data_folder
from mxeon.shaders.library_tree import standard_folders

STOCK, GLSL = standard_folders()[0], "pbrlib/genglsl"


def copy_of_eonlib(folder):
    """Documents of a copy of eonlib in a folder, next to its sources."""
    for name in ("libraries", "genglsl", "genosl"):
        shutil.copytree(data_folder() / name, folder / name)
    return folder / "libraries"


def replace_text(folder, old, new, *files):
    """Replace all occurrences of a text in these files of a copy; at least one must contain it."""
    texts = {folder / file: (folder / file).read_text(encoding="utf-8") for file in files}
    assert any(old in text for text in texts.values())
    for path, text in texts.items():
        path.write_text(text.replace(old, new), encoding="utf-8")


def wrong_copy(folder, old, new, *files):
    """Path of a copy of eonlib with one text replaced in these files."""
    library = copy_of_eonlib(folder)
    replace_text(folder, old, new, *files)
    return str(library)


def copy_of_stock(folder, *parts):
    """Folder with a copy of MaterialX's libraries, or of some files and folders at their paths."""
    for part in parts or ["."]:
        (folder / part).parent.mkdir(parents=True, exist_ok=True)
        if (STOCK / part).is_dir():
            shutil.copytree(STOCK / part, folder / part, dirs_exist_ok=True)
        else:
            shutil.copy(STOCK / part, folder / part)
    return folder


def wrong_stock(folder, file, *changes):
    """Path of a part of MaterialX's libraries: one file, with some texts replaced."""
    copy_of_stock(folder, file)
    for old, new in changes:
        replace_text(folder, old, new, file)
    return str(folder)


def wrong_stock_node(folder, name, old, new):
    """Path of a part of MaterialX's libraries: a node's GLSL, by name of the node or file, with one text replaced."""
    file = name if name.endswith(".glsl") else f"mx_{name}.glsl"
    if not (STOCK / GLSL / file).is_file():  # the node shares a file
        rows = (STOCK / GLSL / "pbrlib_genglsl_impl.mtlx").read_text(encoding="utf-8")
        [file] = re.findall(rf'nodedef="ND_{name}" file="([^"]+)"', rows)
    return wrong_stock(folder, f"{GLSL}/{file}", (old, new))


def wrong_library(folder, file, old, new):
    """Path of a library with a text replaced in a file of eonlib or, for a bare name, of MaterialX's GLSL."""
    if "/" in file:
        return wrong_copy(folder, old, new, file)
    return wrong_stock_node(folder, file, old, new)


def place_of(name, language="glsl"):
    """Path of an eonlib source in a copy, by its stem."""
    return source_file(language, name).relative_to(data_folder())
