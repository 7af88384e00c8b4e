# SPDX-License-Identifier: Apache-2.0
"""Named sets of pairs and inputs, which describe where a shader is wrong."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance.results import Cause, Errors, Kind, Quantity, Region
from mxeon.conformance.samples import Array, Batch, Mask
from mxeon.conformance.tolerance import Compared, Tolerance, checksum, count_of, errors_of, relative

COLORS = ("color", "tint", "color0")  # possible names of a node's color input
INDICES = {"index": "ior", "extinction": "extinction"}
# Inputs that named regions depend on, by the first word of the region's name.
INPUT_OF = {"weight": "weight", "roughness": "roughness", "cuticle": "cuticle_angle", **INDICES}
ABOUT = {"color": COLORS, **{name: (port,) for name, port in INPUT_OF.items()}}
# Inputs whose ranges are never reported.
UNREPORTED = ("normal", "tangent", "curve_direction", "position", "surface_normal")
USUAL = {"weight": np.ones(1), "occlusion": np.ones(1)}  # defaults of inputs a batch lacks
CHANNELS = "red", "green", "blue"
EXACT = count_of(Quantity.VALUES)
# Largest share of all correct values that a range with all wrong values may contain: usually
# RIGHT, or WEAK if the input is known to be the cause.
RIGHT, WEAK = 0.4, 0.7
CLEARER = 0.5  # a two-sided range must reduce that share by this factor over a one-sided range
CHANCE = 12.0  # smallest log odds against finding a range by chance
LARGEST = 0.6  # largest share of all pairs or values that a reported region may contain
DENSITY = 0.1  # smallest share of wrong pairs in a region
UPRIGHT = 1e-3  # a half vector counts as upright up to this tangent; its cosine rounds to about 1
COSINES = (1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1)


def place_of(cases: Sequence[Compared], tolerance: Tolerance) -> Region | None:
    """The region or input range that contains all wrong pairs, or None."""
    return smallest(cases, tolerance) or span(cases, tolerance)


def correct_except(
    cases: Sequence[Compared], tolerance: Tolerance, place: Region | None = None
) -> Cause:
    """A cause with the number of wrong pairs, and the region that contains them if given."""
    wrong = np.concatenate(list(map(tolerance.wrong, cases)))
    return Cause(Kind.REGION, region=place, wrong=int(np.count_nonzero(wrong)), of=len(wrong))


def unbounded(compared: Compared) -> Compared:
    """A comparison with 0 in which finite values become 0 and all others NaN."""
    zeros = np.where(np.isfinite(compared.measured), 0.0, np.nan)
    return Compared(compared.batch, zeros, np.zeros_like(zeros))


def smallest(cases: Sequence[Compared], tolerance: Tolerance) -> Region | None:
    """The smallest reportable region that contains all wrong pairs, or None."""
    bad = np.concatenate(list(map(tolerance.wrong, cases)))
    sizes: dict[Region, int] = {}
    found = (chain(_directions(case.batch), _inputs(case.batch)) for case in cases)
    for regions in zip(*found, strict=True):
        mask = np.concatenate([mask for _, mask in regions])
        if not mask[bad].all() or not mask.any():
            continue
        if bad[mask].mean() >= DENSITY and mask.mean() <= LARGEST:
            sizes[regions[0][0]] = int(mask.sum())
    return min(sizes, key=sizes.__getitem__, default=None)


def span(cases: Sequence[Compared], tolerance: Tolerance, most: float = RIGHT) -> Region | None:
    """The input range with all wrong and the fewest correct values; None if there is no clear one.

    Color channels are judged separately, each with the same channel of color inputs.
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
    best: Region | None = None
    if bad.all():  # also true if there are no values
        return best
    channels = tuple(each for each, is_wrong in zip(CHANNELS, wrong, strict=False) if is_wrong)
    if wrong.all():
        channels = ()
    for name, columns in _columns([case.batch for case in cases]):
        for part, numbers in _parts(name, np.concatenate(columns), wrong):
            values = np.broadcast_to(numbers, bad.shape)
            low, high = float(values[bad].min()), float(values[bad].max())
            ranges: list[tuple[float | None, float | None, Mask]] = [
                (None, high, values <= high),
                (low, None, values >= low),
                (low, high, (low <= values) & (values <= high)),
            ]
            for first, last, mask in ranges[2:] if low == high else ranges:
                if mask.mean() > LARGEST:
                    continue
                share, least = float(mask[~bad].mean()), most
                if low < high and first == low and last == high:
                    least *= CLEARER
                # Log odds against all wrong values being in the range by chance.
                odds = -np.log(max(mask.mean(), 1.0 / mask.size)) * (bad.any(axis=1).sum() - 1)
                dense = odds * min(bad[mask].mean() / DENSITY, 1.0) >= CHANCE
                if share < least and dense:
                    most, best = share, Region(name, part, first, last, channels)
    return best


