# SPDX-License-Identifier: Apache-2.0
"""A renderer's pictures of the kit judged: what is in `renders/` in, a Run for the report out."""

import json
import platform
from importlib.metadata import version
from pathlib import Path

import numpy as np

import mxeon
from mxeon.conformance.results import FAILED, NOT_RUN, Picture, Result, Run
from mxeon.errors import InputError
from mxeon.io.files import regular
from mxeon.kit.expected import judged, pixel_means
from mxeon.kit.export import DESCRIPTION, KIT_FORMAT, RENDERS, description
from mxeon.kit.mesh import unit_sphere
from mxeon.kit.questions import QUESTIONS, answer
from mxeon.kit.renders import Missing, Unusable, read_render
from mxeon.kit.shots import MATERIALS, shots
from mxeon.models import table as reference
from mxeon.shaders.hosts.base import Identity
from mxeon.shaders.scene import sphere

RENDERER = "renderer"
LIBRARY = "its own library"
SOFTWARE = ("numpy", "scipy", "OpenImageIO")
# Not the scenes: the last digits of a direction are those of the machine that exported it.
EXACT = ("camera", "sphere", "materials", "pictures")
READABLE = "The picture is there, of the right size, linear float, and finite."


def check_kit(folder, renderer=RENDERER, progress=list):
    """The pictures in a kit's `renders/` judged.

    Parameters
    ----------
    folder : path-like
        Of the kit; it holds `kit.json` and `renders/`.
    renderer : str
        What the report calls who made them.
    progress : callable (sequence) -> iterable
        Goes through the questions; a progress bar, say.

    Returns
    -------
    Run
        Its notes name the models.

    Raises
    ------
    ValueError
        If `folder` is no kit, or one of another format, or `renderer` is no name to be printed.
    ImportError
        If scipy, of the `kit` extra, is not installed.
    """
    if not renderer.strip() or not renderer.isprintable():
        raise InputError(f"renderer must be a name on one line; got {renderer!r}")
    folder = Path(folder)
    pictures, depth = shots(_size(folder)), unit_sphere().depth
    place = {"host": renderer, "library": LIBRARY}
    images, results = _read(folder / RENDERS, pictures, place)
    notes, level = [], ""
    for question in progress(QUESTIONS):
        # Where the light is wrong, every model is: nothing else can be judged.
        result, words = answer(question, pictures, images, depth, place, obstacle=level)
        results.append(result)
        if question.key == "level":
            level = words
        if words:
            notes.append(f"{question.title}: {words}")
    return Run(
        version=mxeon.__version__,
        software={"Python": platform.python_version()} | {name: version(name) for name in SOFTWARE},
        hosts=(Identity(renderer, "version not given", "device not given"),),
        results=tuple(results),
        pictures=tuple(_pictures(pictures, images, place)),
        notes=tuple(notes),
        documents=tuple(folder / "materials" / f"{each.name}.mtlx" for each in MATERIALS),
    )


def _size(folder):
    """Width of the kit's pictures, from its description, which has to be that of this version."""
    file = folder / DESCRIPTION
    kit = _description(file)
    if type(kit.get("format")) is not int or kit["format"] != KIT_FORMAT:
        got = repr(kit.get("format"))
        raise InputError(f"{file}: format must be {KIT_FORMAT}; got {got}: export it again")
    size = kit.get("size")
    if type(size) is not int:
        raise InputError(f"{file}: size must be a whole number; got {size!r}: export it again")
    try:
        exported = json.loads(json.dumps(description(shots(size), size)))
    except ValueError as error:
        raise InputError(f"{file}: {error}: export it again") from None
    for key in EXACT:
        if kit.get(key) != exported[key]:
            raise InputError(f"{file}: {key} must be as kit export writes it: export it again")
    return size


def _description(file):
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
    return kit


def _read(folder, pictures, place):
    """The usable images by name, and a result for each file that is not."""
    images, results = {}, []
    for shot in pictures:
        about = {"check": "file", "claim": READABLE, "subject": shot.name, **place}
        try:
            images[shot.name] = read_render(folder, shot)
        except Missing as error:
            results.append(Result(**about, verdict=NOT_RUN, reason=str(error)))
        except Unusable as error:
            results.append(Result(**about, verdict=FAILED, diagnosis=str(error)))
    return images, results


def _pictures(pictures, images, place):
    """What could be read, each beside the model's picture."""
    for shot in pictures:
        if shot.name in images:
            made = {"version": mxeon.__version__, "scene": shot.scene.name}
            yield Picture(
                document=f"{shot.material.name}.mtlx",
                element=shot.material.name,
                **place,
                scene=shot.scene.name,
                image=images[shot.name].astype(np.float32) * judged(shot.scene)[..., None],
                reference=_model_picture(shot),
                metadata=made | place,
            )


def _model_picture(shot):
    """The model's values where they are judged, 0 elsewhere."""
    image = np.zeros((*sphere(shot.scene.size).mask.shape, 3))
    image[judged(shot.scene)] = pixel_means(reference.model(shot.material.model), shot)
    return image
