# SPDX-License-Identifier: Apache-2.0
"""Values of a graph without recursion, each computed once and forgotten after its last use."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Hashable, Mapping
from typing import TypeVar

Key = TypeVar("Key", bound=Hashable)
Value = TypeVar("Value")


def evaluated(
    root: Key, parts: Mapping[Key, tuple[Key, ...]], function: Callable[[Key], Callable[..., Value]]
) -> Value:
    """Value of a key: neither a long chain nor a key with many uses does harm."""
    uses = Counter(part for inner in parts.values() for part in inner)
    values: dict[Key, Value] = {}
    waiting = [root]
    while waiting:
        key = waiting[-1]
        if key in values:
            waiting.pop()
        elif missing := [part for part in parts[key] if part not in values]:
            waiting.append(missing[0])
        else:
            values[key] = function(key)(*(values[part] for part in parts[key]))
            for part in parts[key]:
                uses[part] -= 1
                if not uses[part]:
                    del values[part]
    return values[root]
