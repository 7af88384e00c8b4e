# SPDX-License-Identifier: Apache-2.0
"""Versions of MaterialX: what mxeon needs of one, and which were tested.

No version is refused by its number: the methods that mxeon needs are looked up in it, and generated code
is checked against the closure interface of eonlib's sources.
"""

import MaterialX as mx
import MaterialX.PyMaterialXGenShader as mx_gen

import mxeon
from mxeon.errors import PackageError

TESTED = ("1.39.3", "1.39.4", "1.39.5")  # versions of MaterialX; others run with a warning
REQUIRED = ((mx.Document, "setDataLibrary"), (mx_gen.ShaderGenerator, "registerTypeDefs"))


class UntestedVersionWarning(UserWarning):
    """A version of MaterialX that mxeon has not been tested with."""


def check_version() -> None:
    """Raise ImportError unless this MaterialX has every method of REQUIRED."""
    for owner, method in REQUIRED:
        if not hasattr(owner, method):
            raise PackageError(
                f"MaterialX {mx.getVersionString()} lacks {owner.__name__}.{method}; "
                f"install {TESTED[0]} or later: pip install materialx=={TESTED[-1]}"
            )


def untested(version: str) -> str:
    """Note that mxeon has not been tested with a version of MaterialX; "" if it has."""
    if version in TESTED:
        return ""
    return f"MaterialX {version} has not been tested with mxeon {mxeon.__version__}"
