# SPDX-License-Identifier: Apache-2.0
"""Classes of Mitsuba that are made for the variant that is set."""

from __future__ import annotations

from importlib import import_module
from typing import Any, TypeAlias

from mxeon.errors import NotRun, PackageError, install

# Objects of Mitsuba and Dr.Jit, whose types are those of the variant.
Mitsuba: TypeAlias = Any

# LLVM 15 and older cannot compile what Dr.Jit 1.5 makes of a minimum; it ends the process.
OLDEST_LLVM = (16, 0, 0)


def register_plugin(mi: Mitsuba, name: str, kind: type) -> None:
    """Register the BSDF of this name, which has the methods of a class, for the variant that is set."""
    members = {"__init__": _initialize, "mi": mi, "dr": import_module("drjit")}
    mi.register_bsdf(name, type(name, (mi.BSDF,), members | _members(kind)))


def mitsuba() -> Mitsuba:
    """Mitsuba, with a variant that can run."""
    try:
        mi = import_module("mitsuba")
    except ModuleNotFoundError:
        raise PackageError(f"mitsuba is not installed: {install('mitsuba')}") from None
    variant = mi.variant()
    if not variant:
        raise NotRun("mitsuba: no variant is set; call mitsuba.set_variant('llvm_ad_rgb') first")
    version = import_module("drjit").detail.llvm_version() if "llvm" in variant else OLDEST_LLVM
    if version < OLDEST_LLVM:
        raise NotRun(
            f"mitsuba: Dr.Jit found LLVM {version[0]}, with which it ends the process; install LLVM 16 "
            "or later (Debian: libllvm19), or name its library in DRJIT_LIBLLVM_PATH"
        )
    return mi


def _members(kind: type) -> dict[str, object]:
    """What a class and its bases define: a class of Mitsuba's must have one base alone."""
    named = [item for each in reversed(kind.__mro__) for item in vars(each).items()]
    return {name: member for name, member in named if not name.startswith("__")}


def _initialize(self: Mitsuba, properties: Mitsuba) -> None:
    """Make a BSDF of its properties."""
    self.mi.BSDF.__init__(self, properties)
    self.configure(properties)
