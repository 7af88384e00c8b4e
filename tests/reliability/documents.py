# SPDX-License-Identifier: Apache-2.0
"""Documents of a folder on every target: what MaterialX generates and mxeon refuses, and the reverse.

    python -m tests.reliability --folder FOLDER

The folder `resources` of MaterialX's repository holds its own documents. They may name files outside
their folders, and bring code.
"""

import contextlib
import os
import tempfile
from collections import Counter
from pathlib import Path

import MaterialX as mx
import MaterialX.PyMaterialXGenShader as mx_gen

from mxeon.errors import MxeonError
from mxeon.jobs import pool
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.generation import TARGETS, generate
from mxeon.shaders.generators import context_of, generator_of
from mxeon.shaders.library import load_library

WORKERS = 2
LIMIT = 120.0  # seconds for one document and target
LIBRARIES = ("stock", "eonlib")
POLICY = Policy(outside=True, code=True)


def measure(folder, progress=iter):
    """Figures of all documents in a folder."""
    files = sorted(Path(folder).rglob("*.mtlx"))
    jobs = [(str(file), target) for target in TARGETS for file in files]
    rows, refused = {target: Counter() for target in TARGETS}, []
    for place, outcome in progress(pool.run(attempt, jobs, WORKERS, LIMIT), total=len(jobs)):
        file, target = jobs[place]
        plain, *reasons = outcome.value or ("", outcome.failure, outcome.failure)
        rows[target].update(materialx=int(not plain))
        for library, reason in zip(LIBRARIES, reasons, strict=True):
            rows[target].update({library: int(not reason)})
            if reason and not plain:
                name = str(Path(file).relative_to(folder))
                refused.append([name, target, library, reason.replace(str(folder), "")])
    return {
        "documents": len(files),
        "version": mx.getVersionString(),
        "rows": rows,
        "refused": sorted(refused),
    }


def attempt(job):
    """Reasons why MaterialX, and mxeon with each library, generate no shader; "" where they do."""
    file, target = job
    return _plain(file, target), *(_checked(file, target, library) for library in LIBRARIES)


def _checked(file, target, library):
    with _silent():
        try:
            generate(file, target, library=library, policy=POLICY)
        except MxeonError as error:
            return str(error)
    return ""


def _plain(file, target):
    """Why MaterialX alone generates no shader of a document."""
    document, path = mx.createDocument(), mx.FileSearchPath(os.path.dirname(file))
    try:
        with _silent():
            mx.readFromXmlFile(document, file, path)
            document.setDataLibrary(load_library("stock"))
            generator = generator_of(document, target, "stock", None)
            context = context_of(document, target, generator, "eonlib", False, ())
            elements = mx_gen.findRenderableElements(document)
            shaders = [
                generator.generate(f"s{n}", each, context) for n, each in enumerate(elements)
            ]
            texts = [each.getSourceCode("pixel") for each in shaders]
    except (mx.Exception, mx.ExceptionParseError, LookupError, UnicodeError) as error:
        return str(error).strip() or "refused"
    return "" if all(texts) and texts else "no renderable element"


@contextlib.contextmanager
def _silent():
    """Keep what generators print, also those in C++, out of the way."""
    with tempfile.TemporaryFile() as file:
        kept = os.dup(2)
        os.dup2(file.fileno(), 2)
        try:
            yield
        finally:
            os.dup2(kept, 2)
            os.close(kept)
