# SPDX-License-Identifier: Apache-2.0
"""Checks that a pixel with several lights or lobes shows the sum of separately evaluated parts.

For each axis of AXES, such as "lights", a pixel has one state, such as "two lights". Any two states
of different axes occur together in some pixels. The host that is judged also evaluates the parts,
so a wrong model passes, and a failure always means that the sum is wrong.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from itertools import combinations, product
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.conformance import backends, check, controls, diagnosis, results, samples
from mxeon.conformance.case import Case
from mxeon.conformance.checks.lobes import DARK
from mxeon.conformance.samples import Array, Batch, Mask, aimed, float32, rounded
from mxeon.conformance.spec import Ability, LobeSpec, broadcast_inputs
from mxeon.conformance.tolerance import Compared
from mxeon.hosts import base, calls
from mxeon.io.images import FAST_EXR, write_image
from mxeon.jobs.signals import Temporary
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.nodes import FRAME_INPUTS, with_images
from mxeon.shaders.scene import CLIENT, Client

if TYPE_CHECKING:  # the import loads MaterialX
    from mxeon.shaders.generation import Shader

EACH = 12  # pixels per combination of states: three 2 x 2 squares in a picture with two rows
STEP = 0.05  # angle between neighboring pixels of a bent surface with radius 1, in radians
VECTORS = ("normal", "tangent", "position", calls.SURFACE)
FLAT = calls.NORMAL, calls.TANGENT, (0.0, 0.0, 0.0), calls.NORMAL
# A pair of states is reported instead of a single state if the pair occurs in less than this share
# of the pixels that have the single state.
CLEARER = 0.7
Random = np.random.Generator
Layout = tuple[tuple[int, ...], tuple[int, ...]]  # shape and axis order that rearrange pixels


@dataclass(frozen=True)
class Pixels:
    """Pixels with the same combination of states."""

    batch: Batch
    states: tuple[str, ...]
    light: Array  # direction of a second light, in the local frame
    second: Mapping[str, Array] | None = None  # inputs of a second lobe
    second_frame: Array | None = None  # frame of the second lobe, None for the surface's frame
    differing: tuple[str, ...] = ()  # per pixel, the input in which two lobes differ
    lights: int = 1
    sky: str = ""  # environment: "uniform", "uneven", or "" for none
    client: Client = CLIENT  # how the environment is turned and scaled
    image: bool = False  # whether the last lobe's inputs are texels of an image


Build = Callable[[Pixels, Random], Pixels]


def same(pixels: Pixels, rng: Random) -> Pixels:
    return pixels


def lit(pixels: Pixels, rng: Random, count: int, first: float = 1.0, second: float = 1.0) -> Pixels:
    """Set the number of lights. If `first` or `second` is -1, that light is on the dark side."""
    wi = pixels.batch.wi
    batch = replace(pixels.batch, wi=wi * [1.0, 1.0, first])
    light = np.roll(wi, 1, axis=0) * [1.0, 1.0, second]
    return replace(pixels, batch=batch, lights=count, light=light)


def under(pixels: Pixels, rng: Random, sky: str, client: Client = CLIENT) -> Pixels:
    return replace(pixels, sky=sky, client=client)


def framed(
    pixels: Pixels,
    rng: Random,
    make: Callable[[Array, Random], Array] = lambda frames, rng: frames,
    along: bool = False,
    scaled: bool = False,
) -> Pixels:
    """Replace the frames by the result of `make`.

    If `along`, views are along the normal. If `scaled`, tangents lean and are not unit vectors.
    """
    batch = pixels.batch
    assert batch.frame is not None
    frame = make(batch.frame, rng)
    normal, tangent = frame[:, :, 2], frame[:, :, 0]
    if scaled:
        length = 10.0 ** rng.uniform(-1.0, 1.0, (len(frame), 1))
        tangent = length * (tangent + rng.uniform(-0.5, 0.5, (len(frame), 1)) * normal)
    axes = {"normal": float32(normal), "tangent": float32(tangent)}
    wo = np.broadcast_to(calls.NORMAL, batch.wo.shape) if along else batch.wo
    # If normals are coordinate axes, do not turn an uneven environment, because a normal may point
    # to a pole of the map, where the azimuth of a turned direction depends on roundings.
    client = CLIENT if make is on_axes and pixels.sky == "uneven" else pixels.client
    batch = replace(batch.altered(**axes), wo=wo, frame=frame)
    return replace(pixels, batch=batch, client=client)


def upright(frames: Array, rng: Random) -> Array:
    return np.broadcast_to(np.eye(3), frames.shape)


def on_axes(frames: Array, rng: Random) -> Array:
    """Frames in random order. All normals and half of the tangents are along coordinate axes."""
    turns = [np.roll(np.eye(3), shift, axis=0) for shift in range(3)]
    tangents = np.eye(3), np.array([[0.6, -0.8, 0.0], [0.8, 0.6, 0.0], [0.0, 0.0, 1.0]])
    rows = product(tangents, turns, ([1, 1, 1], [1, -1, -1]))
    return rng.permutation([turn * sign @ tangent for tangent, turn, sign in rows])


def bent(pixels: Pixels, rng: Random, columns: float = 0.0, rows: float = 0.0) -> Pixels:
    """Bend each square of pixels by the angles `columns` and `rows`, in radians per pixel."""
    batch, pixel = pixels.batch, np.arange(EACH)
    assert batch.frame is not None
    first, column, row = pixel // 4 * 4, pixel % 2, pixel // 2 % 2
    axes = [batch.inputs[name][first, :, np.newaxis] for name in ("normal", "tangent")]
    frame = np.concatenate([batch.frame[first], *axes], axis=2)
    local = np.stack([np.sin(columns * column), np.sin(rows * row), 0.0 * row], axis=1)
    local[:, 2] = np.sqrt(1.0 - (local**2).sum(axis=1))
    offset = STEP * np.stack([column * (not columns), row * (not rows), 0 * row], axis=1)
    up, position = (
        (frame[:, :, :3] @ each[:, :, np.newaxis])[:, :, 0] for each in (local, local + offset)
    )
    frame = aimed(frame, frame[:, :, 2], up)
    vectors = frame[:, :, 3], frame[:, :, 4], position, frame[:, :, 3]
    inputs = dict(zip(VECTORS, map(float32, vectors), strict=True))
    return replace(pixels, batch=replace(batch.altered(**inputs), frame=frame[:, :, :3]))


def doubled(pixels: Pixels, rng: Random, component: bool = False, swapped: bool = False) -> Pixels:
    """Add a second lobe that differs from the first lobe in one input or component per pixel."""
    first = broadcast_inputs(pixels.batch)
    second, differing = dict(first), [""] * EACH
    names = [name for name in first if name not in VECTORS]
    for row in range(EACH):
        name = differing[row] = names[(row + rng.integers(2)) % len(names)]
        values = second[name] = np.array(second[name])
        columns = rng.integers(values.shape[-1]) if component and values.ndim == 2 else ...
        values[row, columns] = first[name][row - 1, columns]
    inputs, second = (second, first) if swapped else (first, second)
    batch = replace(pixels.batch, inputs=inputs)
    return replace(pixels, batch=batch, second=second, differing=tuple(differing))


def leaning(pixels: Pixels, rng: Random) -> Pixels:
    """Add a second lobe with equal inputs but another normal, except in the first square of pixels.

    The normal of the second lobe is halfway between the surface's normal and the viewer.
    """
    batch = pixels.batch
    assert batch.frame is not None
    normal, leans = batch.frame[:, :, 2], np.arange(EACH) >= EACH // 3
    middle = batch.world(batch.wo) * leans[:, np.newaxis] + normal
    frame = aimed(batch.frame, normal, middle / np.linalg.norm(middle, axis=1, keepdims=True))
    axes = {"normal": float32(frame[:, :, 2]), "tangent": float32(frame[:, :, 0])}
    second = broadcast_inputs(batch) | axes
    differing = tuple("normal" if each else "" for each in leans)
    return replace(pixels, second=second, second_frame=frame, differing=differing)


def changed(pixels: Pixels, change: Callable[[Array], Array]) -> Pixels:
    """Apply a change to all inputs of both lobes except the frame."""
    batch, second = pixels.batch, pixels.second
    first, others = (
        {name: each if name in VECTORS else change(each) for name, each in values.items()}
        for values in (broadcast_inputs(batch), second or {})
    )
    return replace(pixels, batch=replace(batch, inputs=first), second=second and others)


def constant(pixels: Pixels, rng: Random) -> Pixels:
    row = rng.integers(EACH)
    differing = pixels.differing and (pixels.differing[row],) * EACH
    return replace(changed(pixels, lambda values: values[row]), differing=differing)


def in_image(pixels: Pixels, rng: Random) -> Pixels:
    """Read inputs from an image of half floats."""
    halves = changed(pixels, lambda values: values.astype(np.float16).astype(np.float64))
    return replace(halves, image=True)


TWO_SIDED, TURNED_SKY = "an environment: dim and two-sided", "an environment: turned"
# A rotation about y that maps each center of a sky texel to another center.
ANGLE = 37.0 * np.pi / samples.SKY_ROWS
COSINE, SINE = np.cos(ANGLE), np.sin(ANGLE)
ROTATION = np.array([[COSINE, 0.0, SINE], [0.0, 1.0, 0.0], [-SINE, 0.0, COSINE]])
TURNING = tuple((base.TURN @ np.pad(ROTATION, (0, 1))).T.ravel().tolist())
# States of a pixel by axis. The first state of an axis is the default, which other checks use.
# States with the same words before a colon form a group that a diagnosis can name.
AXES: dict[str, dict[str, Build]] = {
    "lights": {
        "one light": partial(lit, count=1),
        "no light": partial(lit, count=0),
        "two lights": partial(lit, count=2),
        "two lights: the second from behind": partial(lit, count=2, second=-1.0),
        "two lights: the first from behind": partial(lit, count=2, first=-1.0),
    },
    "environment": {
        "no environment": same,
        "an environment: uniform": partial(under, sky="uniform"),
        "an environment: uneven": partial(under, sky="uneven"),
        TWO_SIDED: partial(under, sky="uniform", client=Client(intensity=0.5, two_sided=True)),
        TURNED_SKY: partial(under, sky="uneven", client=Client(turn=TURNING)),
    },
    "frame": {
        "the surface's frame": partial(framed, make=upright),
        "a turned frame": framed,
        "a tangent that leans and is not of length 1": partial(framed, make=upright, scaled=True),
        "the normal on an axis": partial(framed, make=on_axes),
        "the normal on an axis: the view along it": partial(framed, make=on_axes, along=True),
    },
    "shape": {
        "a plane": bent,
        "a surface that bends: along the columns": partial(bent, columns=STEP),
        "a surface that bends: along the rows": partial(bent, rows=STEP),
        "a surface that bends: a sphere": partial(bent, columns=STEP, rows=STEP),
    },
    "lobes": {
        "one lobe": same,
        "two lobes: equal inputs": leaning,
        "two lobes: another input": doubled,
        "two lobes: another input: exchanged": partial(doubled, swapped=True),
        "two lobes: another component": partial(doubled, component=True),
        "two lobes: another component: exchanged": partial(doubled, component=True, swapped=True),
    },
    "inputs": {
        "inputs that vary": same,
        "constant inputs": constant,
        "inputs from an image": in_image,
    },
}


@lru_cache(maxsize=8)
def covering(axes: tuple[tuple[str, ...], ...]) -> tuple[tuple[str, ...], ...]:
    """Combinations of one state per axis that contain every pair of states from different axes.

    >>> covering((("a", "b"), ("x", "y"), ("1",)))
    (('a', 'x', '1'), ('b', 'y', '1'), ('a', 'y', '1'), ('b', 'x', '1'))
    """
    sizes = [len(axis) for axis in axes]
    rows = np.array(list(product(*map(range, sizes))))
    # For each combination of states, a mask of the pairs of states in the combination.
    masks = [
        np.eye(sizes[one] * sizes[other], dtype=bool)[rows[:, one] * sizes[other] + rows[:, other]]
        for one, other in combinations(range(len(axes)), 2)
    ]
    pairs, chosen = np.concatenate(masks, axis=1), []
    gain, missing = pairs.sum(axis=1), np.ones(pairs.shape[1], bool)
    while missing.any():
        best = int(gain.argmax())
        chosen.append(tuple(axis[state] for axis, state in zip(axes, rows[best], strict=True)))
        gain -= pairs[:, pairs[best] & missing].sum(axis=1)
        missing &= ~pairs[best]
    return tuple(chosen)


@lru_cache(maxsize=1)  # shared by a check and the check's negative control
def pixels_of(backend: backends.Backend) -> tuple[Pixels, ...]:
    """Pixels with combinations of the states that the node and the engine support."""
    lobe, rng = backend.lobe, samples.generator()
    # Unsupported states, and axes of which only the first state is supported.
    unsupported = {*lobe.plain, *backend.plain}
    if not backend.host.reads_images:
        unsupported.add("inputs from an image")
    if "frame" in unsupported:
        unsupported.add(TURNED_SKY)
    # The correct light from a dim, two-sided environment is unknown if a surface shader hides the
    # tints of lobes, or if opacity replaces refraction and ignores the environment's intensity.
    if Ability.MATERIAL in lobe.requires or backend.host.active.transmission == "opacity":
        unsupported.add(TWO_SIDED)
    axes = tuple(
        tuple(state for n, state in enumerate(each) if not n or not {name, state} & unsupported)
        for name, each in AXES.items()
    )
    rows = covering(axes)
    turned = backend.turned
    batch = turned.where(np.arange(EACH * len(rows)) % len(turned.wo))
    if lobe.curved:
        batch = batch.altered(**lobe.random_inputs(rng, len(batch.wo)))
    if lobe.types.get("roughness") == "vector2":
        alpha = np.array(batch.inputs["roughness"])
        alpha[::2, 1] = np.roll(alpha[:, 0], 1)[::2]  # half of the pixels have two different alphas
        batch = batch.altered(roughness=alpha)
    if "weight" in lobe.names:
        # Keep weights equal in each 2 x 2 square of pixels, because screen-space derivatives are
        # undefined where a shader skips a lobe of weight 0.
        weights = rng.choice((0.0, 0.3, 1.0, 1.0), len(batch.wo) // 4)
        batch = batch.altered(weight=np.repeat(weights, 4))
    groups = []
    for number, states in enumerate(rows):
        part = batch.where(slice(EACH * number, EACH * (number + 1)))
        pixels = Pixels(part, states, part.wi)
        for axis, state in zip(AXES.values(), states, strict=True):
            pixels = axis[state](pixels, rng)
        groups.append(pixels)
    return tuple(groups)


exchanged = controls.with_batch(
    "each pixel has another pixel's view and light",
    lambda batch: replace(batch, wo=np.roll(batch.wo, 1, axis=0), wi=np.roll(batch.wi, 1, axis=0)),
)


def states(case: Case) -> Iterator[Compared]:
    groups: Sequence[Pixels] = pixels_of(case.backend)
    if case.control:
        groups = [each for each in groups if not each.image][:6]
    # One picture shows all groups of pixels with the same shader and environment. Each group with
    # constant inputs needs a separate picture.
    pictures: dict[tuple[bool, bool, Client, bool, int], list[int]] = {}
    for number, pixels in enumerate(groups):
        alone = number if "constant inputs" in pixels.states else -1
        two, uneven = pixels.second is not None, pixels.sky == "uneven"
        key = two, uneven, pixels.client, pixels.image, alone
        pictures.setdefault(key, []).append(number)
    measured: dict[int, Array] = {}
    with Temporary("mxeon-states-") as folder:
        file = Path(folder, "inputs.exr")
        from_image = partial(imaged, case, file, {})
        for (two, uneven, client, image, _), numbers in pictures.items():
            batch = backends.joined([batch_of(groups[number]) for number in numbers])
            evaluate = partial(
                from_image if image else case.evaluating.together,
                irradiance=samples.sky_map() if uneven else None,
                client=client,
                two=two,
            )
            values = case.outputs(batch, drawn(case.inputs(batch), evaluate, SQUARES))
            measured |= zip(numbers, np.split(values, len(numbers)), strict=True)
    for number, (pixels, expected) in enumerate(zip(groups, sums(case, groups), strict=True)):
        yield Compared(pixels.batch, measured[number], expected)


# Layouts of pixels in a picture with two rows. SQUARES and TRANSPOSED form 2 x 2 squares. In the
# layout APART, pixels of a square are not neighbors.
SQUARES, TRANSPOSED = ((-1, 2, 2), (1, 0, 2)), ((-1, 2, 2), (2, 0, 1))
APART = (-1, EACH), (1, 0)


def drawn(batch: Batch, evaluate: Callable[[Batch], Array], layout: Layout) -> Array:
    shape, axes = layout
    order = np.arange(len(batch.wo)).reshape(shape).transpose(axes).ravel()
    values = np.empty_like(batch.wo)
    values[order] = evaluate(batch.where(order))
    return values


def imaged(
    case: Case,
    file: Path,
    shaders: "dict[bool, Shader]",
    batch: Batch,
    irradiance: NDArray[np.float32] | None,
    client: Client,
    two: bool,
) -> Array:
    """Light in pixels whose last lobe reads its inputs from an image.

    The image has a row for each input and a column for each pixel. Each entry has 2 x 2 equal
    texels. `shaders` caches the shader with one lobe and the shader with two lobes.
    """
    count, lobe = len(batch.wo), "second" if two else "lobe"
    paths = {name.removeprefix("second/"): name for name in batch.inputs if ("/" in name) == two}
    names = [name for name in paths if name in case.lobe.types and name not in VECTORS]
    texels, inputs = [], dict(batch.inputs)
    for row, name in enumerate(names):
        values = inputs.pop(paths[name]).reshape(count, -1)
        texels.append(np.concatenate([values, 1.0 - values, 1.0 - values], axis=1)[:, :3])
        middles = (np.arange(count) + 0.5) / count, np.full(count, 1.0 - (row + 0.5) / len(names))
        inputs[f"{lobe}_{name}_place/value"] = rounded(middles)
    write_image(file, np.asarray(texels, np.float32).repeat(2, axis=0).repeat(2, axis=1), FAST_EXR)
    if two not in shaders:
        ports = {f"{lobe}/{name}": case.lobe.types[name] for name in names}
        text = case.lobe.two_lobes() if two else case.lobe.document()
        document, policy = with_images(text, ports, str(file)), Policy(outside=True)
        [shaders[two]] = case.host.compile(document, library=case.library, policy=policy)
    evaluate, batch = case.evaluating.evaluate, replace(batch, inputs=inputs)
    return evaluate(batch, calls.LIT, irradiance=irradiance, shader=shaders[two], client=client)


def batch_of(pixels: Pixels) -> Batch:
    batch, count = pixels.batch, len(pixels.batch.wo)
    inputs: dict[str, ArrayLike] = {
        calls.LIGHTS: np.full(count, float(pixels.lights)),
        calls.SECOND_LIGHT: batch.world(pixels.light),
        calls.SKY: np.full(count, bool(pixels.sky)),
    }
    if second := pixels.second:
        inputs |= {f"second/{name}": second[name] for name in second if name not in VECTORS}
        for name in FRAME_INPUTS:
            vector = second[name.replace("curve_direction", "tangent")]
            inputs[f"second_{name}/value"] = vector
    return batch.altered(**inputs)


def sums(case: Case, groups: Sequence[Pixels]) -> list[Array]:
    """Expected light of each pixel: the sum of parts with one light and one lobe each.

    The parts are evaluated in another order of pixels, so that a pixel has other neighbors. Each
    part is evaluated on a plane in the surface's frame, except under an uneven sky. If a lobe
    depends on the surface's shape, the shape stays, but rows and columns of squares are exchanged.
    """
    curved = case.lobe.curved
    layout = TRANSPOSED if curved else APART
    totals = [np.zeros_like(pixels.batch.wo) for pixels in groups]
    parts: dict[str, list[tuple[int, Batch]]] = {}
    for number, pixels in enumerate(groups):
        batch = pixels.batch
        for inputs, frame in ((batch.inputs, None), (pixels.second, pixels.second_frame)):
            if inputs is None:
                continue
            wo, *lights = (
                each if frame is None else np.einsum("nij,ni->nj", frame, batch.world(each))
                for each in (batch.wo, batch.wi, pixels.light)
            )
            frame = batch.frame if frame is None else frame
            lobe = flat = replace(batch, inputs=inputs, wo=wo, wi=lights[0], frame=frame)
            if not curved:
                axes = dict(zip(VECTORS, FLAT, strict=True))
                flat = replace(lobe.altered(**axes), frame=None)
            for light in lights[: pixels.lights]:
                parts.setdefault("light", []).append((number, replace(flat, wi=light)))
            if pixels.sky:
                part = in_turn(lobe if pixels.sky == "uneven" else flat, pixels.client)
                parts.setdefault(pixels.sky, []).append((number, part))
    for kind, rows in parts.items():
        batch = backends.joined([each for _, each in rows])
        if kind == "light":
            values = drawn(batch, case.backend.direct, layout)
        else:
            sky = samples.sky_map() if kind == "uneven" else None
            values = drawn(batch, partial(case.backend.albedo, irradiance=sky), layout)
            if "tint" in batch.inputs and not case.opaque:  # two-sided light is tinted twice
                twice = np.repeat([groups[n].client.two_sided for n, _ in rows], EACH)
                tint = batch.inputs["tint"]
                batch = batch.altered(tint=np.where(twice[:, np.newaxis], tint * tint, tint))
            values += drawn(batch, partial(case.evaluating.transmitted, radiance=sky), layout)
        for (number, _), each in zip(rows, np.split(values, len(rows)), strict=True):
            totals[number] += each * (1.0 if kind == "light" else groups[number].client.intensity)
    return totals


def in_turn(batch: Batch, client: Client) -> Batch:
    """The batch, with the surface turned if the client turns the environment."""
    if client.turn == CLIENT.turn:
        return batch
    frame = np.eye(3) if batch.frame is None else batch.frame
    frame = np.broadcast_to(ROTATION @ frame, (len(batch.wo), 3, 3))
    axes = {
        name: float32(np.broadcast_to(batch.inputs.get(name, first), batch.wo.shape) @ ROTATION.T)
        for name, first in zip(VECTORS, FLAT, strict=True)
    }
    return replace(batch.altered(**axes), frame=frame)


def diagnose(case: Case) -> results.Diagnosis:
    tolerance, compared = case.tolerance("states"), list(states(case))
    wrong = np.concatenate(list(map(tolerance.wrong, compared)))
    names = []
    for group in pixels_of(case.backend):
        common = named(group.states, AXES)
        for name in group.differing or ("",) * EACH:
            names.append(common | {f"two lobes that differ in {name}"} if name else common)
    return results.Diagnosis((shared(wrong, names), *diagnosis.not_finite(compared)))


def shared(wrong: Mask, states: Sequence[set[str]]) -> results.Cause:
    """Find what all wrong pixels have in common: one state, two states, or either of two states.

    - `states`: For each pixel, the names of the pixel's states.
    """
    names = sorted(set().union(*states))
    masks = {name: np.array([name in each for each in states]) for name in names}
    everywhere: dict[tuple[str, ...], Mask] = {(): np.ones(len(wrong), bool)}
    pairs = list(combinations(names, 2))
    one, both, either = (
        min((int(mask.sum()), names) for names, mask in each.items() if mask[wrong].all())
        for each in (
            everywhere | {(name,): mask for name, mask in masks.items()},
            everywhere | {(a, b): masks[a] & masks[b] for a, b in pairs},
            everywhere | {(a, b): masks[a] | masks[b] for a, b in pairs},
        )
    )
    key, common = "state", one[1]
    if both[0] < CLEARER * one[0]:
        key, common = "both_states", both[1]
    elif either < one:
        key, common = "either_state", either[1]
    return results.Cause(results.Kind.DEFECT, key, common, wrong=int(wrong.sum()), of=len(wrong))


def named(states: Iterable[str], axes: Mapping[str, Mapping[str, object]]) -> set[str]:
    """Names of states that are not the default, and names of groups, which end at a colon."""
    first = {next(iter(each)) for each in axes.values()}
    parts = [state.split(":") for state in states if state not in first]
    return {":".join(each[: count + 1]) for each in parts for count in range(len(each))}


# fmt: off
ROWS = (
    check.Check(key="states",
          claim="A pixel's light is the sum over lights, environments and lobes, in every frame, whether inputs vary or not.",
          applies=check.family(LobeSpec), measure=states, control=exchanged,
          explain=diagnose, requires=Ability.PAIRS,
          # If opacity replaces refraction, a lobe in mode T passes the same light at every view, so
          # the negative control, which exchanges views, could not fail.
          methods=lambda spec, methods: methods.transmission != "opacity" or not DARK(spec)),
)
# fmt: on
