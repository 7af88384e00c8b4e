# SPDX-License-Identifier: Apache-2.0
"""The table of the page on arrays: which functions take those of other libraries."""

import inspect
import re
from pkgutil import resolve_name

from tools.site import DOCS, with_block

PAGE = DOCS / "arrays.md"
ARRAYS = "ArrayLike", "Mapping[str, ArrayLike]"
PUBLIC = re.compile(r"^::: (mxeon\.(?:models|albedo|inversion|sampling)\.[\w.]*[a-z]\w*)$", re.M)


def public():
    """Public functions of arrays by their documented names."""
    pages = sorted((DOCS / "api").glob("*.md"))
    names = [name for page in pages for name in PUBLIC.findall(page.read_text(encoding="utf-8"))]
    functions = {name: resolve_name(name) for name in names}
    return {
        name: each for name, each in functions.items() if inspect.isfunction(each) and arrays(each)
    }


def arrays(function):
    """Names of the arguments that are arrays: by these it has gradients."""
    parameters = inspect.signature(function).parameters.values()
    return [each.name for each in parameters if each.annotation in ARRAYS]


def takes_any(function):
    """Whether a function takes arrays of any library."""
    return inspect.unwrap(function) is not function


def page(text):
    """The page with its table, and its list of the other functions, as they are now."""
    lines = ["| function | array arguments, each differentiable |", "|---|---|"]
    others = []
    for name, function in public().items():
        if takes_any(function):
            taken = ", ".join(f"`{each}`" for each in arrays(function))
            lines.append(f"| `{name.removeprefix('mxeon.')}` | {taken} |")
        else:
            others.append(f"`{name.rpartition('.')[2]}`")
    lines += ["", f"{' and '.join(others)} take lobes, whose arrays may be of any library.", ""]
    return with_block(text, "functions", "\n".join(lines))
