# SPDX-License-Identifier: Apache-2.0
"""Libraries with one wrong text: copies of eonlib, and of MaterialX's libraries or a part of them."""

import re
import shutil

from mxeon.shaders.functions import source_file
from mxeon.shaders.library import data_folder
from mxeon.shaders.library_tree import standard_folders

STOCK, GLSL = standard_folders()[0], "pbrlib/genglsl"


def copy_of_eonlib(folder):
    """Documents of a copy of eonlib in a folder, with its sources beside them."""
    for name in ("libraries", "genglsl", "genosl"):
        shutil.copytree(data_folder() / name, folder / name)
    return folder / "libraries"


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


def copy_of_stock(folder, *parts):
    """Folder of a copy of MaterialX's libraries, or of files and folders of them at their paths."""
    for part in parts or ["."]:
        (folder / part).parent.mkdir(parents=True, exist_ok=True)
        if (STOCK / part).is_dir():
            shutil.copytree(STOCK / part, folder / part, dirs_exist_ok=True)
        else:
            shutil.copy(STOCK / part, folder / part)
    return folder


def wrong_stock_node(folder, name, old, new):
    """Path of a part of MaterialX's libraries: the GLSL of a node, by its name or that of its file, with another text."""
    file = name if name.endswith(".glsl") else f"mx_{name}.glsl"
    if not (STOCK / GLSL / file).is_file():  # of a node that shares one
        rows = (STOCK / GLSL / "pbrlib_genglsl_impl.mtlx").read_text(encoding="utf-8")
        [file] = re.findall(rf'nodedef="ND_{name}" file="([^"]+)"', rows)
    replace_text(copy_of_stock(folder, f"{GLSL}/{file}"), old, new, f"{GLSL}/{file}")
    return str(folder)


def wrong_library(folder, file, old, new):
    """Path of a library with another text in a file: of eonlib, or by its bare name in MaterialX's GLSL."""
    if "/" in file:
        return wrong_copy(folder, old, new, file)
    return wrong_stock_node(folder, file, old, new)


def place_of(name, language="glsl"):
    """Path of a source of eonlib, by its stem, in a copy."""
    return source_file(language, name).relative_to(data_folder())
