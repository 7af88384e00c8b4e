# SPDX-License-Identifier: Apache-2.0
"""Writes OSL versions of GLSL files and generated tables of pages: `python -m tools.site`.

The command needs no renderer. Other commands in `tools.site` measure hosts or draw pictures.
"""

from pathlib import Path

from mxeon.io.files import write_text
from tools.site import arrays, gallery, note, research, twins, versions


def made() -> dict[Path, str]:
    tables = {each.PAGE: each.page for each in (arrays, research, note, versions)}
    return {
        **{twins.path(stem): twins.osl_text(stem) for stem in twins.STEMS},
        **{path: page(path.read_text(encoding="utf-8")) for path, page in tables.items()},
        gallery.PAGE: gallery.page(),
    }


if __name__ == "__main__":
    for path, text in made().items():
        if not path.is_file() or path.read_text(encoding="utf-8") != text:
            write_text(path, text)
            print(f"written: {path.relative_to(twins.ROOT)}")
