# SPDX-License-Identifier: Apache-2.0
"""Regions are named sets of pairs, or ranges of inputs, in which a shader is wrong."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain, compress

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.results import Cause, Errors, Kind, Quantity, Region
from mxeon.conformance.samples import Array, Batch, Mask
from mxeon.conformance.tolerance import Compared, Tolerance, checksum, count_of, errors_of, relative

COLORS = ("color", "tint", "color0")  # possible names of a node's color input
INDICES = {"index": "ior", "extinction": "extinction"}
# Inputs that define a region. A key is the first word of a region's name.
INPUTS = {
    "color": COLORS,
    "weight": ("weight",),
    "roughness": ("roughness",),
    "cuticle": ("cuticle_angle",),
    **{name: (port,) for name, port in INDICES.items()},
}
# Inputs whose ranges are never reported.
UNREPORTED = ("normal", "tangent", "curve_direction", "position", "surface_normal")
USUAL = {"weight": np.ones(1), "occlusion": np.ones(1)}  # defaults of inputs that a batch lacks
CHANNELS = "red", "green", "blue"
EXACT = count_of(Quantity.VALUES)
# A reported range of an input contains all wrong values. The range contains at most the share RIGHT
# of all correct values, or WEAK if the input is known to be the cause.
RIGHT, WEAK = 0.4, 0.7
CLEARER = 0.5  # factor for RIGHT and WEAK if a range is limited at both ends
CHANCE = 12.0  # a reported range is due to chance with a probability of at most e^-CHANCE
LARGEST = 0.6  # largest share of all pairs or values that a reported region may contain
DENSITY = 0.1  # smallest share of wrong pairs in a region
# A half vector is upright if the tangent of the angle to the normal is at most 1e-3. In float32,
# the cosine of such an angle rounds to about 1.
UPRIGHT = 1e-3
COSINES = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1)


def region_of(cases: Sequence[Compared], tolerance: Tolerance) -> Region | None:
    return smallest(cases, tolerance) or span(cases, tolerance)


def correct_except(
    cases: Sequence[Compared], tolerance: Tolerance, region: Region | None = None
) -> Cause:
    """A cause that states the number of wrong pairs and, if given, the region of wrong pairs."""
    wrong = np.concatenate(list(map(tolerance.wrong, cases)))
    return Cause(Kind.REGION, region=region, wrong=int(np.count_nonzero(wrong)), of=len(wrong))


def unbounded(compared: Compared) -> Compared:
    """A comparison with 0, in which finite values become 0 and all other values become NaN."""
    zeros = np.where(np.isfinite(compared.measured), 0.0, np.nan)
    return Compared(compared.batch, zeros, np.zeros_like(zeros))


def smallest(cases: Sequence[Compared], tolerance: Tolerance) -> Region | None:
    """The smallest reportable named region that contains all wrong pairs, or None."""
    wrong = np.concatenate(list(map(tolerance.wrong, cases)))
    sizes: dict[Region, int] = {}
    named = (chain(_directions(case.batch), _inputs(case.batch)) for case in cases)
    for parts in zip(*named, strict=True):
        mask = np.concatenate([mask for _, mask in parts])
        if not mask[wrong].all() or not mask.any():
            continue
        if wrong[mask].mean() >= DENSITY and mask.mean() <= LARGEST:
            sizes[parts[0][0]] = int(mask.sum())
    return min(sizes, key=sizes.__getitem__, default=None)


def span(cases: Sequence[Compared], tolerance: Tolerance, most: float = RIGHT) -> Region | None:
    """The range of an input that contains all wrong values and the fewest correct values.

    The result is None if every range contains too many correct values. Each color channel of the
    values is compared with the same channel of color inputs.

    - `most`: Largest share of all correct values that the range may contain.
    """
    rows = []
    for case in cases:
        expected = np.broadcast_to(case.expected, case.measured.shape)
        with np.errstate(divide="ignore", invalid="ignore"):
            scale = expected if tolerance.metric is relative else tolerance.scale(expected)
            errors = np.abs((case.measured - expected) / scale)
        rows.append(~np.asarray(errors <= tolerance.value))
    wrong = np.concatenate(rows)
    columns = np.asarray(wrong.any(axis=0))  # channels with wrong values
    wrong = wrong[:, columns]
    best: Region | None = None
    if wrong.all():  # also true if there are no values
        return best
    channels = () if columns.all() else tuple(compress(CHANNELS, columns))
    for name, values in _columns([case.batch for case in cases]):
        for part, numbers in _parts(np.concatenate(values), columns):
            numbers = np.broadcast_to(numbers, wrong.shape)
            low, high = float(numbers[wrong].min()), float(numbers[wrong].max())
            ranges: list[tuple[float | None, float | None, Mask]] = [
                (None, high, numbers <= high),
                (low, None, numbers >= low),
                (low, high, (low <= numbers) & (numbers <= high)),
            ]
            for first, last, mask in ranges[2:] if low == high else ranges:
                if mask.mean() > LARGEST:
                    continue
                share, limit = float(mask[~wrong].mean()), most
                if low < high and first == low and last == high:
                    limit *= CLEARER
                # If wrong values were random, all would be in the range with probability e^-odds.
                odds = -np.log(max(mask.mean(), 1.0 / mask.size)) * (wrong.any(axis=1).sum() - 1)
                dense = odds * min(wrong[mask].mean() / DENSITY, 1.0) >= CHANCE
                if share < limit and dense:
                    most, best = share, Region(name, part, first, last, channels)
    return best


def _parts(columns: Array, wrong: Mask) -> Iterator[tuple[str, Array]]:
    """Parts of an input in which to search for a range, as keys of `words.PARTS` with numbers.

    - `wrong`: Mask of the color channels with wrong values.
    """
    if columns.shape[1] == len(wrong) == len(CHANNELS):
        yield "value", columns[:, wrong]
    elif columns.shape[1] == 1:
        yield "value", columns
    elif columns.shape[1] == 2:
        yield "first", columns[:, :1]
        yield "second", columns[:, 1:]
        yield "smaller", columns.min(axis=1, keepdims=True)
        yield "larger", columns.max(axis=1, keepdims=True)
        yield "difference", np.ptp(columns, axis=1, keepdims=True)


def unreached(values: Mapping[str, Sequence[float]]) -> tuple[Region, ...]:
    """Regions that cannot contain a pair, because some inputs of a node have constant values."""
    normal = np.array([[0.0, 0.0, 1.0]])
    inputs = {name: np.array([each if len(each) > 1 else each[0]]) for name, each in values.items()}
    return tuple(
        region
        for region, mask in _inputs(Batch(normal, normal, inputs))
        if not mask.any() and {*values} & {*INPUTS.get(region.name.split("_")[0], ())}
    )


def _directions(batch: Batch) -> Iterator[tuple[Region, Mask]]:
    wo, wi = batch.wo, batch.wi
    mu_o, mu_i = wo[:, 2], wi[:, 2]
    dot = (wo * wi).sum(axis=1)
    s = dot - mu_o * mu_i
    half = wo + wi
    upright = np.abs(half[:, :2]).max(axis=1) <= UPRIGHT * half[:, 2]
    # Directions at which formulas have singularities or cancellations.
    yield Region("viewer_above_1"), mu_o > 1.0
    yield Region("light_above_1"), mu_i > 1.0
    yield Region("both_on_horizon"), (mu_o == 0.0) & (mu_i == 0.0)
    yield Region("retro_reflection"), (wo == wi).all(axis=1)
    yield Region("opposite"), (wo == -wi).all(axis=1)
    yield Region("mirror"), (wo * [-1.0, -1.0, 1.0] == wi).all(axis=1)
    yield Region("half_vector_upright"), upright
    yield Region("viewer_along_tangent"), (np.abs(wo) == [1.0, 0.0, 0.0]).all(axis=1)
    for name, mu in (("viewer", mu_o), ("light", mu_i)):
        yield Region(f"{name}_along_normal"), mu >= 1.0
        yield Region(f"{name}_cosine_above", low=0.99), mu > 0.99
        yield Region(f"{name}_on_horizon"), mu == 0.0
        for limit in COSINES:
            within = Region(f"{name}_cosine_within", low=0.0, high=limit)
            yield within, (mu >= 0.0) & (mu <= limit)
            yield Region(f"{name}_cosine_below", high=limit), mu <= limit
    for limit in COSINES:
        both = (mu_i >= 0.0) & (np.maximum(mu_o, mu_i) <= limit)
        yield Region("cosines_within", low=0.0, high=limit), both
    yield Region("light_below_horizon"), mu_i < 0.0
    yield Region("light_above_horizon"), mu_i > 0.0
    yield Region("dot_above", low=0.999), dot > 0.999
    yield Region("dot_above", low=0.99), dot > 0.99
    yield Region("dot_negative"), dot < 0.0
    yield Region("s_negative"), s < 0.0
    yield Region("s_positive"), s > 0.0


def _inputs(batch: Batch) -> Iterator[tuple[Region, Mask]]:
    count, roughness, inputs = len(batch.wo), batch.rough, {**USUAL, **batch.inputs}
    weight, occlusion = (np.broadcast_to(inputs[name], count) for name in USUAL)
    colors = [batch.inputs[name] for name in COLORS if name in batch.inputs]
    color = np.broadcast_to(colors[0] if colors else 0.5, (count, 3))
    yield Region("weight_negative"), weight < 0.0
    yield Region("weight_zero"), weight == 0.0
    yield Region("weight_not_positive"), weight <= 0.0
    yield Region("weight_within", low=0.0, high=0.01), (weight > 0.0) & (weight <= 0.01)
    yield Region("weight_within", low=0.0, high=0.5), (weight > 0.0) & (weight <= 0.5)
    yield Region("weight_not_1"), weight != 1.0
    yield Region("occlusion_zero"), occlusion == 0.0
    yield Region("occlusion_not_1"), occlusion != 1.0
    yield Region("roughness_zero"), roughness == 0.0
    yield Region("roughness_up_to", low=0.0, high=0.01), roughness <= 0.01
    yield Region("roughness_within", low=0.0, high=0.01), (roughness > 0.0) & (roughness <= 0.01)
    yield Region("roughness_largest"), roughness >= 0.999999 * roughness.max()
    yield Region("roughness_above_1"), roughness > 1.0
    yield Region("roughness_positive"), roughness > 0.0
    for name, port in INDICES.items():
        index = _rows(batch.inputs.get(port, 1.0), count)
        yield Region(f"{name}_zero"), np.asarray((index == 0.0).any(axis=1))
    if "cuticle_angle" in batch.inputs:
        yield Region("cuticle_tilted"), _rows(batch.inputs["cuticle_angle"], count)[:, 0] != 0.5
    yield Region("color_white"), (color == 1.0).all(axis=1)
    yield Region("color_black"), (color == 0.0).all(axis=1)
    yield Region("color_gray"), (color == color[:, :1]).all(axis=1)
    yield Region("color_channel_zero"), (color == 0.0).any(axis=1)
    dark = np.asarray((color <= 1e-3).any(axis=1))
    yield Region("color_channel_within", low=0.0, high=0.001), dark
    yield Region("color_channel_1"), (color == 1.0).any(axis=1)
    yield Region("color_channel_above", low=0.99), np.asarray((color > 0.99).any(axis=1))
    normal = np.broadcast_to(batch.inputs.get("normal", batch.normal), batch.wo.shape)
    yield Region("normal_away"), (normal * batch.normal).sum(axis=1) < 0.0


HALF = 0.5  # cosine that divides views (or lights) into two regions


def errors(cases: Sequence[Compared], tolerance: Tolerance) -> tuple[tuple[Errors, ...], str]:
    """Errors of all samples, errors below and above the median of each input, and a checksum.

    The checksum identifies the samples. Colors and pairs of alphas count with the largest
    component.
    """
    batches = [each.batch for each in cases]
    rows = np.concatenate([tolerance.metric(*each[1:]) for each in cases])
    # Each row has the numbers of an input, a limit, and the regions below and above the limit.
    halves: list[tuple[Array, float, Region, Region]] = []
    for name, field in (("viewer", "wo"), ("light", "wi")):
        low, high = (
            Region(f"{name}_cosine_below", high=HALF),
            Region(f"{name}_cosine_above", low=HALF),
        )
        cosines = np.concatenate([getattr(each, field)[:, 2] for each in batches])
        halves.append((cosines, HALF, low, high))
    for name, columns in _columns(batches):
        part = "larger" if columns[0].shape[1] > 1 else "value"
        numbers = np.concatenate([each.max(axis=1) for each in columns])
        middle = float(f"{np.median(numbers):.2g}")
        low, high = Region(name, part, high=middle), Region(name, part, low=middle)
        halves.append((numbers, middle, low, high))
    found = [errors_of(rows, tolerance.value)]
    for numbers, middle, low, high in halves:
        above = numbers > middle
        if above.any() and not above.all():
            found.append(errors_of(rows[~above], tolerance.value, low))
            found.append(errors_of(rows[above], tolerance.value, high))
    return tuple(found), checksum(batches)


def _columns(batches: Sequence[Batch]) -> Iterator[tuple[str, list[Array]]]:
    """Reportable inputs that all batches have, with one table of numbers per batch."""
    rows = [({**USUAL, **batch.inputs}, len(batch.wo)) for batch in batches]
    for name in batches[0].inputs:
        if name not in UNREPORTED and all(name in inputs for inputs, _ in rows):
            yield name, [_rows(inputs[name], count) for inputs, count in rows]


def _rows(values: ArrayLike, count: int) -> Array:
    """Numbers or colors of an input as a table with one row per pair, (count, components)."""
    array = np.asarray(values, np.float64)
    if array.shape[:1] == (count,):
        return array.reshape(count, -1)
    return np.broadcast_to(array.reshape(1, -1), (count, array.size))
