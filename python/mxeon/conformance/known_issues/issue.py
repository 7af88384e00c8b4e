# SPDX-License-Identifier: Apache-2.0
"""The type of a known issue, and who may have one."""

from collections.abc import Sequence
from dataclasses import dataclass

STOCK = "stock"
OWN = "its own nodes"  # in the place of a library
HARDWARE = ("webgl", "vulkan", "wgsl", "slang")  # hosts whose text comes from that of GLSL


@dataclass(frozen=True)
class Issue:
    """An issue upstream: its page, and the results that show it.

    Attributes
    ----------
    page : str
        Its name without suffix.
    host : str
        The host that shows it; "source" for generated text.
    rows : tuple of (str, str)
        Key of the check and subject of each result, all of which fail.
    also : tuple of str
        Other hosts that show it.
    implied : tuple of (str, str)
        Key and subject of other results that fail for it, on those hosts or in the text.
    library : str
        The library that has it; OWN for a renderer's own nodes.
    """

    page: str
    host: str
    rows: tuple[tuple[str, str], ...]
    also: tuple[str, ...] = ()
    implied: tuple[tuple[str, str], ...] = ()
    library: str = STOCK


def product(checks: Sequence[str], subjects: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Each of some checks of each of some subjects."""
    return tuple((check, subject) for check in checks for subject in subjects)
