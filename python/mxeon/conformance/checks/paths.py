# SPDX-License-Identifier: Apache-2.0
"""Checks of path-tracing code: samples follow the stated density, and weights match the values.

Views are from both sides of the surface. A smooth surface reflects or refracts almost all samples
in one of two directions, so samples are counted in cells that are narrow around both directions.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache, partial
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.conformance import cache, check, controls, diagnosis
from mxeon.conformance.case import Case
from mxeon.conformance.checks.lobes import BELOW, CLEAR, DARK, TRANSMITTING
from mxeon.conformance.checks.microfacets import MIRROR, Evaluate, with_directions
from mxeon.conformance.checks.surface_shaders import SURFACES
from mxeon.conformance.results import Cause, Kind, Quantity
from mxeon.conformance.samples import GRAZING, Array, Batch, Values, float32, generator
from mxeon.conformance.spec import NO_ABILITY, Ability, LobeSpec, Spec, draw, materials
from mxeon.conformance.specs import combinations, emission
from mxeon.conformance.specs.microfacets import PASSING, THROUGHPUT, FacetSpec, TransmissionSpec
from mxeon.conformance.specs.surface_shaders import ALBEDO, SurfaceShaderSpec
from mxeon.conformance.tolerance import Compared, Measurement, Term, roundings, single, sum_of
from mxeon.hosts import base, host_row
from mxeon.hosts.calls import NORMAL, TANGENT
from mxeon.shaders.targets import PATH_TRACED

if TYPE_CHECKING:  # the import loads MaterialX
    from mxeon.shaders.generation import Input as Port

POINT = "struct Point\n"
NO_INPUTS: Values = MappingProxyType({})
CALL = """
vec3 path_tracer(float what, vec3 wo, vec3 wi, vec3 u, float inside, vec3 normal, vec3 tangent{parameters})
{{
    {assignments}
    Point p;
    p.position = vec3(0.25, -0.5, 1.0);
    p.normal = normal;
    p.tangent = tangent;
    p.texcoord = vec3(0.3, 0.4, 0.0).xy;
    p.inside = inside > 0.5;
    {answer}
}}
"""
SCATTERED = """if (what < 0.5)
        return material_evaluate(p, wo, wi);
    if (what < 1.5)
        return vec3(material_pdf(p, wo, wi));
    vec3 weight;
    float pdf;
    bool kept = material_sample(p, wo, u, wi, weight, pdf);
    if (!kept)
        return vec3(0.0);
    return what < 2.5 ? wi : what < 3.5 ? weight : vec3(pdf);"""
# PASSED is separate from SCATTERED, because drivers inline the whole material at each call.
PASSED = "return what < 5.5 ? vec3(material_shadow(p, wo)) : material_emitted(p, wo);"
RANDOM = "return path_random(uvec4(uvec3(u), 7u)).xyz;"
# GLSL code for each named value. The argument `what` of CALL is the position of the name in
# FUNCTIONS.
FUNCTIONS = {
    **dict.fromkeys(("evaluate", "pdf", "wi", "weight", "density"), SCATTERED),
    **dict.fromkeys(("opacity", "emission"), PASSED),
    "random": RANDOM,
}
DRAWS = 1 << 15
ANSWERS = cache.Recent[Array](64)  # cache shared by a check and the check's negative control
# Views at which many, some or few facets transmit light from inside a solid.
VIEWS = np.array([[0.7642691, 0.2364137, 0.6], [-0.19, 0.25, 0.9495], [0.3, -0.9367497, 0.18]])
VIEWS /= np.linalg.norm(VIEWS, axis=1, keepdims=True)
# Smallest value that must be sampled. Smaller values may be missed, because a sheen's fitted albedo
# may be 0 where the exact albedo is 3e-6.
LEAST_LIGHT = 1e-5
LEAST_DRAWN = 1e-5  # ratio of density to value up to which light counts as never sampled
# Smallest judged sample weight, which is an albedo. For smaller weights, probabilities of lobes
# have few correct digits, because a sheen's fitted albedo crosses 0.
LEAST_ALBEDO = 1e-3
LEAST_COUNTED = 0.2  # smallest roughness if samples are counted; the counting cells are coarse
# GLSL expressions that convert a parameter of type float or vec3 to the type of an input.
CONVERTED = {"boolean": "{} > 0.5", "integer": "int({})", "vector2": "{}.xy"}
VECTORS = ("vector2", "vector3", "color3")
MEAN_WEIGHT = 0.3333  # weight of a channel when MaterialX turns a transparency into alpha
OPACITY, EMISSION = 0.6, 0.3
# Inputs that make a surface shader emit light and have an alpha below 1.
TRANSPARENT: dict[str, float | str] = {
    **dict.fromkeys(("opacity", "geometry_opacity", "alpha"), OPACITY),
    **dict.fromkeys(("emission", "emission_luminance", "emissive", "emissiveColor"), EMISSION),
    "alpha_mode": "2",
}
WALLS = ("thin_walled", "geometry_thin_walled")

# For each node, the name of the IOR input, and other inputs that make the node glass.
# UsdPreviewSurface is missing, because that node's Schlick curve has no IOR for the denser side.
GLASS: dict[str, tuple[str, Values]] = {
    "dielectric_bsdf": ("ior", {"tint": (0.9, 0.8, 0.7), "roughness": (0.4, 0.4)}),
    "standard_surface": ("specular_IOR", {"transmission": 1.0, "specular_roughness": 0.5}),
    "open_pbr_surface": ("specular_ior", {"transmission_weight": 1.0, "specular_roughness": 0.5}),
}
INDEX = 2.0  # IOR with an inverse that is exact in float32
DRAWN = check.family(LobeSpec) - BELOW
GLASSY = TRANSMITTING | SURFACES  # nodes through which light enters and leaves a solid
# Lobes whose reflection depends on an IOR, which is inverted for light inside a solid.
INDEXED = (
    GLASSY
    | check.family(combinations.CombinedSpec)
    | check.family(FacetSpec, lambda spec: "ior" not in spec.types or spec.types["ior"] == "float")
)
# For each node, inputs of clear glass with IOR INDEX, and the Fresnel curve for light from outside.
SOLIDS: dict[str, tuple[Values, dict[str, Array]]] = {
    "dielectric_bsdf": (
        {**GLASS["dielectric_bsdf"][1], "ior": INDEX},
        {"ior": np.array([INDEX]), "tint": np.ones((1, 3))},
    ),
    "generalized_schlick_bsdf": (
        {"color0": (1.0 / 9.0,) * 3, "roughness": (0.4, 0.4)},
        {
            "color0": np.full((1, 3), 1.0 / 9.0),
            **dict.fromkeys(("color82", "color90"), np.ones((1, 3))),
            "exponent": np.array([5.0]),
        },
    ),
}
SIDES = ("outside", "inside")  # sides of a solid's surface
SUMMED = 1 << 12  # number of samples whose weights are summed
DRAWN_SUM = Term(5e-3, "a sum of 4096 samples")


@dataclass(frozen=True)
class Paths:
    """Path-tracing code of a document's only material, and the host that runs the code."""

    host: base.Host
    text: str
    ports: "tuple[Port, ...]" = ()  # inputs of the material that vary between pairs

    def values(
        self,
        what: str,
        wo: ArrayLike,
        wi: ArrayLike = NORMAL,
        u: ArrayLike = (0.0, 0.0, 0.0),
        inside: ArrayLike = False,
        inputs: Values = NO_INPUTS,
    ) -> Array:
        """Values (N, 3) of the function `what` of FUNCTIONS, or 0 where nothing is sampled.

        - `u`: Random numbers that select a sample.
        - `inside`: Whether the viewer is inside a solid.
        - `inputs`: Inputs of the material by name or path, and the surface's normal and tangent.
        """
        answer = FUNCTIONS[what]
        if self.host.target == "slang":
            answer = answer.replace("uvec", "uint")
        frame = inputs.get("normal", NORMAL), inputs.get("tangent", TANGENT)
        number = float(list(FUNCTIONS).index(what))
        arguments: list[ArrayLike] = [number, wo, wi, u, inside, *frame]
        parameters, assignments = "", []
        for port in self.ports:
            value = inputs.get(port.path, inputs.get(port.path.rpartition("/")[2], port.value))
            value = np.asarray(value, np.float64)
            if port.type == "vector2":
                value = np.insert(value, 2, 0.0, axis=-1)
            arguments.append(value)
            parameter = f"given_{port.name}"
            parameters += f", {'vec3' if port.type in VECTORS else 'float'} {parameter}"
            converted = CONVERTED.get(port.type, "{}").format(parameter)
            assignments.append(f"{port.name} = {converted};")
        rows = [np.atleast_2d(np.asarray(each, np.float64)) for each in arguments]
        text = self.text + CALL.format(
            parameters=parameters, assignments="\n    ".join(assignments), answer=answer
        )
        return ANSWERS.value(
            (self, *map(cache.contents, rows)),
            lambda: self.host.execute(text, "path_tracer", *rows).astype(np.float64),
        )


