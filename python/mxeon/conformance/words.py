# SPDX-License-Identifier: Apache-2.0
"""Sentences about results, made from the fields of the results. No code parses these sentences."""

import math
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

from mxeon.conformance import results
from mxeon.conformance.results import Cause, Diagnosis, Difference, Kind, Region, Result, Run
from mxeon.shaders.nodes import FLAG

NAMED = 3  # maximum number of listed names, after which names are only counted
DIFFERENCES_SHOWN = 3  # maximum number of reported differences between two node graphs
AS_SPECIFIED = "looks as specified"

# --- numbers and lists ---------------------------------------------------------------------------


def in_words(number: float) -> str:
    """A number with two significant digits and without an exponent.

    >>> in_words(1.234), in_words(1234.5)
    ('1.2', '1,200')
    """
    return f"{float(f'{number:.2g}'):,.10g}"


def of_white(share: float) -> str:
    """A radiance in words. `share` is relative to a white, matte surface that faces the light.

    >>> of_white(0.2035), of_white(1e-7), of_white(48.2)
    ('20 % of white', 'less than 0.1 % of white', '48 times white')
    """
    if share < 0.001:
        return "less than 0.1 % of white"
    return (
        f"{in_words(100.0 * share)} % of white" if share < 2.0 else f"{in_words(share)} times white"
    )


def listed(names: Sequence[str]) -> str:
    """The first names of a list, and the number of the remaining names.

    >>> listed(["a", "b", "c", "d"])
    'a, b, c and 1 more'
    """
    more = f" and {len(names) - NAMED} more" if len(names) > NAMED else ""
    return ", ".join(names[:NAMED]) + more


def enumerated(names: Sequence[str]) -> str:
    """All names of a non-empty list, joined by commas and "and".

    >>> enumerated(["a"]), enumerated(["a", "b", "c"])
    ('a', 'a, b and c')
    """
    *first, last = names
    return f"{', '.join(first)} and {last}" if first else last


def counted(count: int, noun: str) -> str:
    """A count and its noun, which is plural unless the count is 1.

    >>> counted(1, "check"), counted(2, "check")
    ('1 check', '2 checks')
    """
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _short(number: float, digits: int = 2) -> str:
    return f"{float(f'{number:.{digits}g}'):g}"


# --- tables: names of scenes and regions, faults of models, and other defects ---------------------

