# SPDX-License-Identifier: Apache-2.0
"""Check the pictures that a renderer made from the kit."""

import json
import platform
from collections.abc import Callable, Iterable, Iterator, Sequence
from importlib.metadata import version
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import mxeon
from mxeon.conformance import words
from mxeon.conformance.results import FAILED, NO_DIAGNOSIS, NOT_RUN, Picture, Result, Run, quoted
from mxeon.errors import InputError, NotRun
from mxeon.hosts.base import Identity
from mxeon.io.files import regular
from mxeon.kit.expected import judged, pixel_means
from mxeon.kit.export import DESCRIPTION, KIT_FORMAT, RENDERS, description
from mxeon.kit.mesh import unit_sphere
from mxeon.kit.noise import student_quantile
from mxeon.kit.questions import Question, answer, one_model, questions
from mxeon.kit.submitted import Missing, Unusable, read_render
from mxeon.kit.views import LAMBERT, MATERIALS, views
from mxeon.models import table

RENDERER = "renderer"
LIBRARY = "its own library"
SOFTWARE = ("numpy", "scipy", "OpenImageIO")
# Keys of kit.json that must match exactly; the last digits of scenes depend on the exporting machine.
EXACT = ("camera", "sphere", "materials", "pictures")
READABLE = "The picture is there, of the right size, linear float, and finite."


def check_kit(
    folder: str | PathLike[str],
    renderer: str = RENDERER,
    progress: Callable[[Sequence[Question]], Iterable[Question]] = list,
    claims: str = "",
) -> Run:
    """Check the pictures in a kit's folder `renders/`, and return the run.

    `claims` is a renderer's only model, so that pictures of other models are not needed, or "" for
    EON and QON. The run's notes name the nearest models, first a model that all pictures show.
    """
    student_quantile()  # fail early without scipy
    if not renderer.strip() or not renderer.isprintable():
        raise InputError(f"renderer must be a name on one line; got {renderer!r}")
    folder = Path(folder)
    posed, depth = questions(claims), unit_sphere().depth
    needed = [view for view in views(_size(folder)) if any(each.includes(view) for each in posed)]
    place: dict[str, Any] = {"host": renderer, "library": LIBRARY}
    images: dict[str, NDArray[np.float64]] = {}  # usable pictures
    results: list[Result] = []
    pictures: list[Picture] = []
    for view in needed:
        about = {"check": "file", "claim": READABLE, "subject": view.name, **place}
        try:
            images[view.name] = read_render(folder / RENDERS, view)
        except Missing as error:
            results.append(Result(**about, verdict=NOT_RUN, reason=str(error)))
        except Unusable as error:
            results.append(Result(**about, verdict=FAILED, diagnosis=quoted(str(error))))
        else:
            mask, name, scene = judged(view.scene), view.material.name, view.scene.name
            reference = np.zeros((*mask.shape, 3))
            reference[mask] = pixel_means(table.diffuse_model(claims or view.material.model), view)
            pictures.append(
                Picture(
                    document=f"{name}.mtlx",
                    element=name,
                    **place,
                    scene=scene,
                    image=images[view.name].astype(np.float32) * mask[..., None],
                    reference=reference,
                    metadata={"version": mxeon.__version__, "scene": scene} | place,
                )
            )
    if all(each.verdict == NOT_RUN for each in results) and not images:
        raise NotRun(
            f"{folder / RENDERS}: none of the {len(needed)} pictures is there: make them as "
            f"{folder / 'README.md'} describes"
        )
    # Answer the questions in order: a wrong light or encoding makes models indistinguishable, so a
    # wrong setup prevents all other answers.
    notes, obstacle = [], NO_DIAGNOSIS
    for question in progress(posed):
        result, found = answer(question, needed, images, depth, place, obstacle)
        results.append(result)
        if question.key == "setup":
            obstacle = found
        if found.causes:
            notes.append(f"{question.title}: {words.diagnosis(found)}")
    # If a model is wrong, find out whether all pictures show the same wrong model.
    wrong = any(each.check == "model" and each.verdict == FAILED for each in results)
    if wrong and (title := one_model(posed, needed, images, depth)):
        notes.insert(0, f"every picture of a rough material shows one model: {title}")
    return Run(
        version=mxeon.__version__,
        software={"Python": platform.python_version()} | {name: version(name) for name in SOFTWARE},
        hosts=(Identity(renderer, "version not given", "device not given"),),
        results=tuple(results),
        pictures=tuple(pictures),
        notes=tuple(notes),
        documents=tuple(folder / "materials" / f"{each.name}.mtlx" for each in MATERIALS),
    )


def kit_files(folder: str | PathLike[str]) -> Iterator[Path]:
    """The files that `check_kit` reads."""
    yield Path(folder, DESCRIPTION)
    yield from Path(folder, RENDERS).glob("*")


def _size(folder: Path) -> int:
    file = folder / DESCRIPTION
    try:
        with open(file, encoding="utf-8", opener=regular) as stream:
            kit = json.load(stream)
    except FileNotFoundError:
        rule = f"folder must hold {DESCRIPTION}, which kit export writes"
        raise InputError(f"{rule}; got {file.parent}") from None
    except (OSError, ValueError, RecursionError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise InputError(f"{file}: must be a kit's description; {reason}") from None
    if not isinstance(kit, dict):
        raise InputError(f"{file}: must be a kit's description; got {type(kit).__name__}")
    if type(kit.get("format")) is not int or kit["format"] != KIT_FORMAT:
        got = repr(kit.get("format"))
        raise InputError(f"{file}: format must be {KIT_FORMAT}; got {got}: export it again")
    size = kit.get("size")
    if type(size) is not int:
        raise InputError(f"{file}: size must be a whole number; got {size!r}: export it again")
    match kit.get("materials"):
        case {LAMBERT.name: {"node": str(node)}}:  # any node is valid
            pass
        case _:
            node = ""
    try:
        exported = json.loads(json.dumps(description(views(size), size, node)))
    except ValueError as error:
        raise InputError(f"{file}: {error}: export it again") from None
    for key in EXACT:
        if kit.get(key) != exported[key]:
            raise InputError(f"{file}: {key} must be as kit export writes it: export it again")
    return size
