# SPDX-License-Identifier: Apache-2.0
"""The tests of numbers with the instructions of other processors.

NumPy chooses its vector instructions, and OpenBLAS its kernels, when it is loaded; both can be told
to take those of an older or another processor. Sines, powers and sums then differ in their last
digits, as they do between machines.

    python -m tests.reliability processors
"""

import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from xml.etree import ElementTree

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
TESTS = ROOT / "tests"
LIMIT = 3600  # seconds for the tests of one processor
SIMD, CORE = "NPY_DISABLE_CPU_FEATURES", "OPENBLAS_CORETYPE"
CORES = ("Haswell", "SkylakeX", "Zen", "Prescott")

# Tests whose bounds are roundings of float64, and those of shader functions and samplers in float32.
FILES = (
    "albedo",
    "callable",
    "catalog",
    "coat",
    "errors_models",
    "errors_sampling",
    "tools",
    "fresnel",
    "host_reference",
    "images",
    "inversion",
    "microfacet",
    "microfacet_albedo",
    "models",
    "other_models",
    "sampling",
    "sampling_ggx",
    "sampling_statistics",
    "sampling_twins",
    "sampling_variance",
    "scene",
    "sheen",
    "subsurface",
    "transmission",
    "twins",
)
# Tests left out, whose bounds are roundings of float32, printed digits or noise: all are far above
# what instructions change.
COARSE = (
    "browser",
    "cycles",
    "docs",
    "fits",
    "drjit_arrays",
    "document_hosts",
    "gl",
    "hosts",
    "inversion_nodes",
    "kit",
    "library",
    "mitsuba",
    "paths",
    "specular",
    "subsurface_blur",
    "tracer",
    "upstream",
    "version_table",
)

# What a process that is told so says of itself.
ASK = """
import numpy
print(*numpy.show_config(mode="dicts")["SIMD Extensions"].get("found", ["none"]))
"""


def measure(progress=iter):
    """Outcomes of the tests for each choice of instructions.

    Returns
    -------
    dict
        numpy: its version; baseline: instructions that it always uses; rows: for each choice, the
        variable and its value, the instructions and the kernels that were used, and how many tests
        passed, failed and were skipped.
    """
    baseline = np.show_config(mode="dicts")["SIMD Extensions"]["baseline"]
    rows = [_row(*choice) for choice in progress(choices())]
    return {"numpy": np.__version__, "baseline": baseline, "rows": rows}


def choices():
    """Variable and value of each choice: the best instructions, fewer and fewer, other kernels.

    Returns
    -------
    list of (str, str)
    """
    levels = np.show_config(mode="dicts")["SIMD Extensions"].get("found", [])
    fewer = [" ".join(levels[first:]) for first in reversed(range(len(levels)))]
    return [(SIMD, ""), *((SIMD, names) for names in fewer), *((CORE, core) for core in CORES)]


def _row(variable, value):
    environment = os.environ | {variable: value} if value else dict(os.environ)
    simd, core = _used(environment)
    row = {"variable": variable, "value": value, "simd": simd, "core": core}
    with TemporaryDirectory(prefix="mxeon-processors-") as folder:
        report = Path(folder, "junit.xml")
        tests = [str(*TESTS.rglob(f"test_{name}.py")) for name in FILES]
        command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *tests]
        command.append(f"--junitxml={report}")
        subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, timeout=LIMIT)
        return row | counts(report.read_text())


def _used(environment):
    """What NumPy says of its instructions, and OpenBLAS of its kernels."""
    command = [sys.executable, "-c", ASK]
    loud = environment | {"OPENBLAS_VERBOSE": "2"}
    done = subprocess.run(command, env=loud, capture_output=True, text=True, check=True)
    cores = [line.removeprefix("Core: ") for line in done.stderr.splitlines() if "Core: " in line]
    return done.stdout.strip(), cores[0] if cores else "unknown"


def counts(report):
    """How many tests of a JUnit report passed, failed and were skipped, and which failed."""
    cases = ElementTree.fromstring(report).findall(".//testcase")
    wrong = {"failure", "error"}
    failed = [case.get("name") for case in cases if wrong & {part.tag for part in case}]
    skipped = sum(case.find("skipped") is not None for case in cases)
    passed = len(cases) - len(failed) - skipped
    return {"passed": passed, "failed": failed, "skipped": skipped}
