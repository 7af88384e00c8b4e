# SPDX-License-Identifier: Apache-2.0
"""Updates the list in docs/arrays.md of functions that accept no arrays of PyTorch or JAX."""

import inspect
import re
from pkgutil import resolve_name

from tools.site import DOCS, with_block

PAGE = DOCS / "arrays.md"
ARRAYS = "ArrayLike", "Mapping[str, ArrayLike]"
NUMPY_ONLY = "mxeon.models.surfaces."
PUBLIC = re.compile(r"^::: (mxeon\.models\.[\w.]*[a-z]\w*)$", re.M)


def public():
    """Public functions with array arguments, by documented name."""
    pages = sorted((DOCS / "api").glob("*.md"))
    names = [name for page in pages for name in PUBLIC.findall(page.read_text(encoding="utf-8"))]
    names = [name for name in names if not name.startswith(NUMPY_ONLY)]
    functions = {name: resolve_name(name) for name in names}
    return {
        name: each for name, each in functions.items() if inspect.isfunction(each) and arrays(each)
    }


def arrays(function):
    parameters = inspect.signature(function).parameters.values()
    return [each.name for each in parameters if each.annotation in ARRAYS]


def page(text):
    """The page with a new list of functions that only accept NumPy arrays."""
    functions = public().items()
    exceptions = [
        f"`{name.rpartition('.')[2]}`"
        for name, each in functions
        if inspect.unwrap(each) is each  # functions for arrays of any library are wrapped
    ]
    line = (
        "Every public function of arrays in `mxeon.models` takes them, and\nhas gradients with respect to every argument of the type `ArrayLike`. "
        f"Only {' and '.join(exceptions)} take lobes,\nwhose arrays may be of any library. "
        "The surface shaders in `mxeon.models.surfaces` take NumPy's arrays only.\n"
    )
    return with_block(text, "functions", line)