LIGHTS = {"side": "light from the side", "front": "light from the front"}
LIGHTS |= {"back": "light from behind", "furnace": "a white environment"}
# Phrases for regions of pairs and inputs that `mxeon.conformance.diagnosis.regions` finds.
REGIONS = {
    "viewer_above_1": "with dot(N, V) rounded above 1",
    "light_above_1": "with dot(N, L) rounded above 1",
    "both_on_horizon": "with both directions on the horizon",
    "retro_reflection": "in exact retro-reflection (L = V)",
    "opposite": "with the light opposite the view (L = -V)",
    "mirror": "in the mirror direction",
    "half_vector_upright": "with the half vector along the normal",
    "viewer_along_tangent": "with the viewer along the tangent",
    "viewer_along_normal": "with the viewer along the normal",
    "light_along_normal": "with the light along the normal",
    "viewer_cosine_above": "with the viewer's cosine above {low:g}",
    "light_cosine_above": "with the light's cosine above {low:g}",
    "viewer_on_horizon": "with the viewer on the horizon",
    "light_on_horizon": "with the light on the horizon",
    "viewer_cosine_within": "with the viewer's cosine in [{low:g}, {high:g}]",
    "light_cosine_within": "with the light's cosine in [{low:g}, {high:g}]",
    "viewer_cosine_below": "with the viewer's cosine {high:g} or below",
    "light_cosine_below": "with the light's cosine {high:g} or below",
    "cosines_within": "with both cosines in [{low:g}, {high:g}]",
    "light_below_horizon": "with light from below the horizon",
    "light_above_horizon": "with light from above the horizon",
    "dot_above": "with dot(V, L) above {low:g}",
    "dot_negative": "with dot(V, L) below 0",
    "s_negative": "with s below 0",
    "s_positive": "with s above 0",
    "weight_negative": "with a negative weight",
    "weight_zero": "with weight 0",
    "weight_not_positive": "with weight 0 or below",
    "weight_within": "with a weight in ({low:g}, {high:g}]",
    "weight_not_1": "with a weight other than 1",
    "occlusion_zero": "with occlusion 0",
    "occlusion_not_1": "with an occlusion other than 1",
    "roughness_zero": "with roughness 0",
    "roughness_up_to": "with a roughness in [{low:g}, {high:g}]",
    "roughness_within": "with a roughness in ({low:g}, {high:g}]",
    "roughness_largest": "with the largest roughness",
    "roughness_above_1": "with a roughness above 1",
    "roughness_positive": "with a roughness above 0",
    "index_zero": "with an index of refraction of 0",
    "extinction_zero": "with an extinction of 0",
    "cuticle_tilted": "with a tilted cuticle",
    "color_white": "with a white color",
    "color_black": "with a black color",
    "color_gray": "with a gray color",
    "color_channel_zero": "with a color channel at 0",
    "color_channel_within": "with a color channel in [{low:g}, {high:g}]",
    "color_channel_1": "with a color channel at 1",
    "color_channel_above": "with a color channel above {low:g}",
    "normal_away": "where the normal faces away from the viewer",
    **{scene: f"in {light}" for scene, light in LIGHTS.items()},
}
# A region may be a range of an input or of a component of an input.
PARTS = {
    "value": "{}",
    **{each: f"the {each} component of {{}}" for each in ("first", "second", "smaller", "larger")},
    "difference": "a difference between the components of {} of",
}
# fmt: off
# Mistakes of a shader that uses a correct model. {0} and {1} are names in the cause, and {x} is the
# cause's first number.
FAULTS = {
    "channels_exchanged": "the color channels are exchanged: they arrive as {0}, {1}, {2}",
    "one_channel": "every channel takes the {0} of the color",
    "mean_color": "every channel takes the mean of the color",
    "color_ignored": "the color is ignored; {x:g} is used instead",
    "color_clamped": "the color is clamped to 1",
    "weight_unlimited": "a weight outside [0, 1], the range in the specification, is not clamped",
    "color_squared": "the color is squared",
    "color_square_root": "the color is replaced by its square root",
    "roughness_squared": "the roughness is squared",
    "roughness_square_root": "the roughness is replaced by its square root",
    "tangents_exchanged": "tangent and bitangent are exchanged",
    "roughness_halved": "the roughness is halved",
    "roughness_ignored": "the roughness is ignored; {x:g} is used instead",
    "weight_ignored": "the weight is ignored",
    "weight_ignored_above_0": "weights above 0 are ignored",
    "occlusion_and_weight_ignored": "the occlusion and the weight are ignored",
    "occlusion_and_weight_ignored_above_0": "the occlusion and weights above 0 are ignored",
    "weight_twice": "the weight is applied twice",
    "occlusion_ignored": "the occlusion is ignored",
    "occlusion_twice": "the occlusion is applied once too often",
    "occlusion_by_caller": "the occlusion is applied here and again by the caller",
    "cosine_missing": "the cosine of the light is missing",
    "cosine_twice": "the cosine of the light is applied twice",
    "directions_swapped": "the cosine is the viewer's instead of the light's: the directions are swapped",
    "light_mirrored": "the light is mirrored about the normal: s has the wrong sign",
    "light_from_below": "light from below the horizon is reflected as if it came from above",
    "normal_incidence": "the albedo is the one at normal incidence",
    "inputs_exchanged": "{0} and {1} are exchanged",
    "scaled": "every value is {x:.6g} times the right one",
    "pi_missing": "the factor 1/pi is missing",
    "pi_twice": "the factor 1/pi is applied twice",
}
# Words that join the names of states of lobes and lights that all wrong values share.
STATES = {"state": "", "both_states": " and ", "either_state": " or "}
SUMS = "each part is right by itself, but {share} combinations of lobes and lights are wrong{states}"
# Phrases that describe all other defects. `_filled` replaces the braces by names and numbers.
DEFECTS = {
    "average_at_half_vector": "the compensation uses F at the half vector instead of its average",
    "average_by_ends": "the compensation uses the average F0 + (F90 - F0) / 21",
    "average_at_two_thirds": "the compensation uses F at the cosine 2/3 instead of its average",
    "seen": "the mean of 1 - F over the visible normals",
    "seen_over_masking": "the mean of 1 - F over the visible normals, divided by G_1 of the view",
    "wrong_with_methods": "with {methods}",
    "other_directions": "the environment is looked up in wrong directions or with wrong weights",
    "retroreflective_normal": "retroreflection mirrors the view about a normal other than the node's",
    "retroreflective_environment": "retroreflective is ignored or wrong in an environment",
    "reflects_light": "reflects a light",
    "reflects_light_unlike_R": "reflects a light, unlike mode R",
    "reflects_environment": "reflects an environment",
    "reflects_environment_unlike_R": "reflects an environment, unlike mode R",
    "passes_other_light": "passes the wrong light to its base (branch {branch})",
    "mode_R_transmits": "mode R transmits light",
    "wrong_effect": "no effect, or a wrong one: {all}",
    "inputs_without_effect": "inputs without effect: {all}",
    "input_ignored": "{0} is ignored",
    "input_at_fault": "mostly its {0}: without it, the largest difference is {x:.2g} instead of {whole:.2g}",
    "not_zero": "{0} {constant}{place} (branches: {rest})",
    **dict.fromkeys(STATES, SUMS),
    **{f"{key}_of_frames": "{share} frames are wrong{states}" for key in STATES},
    "changes_nothing": "{all} changes nothing",
    "changes_something": "{all} changes something",
    "normal_of_surface": "the node's normal is ignored; the surface's is used instead",
    "not_implemented": "{0} has no implementation of {1}",
    "factor_not_clamped": "the factor is not clamped",
    "value_outside": "the value is wrong with {0} {numbers}",
    "albedo_outside": "the albedo is wrong with {0} {numbers}",
    "throughput_outside": "the throughput is wrong with {0} {numbers}",
    "right_without": "the layer equation holds without the {0}",
    "throughput_of_lobes": "the light that passes {all} alone is wrong",
    "no_single_lobe": "no single lobe explains the error, which is smallest without {0} and {1}",
    "lobes_of_graph": "the graph is not the cause: see the checks of its lobes",
    "lobes_too": "its lobes have errors, too: see the checks of each lobe",
    "sum_of_lobes": "see the checks of each lobe and of `layer`",
    "release": "{released}",
    "newer": "the library has {all}, which the installed MaterialX lacks, and may be newer",
    "clash": "{0} and {1} both define {2} in {3}, so a shader with both does not compile",
    "other_argument": "{1} of {0} is {2}; MaterialX released {3}",
    "drawn_density": "from {any}, samples do not have the density of material_pdf",
    "drawn_weight": "from {0}, weight times density is not material_evaluate's value",
    "sampled_density": "from {0}, the density of material_sample is not material_pdf's",
    "undrawn_light": "from {0}, some light is never sampled",
    "other_refraction": "the environment is not looked up in the directions of visible facets",
    "medium_in_reflection": "a medium absorbs light that is reflected above it",
    "medium_between": "a medium between two lobes has a wrong transmittance",
    "negative_color": "a negative color does not reflect as in MaterialX's own code",
    "other_path_value": "a path tracer and a rasterizer get different values",
    "other_path_emission": "a path tracer's emission is not that of the node's equation",
    "other_random_numbers": "random numbers are not those of pcg4d",
    "other_path_albedo": "samples do not carry the light that a rasterizer reflects and transmits",
    "inside_is_not_outside": "light inside a solid is not as outside a solid with the inverse IOR",
    "curve_below_0": "the curve is not clamped: values are below 0",
    "light_from_inside": "a clear solid gains or loses light, or lets out more or less than enters",
    "density_differs": "the density differs from the paper's listings",
    "samples_differ": "the samples do not follow the density",
    "lookup_opposite": "the environment is looked up opposite to the normal",
    "lookup_viewer": "the environment is looked up toward the viewer",
    "lookup_from_viewer": "the environment is looked up away from the viewer",
    "lookup_light": "the environment is looked up toward the light",
    "lookup_mirror": "the environment is looked up along the mirror direction",
    "lookup_surface_normal": "the environment is looked up along the surface's normal instead of the node's",
    "lookup_facing_surface_normal": "the environment is looked up along the surface's normal turned toward the viewer, instead of the node's",
    "lookup_not_facing": "the environment is looked up along a normal that is not turned toward the viewer",
    "lookup_radiances": "the environment is looked up in the radiance map",
    "lookup_black": "the environment is never looked up: it is black",
    "lookup_other_side": "the environment is looked up on the other side of the surface",
    "lookup_viewer_side": "the environment is looked up only on the viewer's side",
    "same_names": "nodes {0} have the values of one of them; see docs/upstream/same_names.md",
    "material_graph": "a material that a nodegraph defines is not generated; see docs/upstream/material_graphs.md",
    "own_document_refused": "the library refuses a document of mxeon's own: {text}",
    "different_in_osl": "{0} is different in OSL",
    "other_node": "the nearest node is {0} {1!r}, whose values are not the reference's",
    "never_passed": "{0} is never passed",
    "not_passed": "{0} is not passed",
    "float_for_vector": "{0} is a float but receives a color or vector",
    "tint_is_not_eon": "{0} is not that of EON, rho^2 <E> / (1 - rho (1 - <E>)){instead}: error up to {x:.2g}",
    "tint_is_not_qon": "{0} is not black, as without energy_compensation{instead}: error up to {x:.2g}",
    "is_not_the_node_s": "{0} is not the node's {0}{instead}: error up to {x:.2g}",
    "white_lobe": "FON + white lobe, from the source of MDL's module pbrlib_1_10, which was not run",
    "not_defined": "{0} is not defined as in eonlib",
    "function_off": "{0} has an error of {x:.2g}",
    "functions_that_use_it": "also wrong because of it: {all}",
    "cannot_be_told_from": "cannot be distinguished from {any}",
    "neither_fits": "neither fits",
    "picture_black": "{0} is black",
    "picture_clipped": "{0} is clipped",
    "picture_scaled": "{0} is {times} times as bright",
    "picture_srgb": "{0} is sRGB-encoded{also}",
    "picture_power": "{0} is encoded with a power of 1/2.2{also}",
    "picture_tone_mapped": "{0} is tone-mapped by x / (1 + x){also}",
    "picture_upside_down": "{0} is upside down{also}",
    "picture_mirrored": "{0} is mirrored left to right{also}",
    "picture_rotated": "{0} is rotated by 180 degrees{also}",
    "unknown": "the cause is unknown",
    "no_model": "it matches no known mistake",
    "no_input": "no single input is at fault",
    "singly_right": "each value on its own is within tolerance",
    "other_average": "the compensation uses a different average of the film's reflectance",
    "unmasked": "the visible facets are not weighted by masking and shadowing",
    "picture_unknown": "{0} is not Lambert's cosine in any known encoding: tone-mapped, or lit differently",
}
# fmt: on
FACTORS = {"pi": math.pi, "1/pi": 1.0 / math.pi, "pi^2": math.pi**2, "2": 2.0, "1/2": 0.5}
SAME_FACTOR = 0.005

