# SPDX-License-Identifier: Apache-2.0
"""Rough diffuse reflection made right in every MaterialX target, and proved by running it.

Importing this loads nothing but the standard library; the names below load what they need.
"""

from importlib import import_module

__version__ = "0.1.0"

# Public name -> the module that defines it.
_HOMES = {
    "Shader": "mxeon.generation",
    "brdf_test": "mxeon.conformance.callables",
    "check": "mxeon.conformance",
    "check_brdf": "mxeon.conformance.callables",
    "generate": "mxeon.generation",
    "load_library": "mxeon.library",
}
__all__ = ["__version__", *_HOMES]


def __getattr__(name):
    if name not in _HOMES:
        raise AttributeError(f"module 'mxeon' has no attribute {name!r}")
    return getattr(import_module(_HOMES[name]), name)
