# SPDX-License-Identifier: Apache-2.0
"""What takes long, made by one of pytest's processes for all of them."""

import os
import pickle

from filelock import FileLock

import mxeon
from mxeon.shaders.library import examples_folder

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


def every_node(factory, library):
    """Every node and some documents on gl with a library, judged once for all tests that read the results."""
    documents = DOCUMENTS[library]
    return shared(
        factory, library, lambda: mxeon.check(documents, ["gl"], [library], nodes=["all"])
    )