def _parts(name: str, columns: Array, wrong: Mask) -> Iterator[tuple[str, Array]]:
    """Parts of an input that may have a range: keys of `words.PARTS`, each with its numbers."""
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
    """The regions that a node never reaches because of its constant inputs, `values`."""
    one = np.array([[0.0, 0.0, 1.0]])
    inputs = {name: np.array([each if len(each) > 1 else each[0]]) for name, each in values.items()}
    batch = Batch(one, one, inputs)
    out = (region for region, mask in _inputs(batch) if not mask.any())
    return tuple(x for x in out if {*values} & {*ABOUT.get(x.name.split("_")[0], ())})


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
    # Regions by the cosine of the view or the light, then by both cosines.
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
    # Regions by the side of the light, and by the angle between view and light.
    yield Region("light_below_horizon"), mu_i < 0.0
    yield Region("light_above_horizon"), mu_i > 0.0
    yield Region("dot_above", low=0.999), dot > 0.999
    yield Region("dot_above", low=0.99), dot > 0.99
    yield Region("dot_negative"), dot < 0.0
    yield Region("s_negative"), s < 0.0
    yield Region("s_positive"), s > 0.0


def _inputs(batch: Batch) -> Iterator[tuple[Region, Mask]]:
    count = len(batch.wo)
    roughness = batch.rough
    given = {**USUAL, **batch.inputs}
    weight, occlusion = (np.broadcast_to(given[name], count) for name in USUAL)
    colors = [batch.inputs[name] for name in COLORS if name in batch.inputs]
    color = np.broadcast_to(colors[0] if colors else 0.5, (count, 3))
    # Regions by weight, occlusion and roughness.
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
    # Regions by inputs that only some nodes have.
    for name, port in INDICES.items():
        index = _rows(batch.inputs.get(port, 1.0), count)
        yield Region(f"{name}_zero"), np.asarray((index == 0.0).any(axis=1))
    if "cuticle_angle" in batch.inputs:
        yield Region("cuticle_tilted"), _rows(batch.inputs["cuticle_angle"], count)[:, 0] != 0.5
    # Regions by color and by normal.
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


HALF = 0.5  # cosine that splits views and lights into two regions


def errors(cases: Sequence[Compared], tolerance: Tolerance) -> tuple[tuple[Errors, ...], str]:
    """Errors of all samples, then below and above each input's median; and the samples' checksum.

    For colors and pairs of alphas, the largest component is used.
    """
    batches = [each.batch for each in cases]
    rows = np.concatenate([tolerance.metric(*each[1:]) for each in cases])
    found = [errors_of(rows, tolerance.value)]

    def divide(columns: Iterable[Array], middle: float, *ends: Region) -> None:
        above = np.concatenate(list(columns)) > middle
        for mask, region in zip((~above, above), ends, strict=True):
            if above.any() and not above.all():
                found.append(errors_of(rows[mask], tolerance.value, region))

    for name, field in (("viewer", "wo"), ("light", "wi")):
        ends = Region(f"{name}_cosine_below", high=HALF), Region(f"{name}_cosine_above", low=HALF)
        divide((getattr(each, field)[:, 2] for each in batches), HALF, *ends)
    for name, columns in _columns(batches):
        part = "larger" if columns[0].shape[1] > 1 else "value"
        numbers = [each.max(axis=1) for each in columns]
        middle = float(f"{np.median(np.concatenate(numbers)):.2g}")
        divide(numbers, middle, Region(name, part, high=middle), Region(name, part, low=middle))
    return tuple(found), checksum(batches)


def _columns(batches: Sequence[Batch]) -> Iterator[tuple[str, list[Array]]]:
    """Reportable inputs that all batches have, with a row for each pair of each batch."""
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
