# SPDX-License-Identifier: Apache-2.0
"""What takes long, made by one of pytest's processes for all of them."""

import os
import pickle

import pytest
from filelock import FileLock

import mxeon
from mxeon.shaders.library import examples_folder
from tests.support.plans import keep

# Documents that are judged with each library: eonlib has to show all examples right.
EXAMPLES = [examples_folder() / name for name in ("plaster.mtlx", "openpbr_rough_base.mtlx")]
DOCUMENTS = {"eonlib": sorted(examples_folder().glob("*.mtlx")), "stock": EXAMPLES}


_MADE = {}  # by name, where one process tests


def shared(factory, name, make):
    """The value of `make`; where several processes test, that of the first of them to ask."""
    if "PYTEST_XDIST_WORKER" not in os.environ:
        if name not in _MADE:
            _MADE[name] = make()
        return _MADE[name]
    path = factory.getbasetemp().parent / f"{name}.pickle"  # a folder of this session alone
    with FileLock(f"{path}.lock"):
        if not path.exists():
            path.write_bytes(pickle.dumps(make()))
        return pickle.loads(path.read_bytes())


# Checks of the text for path tracers, whose program of a surface shader takes a driver seconds.
DRAWN = ("pdf", "sample", "path_value", "path_inside", "path_energy", "path_leaving", "path_albedo")


def every_node(factory, library):
    """Every node and some documents on gl with a library, judged once for all tests that read the results.

    The text of surface shaders for path tracers is judged by `test_path_tracing.py`, and by the longest tests.
    """

    def make():
        with pytest.MonkeyPatch.context() as patch:
            keep(
                patch,
                lambda task: task.check not in DRAWN or not task.subject.endswith("every lobe"),
            )
            return mxeon.check(DOCUMENTS[library], ["gl"], [library], nodes=["all"])

    return shared(factory, library, make)