# --- diagnoses -----------------------------------------------------------------------------------


def region(place: Region) -> str:
    """The region of wrong values, in words.

    >>> region(Region("roughness", "value", high=0.25))
    'with roughness 0.25 or below'
    """
    if not place.part:
        return REGIONS[place.name].format(low=place.low, high=place.high)
    low, high = place.low, place.high
    if low is None or high is None:
        ends = f"{_short(high)} or below" if high is not None else f"{_short(low or 0.0)} or above"
    elif low == high:
        ends = _short(low)
    else:
        digits = 2 if _short(low) != _short(high) else 4  # enough digits to distinguish both ends
        ends = f"between {_short(low, digits)} and {_short(high, digits)}"
    channels = f", only in {' and '.join(place.channels)}" if place.channels else ""
    return f"with {PARTS[place.part].format(place.name)} {ends}{channels}"


def diagnosis(found: Diagnosis) -> str:
    return "; ".join(filter(None, (_cause(each, found.distances) for each in found.causes)))


def _cause(cause: Cause, distances: Mapping[str, float]) -> str:
    text = _model(cause, distances) if cause.kind is Kind.MODEL else SENTENCES[cause.kind](cause)
    named = cause.branch and cause.key != "passes_other_light"
    return f"branch {cause.branch}: {text}" if named else text