@lru_cache(maxsize=4)
def paths(
    host: base.Host, document: str, library: str = "eonlib", varied: tuple[str, ...] = ()
) -> Paths:
    """Path-tracing code of a document. Inputs with a name or path in `varied` become variables."""
    from mxeon.shaders.generation import generate

    uniforms = bool(varied)
    [shader] = generate(document, host.target, profile="path", library=library, uniforms=uniforms)
    text, ports = shader.stages["pixel"], []
    static = "static " if host.target == "slang" else ""
    for port in shader.inputs if varied else ():
        declared = rf"^ *(?:uniform )?(\w+) {port.name}(?: = [^;]*)?;\n"
        found = re.search(declared, text, re.MULTILINE)
        assert found
        kind, value = found[1], np.ravel(np.asarray(port.value)).tolist()
        literal = f"{kind}({', '.join(str(each).lower() for each in value)})"
        line = f"{static}const {kind} {port.name} = {literal};\n"
        if {port.path, port.path.rpartition("/")[2]} & {*varied}:
            ports.append(port)
            line = f"{static}{kind} {port.name};\n"
        text = text.replace(found[0], "", 1).replace(POINT, line + POINT, 1)
    return Paths(host, text, tuple(ports))


def subjects(case: Case, *walls: bool) -> Iterator[tuple[Paths, Batch]]:
    """Path-tracing code of a node, and pairs of directions with individual frames and inputs.

    A lobe has random inputs. A surface shader has inputs for which all lobes contribute. `walls`
    lists the wanted kinds of surface shader: False for a solid, True for a thin wall if supported.
    """
    if not is_shader(case.spec):
        yield random_materials(case)
        return
    spec, batch = case.of(SurfaceShaderSpec), case.backend.turned
    known = spec.types  # glTF has no anisotropy before MaterialX 1.39.4
    values, _ = materials(*spec.judged, *spec.others)
    inputs: Values = {
        **{
            name: (value,) * 3 if known[name] == "color3" else value
            for name, value in TRANSPARENT.items()
            if name in known
        },
        **{name: value for name, value in values.items() if name in known},
    }
    axes = {name: batch.inputs[name] for name in ("normal", "tangent")}
    switches = [name for name in WALLS if name in known]
    for thin in walls or (False,):
        if thin and not switches:
            continue
        material: Values = {**inputs, **dict.fromkeys(switches if thin else (), True)}
        text = paths(case.host, spec.document(material), case.library)
        numbers = {name: np.asarray(each, np.float64) for name, each in material.items()}
        yield text, replace(batch, inputs={**numbers, **axes})


