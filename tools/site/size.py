# SPDX-License-Identifier: Apache-2.0
"""Count the lines of the package, and write them into the page on its design.

python -m tools.site.size
"""

import ast
import io
import re
import tokenize
from collections import Counter
from functools import cache
from pathlib import Path

from mxeon.io.files import write_text

FOLDER = Path(__file__).resolve().parents[2] / "docs"
PAGE = FOLDER / "design.md"
PACKAGE = FOLDER.parent / "python" / "mxeon"
TABLE = re.compile(r"(<!-- size -->\n).*?(<!-- end -->)", re.DOTALL)
COLUMNS = ("code", "docstrings", "comments", "blank")
DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
# What the suite judges, and the names of the modules that do nothing else.
SUBJECTS = {
    "surface shaders": "surface_*",
    "emissions and media": "emission* media*",
    "closures of OSL, and those that a renderer evaluates": "closures rendered evaluated",
    "thin films": "*film*",
    "transmission and subsurface scattering": "transmission* subsurface*",
    "hair": "hair*",
    "utility nodes": "utilities",
    "combinations of lobes": "combinations",
}


@cache
def lines(path):
    """Lines of a file, by COLUMNS."""
    text = path.read_text(encoding="utf-8")
    kinds = ["blank" if not line.strip() else "code" for line in text.splitlines()]
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type == tokenize.COMMENT and token.line.strip().startswith("#"):
            kinds[token.start[0] - 1] = "comments"
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, DOCUMENTED) and ast.get_docstring(node):
            first = node.body[0]
            kinds[first.lineno - 1 : first.end_lineno] = ["docstrings"] * (
                first.end_lineno - first.lineno + 1
            )
    return Counter(kinds)


def row(title, paths):
    """A row of a table: files, lines, and lines by COLUMNS."""
    count = sum(map(lines, paths), Counter())
    cells = (len(paths), count.total(), *(count[each] for each in COLUMNS))
    return f"| {title} | {' | '.join(f'{each:,}' for each in cells)} |\n"


def modules(folder):
    """Modules of a folder and of those in it."""
    return sorted(folder.rglob("*.py"))


def parts(folder):
    """Modules by each folder in a folder, and those of its own."""
    found = {each.name: modules(each) for each in sorted(folder.iterdir()) if each.is_dir()}
    return {name: paths for name, paths in found.items() if paths} | {
        f"files of `{folder.name}` itself": sorted(folder.glob("*.py"))
    }


def tables():
    """Tables of the packages, of the rooms of the suite, and of what it judges."""
    suite = PACKAGE / "conformance"
    of_subjects = {
        f"of it, {title}": [
            path
            for path in modules(suite)
            if any(map(path.relative_to(suite).match, _globs(names)))
        ]
        for title, names in SUBJECTS.items()
    }
    for title, whole, rows in (
        ("package", PACKAGE, parts(PACKAGE)),
        ("room of `conformance`", suite, parts(suite) | of_subjects),
    ):
        head = f"| {title} | files | lines | {' | '.join(COLUMNS)} |\n|---|" + "---|" * 6 + "\n"
        body = "".join(row(name, paths) for name, paths in rows.items())
        yield head + body + row(f"all of `{whole.name}`", modules(whole))


def _globs(names):
    return [f"{name}.py" for name in names.split()]


def main():
    """Write the tables."""
    text = "\n".join(tables())
    page = PAGE.read_text(encoding="utf-8")
    write_text(PAGE, TABLE.sub(lambda match: match[1] + text + match[2], page))


if __name__ == "__main__":
    main()
