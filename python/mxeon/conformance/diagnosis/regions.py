# SPDX-License-Identifier: Apache-2.0
"""Named sets of pairs and inputs, to say of a shader that is wrong for some of them for which."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.samples import Array, Batch, Mask
from mxeon.conformance.tolerance import Compared, Tolerance, count_of, relative

COLORS = ("color", "tint", "color0")  # inputs of which one is the color of a node
INDICES = {"ior": "an index of refraction", "extinction": "an extinction"}
# The inputs that words in the names of regions are about.
NAMED = {
    "weight": ("weight",),
    "roughness": ("roughness",),
    "index of": ("ior",),
    "extinction": ("extinction",),
    "cuticle": ("cuticle_angle",),
    "color": COLORS,
}
FRAME = ("normal", "tangent", "curve_direction", "position")  # inputs whose ranges say nothing
USUAL = {"weight": 1.0, "occlusion": 1.0}  # where a batch has none
CHANNELS = "red", "green", "blue"
EXACT = count_of("values")
# Largest share of the right values in a range of an input that has all wrong ones, and in one of an input that is
# known to be the cause.
RIGHT, WEAK = 0.4, 0.7
CLEARER = 0.5  # of it, in a range with two ends that is named instead of one with a single end
CHANCE = 12.0  # least logarithm of the odds against finding a range by chance
LARGEST = 0.6  # share of the pairs that a region may have to be worth its name
DENSITY = 0.1  # least share of a region's pairs that have to be wrong
UPRIGHT = 1e-3  # tangent of a half vector along the normal: its cosine rounds to about 1
COSINES = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1)


def place_of(cases: Sequence[Compared], tolerance: Tolerance) -> str:
    """The region, or else the range of an input, that holds all wrong pairs; "" if there is none."""
    return smallest(cases, tolerance) or span(cases, tolerance)


def region(cases: Sequence[Compared], tolerance: Tolerance) -> str:
    """The share of the pairs that are wrong and the region of all of them; "" without a region."""
    place = smallest(cases, tolerance)
    return place and correct_except(cases, tolerance, place)


def correct_except(cases: Sequence[Compared], tolerance: Tolerance, place: str = "") -> str:
    return f"correct except for {share(cases, tolerance)}" + f", all {place}" * bool(place)


def share(cases: Sequence[Compared], tolerance: Tolerance) -> str:
    """How many of the pairs are wrong."""
    wrong = np.concatenate(list(map(tolerance.wrong, cases)))
    return f"{np.count_nonzero(wrong)} of {len(wrong)} pairs"


def unbounded(compared: Compared) -> Compared:
    """0 for finite values and NaN for others, beside 0."""
    zeros = np.where(np.isfinite(compared.measured), 0.0, np.nan)
    return Compared(compared.batch, zeros, np.zeros_like(zeros))


def smallest(cases: Sequence[Compared], tolerance: Tolerance) -> str:
    """Name of the smallest region that holds all wrong pairs; "" if there is none worth a name."""
    bad = np.concatenate(list(map(tolerance.wrong, cases)))
    sizes: dict[str, int] = {}
    found = (chain(_directions(case.batch), _inputs(case.batch)) for case in cases)
    for regions in zip(*found, strict=True):
        mask = np.concatenate([mask for _, mask in regions])
        if not mask[bad].all() or not mask.any():
            continue
        if bad[mask].mean() >= DENSITY and mask.mean() <= LARGEST:
            sizes[regions[0][0]] = int(mask.sum())
    return min(sizes, key=lambda name: sizes[name], default="")


def span(cases: Sequence[Compared], tolerance: Tolerance, most: float = RIGHT) -> str:
    """The range of an input that holds all wrong values and the fewest right ones; "" if none tells them apart.

    A color's channels are values of their own, each with its own channel of the inputs.
    """
    found = []
    for _, measured, right in cases:
        expected = np.broadcast_to(right, measured.shape)
        with np.errstate(divide="ignore", invalid="ignore"):
            scale = expected if tolerance.metric is relative else tolerance.scale(expected)
            found.append(~np.asarray(np.abs((measured - expected) / scale) <= tolerance.value))
    bad = np.concatenate(found)
    wrong = np.asarray(bad.any(axis=0))
    bad = bad[:, wrong]
    best, words = most, ""
    if bad.all():  # or there are none
        return words
    batches = [case.batch for case in cases]
    for name in batches[0].inputs:
        given = [batch.inputs.get(name, USUAL.get(name)) for batch in batches]
        if name in FRAME or any(each is None for each in given):
            continue
        columns = [_rows(each, len(batch.wo)) for each, batch in zip(given, batches, strict=True)]
        for part, numbers in _parts(name, np.concatenate(columns), wrong):
            values = np.broadcast_to(numbers, bad.shape)
            low, high = float(values[bad].min()), float(values[bad].max())
            digits = 2 if _short(low) != _short(high) else 4  # as many as tell them apart
            inside = {
                f"{_short(high)} or below": values <= high,
                f"{_short(low)} or above": values >= low,
                f"between {_short(low, digits)} and {_short(high, digits)}": (low <= values)
                & (values <= high),
            }
            if low == high:
                inside = {_short(low): values == low}
            for text, mask in inside.items():
                share, least = float(mask[~bad].mean()), best
                if text.startswith("between"):
                    least *= CLEARER
                # The wrong values would hardly all lie in the range if they were any others.
                odds = -np.log(max(mask.mean(), 1.0 / mask.size)) * (bad.any(axis=1).sum() - 1)
                dense = odds * min(bad[mask].mean() / DENSITY, 1.0) >= CHANCE
                if share < least and dense:
                    best, words = share, f"with {part} {text}"
    channels = [each for each, is_wrong in zip(CHANNELS, wrong, strict=False) if is_wrong]
    return words + f", in {' and '.join(channels)} alone" * bool(words and not wrong.all())


def _parts(name: str, columns: Array, wrong: Mask) -> Iterator[tuple[str, Array]]:
    """Numbers of an input for each value, or each of its channels, with words for them."""
    if columns.shape[1] == len(wrong) == len(CHANNELS):
        yield name, columns[:, wrong]
    elif columns.shape[1] == 1:
        yield name, columns
    elif columns.shape[1] == 2:
        yield f"the first component of {name}", columns[:, :1]
        yield f"the second component of {name}", columns[:, 1:]
        yield f"the smaller component of {name}", columns.min(axis=1, keepdims=True)
        yield f"the larger component of {name}", columns.max(axis=1, keepdims=True)
        yield (
            f"a difference between the components of {name} of",
            np.ptp(columns, axis=1, keepdims=True),
        )


def _short(number: float, digits: int = 2) -> str:
    return f"{float(f'{number:.{digits}g}'):g}"


def unreached(values: Mapping[str, Sequence[float]]) -> tuple[str, ...]:
    """Names of the regions that a node with constant inputs is not in, of inputs that are all known."""
    one = np.array([[0.0, 0.0, 1.0]])
    inputs = {name: np.array([each if len(each) > 1 else each[0]]) for name, each in values.items()}
    batch = Batch(one, one, inputs)
    return tuple(
        name
        for name, mask in _inputs(batch)
        if not mask.any()
        and any(word in name and port in values for word, ports in NAMED.items() for port in ports)
    )


def _directions(batch: Batch) -> Iterator[tuple[str, Mask]]:
    wo, wi = batch.wo, batch.wi
    mu_o, mu_i = wo[:, 2], wi[:, 2]
    dot = (wo * wi).sum(axis=1)
    s = dot - mu_o * mu_i
    # Where formulas divide or cancel.
    yield "with dot(N, V) rounded above 1", mu_o > 1.0
    yield "with dot(N, L) rounded above 1", mu_i > 1.0
    yield "with both directions on the horizon", (mu_o == 0.0) & (mu_i == 0.0)
    yield "in exact retro-reflection (L = V)", (wo == wi).all(axis=1)
    yield "with the light opposite the view (L = -V)", (wo == -wi).all(axis=1)
    yield "in the mirror direction", (wo * [-1.0, -1.0, 1.0] == wi).all(axis=1)
    half = wo + wi
    upright = np.abs(half[:, :2]).max(axis=1) <= UPRIGHT * half[:, 2]
    yield "with the half vector along the normal", upright
    yield "with the viewer along the tangent", (np.abs(wo) == [1.0, 0.0, 0.0]).all(axis=1)
    # By one cosine, then by both.
    for name, mu in (("viewer", mu_o), ("light", mu_i)):
        yield f"with the {name} along the normal", mu >= 1.0
        yield f"with the {name}'s cosine above 0.99", mu > 0.99
        yield f"with the {name} on the horizon", mu == 0.0
        for limit in COSINES:
            yield f"with the {name}'s cosine in [0, {limit:g}]", (mu >= 0.0) & (mu <= limit)
            yield f"with the {name}'s cosine {limit:g} or below", mu <= limit
    for limit in COSINES:
        yield (
            f"with both cosines in [0, {limit:g}]",
            (mu_i >= 0.0) & (np.maximum(mu_o, mu_i) <= limit),
        )
    # By the side of the light, and by the angle between the two.
    yield "with light from below the horizon", mu_i < 0.0
    yield "with light from above the horizon", mu_i > 0.0
    yield "with dot(V, L) above 0.999", dot > 0.999
    yield "with dot(V, L) above 0.99", dot > 0.99
    yield "with dot(V, L) below 0", dot < 0.0
    yield "with s below 0", s < 0.0
    yield "with s above 0", s > 0.0


def _inputs(batch: Batch) -> Iterator[tuple[str, Mask]]:
    count = len(batch.wo)
    roughness = batch.rough
    weight, occlusion = (
        np.broadcast_to(batch.inputs.get(name, default), count) for name, default in USUAL.items()
    )
    colors = [batch.inputs[name] for name in COLORS if name in batch.inputs]
    color = np.broadcast_to(colors[0] if colors else 0.5, (count, 3))
    # By numbers that every node has.
    yield "with a negative weight", weight < 0.0
    yield "with weight 0", weight == 0.0
    yield "with weight 0 or below", weight <= 0.0
    yield "with a weight in (0, 0.01]", (weight > 0.0) & (weight <= 0.01)
    yield "with a weight in (0, 0.5]", (weight > 0.0) & (weight <= 0.5)
    yield "with a weight other than 1", weight != 1.0
    yield "with occlusion 0", occlusion == 0.0
    yield "with an occlusion other than 1", occlusion != 1.0
    yield "with roughness 0", roughness == 0.0
    yield "with a roughness in [0, 0.01]", roughness <= 0.01
    yield "with a roughness in (0, 0.01]", (roughness > 0.0) & (roughness <= 0.01)
    yield "with the largest roughness", roughness >= 0.999999 * roughness.max()
    yield "with a roughness above 1", roughness > 1.0
    yield "with a roughness above 0", roughness > 0.0
    # By inputs of some nodes.
    for name, words in INDICES.items():
        index = _rows(batch.inputs.get(name, 1.0), count)
        yield f"with {words} of 0", np.asarray((index == 0.0).any(axis=1))
    if "cuticle_angle" in batch.inputs:
        yield "with a tilted cuticle", _rows(batch.inputs["cuticle_angle"], count)[:, 0] != 0.5
    # By colors and normals.
    yield "with a white color", (color == 1.0).all(axis=1)
    yield "with a black color", (color == 0.0).all(axis=1)
    yield "with a gray color", (color == color[:, :1]).all(axis=1)
    yield "with a color channel at 0", (color == 0.0).any(axis=1)
    yield "with a color channel in [0, 0.001]", np.asarray((color <= 1e-3).any(axis=1))
    yield "with a color channel at 1", (color == 1.0).any(axis=1)
    yield "with a color channel above 0.99", np.asarray((color > 0.99).any(axis=1))
    normal = np.broadcast_to(batch.inputs.get("normal", batch.normal), batch.wo.shape)
    away = (normal * batch.normal).sum(axis=1) < 0.0
    yield "where the normal faces away from the viewer", away


def _rows(values: ArrayLike, count: int) -> Array:
    """Values of an input with a row for each pair: of numbers or colors, or one for all pairs."""
    array = np.asarray(values, np.float64)
    if array.shape[:1] == (count,):
        return array.reshape(count, -1)
    return np.broadcast_to(array.reshape(1, -1), (count, array.size))