def is_shader(spec: Spec) -> bool:
    return Ability.MATERIAL in spec.requires


def random_materials(case: Case) -> tuple[Paths, Batch]:
    """Random materials with a normal and a tangent that differ from those of the surface."""
    spec, batch = case.lobe, case.backend.turned
    rng, count = generator(), len(batch.wo)
    frame: Values = {each.name: NORMAL for each in spec.inputs if each.type == "vector3"}
    flags = [each.name for each in spec.inputs if each.type == "boolean"]
    others = [each for each in spec.inputs if each.name not in {*flags, *batch.inputs, *frame}]
    alternating = np.arange(count) % 2
    inputs: dict[str, ArrayLike] = {name: alternating for name in flags if name not in spec.mode}
    for name in frame:
        inputs[f"lobe_{name}/value"] = batch.inputs["normal" if name == "normal" else "tangent"]
    if frame:
        inputs |= {name: np.roll(batch.inputs[name], 1, axis=0) for name in ("normal", "tangent")}
    batch = batch.altered(**draw(rng, count, others), **inputs)
    return paths(case.host, spec.document(frame), case.library, tuple(batch.inputs)), batch


def random(count: int, rng: np.random.Generator) -> Array:
    """Random numbers (N, 3) in [0, 1) of 24 bits, like the random numbers of a shader."""
    return rng.integers(0, 1 << 24, (count, 3)).astype(np.float64) * 2.0**-24


def lattice(count: int) -> Array:
    """Points (count, 3) that evenly fill the unit cube [0, 1)^3."""
    # Each column holds the multiples, modulo 1, of a power of 1 / x, where x^4 = x + 1.
    steps = 1.2207440846057596 ** -np.arange(1.0, 4.0)
    return float32((0.5 + np.arange(count)[:, np.newaxis] * steps) % 1.0 * (1.0 - 2.0**-24))


def refracted(wo: Array, index: float = 1.5) -> Array:
    """Direction in which a smooth surface refracts a view, or -wo beyond the critical angle."""
    x, y, _ = -wo / index
    return np.array([x, y, -np.sqrt(1.0 - x * x - y * y)]) if x * x + y * y < 1.0 else -wo


def steepness(density: Array) -> Array:
    """Factor that amplifies the rounding of a direction: 1 + 1 / alpha, computed from the density.

    GGX facets reflect with a density of at most 1 / (4 pi alpha^2). The relative slope of the
    density is about 1 / alpha.
    """
    return 1.0 + np.sqrt(4.0 * np.pi * density)