def _rms(cause: Cause) -> str:
    return "" if cause.rms is None else f" (rms {cause.rms:.2g})"


def _model(cause: Cause, distances: Mapping[str, float]) -> str:
    """The nearest and the second nearest model, in words.

    >>> _model(Cause(Kind.MODEL, "Lambert", rms=0.001), {"EON": 0.25, "Lambert": 0.001})
    'best match: Lambert (rms 0.001), then EON (0.25)'
    """
    others = {title: distance for title, distance in distances.items() if title != cause.key}
    second = min(others, key=others.__getitem__, default="")
    then = f", then {second} ({others[second]:.2g})" if second else ""
    flags = (f", as with {FLAG} {str(bool(each)).lower()}" for each in cause.values)
    return f"best match: {cause.key}{_rms(cause)}{then}{''.join(flags)}"


def _region(cause: Cause) -> str:
    begins = "wrong for" if cause.key == "wrong" else "correct except for"
    wrong, count = cause.wrong or 0, cause.of or 1
    if cause.region:
        return f"{begins} {wrong} of {count} pairs, all {region(cause.region)}"
    if not cause.point:
        return f"{begins} {wrong} of {count} pairs"
    separator = ", worst" if cause.key == "wrong" else "; worst"
    percent = _short(100.0 * wrong / count, 2 if wrong < 0.995 * count else 3)
    if "wo" in cause.point:
        light = f" and the light at {_degrees(cause.point['wi'])}" if "wi" in cause.point else ""
        point = f"the view at {_degrees(cause.point['wo'])}{light} degrees"
    else:
        point = _point(cause.point, 3)
    return f"{begins} {percent} % of view/light pairs{separator} with {point}"


