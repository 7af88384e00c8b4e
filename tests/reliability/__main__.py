# SPDX-License-Identifier: Apache-2.0
"""Measures how runs survive faults, prints the figures, and keeps them in out/reliability.json.

python -m tests.reliability [GROUP ...] [--folder FOLDER]
"""

import argparse
import json
from importlib import import_module
from pathlib import Path

from tqdm import tqdm

from mxeon.io.files import write_text

GROUPS = ("kills", "hangs", "disk", "memory", "versions")
FOLDERS = ("documents",)  # groups that are measured on a folder
FIGURES = Path(__file__).resolve().parents[2] / "out" / "reliability.json"


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="tests.reliability", description=__doc__.splitlines()[0])
    parser.add_argument("groups", nargs="*", metavar="GROUP", help=", ".join(GROUPS + FOLDERS))
    parser.add_argument("--folder", help="of documents, for the group of that name")
    options = parser.parse_args(arguments)
    if unknown := set(options.groups) - {*GROUPS, *FOLDERS}:
        known = ", ".join(GROUPS + FOLDERS)
        parser.error(f"group must be one of {known}; got {', '.join(unknown)}")
    if set(options.groups) & set(FOLDERS) and not options.folder:
        parser.error("--folder must name the folder of the documents")
    for name in options.groups or GROUPS:
        measure = import_module(f"tests.reliability.{name}").measure
        given = [options.folder] if name in FOLDERS else []
        keep(name, measure(*given, progress=tqdm))


def keep(group, figures):
    """Print the figures of a group, and put them in place of its former ones."""
    print(json.dumps({group: figures}, indent=1))
    kept = json.loads(FIGURES.read_text()) if FIGURES.exists() else {}
    FIGURES.parent.mkdir(exist_ok=True)
    write_text(FIGURES, json.dumps(kept | {group: figures}, indent=1, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
