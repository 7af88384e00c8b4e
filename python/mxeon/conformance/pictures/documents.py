# SPDX-License-Identifier: Apache-2.0
"""Documents on hosts that make no pictures: their shaders are generated, and not run."""

import warnings
from pathlib import Path

from mxeon.conformance.results import FAILED, PASSED, Control, Result
from mxeon.errors import DocumentError, NotRun
from mxeon.hosts import host_row
from mxeon.shaders.document.notes import DocumentWarning, MissingFileWarning
from mxeon.shaders.document.policy import DEFAULT, Policy
from mxeon.shaders.generation import TARGETS, CodeWarning, generate

DOCUMENT_KEY = "document"
DOCUMENT_CLAIM = "Shaders are generated from every material of the document."


def generate_document(
    file: Path, host: str, library: str, policy: Policy = DEFAULT
) -> tuple[tuple[Result, ...], tuple[tuple[str, str], ...]]:
    """Result of generating a document's shaders for a host's target, and notes with their location.

    Raise DocumentError if no shader can be made from the document; NotRun if the host reads no
    documents, or this MaterialX has no generator for its target.
    """
    target = host_row(host).target
    if not target:
        raise NotRun(f"{host}: this renderer only has its own materials; it reads no documents")
    if target not in TARGETS:
        raise NotRun(f"{host}: this MaterialX has no generator for {target}")
    with warnings.catch_warnings(record=True) as records:
        warnings.simplefilter("always")
        warnings.simplefilter("error", MissingFileWarning)
        shaders = generate(file, target, library=library, policy=policy)
    notes = tuple(
        (str(record.message), file.name)
        for record in records
        if isinstance(record.message, (CodeWarning, DocumentWarning))
    )
    data = file.read_bytes()
    half = data[: len(data) // 2].decode(errors="replace")
    try:
        generate(half if "<" in half else "<", target, library=library)
        caught = False
    except DocumentError:
        caught = True
    result = Result(
        DOCUMENT_KEY,
        DOCUMENT_CLAIM,
        file.name,
        host,
        library,
        PASSED if shaders and caught else FAILED,
        error=float(not shaders),
        unit="documents without a shader",
        tolerance=0,
        derivation="a count",
        control=Control("half of the document is cut off", float(caught), caught),
    )
    return (result,), notes