def _point(point: Mapping[str, Sequence[float]], digits: int) -> str:
    rows = (f"{name} {' '.join(f'{x:.{digits}g}' for x in each)}" for name, each in point.items())
    return ", ".join(rows)


def _degrees(direction: Sequence[float]) -> str:
    return f"{math.degrees(math.acos(max(-1.0, min(1.0, direction[2])))):.0f}"


def _not_finite(cause: Cause) -> str:
    place = region(cause.region) if cause.region else ""
    if cause.wrong is None:
        return f"NaN or infinity {place}".rstrip()
    all_in = f", all {place}" if place else ""
    first = f"; the first for {_point(cause.point, 6)}" if cause.point else ""
    return f"{cause.wrong} of {cause.of} values are not finite{all_in}{first}"


def _cure(cause: Cause) -> str:
    if cause.key == "beside_equal_pixels":
        return "the worst values are right next to pixels with equal inputs"
    pairs = (f"{name} {x:g}" for name, x in zip(cause.names, cause.values, strict=True))
    return f"the worst values are right with {' or '.join(pairs)}"


def _filled(text: str, cause: Cause) -> str:
    """The sentence, with a cause's names and numbers in place of the braces."""
    names, values = cause.names, cause.values
    first = values[0] if values else math.nan
    known = (name for name, x in FACTORS.items() if abs(first / x - 1.0) <= SAME_FACTOR)
    times = next(known, f"{first:.3g}")
    joint = STATES.get(cause.key.removesuffix("_of_frames"), "")
    return text.format(
        *names,
        x=first,
        whole=values[-1] if values else math.nan,
        text=cause.text,
        branch=cause.branch,
        all=", ".join(names),
        any=" and ".join(names),
        methods=" and with ".join(names),
        rest=", ".join(names[1:]),
        numbers=", ".join(f"{each:g}" for each in values),
        constant=f"{first:.3g}" if values else "not 0",
        instead="".join(f", but {each:.3g}" for each in values[1:]),
        place=f" {region(cause.region)}" if cause.region else "",
        share=f"{cause.wrong} of {cause.of}",
        released=_release(cause),
        states=f", all with {joint.join(names)}" if names else "",
        times=times,
        also=f" and {times} times as bright" if values else "",
    )


