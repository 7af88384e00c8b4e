# SPDX-License-Identifier: Apache-2.0
"""Measures how runs survive faults, and writes docs/reliability.json and the page from it.

python -m tests.reliability [GROUP ...] [--page] [--folder FOLDER]
"""

import argparse
import json
from importlib import import_module
from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined
from tqdm import tqdm

from mxeon.io.files import write_text

GROUPS = ("kills", "hangs", "disk", "memory", "farm", "versions", "processors")
FOLDERS = ("documents",)  # groups that are measured on a folder
DOCS = Path(__file__).resolve().parents[2] / "docs"


def main(arguments=None):
    """Measure what is asked for, and write the page."""
    parser = argparse.ArgumentParser(prog="tests.reliability", description=__doc__.splitlines()[0])
    parser.add_argument("groups", nargs="*", metavar="GROUP", help=", ".join(GROUPS + FOLDERS))
    parser.add_argument("--page", action="store_true", help="make the page alone")
    parser.add_argument("--folder", help="of documents, for the group of that name")
    options = parser.parse_args(arguments)
    if unknown := set(options.groups) - {*GROUPS, *FOLDERS}:
        known = ", ".join(GROUPS + FOLDERS)
        parser.error(f"group must be one of {known}; got {', '.join(unknown)}")
    if set(options.groups) & set(FOLDERS) and not options.folder:
        parser.error("--folder must name the folder of the documents")
    for name in () if options.page else options.groups or GROUPS:
        measure = import_module(f"tests.reliability.{name}").measure
        given = [options.folder] if name in FOLDERS else []
        keep(name, measure(*given, progress=tqdm))
    write_text(DOCS / "reliability.md", page(read()))


def read():
    """The figures measured so far, by group."""
    file = DOCS / "reliability.json"
    return json.loads(file.read_text()) if file.exists() else {}


def keep(group, figures):
    """Put the figures of a group in place of its former ones."""
    text = json.dumps(read() | {group: figures}, indent=1, sort_keys=True)
    write_text(DOCS / "reliability.json", text + "\n")


def page(figures):
    """The page in Markdown."""
    environment = Environment(
        loader=PackageLoader("tests.reliability", "."),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("reliability.md.jinja").render(figures)


if __name__ == "__main__":
    main()
