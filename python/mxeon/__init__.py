# SPDX-License-Identifier: Apache-2.0
"""Check MaterialX shaders, and evaluate the BRDFs of MaterialX's specification.

Importing mxeon loads only the standard library. Each public name is imported when it is first used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:  # type checkers and the API reference run no code
    from mxeon.conformance.results import Run
    from mxeon.conformance.run import check
    from mxeon.models.catalog import model, model_names
    from mxeon.shaders.generation import Shader, generate
    from mxeon.shaders.library import load_library
    from mxeon.survey.callables import check_brdf

__version__ = "0.2.0"

# Public names, and the modules that define them.
_HOMES = {
    "Run": "mxeon.conformance.results",
    "Shader": "mxeon.shaders.generation",
    "check": "mxeon.conformance.run",
    "check_brdf": "mxeon.survey.callables",
    "generate": "mxeon.shaders.generation",
    "load_library": "mxeon.shaders.library",
    "model": "mxeon.models.catalog",
    "model_names": "mxeon.models.catalog",
}
__all__ = [
    "Run",
    "Shader",
    "__version__",
    "check",
    "check_brdf",
    "generate",
    "load_library",
    "model",
    "model_names",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'mxeon' has no attribute {name!r}")
    if name == "check":
        import_module("mxeon.hosts").register(*import_module("mxeon.survey").ROWS)
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return sorted(__all__)
