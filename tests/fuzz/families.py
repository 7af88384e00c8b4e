# SPDX-License-Identifier: Apache-2.0
"""Families of cases, each the product of tables, of which some are tried.

A family covers its tables evenly: every element kind with every type, every attribute with every odd value,
every option, every include, every name of a file, every argument of the models' functions. Only `mutated` draws
at random, and `found` has the faults that earlier runs found.
"""

import random
from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from xml.etree import ElementTree

from tests.fuzz import arguments, includes, names
from tests.fuzz.cases import COMMANDS, OUT, TARGETS, Case, case
from tests.fuzz.documents import originals
from tests.fuzz.found import FOUND, LOBE
from tests.fuzz.trial import judged
from tests.fuzz.words import ATTRIBUTES, CATEGORIES, PATHS, SNIPPETS, TYPES, VALUES
from tests.support.documents import material

SEED = 1


def documents():
    """Documents with an element of every category and type, and with every pair of snippets."""
    port = '<{0} name="odd" type="{1}"><input name="in" type="{1}" value="1"/></{0}>'
    for category, kind in product(CATEGORIES, TYPES):
        connected = f'<input name="color" type="{kind}" nodename="odd"/>'
        yield port.format(category, kind) + LOBE.format(connected)
    for first, second in product(SNIPPETS, SNIPPETS):
        yield first + second + LOBE.format("")


def attributes():
    """The bundled documents with one attribute that has, or gets, an odd value."""
    for text in dict.fromkeys(originals()):
        count = sum(1 for _ in ElementTree.fromstring(text).iter())
        for place, value in product(range(count), VALUES + PATHS):
            for name in ATTRIBUTES:
                yield text, place, name, value


def lines():
    """Every command line with one argument replaced by every odd word."""
    for command in COMMANDS:
        for place, word in product(range(len(command)), VALUES + PATHS):
            yield command, place, word


def _document_case(rng, nodes):
    return Case("document", (("base.mtlx", material(nodes).encode()),), _arguments(rng))


def _attribute_case(rng, row):
    text, place, name, value = row
    root = ElementTree.fromstring(text)
    list(root.iter())[place].set(name, value)
    data = ElementTree.tostring(root, encoding="unicode").encode(errors="surrogatepass")
    return Case(f"{name} {place}", (("base.mtlx", data),), _arguments(rng))


def _line_case(_, row):
    command, place, word = row
    arguments = (*command[:place], word, *command[place + 1 :])
    host = ("--host", "abacus") if command[0] == "check" else ()
    data = material(LOBE.format("")).encode()
    return Case(" ".join(arguments), (("base.mtlx", data), ("part.mtlx", data)), arguments + host)


def _arguments(rng):
    """A command that reads the document: mostly it is generated, sometimes drawn."""
    if rng.random() < 0.1:
        size = ("--size", "4", "--output", f"{OUT}/a.png")
        return "render", "base.mtlx", "--host", "reference", *size
    return "generate", "base.mtlx", "--target", rng.choice(TARGETS), "--outputPath", OUT


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
    "documents": Family(documents, _document_case, 1500),
    "attributes": Family(attributes, _attribute_case, 4000),
    "command lines": Family(lines, _line_case, 1000),
    "arguments": Family(arguments.rows, lambda _, row: row, 10_000, arguments.judged),
    "includes": Family(includes.rows, includes.to_case, 1000),
    "names": Family(names.rows, names.to_case, 400),
}


def cases(family, count=None):
    """Cases of a family: all of them or, where there are more than `count`, some."""
    row = FAMILIES[family]
    rng = random.Random(f"{SEED}-{family}")
    rows = list(row.rows())
    return [row.to_case(rng, each) for each in rng.sample(rows, min(count or row.count, len(rows)))]
