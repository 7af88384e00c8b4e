# SPDX-License-Identifier: Apache-2.0
"""What the commands make of documents, in processes that a document may bring down."""

import warnings
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import mxeon
from mxeon.errors import InputError, MxeonError, NotRun, printable
from mxeon.jobs import pool


class Ended(NotRun):
    """The process that worked on a document ended, or did not end in time."""


@dataclass(frozen=True)
class Made:
    """What became of one piece of work.

    Attributes
    ----------
    value : object
        What was made, or None.
    warnings : tuple of str
    error : Exception or None
        Why nothing was made.
    """

    value: object
    warnings: tuple[str, ...] = ()
    error: Exception | None = None


def make(work, documents, workers, limit):
    """What `work` makes of each document, in their order.

    Parameters
    ----------
    work : callable (document) -> object
        Can be imported by name.
    documents : sequence
        Whatever `work` takes; its text stands in the message if the process ends.
    workers : int
        Processes that share the work; 0 for none but this.
    limit : float
        Seconds for one document in such a process.

    Yields
    ------
    Made

    Raises
    ------
    ValueError
        If `workers` is negative or `limit` is not positive.
    """
    if workers < 0:
        raise InputError(f"workers must be at least 0; got {workers}")
    work = partial(_made, work)
    if workers == 0:
        yield from map(work, documents)
        return
    outcomes = pool.in_order(pool.run(work, documents, workers, limit))
    for document, outcome in zip(documents, outcomes, strict=True):
        yield outcome.value or _ended(document, outcome.failure)


def _ended(document, failure):
    return Made(None, error=Ended(f"{document}: must be worked on to the end; {failure}"))


def _made(work, document):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            value, error = work(document), None
        except (MxeonError, OSError) as raised:
            value, error = None, raised
    return Made(value, tuple(str(each.message) for each in caught), error)


@dataclass(frozen=True)
class Source:
    """A document and the target that shaders are wanted for."""

    file: str
    target: str

    def __str__(self):
        return f"{self.file}: {self.target}"


def texts(source, element, **options):
    """Shader texts of a document by file name; options are those of `mxeon.generate`."""
    from mxeon.shaders.generation import generate

    stem = " ".join(printable(Path(source.file).stem).split())
    return {
        f"{stem}.{shader.name}.{source.target}{_ending(shader, stage)}": text
        for shader in generate(source.file, source.target, element, **options)
        for stage, text in shader.stages.items()
    }


def _ending(shader, stage):
    """As generateshader ends the names of files."""
    return {"pixel": ".frag", "vertex": ".vert"}[stage] if len(shader.stages) > 1 else ""


def picture(file, host, scene, environment, size, element, library, policy):
    """A picture of a document's one material, and what is to be said of it in a file.

    Parameters
    ----------
    file, host, scene, element, library : str
        Scene is a name that `mxeon.shaders.scene.scene` knows.
    environment : str or None
        A latitude-longitude image that takes the place of the scene's light.
    size : int
        Width and height in pixels.
    policy : Policy

    Returns
    -------
    ndarray, dict
    """
    from mxeon.conformance import reference
    from mxeon.shaders import scene as scenes
    from mxeon.shaders.document.notes import MissingFileWarning
    from mxeon.shaders.hosts import open_host

    shown = scenes.scene(scene)
    if environment:
        shown = scenes.Scene("environment", environment=Path(environment))
    with open_host(host, reference.ROW) as engine:
        with warnings.catch_warnings():
            warnings.simplefilter("error", MissingFileWarning)
            found = engine.compile(file, element, library=library, policy=policy)
        if len(found) > 1:
            known = ", ".join(shader.element for shader in found)
            raise InputError(f"--element must name one of {known}; got none")
        image = engine.picture(found[0], replace(shown, size=size))
        identity = engine.identity()
    return image, {
        "version": mxeon.__version__,
        "host": f"{identity.name} {identity.version}",
        "device": identity.device,
        "library": library,
        "document": file,
        "element": found[0].element,
        "scene": shown.name,
    }