def scores(case: Case) -> Iterator[tuple[float, bool, Batch]]:
    """Deviations of samples from the stated density, per material and view.

    Each row has the deviation in standard deviations, whether the view is inside a solid, and a
    batch with the view and the material. Quadratures with few nodes cannot hide a failure, because
    quadrature errors only increase the deviation.
    """
    u = random(DRAWS, generator())
    for text, batch in subjects(case, False, True):
        rough = {
            name: np.maximum(each, LEAST_COUNTED)
            for name, each in batch.inputs.items()
            if "roughness" in name
        }
        if "cuticle_angle" in batch.inputs:  # tilted lobes have a pole along the fiber
            rough["cuticle_angle"] = np.clip(batch.inputs["cuticle_angle"], 0.45, 0.55)
        batch = batch.altered(**rough)
        thin = any(name in batch.inputs for name in WALLS)  # a thin wall has no inside
        for row in range(3 if case.control or is_shader(case.spec) else 6):
            one = batch.where(slice(row, row + 1))
            assert one.frame is not None
            view, axes = one.wo[0], one.frame[0]
            for inside in (False, True) if GLASSY(case.spec) and not thin else (row % 2 == 1,):
                values = partial(
                    text.values, wo=one.world(one.wo), inside=inside, inputs=one.inputs
                )

                def density(w: Array, values: Evaluate = values, axes: Array = axes) -> Array:
                    return case.outputs(Batch(w, w, {}), values("pdf", wi=w @ axes.T))[:, 0]

                pole = refracted(view, 1.0 / 1.5 if inside else 1.5)
                for count, nodes, limit in LOOKS[1:2] if case.control else LOOKS:
                    wi = values("wi", u=u[:count]) @ axes
                    straight = np.linalg.norm(wi + view, axis=1, keepdims=True) < 1e-6
                    score = deviation(wi * ~straight, density, pole, view * MIRROR, nodes)
                    if score <= limit:
                        break
                yield score, inside, one
                if case.control and score > MOST_DEVIATIONS:
                    return


def pdf(case: Case) -> Measurement:
    score, inside, view = max(scores(case), key=lambda each: each[0])
    return Measurement(score, {"wo": view.wo[0].tolist(), "inside": [float(inside)]})


def parts(case: Case) -> Iterator[tuple[Cause, Compared]]:
    """Compare weight times density with value, and density with material_pdf(). Find unsampled
    light.

    Each comparison is paired with the cause to report. Measured values are divided by expected
    values, and errors are divided by the amplification of roundings.
    """
    for text, batch in subjects(case, False, True):
        u, wo = random(len(batch.wo), generator()), batch.world(batch.wo)
        for inside in (False, True):

            def cause(key: str, side: str = SIDES[inside]) -> Cause:
                return Cause(Kind.DEFECT, key, (side,))

            values = partial(text.values, inside=inside)
            value, pdf = (
                values(what, wo, batch.world(batch.wi), inputs=batch.inputs)
                for what in ("evaluate", "pdf")
            )
            missed = value * ((pdf <= LEAST_DRAWN * value) & (value > LEAST_LIGHT))
            yield cause("undrawn_light"), Compared(batch, missed, np.zeros_like(missed))
            wi, weight, density = (
                values(what, wo, u=u, inputs=batch.inputs) for what in ("wi", "weight", "density")
            )
            sampled = density[:, 0] > 0.0
            if not sampled.any():
                continue
            rows = replace(batch.where(sampled), wi=wi[sampled])
            weight, density = weight[sampled], density[sampled, :1]
            value, pdf = (
                values(what, wo[sampled], rows.wi, inputs=rows.inputs)
                for what in ("evaluate", "pdf")
            )
            size, pdf = value.max(axis=1, keepdims=True), pdf[:, :1]
            size[size <= 0.0] = 1.0
            normal = rows.inputs.get("lobe_normal/value", rows.inputs["normal"])
            cosine = np.abs(np.sum(rows.wi * normal, axis=1, keepdims=True))
            ratio = np.maximum(weight, value / np.maximum(pdf, 1e-30)).max(axis=1, keepdims=True)
            amplified = steepness(pdf) + 1.0 / np.maximum(cosine, GRAZING)
            amplified += LEAST_ALBEDO / np.maximum(ratio, LEAST_LIGHT)
            for key, measured, expected in (
                ("drawn_weight", case.outputs(rows, weight * density) / size, value / size),
                ("sampled_density", density / np.maximum(pdf, 1e-30), np.ones_like(pdf)),
            ):
                scaled = expected + (measured - expected) / amplified
                yield cause(key), Compared(rows, scaled, expected)


SAMPLE = sum_of(
    roundings(
        16,
        "of a weight and a density, times 1 + 1 / alpha of the lobe + 1 / cosine + 1 / (1000 weight)",
    ),
    quantity=Quantity.DRAWN,
)