def _release(cause: Cause) -> str:
    """The differences between a node and the released version of the node.

    For each difference, the cause lists the name of a part, the value, and the released value.
    """
    node, *rows = cause.names or ("",)
    parts = [
        f"{name} is {value} instead of {released}"
        for name, value, released in zip(rows[::3], rows[1::3], rows[2::3], strict=False)
    ]
    text = (f"{node}: " if node else "") + ", ".join(parts[:DIFFERENCES_SHOWN])
    if len(parts) > DIFFERENCES_SHOWN:
        text += f", and {len(parts) - DIFFERENCES_SHOWN} more differences"
    if rows and cause.values and math.isfinite(cause.values[0]):
        text += f", with an error up to {in_words(cause.values[0])}"
    if cause.of and cause.of > 1:
        text += f", and {cause.of - 1} more with the same source"
    return text


SENTENCES: Mapping[Kind, Callable[[Cause], str]] = {
    Kind.FAULT: lambda cause: f"fault: {_filled(FAULTS[cause.key], cause)}{_rms(cause)}",
    Kind.ACCURACY: lambda cause: f"right model, {cause.key}{_rms(cause)}, but not accurate enough",
    Kind.REGION: _region,
    Kind.NOT_FINITE: _not_finite,
    Kind.CURE: _cure,
    Kind.DEFECT: lambda cause: _filled(DEFECTS[cause.key], cause),
    Kind.UNKNOWN: lambda cause: DEFECTS[cause.key],
    Kind.TEXT: lambda cause: cause.text,
    Kind.CONTROL: lambda cause: "inconclusive: the deliberately wrong control passed too",
    # The result's reason already explains causes of the kinds NONE, FOLLOWS and INPUT.
    **dict.fromkeys((Kind.NONE, Kind.FOLLOWS, Kind.INPUT), lambda cause: ""),
}

# --- results -------------------------------------------------------------------------------------


def difference(found: Difference) -> str:
    """The difference between a picture and its reference, in words.

    >>> difference(Difference("back", 0.2035, False, 0.124))
    'up to 20 % of white too bright in light from behind, visible on 12 % of its pixels'
    >>> difference(Difference("side", -0.5, True, 0.997))
    'highlights up to 50 % too dark in light from the side, visible on 100 % of its pixels'
    """
    if not math.isfinite(found.largest):
        return appearance(found)
    share = in_words(100.0 * found.visible)
    visible = f", visible on {share} % of its pixels" if found.visible else ""
    return f"{size(found)} {appearance(found)}{visible}"


def size(found: Difference) -> str:
    largest = abs(found.largest)
    if not math.isfinite(largest):
        return "not finite"
    if largest < 0.001:
        return of_white(largest)
    if found.highlight:
        return f"highlights up to {in_words(100.0 * largest)} %"
    return f"up to {of_white(largest)}"


def appearance(found: Difference) -> str:
    """Whether a picture is too bright, too dark or not finite, and in which light, in words."""
    light = LIGHTS.get(found.scene, found.scene)
    if not math.isfinite(found.largest):
        return f"has pixels that are infinite or not a number in {light}"
    return f"too {'bright' if found.largest > 0.0 else 'dark'} in {light}"


