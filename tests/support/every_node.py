# SPDX-License-Identifier: Apache-2.0
"""Judges the nodes of a library on gl with the MaterialX of this process, each by its values.

python -m tests.support.every_node LIBRARY [NODE ...]     prints the verdicts as JSON
"""

import json
import sys
from contextlib import closing
from dataclasses import replace

from mxeon.conformance.checks.application import judge_subject
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.nodes.diffuse import SUBJECTS
from mxeon.conformance.probes.families import PBR_SUBJECTS, probe_type_of
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.hosts import open_host
from tests.support.checks import undiagnosed

KEYS = (
    *("value", "environment", "film", "transmitted", "combination"),
    *("radiance", "transmittance", "output"),
)
FEWER = {"pairs": 1 << 9, "few": 1 << 8, "albedos": 1 << 5, "materials": 32, "mirrored": 1 << 9}


def main(library, *nodes):
    rows = [undiagnosed(row) for row in CHECKS if row.key in KEYS]
    results = []
    with closing(open_host("gl")) as host:
        for subject in (*SUBJECTS, *PBR_SUBJECTS):
            if not nodes or subject.node in nodes:
                probe = probe_type_of(subject, PairProbe)(host, subject, library)
                fewer = {key: value for key, value in FEWER.items() if hasattr(probe.usual, key)}
                probe = type(probe)(host, subject, library, replace(probe.usual, **fewer))
                results += judge_subject(probe, rows)
    print(json.dumps({f"{each.check}, {each.subject}": each.verdict for each in results}))


if __name__ == "__main__":
    main(*sys.argv[1:])
