# SPDX-License-Identifier: Apache-2.0
"""The documents of a run, read before any other work: their nodes, and those that cannot be read."""

import re
from collections.abc import Generator, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from functools import cache, partial
from itertools import product
from pathlib import Path

from mxeon.conformance.diagnosis.regions import unreached
from mxeon.conformance.spec import Spec, ValueSpec
from mxeon.conformance.specs import ALL
from mxeon.conformance.specs.emission import EmittingSurface
from mxeon.conformance.specs.thin_films import FilmSpec
from mxeon.errors import DocumentError, MxeonError
from mxeon.jobs import pool
from mxeon.shaders.contents import ShownNode, document_nodes, node_of
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.library import examples_folder

LETTERS = re.compile(r"\(([A-Z]+)\)$")  # of a model, behind its name
Source = tuple[str, str]  # a file, and the library that it is read with


@dataclass(frozen=True)
class Survey:
    """What the documents of a run contain."""

    # Titles of the nodes of each document, by its path.
    nodes: dict[str, tuple[str, ...]] = field(default_factory=dict)
    # For each document, by title of a node, the regions that its inputs are not in.
    unreached: dict[str, dict[str, tuple[str, ...]]] = field(default_factory=dict)
    # Documents that cannot be read, each with the library that it is read with.
    unread: frozenset[Source] = frozenset()
    # As of `mxeon.conformance.results.Run`.
    refused: dict[str, tuple[str, ...]] = field(default_factory=dict)


def survey_documents(
    files: Sequence[str], libraries: Sequence[str], policy: Policy, workers: int, timeout: float
) -> Survey:
    """Read documents with each library, in worker processes unless there are none.

    A document that ends its worker has no nodes; the task that draws it says why.

    Raise MxeonError if a library cannot be used.
    """
    sources = [(file, library) for file in dict.fromkeys(files) for library in libraries]
    titles: dict[str, dict[str, set[str]]] = {file: {} for file in files}
    faults: dict[Source, tuple[str, ...]] = {}
    with closing(_answers(sources, policy, workers, timeout)) as answers:
        for (file, library), answer in zip(sources, answers, strict=True):
            if isinstance(answer, DocumentError):
                # An example that cannot be read is the library's fault.
                if not Path(file).resolve().is_relative_to(examples_folder()):
                    faults[file, library] = answer.args
            elif isinstance(answer, MxeonError):
                raise answer
            else:
                for (spec, mode), node in product(_modes(), answer or ()):
                    if _is(node, spec, mode):
                        regions = set(unreached(dict(node.values)))
                        titles[file].setdefault(spec.title, regions).intersection_update(regions)
    refused: dict[str, tuple[str, ...]] = {}
    for (file, library), lines in faults.items():
        if all((file, each) in faults for each in libraries):
            refused[file] = tuple(dict.fromkeys((*refused.get(file, ()), *lines)))
        else:  # another library can read it
            refused[f"{file} with {library}"] = tuple(f"{line} (with {library})" for line in lines)
    return Survey(
        {file: tuple(each) for file, each in titles.items()},
        {
            file: {title: tuple(sorted(each)) for title, each in found.items() if each}
            for file, found in titles.items()
        },
        frozenset(faults),
        refused,
    )


def _answers(
    sources: Sequence[Source], policy: Policy, workers: int, timeout: float
) -> Generator[tuple[ShownNode, ...] | MxeonError | None, None, None]:
    """The nodes of each document, or its error; None where reading it ended the process.

    Processes read until it is closed.
    """
    work = partial(document_nodes, policy)
    if not workers:
        yield from map(work, sources)
    elif sources:
        for outcome in pool.in_order(pool.run(work, sources, workers, timeout)):
            yield outcome.value


def _is(node: ShownNode, spec: Spec, mode: ShownNode) -> bool:
    if isinstance(spec, EmittingSurface) and spec.has_bsdf != ("bsdf" in dict(node.inputs)):
        return False
    return node.has(mode) and (node.film or not isinstance(spec, FilmSpec))


@cache
def _modes() -> tuple[tuple[Spec, ShownNode], ...]:
    """Every node that is judged, in the mode in which it is judged."""
    return tuple((row, node_of(row.document(), row.node)) for row in ALL)


def model_of(title: str) -> str:
    """Name of the model that a node has to be, by its title; its letters where it has some."""
    spec = next(row for row, _ in _modes() if row.title == title)
    own = spec.value_candidates if isinstance(spec, ValueSpec) else ()
    name = own[0].title if own else "as specified"
    letters = LETTERS.search(name)
    return letters[1] if letters else name