def path_value(case: Case) -> Iterator[Compared]:
    for text, batch in subjects(case):
        count, shader = len(batch.wo), is_shader(case.spec)
        wi = batch.wi.copy()
        if not GLASSY(case.spec):
            wi[::4, 2] *= -1.0
        wi[:8] = batch.wo[:8]
        batch = replace(batch, wi=wi)
        normal = np.broadcast_to(NORMAL, wi.shape)
        if shader and batch.frame is not None:
            # Use +z or -z of the frame as the normal, about which the node graph rotates tangents.
            normal = np.einsum("nij,ni->nj", batch.frame, batch.inputs["normal"]).round()
        local = replace(batch.altered(normal=normal, tangent=TANGENT), frame=None)
        # Rasterizers cannot draw the inside of a solid, so skip inside views if there is an IOR.
        inside = np.zeros(count) if INDEXED(case.spec) else np.arange(count) % 2
        values = partial(
            text.values,
            wo=batch.world(batch.wo),
            wi=batch.world(wi),
            inside=inside,
            inputs=batch.inputs,
        )
        share = OPACITY if shader and case.spec.node != "UsdPreviewSurface" else 1.0
        opacity = 1.0 - 3.0 * MEAN_WEIGHT * (1.0 - share)
        scale = steepness(values("pdf")[:, :1]) / np.pi
        expected = opacity * case.evaluating.evaluate(local, "direct")
        yield Compared(batch, case.outputs(batch, values("evaluate")), expected).over(scale)
        yield Compared(batch, values("opacity"), np.full((count, 1), opacity))
        emitted = np.zeros((count, 3))
        if shader:
            emitted = case.evaluating.evaluate(local, "emission", "radiance")
        yield Compared(batch, values("emission"), share * emitted)


def path_emission(case: Case) -> Iterator[Compared]:
    """Radiance toward views from both sides, in frames that permute the axes without roundings."""
    spec = case.of(emission.EmissionSpec)
    permutations = np.stack([np.roll(np.eye(3), shift, axis=0) for shift in range(3)])
    for batch in (*case.batches, case.backend.take(spec.backs)):
        if "normal" in batch.inputs:  # skip cones, whose axis is a connected node
            continue
        frame = permutations[np.arange(len(batch.wo)) % 3]
        inputs = {**batch.inputs, "normal": frame[:, :, 2], "tangent": frame[:, :, 0]}
        text = paths(case.host, spec.document(), case.library, tuple(batch.inputs))
        radiance = text.values(
            "emission", replace(batch, frame=frame).world(batch.wo), inputs=inputs
        )
        yield spec.rescaled(Compared(batch, case.outputs(batch, radiance), case.expected(batch)))


def pcg4d(state: NDArray[np.uint32]) -> NDArray[np.uint32]:
    x, y, z, w = state
    x = x + y * w
    y = y + z * x
    z = z + x * y
    return np.stack([x, y, z, w + y * z])


def path_random(case: Case) -> Iterator[Compared]:
    """Compare random numbers with pcg4d [Jarzynski2020], bit for bit."""
    counters = np.arange(3 * 256).reshape(-1, 3) ** 2
    [(text, _)] = subjects(case)
    state = np.insert(counters, 3, 7, axis=1).T.astype(np.uint32)
    state = pcg4d(state * np.uint32(1664525) + np.uint32(1013904223))
    expected = (pcg4d(state ^ (state >> np.uint32(16)))[:3] >> np.uint32(8)).T / 2.0**24
    numbers = text.values("random", NORMAL, u=counters.astype(np.float64))
    normals = np.broadcast_to(NORMAL, numbers.shape)
    batch = Batch(normals, normals, {})
    yield Compared(batch, case.outputs(batch, numbers), expected)