def excess(result: Result) -> str:
    """Words for an error above the tolerance, or for a negative control that passed, or ""."""
    control = result.control
    if result.error is not None and not result.within:
        if result.difference:
            return difference(result.difference)
        if result.quantity and result.quantity.counted and math.isfinite(result.error):
            return counted(int(result.error), result.unit.removesuffix("s"))
        if result.quantity is results.Quantity.KIT:
            return f"the error is {in_words(result.error)} {result.unit}"
        return f"{result.error:.3g} > {result.tolerance:.3g} {result.unit}".rstrip()
    if control and not control.caught:
        return f"the negative control is not caught: {control.variant}, {control.error:.3g}"
    return ""


def look(result: Result) -> str:
    if result.verdict == results.NOT_RUN:
        return f"not judged: {result.reason}"
    if result.verdict != results.PASSED:
        return explanation(replace(result, pages=()))
    if result.check == "finite":
        return f"no reference ({diagnosis(result.diagnosis)}); every pixel is finite"
    if result.check == "document":
        return "shaders are generated, not run"
    if result.difference and result.difference.is_visible:
        return f"{difference(result.difference)}, within this check's tolerance"
    return AS_SPECIFIED


def unchecked(names: Iterable[str]) -> str:
    """A note on inputs that are not checked because no model computes their values.

    >>> unchecked(["SR_tiles.base_color"])
    'not checked: base_color, which comes from a pattern or texture'
    """
    inputs = list(dict.fromkeys(each.rpartition(".")[2] for each in names))
    verb = "comes" if len(inputs) == 1 else "come"
    return f"not checked: {listed(inputs)}, which {verb} from a pattern or texture"


def explanation(result: Result) -> str:
    """The reason for a failure: the size of the error, the diagnosis, and pages on defects."""
    pages = (f"see docs/upstream/{page}.md" for page in result.pages)
    return "; ".join(filter(None, (excess(result), diagnosis(result.diagnosis), *pages)))


# --- changes -------------------------------------------------------------------------------------

# Changes of a number between two runs of a check, from the old value {0} to the new value {1}.
GROWTHS = {
    "largest": "the largest error is {0} -> {1}",
    "rms": "the rms error is {0} -> {1}",
    "best": "the rms distance to the best match is {0} -> {1}",
    "wrong": "{0} % -> {1} % of the samples are wrong",
    "not_finite": "{0} % -> {1} % of the samples are not finite",
}
LOST_PAGE, FOUND_PAGE = "{} no longer explains it", "{} explains it"
UNEXPLAINED = "the specification no longer allows it"
ROUNDED = "with another driver, few samples exceed the tolerance"


def growth(key: str, before: float, after: float, place: Region | None) -> str:
    """A change of a number between two runs, in words, with the region `place` of the samples.

    >>> growth("wrong", 0.125, 0.25, Region("roughness", "value", low=0.5))
    '12.5 % -> 25 % of the samples are wrong with roughness 0.5 or above'
    """
    if key == "error":
        factor = max(before, after) / min(before, after) if min(before, after) else math.inf
        side = "larger" if after > before else "smaller"
        return f"{in_words(factor)} times {side}" if math.isfinite(factor) else ""
    percent = 100.0 if key in ("wrong", "not_finite") else 1.0
    numbers = (_short(percent * each, 3) for each in (before, after))
    return f"{GROWTHS[key].format(*numbers)} {region(place) if place else ''}".rstrip()


def annotation(level: str, title: str, message: str) -> str:
    """A line that GitHub Actions shows as an annotation.

    >>> annotation("error", "worse: sheen", "50 % darker")
    '::error title=worse%3A sheen::50 %25 darker'
    """
    message, title = (each.replace("%", "%25").replace("\n", "%0A") for each in (message, title))
    return f"::{level} title={title.replace(':', '%3A').replace(',', '%2C')}::{message}"


