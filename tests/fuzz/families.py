# SPDX-License-Identifier: Apache-2.0
"""Families of cases: each is a product of tables, from which some are drawn.

A family covers its tables evenly: every include, every kind of file name, every argument of the
models' functions. Only `mutated` draws documents and command lines at random; `found` contains
faults of earlier runs.
"""

import random
from collections.abc import Callable
from dataclasses import dataclass

from tests.fuzz import arguments, includes, names
from tests.fuzz.cases import case
from tests.fuzz.found import FOUND
from tests.fuzz.trial import judged

SEED = 1


@dataclass(frozen=True)
class Family:
    """Cases of one kind."""

    rows: Callable
    to_case: Callable
    count: int
    trial: Callable = judged


FAMILIES = {
    "found": Family(lambda: FOUND, lambda _, found: found, len(FOUND)),
    "mutated": Family(lambda: range(20_000), lambda _, number: case(SEED, number), 20_000),
    "arguments": Family(arguments.rows, lambda _, row: row, 10_000, arguments.judged),
    "includes": Family(includes.rows, includes.to_case, 1000),
    "names": Family(names.rows, names.to_case, 400),
}


def cases(family, count=None):
    """All cases of a family, or a sample if there are more than `count`."""
    row = FAMILIES[family]
    rng = random.Random(f"{SEED}-{family}")
    rows = list(row.rows())
    return [row.to_case(rng, each) for each in rng.sample(rows, min(count or row.count, len(rows)))]
