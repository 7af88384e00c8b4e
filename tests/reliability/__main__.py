# SPDX-License-Identifier: Apache-2.0
"""Measures how runs survive faults, prints the figures, and keeps them in out/reliability.json.

python -m tests.reliability [GROUP ...] [--folder FOLDER]
"""

import argparse
import json
from functools import partial
from pathlib import Path

from tqdm import tqdm

from mxeon.io.files import write_text
from tests.reliability import documents, faults, versions

GROUPS = {
    "kills": faults.kills,
    "hangs": faults.hangs,
    "disk": faults.disk,
    "memory": faults.memory,
    "versions": versions.measure,
}
FIGURES = Path(__file__).resolve().parents[2] / "out" / "reliability.json"


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="tests.reliability", description=__doc__.splitlines()[0])
    parser.add_argument("groups", nargs="*", metavar="GROUP", help=", ".join(GROUPS))
    parser.add_argument("--folder", help="documents that are generated on every target")
    options = parser.parse_args(arguments)
    groups = {name: GROUPS[name] for name in options.groups or GROUPS}
    if options.folder:
        groups = {"documents": partial(documents.measure, options.folder)}
    for name, measure in groups.items():
        keep(name, measure(progress=tqdm))


def keep(group, figures):
    """Print the figures of a group, and put them in place of its former ones."""
    print(json.dumps({group: figures}, indent=1))
    kept = json.loads(FIGURES.read_text()) if FIGURES.exists() else {}
    FIGURES.parent.mkdir(exist_ok=True)
    write_text(FIGURES, json.dumps(kept | {group: figures}, indent=1, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
