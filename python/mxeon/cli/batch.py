# SPDX-License-Identifier: Apache-2.0
"""Runs `generate` and `render` in worker processes, because a document may crash a process."""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable, Generator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import mxeon
from mxeon.errors import DocumentError, InputError, MxeonError, NotRun, printable
from mxeon.jobs import check_timeout

if TYPE_CHECKING:
    from mxeon.shaders.document.policy import Policy
    from mxeon.shaders.scene import Paths


class WorkerCrashed(NotRun):
    pass


@dataclass(frozen=True)
class BatchResult:
    """The value of a job, or the error that ended the job."""

    value: Any
    warnings: tuple[str, ...] = ()
    error: Exception | None = None


def run_batch(
    work: Callable[[Any], Any], documents: Sequence[Any], workers: int, timeout: float
) -> Generator[BatchResult, None, None]:
    """Run `work` on each document, and yield results in order.

    Closing the generator stops the processes. `work` must be importable by name. `timeout` is the
    maximum time of a document in seconds.
    """
    if workers < 0:
        raise InputError(f"workers must be at least 0; got {workers}")
    check_timeout(timeout)
    work = partial(_work, work)
    if workers == 0:
        yield from map(work, documents)
        return
    from mxeon.jobs import pool

    outcomes = pool.in_order(pool.run(work, documents, workers, timeout))
    for document, outcome in zip(documents, outcomes, strict=True):
        error = WorkerCrashed(f"{document}: {outcome.failure}")
        yield outcome.value or BatchResult(None, error=error)


def _work(work: Callable[[Any], Any], document: Any) -> BatchResult:
    with warnings.catch_warnings(record=True) as records:
        warnings.simplefilter("always")
        value, error = None, None
        try:
            value = work(document)
        except (MxeonError, OSError) as reason:
            error = reason
    lines: list[str] = []
    for each in (record.message for record in records):
        lines += each.args if isinstance(each, DocumentError) else (str(each),)
    return BatchResult(value, tuple(lines), error)


@dataclass(frozen=True)
class Source:
    file: str
    target: str

    def __str__(self) -> str:
        return f"{self.file}: {self.target}"


ENDINGS = {"pixel": ".frag", "vertex": ".vert"}  # suffixes of MaterialX's generateshader


def stem(file: str) -> str:
    """First part of the file names of a document's shaders."""
    return " ".join(printable(Path(file).stem).split())


def shader_texts(source: Source, element: str | None, **options: Any) -> dict[str, str]:
    """Texts of a document's shaders, keyed by file name. `mxeon.generate` has the same options."""
    from mxeon.shaders.generation import generate

    texts = {}
    for shader in generate(source.file, source.target, element, **options):
        name = f"{stem(source.file)}.{shader.name}.{source.target}"
        for stage, text in shader.stages.items():
            texts[name + (ENDINGS[stage] if len(shader.stages) > 1 else "")] = text
    return texts


def picture(
    file: str,
    host: str,
    scene: str | None,
    environment: str | None,
    size: int,
    shape: str | None,
    element: str | None,
    library: str,
    policy: Policy,
    paths: Paths,
) -> tuple[Any, dict[str, str]]:
    """Render a document's only material; return linear pixels, (size, size, 3), and metadata.

    The default scene is a shader ball in the studio. Hosts that draw no images show a sphere that
    is lit from the side, and issue a warning. `environment` is a latitude-longitude image. A
    LobeWarning reports lobes that the host cannot render correctly.
    """
    from mxeon.conformance import reference
    from mxeon.hosts import open_host, path_tracer
    from mxeon.hosts.base import LobeWarning
    from mxeon.hosts.still import still
    from mxeon.shaders import scene as scenes
    from mxeon.shaders.document.notes import MissingFileWarning

    setting = scenes.scene(scene or "studio")
    if environment:
        light = setting.light if scene else None
        setting = scenes.Scene("environment", light, Path(environment))
    with open_host(host, reference.ROW, path_tracer.ROW) as engine:
        if no_studio := not (scene or environment or engine.draws_images):
            setting = scenes.SIDE
        setting = replace(setting, size=size, paths=paths, shape=shape or setting.shape)
        with warnings.catch_warnings():
            warnings.simplefilter("error", MissingFileWarning)
            shaders = engine.compile(file, element, library=library, policy=policy)
        if len(shaders) > 1:
            names = ", ".join(each.element for each in shaders)
            raise InputError(f"--element must name one of {names}; got none")
        [shader] = shaders
        image = still(engine, shader, setting)
        for reason in engine.approximations(shader, setting):
            warnings.warn(LobeWarning(shader.element, reason), stacklevel=2)
        if no_studio:
            reason = "cannot draw the studio's environment; used --scene side --shape sphere"
            warnings.warn(f"{host}: {reason}", stacklevel=2)
        identity = engine.identity()
    return image, {
        "version": mxeon.__version__,
        "host": f"{identity.name} {identity.version}",
        "device": identity.device,
        "library": library,
        "document": file,
        "element": shader.element,
        "scene": setting.name,
        "shape": setting.shape,
    } | ({"definitions": os.pathsep.join(policy.definitions)} if policy.definitions else {})
