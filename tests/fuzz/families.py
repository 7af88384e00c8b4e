# SPDX-License-Identifier: Apache-2.0
"""Families of cases, each the product of tables, of which some are tried.

A family covers its tables evenly: every element kind with every type, every attribute with every odd value,
every spelling of a number, every encoding, every option, every value of a journal, of results and of a kit's
description, every argument of the models' functions, the explorer's page in Chromium, every include. Only
`mutated` draws at random, and `found` has the faults that earlier runs found.
"""

import encodings.aliases
import random
from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from xml.etree import ElementTree

from mxeon.hosts import HOSTS
from tests.fuzz import arguments, bombs, edited, includes, libraries, names, pages, templates
from tests.fuzz.cases import COMMANDS, OUT, TARGETS, Case, case
from tests.fuzz.documents import originals
from tests.fuzz.found import FOUND, LOBE
from tests.fuzz.trial import judged, trial
from tests.fuzz.words import ATTRIBUTES, CATEGORIES, PATHS, SNIPPETS, TYPES, VALUES
from tests.support.documents import material

SEED = 1

NUMBERS = (
    "0.5f", "0.5F", "0.5d", "1d5", "1e", "1e+", "e5", "0x10", "0x1p3", "0b1", "0o7", "1/2", "50%",
    "0.5;0.5", "0.5.0", "1.#INF", "1.#IND", "-1.#QNAN", "INF", "+inf", "Infinity", "NAN", "nan(1)",
    "+0.5", "--1", "+-1", "1_000", "1,000", "1 000", "1'000", ".5", "5.", ".", "-", "+", "0,5",
    "(0.5)", "[0.5]", "{0.5}", "0.5 0.5", "0.5,", ",0.5", "0.5,,0.5", "1e400", "1e-400", "\uff11",
    "\u0661", "\u00bd", "\u22121", "true", "M_PI", "pi", "0.5 m", "0.5\u00a0", "1E5", "00001", "1e0x1",
)  # fmt: skip
NUMERIC = ("float", "integer", "color3", "color4", "vector2", "vector3", "matrix33", "floatarray")
NO_CODECS = ("ebcdic", "UCS-4", "x-user-defined", "", " ", "utf-8\n", "a" * 5000, "mbcs", "oem")


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


def numbers():
    """Every spelling of a number as a value of every numeric type."""
    value = (
        '<constant name="odd" type="{0}"><input name="value" type="{0}" value="{1}"/></constant>'
    )
    for kind, number in product(NUMERIC, NUMBERS):
        yield value.format(kind, number) + LOBE.format("")
    for number in NUMBERS:
        yield LOBE.format(f'<input name="roughness" type="float" value="{number}"/>')
        yield LOBE.format(f'<input name="color" type="color3" value="{number}, 0.5, 0.5"/>')


def codings():
    """A document in every encoding that Python knows, declared rightly, wrongly or not at all."""
    known = sorted(set(encodings.aliases.aliases) | set(encodings.aliases.aliases.values()))
    for name in (*known, *NO_CODECS):
        for used in (name, "utf-8", "utf-16"):
            yield name, used


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


def _coding_case(rng, row):
    declared, used = row
    text = material(LOBE.format("")).replace('"1.0"?', f'"1.0" encoding="{declared}"?', 1)
    try:
        data = text.encode(used)
    except (LookupError, UnicodeError):
        data = text.encode()
    return Case(declared, (("base.mtlx", data),), _arguments(rng))


def _line_case(_, row):
    command, place, word = row
    arguments = (*command[:place], word, *command[place + 1 :])
    host = ("--host", "abacus") if command[0] == "check" else ()
    data = material(LOBE.format("")).encode()
    return Case(" ".join(arguments), (("base.mtlx", data), ("part.mtlx", data)), arguments + host)


def _host_case(rng, row):
    host, nodes = row
    arguments = ("render", "base.mtlx", "--host", host, "--size", "4", "--output", f"{OUT}/a.png")
    return Case(host, (("base.mtlx", material(nodes).encode()),), arguments)


def hosts():
    """Documents with every pair of snippets on every host that draws spheres, gl apart."""
    others = [row.name for row in HOSTS if row.scenes and row.name != "gl"]
    for first, second in product(SNIPPETS, SNIPPETS):
        for host in others:
            yield host, first + second + LOBE.format("")


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
    "numbers": Family(numbers, _document_case, 600),
    "encodings": Family(codings, _coding_case, 600),
    "command lines": Family(lines, _line_case, 1000),
    "journals": Family(edited.journal_rows, edited.to_journal, 500),
    "results": Family(edited.result_rows, edited.to_results, 500),
    "kits": Family(edited.kit_rows, edited.to_kit, 300),
    "templates": Family(templates.rows, templates.to_case, 700),
    "arguments": Family(arguments.rows, lambda _, row: row, 10_000, arguments.judged),
    "explorer documents": Family(pages.document_rows, pages.to_document, 60, pages.shown),
    "explorer addresses": Family(pages.fragment_rows, lambda _, row: row, 500, pages.addressed),
    "includes": Family(includes.rows, includes.to_case, 1000),
    "libraries": Family(libraries.rows, libraries.to_case, 500),
    "images": Family(bombs.rows, lambda _, row: row, 30, bombs.weighed),
    "hosts": Family(hosts, _host_case, 60, trial),  # a browser reserves more memory than it uses
    "names": Family(names.rows, names.to_case, 400),
}


def cases(family, count=None):
    """Cases of a family: all of them or, where there are more than `count`, some."""
    row = FAMILIES[family]
    rng = random.Random(f"{SEED}-{family}")
    rows = list(row.rows())
    return [row.to_case(rng, each) for each in rng.sample(rows, min(count or row.count, len(rows)))]