# --- runs ----------------------------------------------------------------------------------------


def sentence(run: Run) -> str:
    """The verdict in words, which ignores libraries that are judged for comparison."""
    judged, total = run.judged, counted(len(run.judged), "check")
    passed, differing, failed, not_run = (run.counts[each] for each in results.VERDICTS)
    allowed = ""
    if differing:
        verb = "differs" if differing == 1 else "differ"
        allowed = f"; {differing} {verb}, but the specification allows it"
    if failed:
        places = Counter(each.location for each in judged if each.verdict == results.FAILED)
        counts = ", ".join(f"{count} on {location}" for location, count in places.items())
        where = f": {counts}" if len(places) > 1 else f" on {next(iter(places))}"
        # A check that could not run because another check failed is not counted.
        idle = sum(each.verdict == results.NOT_RUN and not each.follows for each in judged)
        text = (
            f"{failed} of {total} failed{where}{f'; {idle} did not run' if idle else ''}{allowed}."
        )
    elif not passed + differing:
        text = "No check ran."
    elif not_run:
        text = f"Nothing failed, but {not_run} of {total} did not run{allowed}."
    else:
        hosts: dict[str, dict[str, None]] = {}  # hosts by library
        for result in judged:
            hosts.setdefault(result.library, {})[result.host] = None
        named = (f"{enumerated(list(names))} with {library}" for library, names in hosts.items())
        on = f"on {' and '.join(named)}{allowed}."
        if differing:
            text = f"{passed} of {total} passed {on}"
        elif run.unjudged:
            text = f"{counted(len(judged), 'check')} passed and none failed {on}"
        else:
            text = f"{'The check' if len(judged) == 1 else f'All {total}'} passed {on}"
    if elsewhere := sum(map(run.is_elsewhere, judged)):
        text += f" {elsewhere} of them for inputs that no document uses."
    if run.missing:
        verb = "is" if len(run.missing) == 1 else "are"
        text += f" The run is not finished: {counted(len(run.missing), 'item')} {verb} missing."
    if run.refused:
        names, faults = tuple(map(str, run.refused)), counted(len(run.errors), "error")
        if passed + differing + failed:
            verb = "was" if len(names) == 1 else "were"
            text = f"{listed(names)} {verb} not checked: {faults}. {text}"
        else:
            verb = "has" if len(names) == 1 else "have"
            text = f"{listed(names)} {verb} {faults}; nothing was checked."
    for library in run.compared:
        verdicts = Counter(each.verdict for each in run.results if each.library == library)
        if ran := verdicts.total() - verdicts[results.NOT_RUN]:
            text += f" For comparison, {verdicts[results.FAILED]} of {ran} failed with {library}."
    return text


def summary(run: Run) -> str:
    """The verdict, the version and folder of the judged MaterialX, and the time."""
    text = sentence(run)
    if version := run.software.get("MaterialX"):
        folder = run.software.get("MaterialX folder")
        text += f" MaterialX {version}{f', from {folder}' if folder else ''}."
    return text if run.seconds is None else f"{text} Finished in {run.seconds:.1f} s."


def origins(run: Run) -> tuple[str, ...]:
    """For each folder judged as a library, the number of its files and of MaterialX's files."""
    return tuple(
        f"library {folder}: {counted(len(files['folder']), 'file')} from the folder, "
        + (f"{len(files['MaterialX']) or 'none'} from" if "MaterialX" in files else "loaded before")
        + f" MaterialX {run.software['MaterialX']}"
        for folder, files in run.libraries.items()
    )


def not_judged(run: Run) -> tuple[str, ...]:
    """A line with the subjects that no check judges, and with reasons; () without such subjects."""
    reasons: dict[str, list[str]] = {}
    for what, reason in run.unjudged:
        reasons.setdefault(reason, []).append(what)
    parts = (f"{', '.join(names)} ({reason})" for reason, names in reasons.items())
    return (f"not judged here: {'; '.join(parts)}",) if reasons else ()
