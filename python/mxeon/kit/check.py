# SPDX-License-Identifier: Apache-2.0
"""Check pictures that a renderer made from the scenes of the kit."""

import json
import platform
from collections.abc import Callable, Iterable, Iterator, Sequence
from importlib.metadata import version
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
import OpenImageIO as oiio
from numpy.typing import NDArray

import mxeon
from mxeon.conformance import words
from mxeon.conformance.results import FAILED, NO_DIAGNOSIS, NOT_RUN, Picture, Result, Run, quoted
from mxeon.errors import ImageError, InputError, NotRun
from mxeon.hosts.base import Identity
from mxeon.io.files import regular
from mxeon.io.images import open_image
from mxeon.io.images import words as on_one_line
from mxeon.kit.expected import judged, pixel_means
from mxeon.kit.export import DESCRIPTION, KIT_FORMAT, RENDERS, description
from mxeon.kit.noise import student_quantile
from mxeon.kit.questions import Question, answer, one_model, questions
from mxeon.kit.scenes import unit_sphere
from mxeon.kit.views import LAMBERT, MATERIALS, View, views
from mxeon.models import table
from mxeon.shaders.scene import sphere

RENDERER = "renderer"
LIBRARY = "its own library"
SOFTWARE = ("numpy", "scipy", "OpenImageIO")
# Keys of kit.json that must match exactly. The key `scenes` is left out, because the last digits of
# the scenes depend on the exporting machine.
EXACT = ("camera", "sphere", "materials", "pictures")
READABLE = "The picture exists and has the right size and finite, linear floats."
CHANNELS = "RGB"
LEVELS = 255  # largest eight-bit value
ROUNDED = LEVELS * 2.0**-12  # largest rounding of a half float below 1, in eight-bit steps
FLOATS = ("half", "float", "double")
# A smoothly shaded picture has about as many distinct values as pixels. After rounding to eight
# bits, less than a quarter as many values as pixels are distinct.
DISTINCT = 4


class Missing(ValueError):
    """The file of a picture does not exist."""


class Unusable(ValueError):
    """A picture cannot be judged, for a reason that the message states."""


def check_kit(
    folder: str | PathLike[str],
    renderer: str = RENDERER,
    progress: Callable[[Sequence[Question]], Iterable[Question]] = list,
    claims: str = "",
) -> Run:
    """Check the pictures in a kit's folder `renders/`, and return the run.

    If the renderer has only one model, `claims` is the name of the model, and pictures of other
    models are not needed. For a renderer with EON and QON, `claims` is "". The run's notes name the
    nearest models. The first note names a model that all pictures show, if there is such a model.
    """
    student_quantile()  # fails if scipy is missing
    if not renderer.strip() or not renderer.isprintable():
        raise InputError(f"renderer must be a name on one line; got {renderer!r}")
    folder = Path(folder)
    posed, depth = questions(claims), unit_sphere().depth
    needed = [view for view in views(_size(folder)) if any(each.includes(view) for each in posed)]
    place: dict[str, Any] = {"host": renderer, "library": LIBRARY}
    images: dict[str, NDArray[np.float64]] = {}  # usable pictures by name
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
            f"{folder / RENDERS}: none of the {len(needed)} pictures exists: render them as "
            f"{folder / 'README.md'} describes"
        )
    # The question about light and encoding comes first. If the setup is wrong, models are
    # indistinguishable, and the other questions are not answered.
    notes, obstacle = [], NO_DIAGNOSIS
    for question in progress(posed):
        result, found = answer(question, needed, images, depth, place, obstacle)
        results.append(result)
        if question.key == "setup":
            obstacle = found
        if found.causes:
            notes.append(f"{question.title}: {words.diagnosis(found)}")
    # If a model is wrong, all pictures may show the same wrong model.
    wrong = any(each.check == "model" and each.verdict == FAILED for each in results)
    if wrong and (title := one_model(posed, needed, images, depth)):
        notes.insert(0, f"all pictures of rough materials show the same model: {title}")
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
        case {LAMBERT.name: {"node": str(node)}}:  # any name is valid
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


# --- submitted pictures ------------------------------------------------------------------------


def read_render(folder: str | PathLike[str], view: View) -> NDArray[np.float64]:
    """Linear float64 values of a view's picture, 0 off the sphere. Raises Missing or Unusable."""
    files = sorted(Path(folder).glob(f"{view.name}.*"))
    if not files:
        raise Missing(f"{view.name}.exr: must be in {folder}; got no such file")
    if len(files) > 1:
        raise Unusable(f"{view.name}: must be one file; got {', '.join(f.name for f in files)}")
    try:
        image = _read_image(files[0], view.scene.size)
        mask = sphere(view.scene.size).mask
        bad = ~np.isfinite(image).all(axis=-1) & mask
        if bad.any():
            row, column = np.argwhere(bad)[0]
            raise Unusable(
                f"pixels on the sphere must be finite numbers; got {image[row, column].tolist()} "
                f"at row {row}, column {column}, {bad.sum()} in all"
            )
        _check_depth(image[mask])
    except Unusable as error:
        raise Unusable(f"{files[0].name}: {error}") from None
    return np.where(mask[..., None], image, 0.0)


def _read_image(file: Path, size: int) -> NDArray[np.float64]:
    try:
        image = open_image(file)
    except ImageError as error:
        raise Unusable(f"must be an EXR file; {error.reason}") from None
    spec = image.spec()
    if (spec.width, spec.height) != (size, size):
        raise Unusable(f"must be {size} x {size} pixels; got {spec.width} x {spec.height}")
    if (offset := (spec.x - spec.full_x, spec.y - spec.full_y)) != (0, 0):
        raise Unusable(f"must begin at the display window's corner; got {offset}")
    if str(spec.format) not in FLOATS:
        raise Unusable(f"must hold half or float numbers; got {spec.format}")
    try:
        channels = _channels(spec.channelnames)
    except UnicodeDecodeError:
        raise Unusable("must have channel names in UTF-8") from None
    # Only red, green and blue are read, because even a small file may have thousands of channels.
    read = [image.read_image(0, 0, each, each + 1, oiio.FLOAT) for each in channels]
    pixels = [each for each in read if each is not None]
    reason = on_one_line(image.geterror)
    image.close()
    if reason or len(pixels) < len(read):
        raise Unusable(f"must be a complete image; {reason}")
    return np.concatenate(pixels, axis=-1, dtype=np.float64)


def _channels(names: Sequence[str]) -> list[int]:
    """Indices of the channels R, G and B without a layer, or of the only layer with R, G and B."""
    layers: dict[str, dict[str, int]] = {}
    for index, name in enumerate(names):
        layer, _, channel = name.rpartition(".")
        layers.setdefault(layer, {})[channel.upper()] = index
    complete = {layer: rgb for layer, rgb in layers.items() if rgb.keys() >= set(CHANNELS)}
    chosen = complete.get("") or (len(complete) == 1 and next(iter(complete.values())))
    if not chosen:
        raise Unusable(f"must hold one R, G and B; got channels {', '.join(names)}")
    return [chosen[channel] for channel in CHANNELS]


def _check_depth(values: NDArray[np.float64]) -> None:
    """Refuse a picture with few distinct values that are all multiples of 1 / 255 up to 1."""
    distinct = len(np.unique(values))
    steps = values * LEVELS
    rounded = values.max() <= 1.0 and np.abs(steps - np.rint(steps)).max() <= ROUNDED
    if 2 < distinct < len(values) / DISTINCT and rounded:
        rule = "must hold numbers that were never quantized to 8 bits"
        raise Unusable(f"{rule}; got multiples of 1/255")
