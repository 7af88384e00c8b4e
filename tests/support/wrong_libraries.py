# SPDX-License-Identifier: Apache-2.0
"""Copies of eonlib and of MaterialX's libraries with one mistake each."""

import re
import shutil

from mxeon.shaders.functions import source_file
from mxeon.shaders.library import data_folder
from mxeon.shaders.library_tree import standard_folders

STOCK, GLSL = standard_folders()[0], "pbrlib/genglsl"


def copy_of_eonlib(folder):
    for name in ("libraries", "genglsl", "genosl"):
        shutil.copytree(data_folder() / name, folder / name)
    return folder / "libraries"


def replace_text(folder, old, new, *files):
    """Replace `old` everywhere in the given files. At least one file must contain `old`."""
    texts = {folder / file: (folder / file).read_text(encoding="utf-8") for file in files}
    assert any(old in text for text in texts.values())
    for path, text in texts.items():
        path.write_text(text.replace(old, new), encoding="utf-8")


def wrong_copy(folder, old, new, *files):
    library = copy_of_eonlib(folder)
    replace_text(folder, old, new, *files)
    return str(library)


def copy_of_stock(folder, *parts):
    """Folder with a copy of MaterialX's libraries, or only of the given files and folders."""
    for part in parts or ["."]:
        (folder / part).parent.mkdir(parents=True, exist_ok=True)
        if (STOCK / part).is_dir():
            shutil.copytree(STOCK / part, folder / part, dirs_exist_ok=True)
        else:
            shutil.copy(STOCK / part, folder / part)
    return folder


def wrong_stock(folder, file, *changes):
    """Path of a library with a single file of MaterialX, in which code is replaced."""
    copy_of_stock(folder, file)
    for old, new in changes:
        replace_text(folder, old, new, file)
    return str(folder)


def wrong_stock_node(folder, name, old, new):
    """Path of a library with only the GLSL of one MaterialX node, in which code is replaced."""
    file = name if name.endswith(".glsl") else f"mx_{name}.glsl"
    if not (STOCK / GLSL / file).is_file():  # several nodes may share a file
        rows = (STOCK / GLSL / "pbrlib_genglsl_impl.mtlx").read_text(encoding="utf-8")
        [file] = re.findall(rf'nodedef="ND_{name}" file="([^"]+)"', rows)
    return wrong_stock(folder, f"{GLSL}/{file}", (old, new))


def wrong_library(folder, file, old, new):
    """Path of a library with code replaced in `file`.

    The library is a copy of eonlib. If `file` is a name without a folder, the library contains only
    this GLSL file of MaterialX.
    """
    if "/" in file:
        return wrong_copy(folder, old, new, file)
    return wrong_stock_node(folder, file, old, new)


def place_of(name, language="glsl"):
    """Path of the eonlib source with the given stem, relative to the folder of a copy."""
    return source_file(language, name).relative_to(data_folder())
