# SPDX-License-Identifier: Apache-2.0
"""A systematic attack: families of cases, each the product of tables, of which some are tried.

    python -m tests.fuzz.attack [FAMILY ...] [--cases N] [--keep]

Where `python -m tests.fuzz` mutates at random, a family covers its tables evenly: every element kind with
every type, every attribute with every odd value, every spelling of a number, every encoding, every
option, every value of a journal, of results and of a kit's description, every argument of the models'
functions, the explorer's page in Chromium, signals at any time, every include. The figures go to
out/reliability.json under "attack".
"""

import argparse
import encodings.aliases
import json
import random
import sys
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from itertools import product
from xml.etree import ElementTree

from tqdm import tqdm

from mxeon.hosts import HOSTS
from mxeon.jobs import pool
from tests.fuzz import (
    arguments,
    bombs,
    includes,
    journals,
    kits,
    libraries,
    outputs,
    pages,
    results,
    signals,
    templates,
)
from tests.fuzz.cases import COMMANDS, OUT, TARGETS, Case
from tests.fuzz.documents import originals
from tests.fuzz.found import LOBE
from tests.fuzz.trial import judged, unlimited
from tests.fuzz.words import ATTRIBUTES, CATEGORIES, PATHS, SNIPPETS, TYPES, VALUES
from tests.reliability.__main__ import FIGURES, keep
from tests.support.documents import material

SEED = 1
LIMIT = 300.0  # seconds for one case, on a machine that is busy
STATUSES = {0: "accepted", 1: "failed", 2: "refused", 3: "not_run"}

NUMBERS = (
    "0.5f", "0.5F", "0.5d", "1d5", "1e", "1e+", "e5", "0x10", "0x1p3", "0b1", "0o7", "1/2", "50%",
    "0.5;0.5", "0.5.0", "1.#INF", "1.#IND", "-1.#QNAN", "INF", "+inf", "Infinity", "NAN", "nan(1)",
    "+0.5", "--1", "+-1", "1_000", "1,000", "1 000", "1'000", ".5", "5.", ".", "-", "+", "0,5",
    "(0.5)", "[0.5]", "{0.5}", "0.5 0.5", "0.5,", ",0.5", "0.5,,0.5", "1e400", "1e-400", "\uff11",
    "\u0661", "\u00bd", "\u22121", "true", "M_PI", "pi", "0.5 m", "0.5\u00a0", "1E5", "00001", "1e0x1",
)  # fmt: skip
NUMERIC = ("float", "integer", "color3", "color4", "vector2", "vector3", "matrix33", "floatarray")
NO_CODECS = (
    "ebcdic",
    "UCS-4",
    "x-user-defined",
    "",
    " ",
    "utf-8\n",
    "a" * 5000,
    "mbcs",
    "oem",
    "locale",
)


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
    "documents": Family(documents, _document_case, 1500),
    "attributes": Family(attributes, _attribute_case, 4000),
    "numbers": Family(numbers, _document_case, 600),
    "encodings": Family(codings, _coding_case, 600),
    "command lines": Family(lines, _line_case, 1000),
    "journals": Family(journals.rows, journals.to_case, 500),
    "results": Family(results.rows, results.to_case, 500),
    "kits": Family(kits.rows, kits.to_case, 300),
    "templates": Family(templates.rows, templates.to_case, 700),
    "arguments": Family(arguments.rows, lambda _, row: row, 10_000, arguments.judged),
    "explorer documents": Family(pages.document_rows, pages.to_document, 60, pages.shown),
    "explorer addresses": Family(pages.fragment_rows, lambda _, row: row, 500, pages.addressed),
    "signals": Family(signals.rows, lambda _, row: row, 150, signals.struck),
    "includes": Family(includes.rows, includes.to_case, 1000),
    "libraries": Family(libraries.rows, libraries.to_case, 500),
    "images": Family(bombs.rows, lambda _, row: row, 30, bombs.weighed),
    "hosts": Family(hosts, _host_case, 60, unlimited),
    "links": Family(outputs.link_rows, outputs.to_link, 200),
    "names": Family(outputs.name_rows, outputs.to_name, 400),
}


def cases(family, count=None):
    """Cases of a family: all of them or, where there are more than `count`, some."""
    row = FAMILIES[family]
    rng = random.Random(f"{SEED}-{family}")
    rows = list(row.rows())
    return [row.to_case(rng, each) for each in rng.sample(rows, min(count or row.count, len(rows)))]


def measure(families=FAMILIES, count=None, workers=1, progress=tqdm):
    """Figures of an attack."""
    figures = {}
    for family in families:
        tried = cases(family, count)
        outcomes = pool.run(FAMILIES[family].trial, tried, workers, LIMIT)
        tally, most = Counter(), [0.0, 0]
        for place, outcome in progress(outcomes, total=len(tried), desc=family, disable=None):
            status, fault, *taken = outcome.value or (None, outcome.failure)
            most = list(map(max, most, taken)) if taken else most
            tally["faults" if fault else STATUSES.get(status, "ended")] += 1
            if fault:
                print(f"{family}: {tried[place]}: {fault}", file=sys.stderr, flush=True)
        taken = {"seconds": round(most[0], 1), "mebibytes": most[1]} if most[1] else {}
        figures[family] = {"tried": len(tried), **tally, **taken}
    return figures


def main(arguments=None):
    """Run the command; the exit status is 1 if there was a fault."""
    parser = argparse.ArgumentParser(prog="tests.fuzz.attack", description=__doc__.splitlines()[0])
    parser.add_argument("families", nargs="*", metavar="FAMILY", help=", ".join(FAMILIES))
    parser.add_argument("--cases", type=int, help="of each family")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--keep", action="store_true", help="keep the figures in out/")
    options = parser.parse_args(arguments)
    figures = measure(options.families or FAMILIES, options.cases, options.workers)
    print(json.dumps(figures, indent=1))
    if options.keep:
        kept = json.loads(FIGURES.read_text()).get("attack", {}) if FIGURES.exists() else {}
        keep("attack", kept | figures)
    return 1 if any(each.get("faults") for each in figures.values()) else 0


if __name__ == "__main__":
    sys.exit(main())