def path_inside(case: Case) -> Iterator[Compared]:
    name, values = GLASS[case.spec.node]
    if is_shader(case.spec):
        text = paths(case.host, case.spec.document({**values, name: INDEX}), case.library, (name,))
        batch = case.backend.turned
        batch = replace(batch, inputs={each: batch.inputs[each] for each in ("normal", "tangent")})
    else:
        [(text, batch)] = subjects(case)
    index = INDEX ** (np.arange(len(batch.wo)) // 2 % 2 * 2.0 - 1.0)
    inner, outer = ({**batch.inputs, name: each} for each in (index, 1.0 / index))
    wo, u = batch.world(batch.wo), random(len(batch.wo), generator())
    wi = text.values("wi", wo, u=u, inputs=outer)
    wi = np.where(np.any(wi != 0.0, axis=1, keepdims=True), wi, wo)
    amplified = steepness(text.values("pdf", wo, wi, inputs=outer)[:, :1])
    for what in ("evaluate", "pdf"):
        measured = case.outputs(batch, text.values(what, wo, wi, inside=True, inputs=inner))
        expected = text.values(what, wo, wi, inputs=outer)
        scale = amplified * np.maximum(1.0, expected.max(axis=1, keepdims=True))
        yield Compared(batch, measured, expected).over(scale)


def clear_draws(case: Case, inside: bool) -> Iterator[tuple[Batch, Array, Array]]:
    """Views of a clear solid, sampled directions, and sample weights divided by the tint."""
    values, _ = SOLIDS[case.spec.node]
    [(text, _)] = subjects(case)
    inputs = {**values, "lobe_normal/value": NORMAL, "lobe_tangent/value": TANGENT}
    for view in VIEWS:
        wi, weight = (
            text.values(what, view, u=lattice(SUMMED), inside=inside, inputs=inputs)
            for what in ("wi", "weight")
        )
        one = Batch(view[np.newaxis], view[np.newaxis], {})
        yield one, wi, weight / np.asarray(values.get("tint", 1.0))


def path_energy(case: Case) -> Iterator[Compared]:
    for inside in (False, True):
        for batch, _, weight in clear_draws(case, inside):
            total = weight.mean(axis=0, keepdims=True)
            yield Compared(batch, case.outputs(batch, total), np.ones((1, 3)))


def path_leaving(case: Case) -> Iterator[Compared]:
    spec = case.of(TransmissionSpec)
    values, curve = SOLIDS[spec.node]
    alpha = float(np.ravel(values["roughness"])[0])
    passed = spec.reversed(VIEWS[:, 2], alpha, INDEX, curve)
    for (batch, wi, weight), expected in zip(clear_draws(case, True), passed, strict=True):
        leaving = (weight * (wi[:, 2:] < 0.0)).mean(axis=0, keepdims=True)
        yield Compared(batch, case.outputs(batch, leaving), np.full((1, 3), expected))


def path_albedo(case: Case) -> Iterator[Compared]:
    [(text, batch)] = subjects(case)
    for view in VIEWS:
        one = Batch(view[np.newaxis], view[np.newaxis], batch.inputs)
        one = one.altered(normal=NORMAL, tangent=TANGENT)
        light = text.values("weight", view, u=lattice(SUMMED)).mean(axis=0, keepdims=True)
        rasterized = case.evaluating.albedo(one) + case.evaluating.transmitted(one)
        opacity = text.values("opacity", view)
        yield Compared(one, case.outputs(one, light), 1.0 - opacity + opacity * rasterized)


# --- directions against a density: a chi-square test on the sphere -------------------------------

# Cells divide the angle from a pole and the azimuth around the pole. The pole is the main direction
# of a smooth lobe, for which the first ring of cells is narrow. If a density of N samples is wrong
# everywhere by a fraction e, chi-square grows by N e^2. The standard deviation of chi-square is the
# square root of twice the number of cells. With 272 cells, an e of 6.5 % therefore adds six
# standard deviations for 2^15 samples, and three standard deviations for half as many samples.
CELLS = 16  # divisions of the angle and of the azimuth
ORDERS = 4, 8, 16, 32, 64, 128  # quadrature nodes per axis of a patch
# Tests whether samples follow a density, from cheap to accurate. Each row has a number of samples,
# numbers of quadrature nodes, and the score up to which no further test is needed.
LOOKS = (
    (DRAWS // 2, ORDERS[:1], 2.0),
    (DRAWS // 2, ORDERS[:4], 2.0),
    (DRAWS, ORDERS[:4], 3.0),
    (DRAWS, ORDERS, 0.0),
)
CLOSE = 2.0  # largest accepted difference between two quadratures of a patch, in samples
MOST_DEVIATIONS = 6.0  # tolerance of the check `pdf`, in standard deviations
CONE = 0.02  # angular width of the first ring of cells, in radians
LEAST = 1e-7  # angle from the pole, in radians, up to which a density counts as constant
INNER = 9  # number of rings of patches, of geometric widths, in the first ring of cells
RARE = 10.0  # cells with fewer expected samples are merged


def deviation(
    draws: Array,
    density: Callable[[Array], Array],
    pole: Array,
    other: Array,
    nodes: Sequence[int] = ORDERS,
) -> float:
    """Deviation of samples from a density, in standard deviations of a chi-square test.

    A deviation below the expected noise counts as 0. If the density is NaN, the deviation is
    infinite. The cube root of (chi-square / degrees of freedom) is nearly normal
    [WilsonHilferty1931].

    - `draws`: Unit vectors, (N, 3), or zeros for lost samples. The expected share of lost samples
      is 1 minus the integral of the density.
    - `density`: Function that returns densities (M,), in 1/sr, for unit vectors (M, 3).
    - `pole`, `other`: Directions around which a smooth lobe may be sampled. If the directions
      differ, the cone around `other` is one cell.
    - `nodes`: See `density_integrals`.
    """
    count = (CELLS + 1) * CELLS
    separate = pole @ other < np.cos(2.0 * CONE)
    poles = [pole, other] if separate else [pole]
    integrals = density_integrals(density, poles, CLOSE / len(draws), nodes)
    rings = np.maximum(np.arange(INNER + CELLS) - INNER + 1, 0)
    cells = (rings[:, np.newaxis] * CELLS + np.arange(CELLS)).ravel()
    cells = np.append(cells, np.full(len(integrals) - len(cells), count))
    shares = np.bincount(cells, integrals, minlength=count + 1)
    directions = draws[np.linalg.norm(draws, axis=1) > 0.5]
    hit = cell(directions, pole)
    hit[(directions @ other >= np.cos(CONE)) & separate] = count
    counts = np.bincount(hit, minlength=len(shares))
    mean = len(draws) * np.append(shares, 1.0 - shares.sum())
    observed = np.append(counts, len(draws) - len(directions))
    rare = mean < RARE
    observed, mean = (np.append(each[~rare], each[rare].sum()) for each in (observed, mean))
    mean[-1] = max(mean[-1], RARE)
    freedom = len(mean) - 1
    spread = 2.0 / (9.0 * freedom)
    ratio = ((observed - mean) ** 2 / mean).sum() / freedom
    score = (ratio ** (1.0 / 3.0) - (1.0 - spread)) / np.sqrt(spread)
    return max(float(score), 0.0) if np.isfinite(score) else np.inf


def axes(pole: Array) -> Array:
    """Two unit vectors perpendicular to the pole, and the pole, (3, 3)."""
    across = np.cross(pole, np.eye(3)[np.argmin(np.abs(pole))])
    across /= np.linalg.norm(across)
    return np.stack([across, np.cross(pole, across), pole])


def cell(w: Array, pole: Array) -> NDArray[np.int64]:
    x, y, z = axes(pole) @ w.T
    angle, azimuth = np.arctan2(np.hypot(x, y), z), np.arctan2(y, x) / (2.0 * np.pi) % 1.0
    ring = np.floor((angle - CONE) / (np.pi - CONE) * CELLS).clip(-1, CELLS - 1) + 1
    sector = np.minimum(np.floor(azimuth * CELLS), CELLS - 1)
    number: NDArray[np.int64] = (ring * CELLS + sector).astype(np.int64)
    return number


def density_integrals(
    density: Callable[[Array], Array], poles: Sequence[Array], close: float, nodes: Sequence[int]
) -> Array:
    """Integrals of a density over patches of a sphere, and over patches of a cone.

    Patches of the sphere surround the first pole. The cone around the second pole is excluded from
    the sphere. For each patch, the number of nodes per axis increases along `nodes` until two
    results agree up to `close` in the patch and in all neighboring patches. The neighbors count,
    because the nodes of a single patch may miss an edge of the density.
    """
    frames = np.stack(list(map(axes, poles)))
    sphere = (INNER + CELLS) * CELLS  # number of patches around the first pole
    rings = INNER + CELLS + INNER * (len(poles) - 1)
    integrals, pending = np.zeros(rings * CELLS), np.arange(rings * CELLS)
    for count in nodes:
        local, area = patches(count)
        patch, pole = pending % sphere, pending // sphere
        w, area = local[patch] @ frames[pole], area[patch]
        for other in poles[1:]:
            area = area * ((pole > 0)[:, np.newaxis] | (w @ other < np.cos(CONE)))
        results = (density(w.reshape(-1, 3)).reshape(area.shape) * area).sum(axis=1)
        unsure = np.zeros((rings, CELLS), bool)
        unsure.flat[pending] = np.abs(results - integrals[pending]) > close
        integrals[pending] = results
        for axis in (0, 1):
            unsure |= np.roll(unsure, 1, axis) | np.roll(unsure, -1, axis)
        if not len(pending := np.flatnonzero(unsure)):
            break
    return integrals


@lru_cache(maxsize=len(ORDERS))
def patches(nodes: int) -> tuple[Array, Array]:
    """Directions (P, M, 3) and solid angles (P, M) of M Gauss nodes in P patches around +z."""
    x, weight = np.polynomial.legendre.leggauss(nodes)
    edges = np.append(0.0, np.geomspace(LEAST, CONE, INNER))
    edges = np.append(edges, np.linspace(CONE, np.pi, CELLS + 1)[1:])
    half, turn = 0.5 * np.diff(edges)[:, np.newaxis], np.pi / CELLS
    angle = 0.5 * (edges[1:] + edges[:-1])[:, np.newaxis] + half * x
    azimuth = turn * (2.0 * np.arange(CELLS)[:, np.newaxis] + 1.0 + x)
    angle, azimuth = angle[:, np.newaxis, :, np.newaxis], azimuth[:, np.newaxis]
    w = np.stack(
        np.broadcast_arrays(
            np.sin(angle) * np.cos(azimuth), np.sin(angle) * np.sin(azimuth), np.cos(angle)
        ),
        axis=-1,
    )
    strips = (half * weight)[:, np.newaxis, :, np.newaxis] * turn * weight
    area = np.broadcast_to(np.sin(angle) * strips, w.shape[:-1])
    return w.reshape(-1, nodes**2, 3), area.reshape(-1, nodes**2)


PATHS = partial(
    check.Check,
    requires=Ability.PAIRS,
    profile="path",
    hosts=lambda spec, host: host_row(host).way == "pairs" and host_row(host).target in PATH_TRACED,
)


# fmt: off
ROWS = (
    PATHS(key="pdf",
          claim="A path tracer samples the density that it returns, which integrates to the fraction of samples it keeps.",
          applies=DRAWN, measure=pdf,
          tolerance=single(
              MOST_DEVIATIONS, Quantity.DEVIATIONS,
              "a correct sampler reaches 6 once in 10^7 chi-square tests"),
          control=controls.with_values(
              "a tenth of the density is that of a uniform lobe that is never sampled",
              lambda batch, values: 0.9 * values + 0.1 / (4.0 * np.pi)),
          explain=lambda case: diagnosis.defect(
              "drawn_density",
              *dict.fromkeys(
                  SIDES[inside] for score, inside, _ in scores(case) if score > MOST_DEVIATIONS))),
    PATHS(key="sample",
          claim="A sample's weight times its density is the value in its direction, and the density is that of material_pdf.",
          applies=DRAWN, measure=lambda case: (compared for _, compared in parts(case)), tolerance=SAMPLE,
          control=controls.scale("weights are 0.01 % too large", 1.0001),
          explain=lambda case: diagnosis.causes_of(parts(case), SAMPLE)),
    PATHS(key="path_value",
          claim="A path tracer's value, opacity and emission equal the rasterizer's, in any frame.",
          applies=DRAWN - DARK, measure=path_value,
          tolerance=sum_of(roundings(
              64, "of two directions and their frame, times 1 + 1 / alpha of the lobe")),
          control=controls.scale("values are 0.1 % too large", 1.001),
          explain=diagnosis.defect("other_path_value"),
          methods=lambda spec, methods: not methods.distributed),
    PATHS(key="path_emission",
          claim="A path tracer's emission matches the node's equation on both sides of surfaces along each axis.",
          applies=check.family(emission.EmissionSpec), measure=path_emission, tolerance="value",
          control=controls.scale("values are 0.1 % too large", 1.001),
          explain=diagnosis.defect("other_path_emission"), requires=NO_ABILITY),
    PATHS(key="path_random",
          claim="The random numbers of path-tracing code are those of pcg4d.",
          applies=check.family(LobeSpec, lambda spec: spec.node == "eon_diffuse_bsdf"), measure=path_random,
          tolerance=single(0.0, Quantity.VALUE, "the same bits"),
          control=controls.scale("numbers are half as large", 0.5),
          explain=diagnosis.defect("other_random_numbers")),
    PATHS(key="path_inside",
          claim="Light inside a solid is reflected and refracted as outside a solid with the inverse IOR.",
          applies=GLASSY & check.Specs(lambda spec: spec.node in GLASS), measure=path_inside,
          tolerance=sum_of(roundings(
              256, "of an IOR that OpenPBR computes from the reflectance, near a critical angle")),
          control=controls.scale("values are 0.1 % too large", 1.001),
          explain=diagnosis.defect("inside_is_not_outside")),
    PATHS(key="path_albedo",
          claim="Samples from outside carry as much light as a rasterizer reflects and transmits.",
          applies=SURFACES, measure=path_albedo,
          tolerance=ALBEDO.plus(DRAWN_SUM),
          control=controls.scale("values are 10 % too large", 1.1),
          explain=diagnosis.defect("other_path_albedo"),
          methods=lambda spec, methods: (
              with_directions(spec, methods) and methods.transmission == "refraction")),
    PATHS(key="path_energy",
          claim="Samples at a clear solid carry all light, from outside and from inside.",
          applies=CLEAR, measure=path_energy, tolerance=PASSING.plus(DRAWN_SUM),
          control=controls.scale("values are 10 % too large", 1.1),
          explain=diagnosis.defect("light_from_inside")),
    PATHS(key="path_leaving",
          claim="Samples that leave a clear solid carry the light that could enter along the same paths.",
          applies=CLEAR, measure=path_leaving, tolerance=THROUGHPUT.plus(DRAWN_SUM),
          control=controls.scale("values are 10 % too large", 1.1),
          explain=diagnosis.defect("light_from_inside")),
)
# fmt: on
