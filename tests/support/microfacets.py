# SPDX-License-Identifier: Apache-2.0
"""Judges the microfacet nodes of a library with the MaterialX of this process.

python -m tests.support.microfacets FOLDER     prints the verdicts as JSON
"""

import json
import sys
from contextlib import closing
from dataclasses import replace

from mxeon.conformance.checks.application import judge_subject
from mxeon.conformance.checks.table import CHECKS
from mxeon.conformance.diagnosis.candidates import Diagnosis
from mxeon.conformance.probes.families import PBR_SUBJECTS, probe_type_of
from mxeon.conformance.probes.pairs import PairProbe
from mxeon.hosts import open_host

NODES = ("dielectric_bsdf", "conductor_bsdf", "generalized_schlick_bsdf")
KEYS = ("value", "film")
FEWER = {"pairs": 1 << 9, "few": 1 << 8, "albedos": 1 << 5, "materials": 32, "mirrored": 1 << 9}


def main(library):
    quick = {"diagnose": lambda probe: Diagnosis("")}  # which takes long
    rows = [replace(row, **quick) for row in CHECKS if row.key in KEYS]
    results = []
    with closing(open_host("gl")) as host:
        for subject in PBR_SUBJECTS:
            if subject.node in NODES:
                probe = probe_type_of(subject, PairProbe)(host, subject, library)
                probe = type(probe)(host, subject, library, replace(probe.usual, **FEWER))
                results += judge_subject(probe, rows)
    print(json.dumps({f"{each.check}, {each.subject}": each.verdict for each in results}))


if __name__ == "__main__":
    main(sys.argv[1])
