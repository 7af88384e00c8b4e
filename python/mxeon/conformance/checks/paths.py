# SPDX-License-Identifier: Apache-2.0
"""Checks of path-tracing code: samples match the stated density, and weights match the values.

Views are from both sides of the surface. The directions of smooth transmission and reflection are
nearly constant, so samples are counted around them.
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
from mxeon.conformance.checks.microfacets import with_directions
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
# Separate from SCATTERED: drivers inline the material into each call.
PASSED = "return what < 5.5 ? vec3(material_shadow(p, wo)) : material_emitted(p, wo);"
RANDOM = "return path_random(uvec4(uvec3(u), 7u)).xyz;"
# Code that returns each value; the value's position here is its number `what`.
FUNCTIONS = {
    **dict.fromkeys(("evaluate", "pdf", "wi", "weight", "density"), SCATTERED),
    **dict.fromkeys(("opacity", "emission"), PASSED),
    "random": RANDOM,
}
TARGETS = ("glsl", "essl", "vulkan", "slang")  # targets of mxeon.shaders.path_tracing
DRAWS = 1 << 15
ANSWERS = cache.Recent[Array](64)  # a check and its control need the same values
# Views that see many and few facets below the critical angle, and one at which no light leaves a
# smooth solid.
VIEWS = np.array([[0.7642691, 0.2364137, 0.6], [-0.19, 0.25, 0.9495], [0.3, -0.9367497, 0.18]])
VIEWS /= np.linalg.norm(VIEWS, axis=1, keepdims=True)
MATERIALS_DRAWN = 6  # materials whose samples are counted, each at one view
# Smallest value that must be sampled: a sheen's fitted albedo may be 0 where the exact one is 3e-6.
LEAST_LIGHT = 1e-5
LEAST_DRAWN = 1e-5  # density over value, below which light is never sampled in practice
# Below this sample weight (an albedo), shares of lobes have few digits: a sheen's fit crosses 0.
LEAST_ALBEDO = 1e-3
LEAST_COUNTED = 0.2  # minimum roughness of lobes with counted samples: the cells are coarse
# Expressions that convert a parameter, a float or a vec3, to an input's type.
GIVEN = {"boolean": "{} > 0.5", "integer": "int({})", "vector2": "{}.xy"}
VECTORS = ("vector2", "vector3", "color3")
# These inputs give materials with all lobes an alpha below 1 and an emission.
MEAN_WEIGHT = 0.3333  # MaterialX's weight of a channel when it turns a transparency into alpha
OPACITY, EMISSION = 0.6, 0.3
THIN: dict[str, float | str] = {
    **dict.fromkeys(("opacity", "geometry_opacity", "alpha"), OPACITY),
    **dict.fromkeys(("emission", "emission_luminance", "emissive", "emissiveColor"), EMISSION),
    "alpha_mode": "2",
}
WALLS = ("thin_walled", "geometry_thin_walled")

# Each node's name of the index, and its inputs for glass. UsdPreviewSurface is left out: its
# Schlick curve has no index for the denser side.
GLASS: dict[str, tuple[str, Values]] = {
    "dielectric_bsdf": ("ior", {"tint": (0.9, 0.8, 0.7), "roughness": (0.4, 0.4)}),
    "standard_surface": ("specular_IOR", {"transmission": 1.0, "specular_roughness": 0.5}),
    "open_pbr_surface": ("specular_ior", {"transmission_weight": 1.0, "specular_roughness": 0.5}),
}
INDEX = 2.0  # its inverse is exact
DRAWN = check.family(LobeSpec) - BELOW
GLASSY = TRANSMITTING | SURFACES  # light enters and leaves a solid
# Lobes whose reflection uses an index, which is inverted for light inside.
UNLIKE_INSIDE = (
    GLASSY
    | check.family(combinations.CombinedSpec)
    | check.family(FacetSpec, lambda spec: "ior" not in spec.types or spec.types["ior"] == "float")
)
# Glass of index INDEX by node: its inputs, its tint, and the inputs of its curve from outside.
SOLIDS: dict[str, tuple[Values, Values, dict[str, Array]]] = {
    "dielectric_bsdf": (
        {**GLASS["dielectric_bsdf"][1], "ior": INDEX},
        {"tint": (0.9, 0.8, 0.7)},
        {"ior": np.array([INDEX]), "tint": np.ones((1, 3))},
    ),
    "generalized_schlick_bsdf": (
        {"color0": (1.0 / 9.0,) * 3, "roughness": (0.4, 0.4)},
        {},
        {
            "color0": np.full((1, 3), 1.0 / 9.0),
            "color82": np.ones((1, 3)),
            "color90": np.ones((1, 3)),
            "exponent": np.array([5.0]),
        },
    ),
}
PLACES = ("outside", "inside")  # sides of a solid's surface
SUMMED = 1 << 12  # samples whose weights are summed
DRAWN_SUM = Term(5e-3, "a sum of 4096 draws")


@dataclass(frozen=True)
class Paths:
    """The path-tracing text of a document's only material, on a host."""

    host: base.Host
    text: str
    ports: "tuple[Port, ...]" = ()  # inputs that are variables, set for each row

    def values(
        self,
        what: str,
        wo: ArrayLike,
        wi: ArrayLike = NORMAL,
        u: ArrayLike = (0.0, 0.0, 0.0),
        inside: ArrayLike = False,
        inputs: Values = NO_INPUTS,
    ) -> Array:
        """Values (N, 3) of one of FUNCTIONS; 0 where nothing is sampled.

        - `inputs`: Inputs of the material by name or path, and "normal" and "tangent" of the surface.
        """
        number, answer = list(FUNCTIONS).index(what), FUNCTIONS[what]
        if self.host.target == "slang":
            answer = answer.replace("uvec", "uint")
        given: list[Array] = []
        for port in self.ports:
            own = inputs.get(port.path, inputs.get(port.path.rpartition("/")[2], port.value))
            value = np.asarray(own, np.float64)
            wide = [(0, 0)] * (value.ndim - 1) + [(0, 1)]
            given.append(np.pad(value, wide) if port.type == "vector2" else value)
        frame = inputs.get("normal", NORMAL), inputs.get("tangent", TANGENT)
        rows = [
            np.atleast_2d(np.asarray(each, np.float64))
            for each in (float(number), wo, wi, u, inside, *frame, *given)
        ]
        text = self.text + CALL.format(
            parameters="".join(
                f", {'vec3' if port.type in VECTORS else 'float'} given_{port.name}"
                for port in self.ports
            ),
            assignments="\n    ".join(
                f"{port.name} = {GIVEN.get(port.type, '{}').format(f'given_{port.name}')};"
                for port in self.ports
            ),
            answer=answer,
        )
        return ANSWERS.value(
            (self, *map(cache.contents, rows)),
            lambda: self.host.execute(text, "path_tracer", *rows).astype(np.float64),
        )


@lru_cache(maxsize=4)
def paths(
    host: base.Host, document: str, library: str = "eonlib", varied: tuple[str, ...] = ()
) -> Paths:
    """The code of a document, in which inputs in `varied` (names or paths) are variables."""
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
    """Materials with pairs in individual frames: random ones of a node, or a shader with all lobes.

    `walls` lists the kinds of a surface shader that supports them: False for solid, True for thin.
    """
    if is_shader(case.spec):
        yield from shaders(case, *walls)
    else:
        yield random_materials(case)


def is_shader(spec: Spec) -> bool:
    return Ability.MATERIAL in spec.requires


def shaders(case: Case, *walls: bool) -> Iterator[tuple[Paths, Batch]]:
    spec, batch = case.of(SurfaceShaderSpec), case.backend.turned
    known = spec.types  # glTF has no anisotropy before MaterialX 1.39.4
    values, _ = materials(*spec.judged, *spec.others)
    values = {name: value for name, value in values.items() if name in known}
    thin: dict[str, ArrayLike] = {
        name: (value,) * 3 if known[name] == "color3" else value
        for name, value in THIN.items()
        if name in known and name not in values
    }
    axes = {name: batch.inputs[name] for name in ("normal", "tangent")}
    named = [name for name in WALLS if name in known]
    for wall in [each for each in walls or (False,) if named or not each]:
        solid: Values = {**values, **thin, **dict.fromkeys(named * wall, True)}
        numbers = {name: np.asarray(each, np.float64) for name, each in solid.items()}
        text = paths(case.host, spec.document(solid), case.library)
        yield text, replace(batch, inputs={**numbers, **axes})


def random_materials(case: Case) -> tuple[Paths, Batch]:
    """Random materials of a node whose normal and tangent inputs differ from the surface's."""
    spec, batch = case.lobe, case.backend.turned
    rng, count = generator(), len(batch.wo)
    own: Values = {each.name: NORMAL for each in spec.inputs if each.type == "vector3"}
    flags = [each.name for each in spec.inputs if each.type == "boolean"]
    rest = [each for each in spec.inputs if each.name not in {*flags, *batch.inputs, *own}]
    even = np.arange(count) % 2
    drawn: dict[str, ArrayLike] = {name: even for name in flags if name not in spec.mode}
    axes = {"normal": batch.inputs["normal"], "tangent": batch.inputs["tangent"]}
    if own:
        drawn |= {
            f"lobe_{name}/value": axes["normal" if name == "normal" else "tangent"] for name in own
        }
        drawn |= {name: np.roll(each, 1, axis=0) for name, each in axes.items()}
    batch = batch.altered(**draw(rng, count, rest), **drawn)
    return paths(case.host, spec.document(own), case.library, tuple(batch.inputs)), batch


def random(count: int, rng: np.random.Generator) -> Array:
    """Numbers in [0, 1) with 24 bits, like those of a shader's generator, (N, 3)."""
    return rng.integers(0, 1 << 24, (count, 3)).astype(np.float64) * 2.0**-24


def lattice(count: int) -> Array:
    """Numbers that evenly fill the unit cube, multiples of the powers of a root of x^4 = x + 1, (count, 3)."""
    steps = 1.2207440846057596 ** -np.arange(1.0, 4.0)
    return float32((0.5 + np.arange(count)[:, np.newaxis] * steps) % 1.0 * (1.0 - 2.0**-24))


def refracted(wo: Array, index: float = 1.5) -> Array:
    """Direction in which a smooth surface refracts; straight ahead beyond the critical angle."""
    x, y, _ = -wo / index
    return np.array([x, y, -np.sqrt(1.0 - x * x - y * y)]) if x * x + y * y < 1.0 else -wo


def steepness(density: Array) -> Array:
    """Factor that multiplies a direction's rounding: 1 + 1 / alpha, with alpha from the density.

    GGX facets reflect with a density of at most 1 / (4 pi alpha^2); its slope is about 1 / alpha.
    """
    return 1.0 + np.sqrt(4.0 * np.pi * density)


def scores(case: Case) -> Iterator[tuple[float, bool, Batch]]:
    """Deviations of samples from their density, in standard deviations, per material and view.

    Three views are enough for a surface shader, which has one solid and one thin wall, and for a
    control, which stops at the first failure. Quadrature errors at a low order only increase the
    deviation.
    """
    u = random(DRAWS, generator())
    looks = LOOKS[1:2] if case.control else LOOKS
    for text, batch in subjects(case, False, True):
        rough = {
            name: np.maximum(each, LEAST_COUNTED)
            for name, each in batch.inputs.items()
            if "roughness" in name
        }
        if "cuticle_angle" in batch.inputs:  # steep lobes have a pole along the fiber
            rough["cuticle_angle"] = np.clip(batch.inputs["cuticle_angle"], 0.45, 0.55)
        batch = batch.altered(**rough)
        few = case.control or is_shader(case.spec)
        for row in range(3 if few else MATERIALS_DRAWN):
            one = batch.where(np.arange(row, row + 1))
            assert one.frame is not None
            view, axes = one.wo[0], one.frame[0]
            # A thin wall has no inside.
            glassy = GLASSY(case.spec) and not {*WALLS} & {*batch.inputs}
            for inside in (False, True) if glassy else (row % 2 == 1,):
                ask = partial(text.values, wo=one.world(one.wo), inside=inside, inputs=one.inputs)

                def density(w: Array, ask: Callable[..., Array] = ask, axes: Array = axes) -> Array:
                    return case.outputs(Batch(w, w, {}), ask("pdf", wi=w @ axes.T))[:, 0]

                pole = refracted(view, 1.0 / 1.5 if inside else 1.5)
                mirror = view * [-1.0, -1.0, 1.0]
                for count, nodes, suspect in looks:
                    drawn = ask("wi", u=u[:count]) @ axes
                    straight = np.linalg.norm(drawn + view, axis=1, keepdims=True) < 1e-6
                    score = deviation(drawn * ~straight, density, pole, mirror, nodes)
                    if score <= suspect:
                        break
                yield score, inside, one
                if case.control and score > MOST_DEVIATIONS:
                    return


def pdf(case: Case) -> Measurement:
    score, inside, view = max(scores(case), key=lambda each: each[0])
    return Measurement(score, {"wo": view.wo[0].tolist(), "inside": [float(inside)]})


def parts(case: Case) -> Iterator[tuple[Cause, Compared]]:
    """Compare weight times density with value, density with material_pdf; find missed light.

    Errors of the first two are relative to the expected values.
    """
    for text, batch in subjects(case, False, True):
        u, wo = random(len(batch.wo), generator()), batch.world(batch.wo)
        for inside in (False, True):
            ask, wrong = partial(text.values, inside=inside), (PLACES[inside],)
            value, stated = (
                ask(what, wo, batch.world(batch.wi), inputs=batch.inputs)
                for what in ("evaluate", "pdf")
            )
            missed = value * ((stated <= LEAST_DRAWN * value) & (value > LEAST_LIGHT))
            yield (
                Cause(Kind.DEFECT, "undrawn_light", wrong),
                Compared(batch, missed, np.zeros_like(missed)),
            )
            wi, weight, density = (
                ask(what, wo, u=u, inputs=batch.inputs) for what in ("wi", "weight", "density")
            )
            kept = density[:, 0] > 0.0
            if not kept.any():
                continue
            rows = replace(batch.where(kept), wi=wi[kept])
            value, stated = (
                ask(what, wo[kept], rows.wi, inputs=rows.inputs) for what in ("evaluate", "pdf")
            )
            stated = stated[:, :1]
            size = value.max(axis=1, keepdims=True)
            size[size <= 0.0] = 1.0
            normal = rows.inputs.get("lobe_normal/value", rows.inputs["normal"])
            cosine = np.abs(np.sum(rows.wi * normal, axis=1, keepdims=True))
            returned = np.maximum(weight[kept], value / np.maximum(stated, 1e-30))
            few = LEAST_ALBEDO / np.maximum(returned.max(axis=1, keepdims=True), LEAST_LIGHT)
            steep = steepness(stated) + 1.0 / np.maximum(cosine, GRAZING) + few
            found = case.outputs(rows, (weight * density)[kept]) / size
            right, one = value / size, np.ones_like(stated)
            ratio = density[kept, :1] / np.maximum(stated, 1e-30)
            weights = Compared(rows, right + (found - right) / steep, right)
            yield Cause(Kind.DEFECT, "drawn_weight", wrong), weights
            densities = Compared(rows, one + (ratio - one) / steep, one)
            yield Cause(Kind.DEFECT, "sampled_density", wrong), densities


SAMPLE = sum_of(
    roundings(
        16,
        "of a weight and a density, times 1 + the inverses of the lobe's own alpha, its cosine and 1000 weights",
    ),
    quantity=Quantity.DRAWN,
)


def path_value(case: Case) -> Iterator[Compared]:
    for text, batch in subjects(case):
        glassy = GLASSY(case.spec)
        sign = np.where(np.arange(len(batch.wo)) % 4 == 0, -1.0, 1.0)
        wi = batch.wi if glassy else batch.wi * np.stack([0.0 * sign + 1.0] * 2 + [sign], axis=1)
        wi[:8] = batch.wo[:8]
        batch = replace(batch, wi=wi)
        normal = np.broadcast_to(NORMAL, wi.shape)
        shader = is_shader(case.spec)
        if shader and batch.frame is not None:
            # The graph turns tangents about the normal, which may face away: it is +z or -z of
            # the frame.
            normal = np.einsum("nij,ni->nj", batch.frame, batch.inputs["normal"]).round()
        local = replace(batch.altered(normal=normal, tangent=TANGENT), frame=None)
        # A rasterizer does not light surfaces from behind, and cannot view lobes with an index of
        # refraction from inside.
        inside = np.arange(len(wi)) % 2 * (not UNLIKE_INSIDE(case.spec))
        wo, own = batch.world(batch.wo), batch.world(wi)
        ask = partial(text.values, wo=wo, wi=own, inside=inside, inputs=batch.inputs)
        thin = shader and case.spec.node != "UsdPreviewSurface"
        share = OPACITY if thin else 1.0
        opacity = 1.0 - 3.0 * MEAN_WEIGHT * (1.0 - share)
        steep = steepness(ask("pdf")[:, :1])
        found = case.outputs(batch, ask("evaluate"))
        value = case.evaluating.evaluate(local, "direct")
        yield Compared(batch, np.pi * found / steep, opacity * np.pi * value / steep)
        yield Compared(batch, ask("opacity"), np.full((len(wi), 1), opacity))
        emitted = np.zeros((len(wi), 3))
        if shader:
            emitted = case.evaluating.evaluate(local, "emission", "radiance")
        yield Compared(batch, ask("emission"), share * emitted)


def path_emission(case: Case) -> Iterator[Compared]:
    """Radiance toward views from both sides, in frames that permute the axes, which is exact."""
    spec = case.of(emission.EmissionSpec)
    thirds = np.stack([np.roll(np.eye(3), turn, axis=0) for turn in range(3)])
    for batch in (*case.batches, case.backend.take(spec.backs)):
        if "normal" in batch.inputs:  # another node sets a cone's axis
            continue
        frame = thirds[np.arange(len(batch.wo)) % 3]
        axes = {"normal": frame[:, :, 2], "tangent": frame[:, :, 0]}
        placed = replace(batch, frame=frame)
        text = paths(case.host, spec.document(), case.library, tuple(batch.inputs))
        found = text.values("emission", placed.world(batch.wo), inputs={**batch.inputs, **axes})
        yield spec.rescaled(Compared(batch, case.outputs(batch, found), case.expected(batch)))


def pcg4d(v: NDArray[np.uint32]) -> NDArray[np.uint32]:
    x, y, z, w = v
    x = x + y * w
    y = y + z * x
    z = z + x * y
    return np.stack([x, y, z, w + y * z])


def path_random(case: Case) -> Iterator[Compared]:
    """Random numbers compared with pcg4d [Jarzynski2020], bit for bit."""
    counters = np.arange(3 * 256).reshape(-1, 3) ** 2
    [(text, _)] = subjects(case)
    four = np.pad(counters, [(0, 0), (0, 1)], constant_values=7).T.astype(np.uint32)
    once = pcg4d(four * np.uint32(1664525) + np.uint32(1013904223))
    expected = (pcg4d(once ^ (once >> np.uint32(16)))[:3] >> np.uint32(8)).T / 2.0**24
    found = text.values("random", NORMAL, u=counters.astype(np.float64))
    views = Batch(np.broadcast_to(NORMAL, found.shape), np.broadcast_to(NORMAL, found.shape), {})
    yield Compared(views, case.outputs(views, found), expected)


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
    steep = steepness(text.values("pdf", wo, wi, inputs=outer)[:, :1])
    for what in ("evaluate", "pdf"):
        found = text.values(what, wo, wi, inside=True, inputs=inner)
        expected = text.values(what, wo, wi, inputs=outer)
        scale = steep * np.maximum(1.0, expected.max(axis=1, keepdims=True))
        yield Compared(batch, case.outputs(batch, found) / scale, expected / scale)


def clear_draws(case: Case, inside: bool) -> Iterator[tuple[Batch, Array, Array]]:
    """Sampled directions and weights at the surface of a clear solid, for each view."""
    values, tint, _ = SOLIDS[case.spec.node]
    [(text, _)] = subjects(case)
    inputs = {**values, "lobe_normal/value": NORMAL, "lobe_tangent/value": TANGENT}
    for view in VIEWS:
        wi, weight = (
            text.values(what, view, u=lattice(SUMMED), inside=inside, inputs=inputs)
            for what in ("wi", "weight")
        )
        one = Batch(view[np.newaxis], view[np.newaxis], {})
        yield one, wi, weight / np.asarray(tint.get("tint", 1.0))


def path_energy(case: Case) -> Iterator[Compared]:
    for inside in (False, True):
        for batch, _, weight in clear_draws(case, inside):
            total = weight.mean(axis=0, keepdims=True)
            yield Compared(batch, case.outputs(batch, total), np.ones((1, 3)))


def path_leaving(case: Case) -> Iterator[Compared]:
    spec = case.of(TransmissionSpec)
    values, _, curve = SOLIDS[spec.node]
    alpha = float(np.ravel(values["roughness"])[0])
    passed = spec.reversed(VIEWS[:, 2], alpha, INDEX, curve)
    for (batch, wi, weight), expected in zip(clear_draws(case, True), passed, strict=True):
        left = (weight * (wi[:, 2:] < 0.0)).mean(axis=0, keepdims=True)
        yield Compared(batch, case.outputs(batch, left), np.full((1, 3), expected))


def path_albedo(case: Case) -> Iterator[Compared]:
    [(text, batch)] = subjects(case)
    for view in VIEWS:
        one = Batch(view[np.newaxis], view[np.newaxis], batch.inputs)
        one = one.altered(normal=NORMAL, tangent=TANGENT)
        drawn = text.values("weight", view, u=lattice(SUMMED)).mean(axis=0, keepdims=True)
        seen = case.evaluating.albedo(one) + case.evaluating.transmitted(one)
        opacity = text.values("opacity", view)
        yield Compared(one, case.outputs(one, drawn), 1.0 - opacity + opacity * seen)


# --- directions against a density: a chi-square test on the sphere -------------------------------

# Cells divide the angle from a pole, and the azimuth around it. The first ring is narrow, for lobes
# that are nearly a single direction: choose that direction as the pole. A density that is wrong
# everywhere by a fraction e adds N e^2 to chi-square, whose standard deviation is the root of twice
# the number of cells: with 2^15 samples in these cells, six standard deviations correspond to e =
# 6.5 %, and with half of the samples three do.
CELLS = 16  # divisions of the angle and of the azimuth
ORDERS = 4, 8, 16, 32, 64, 128  # quadrature nodes per axis of a patch
# Each look has samples, quadrature orders and a limit; looks end once a score is within the limit.
LOOKS = (
    (DRAWS // 2, ORDERS[:1], 2.0),
    (DRAWS // 2, ORDERS[:4], 2.0),
    (DRAWS, ORDERS[:4], 3.0),
    (DRAWS, ORDERS, 0.0),
)
CLOSE = 2.0  # two orders of a patch must agree within this number of expected samples
MOST_DEVIATIONS = 6.0  # standard deviations, the tolerance of the check
CONE = 0.02  # radian, width of the first ring
LEAST = 1e-7  # radian, distance below which a density is constant
INNER = 9  # rings of patches in the first ring of cells, with a constant ratio of widths
RARE = 10.0  # minimum expected samples; smaller cells are merged


def deviation(
    draws: Array,
    density: Callable[[Array], Array],
    pole: Array,
    other: Array,
    nodes: Sequence[int] = ORDERS,
) -> float:
    """Standard deviations between counted samples and a density; 0 if less than the expected noise.

    Infinite if the density is not a number.

    The cube root of chi-square over its degrees of freedom is nearly normal [WilsonHilferty1931].

    - `draws`: Unit vectors, (N, 3); zeros for lost samples, whose share is 1 minus the integral.
    - `density`: Density of unit vectors (M, 3), in 1/sr, (M,).
    - `pole`, `other`: Directions around which a smooth lobe may be sampled. If they are apart, the
      cone around `other` is one cell.
    - `nodes`: See `density_integrals`.
    """
    count = (CELLS + 1) * CELLS
    apart = pole @ other < np.cos(2.0 * CONE)
    poles = [pole, other] if apart else [pole]
    integrals = density_integrals(density, poles, CLOSE / len(draws), nodes)
    rings = np.maximum(np.arange(INNER + CELLS) - INNER + 1, 0)
    cells = (rings[:, np.newaxis] * CELLS + np.arange(CELLS)).ravel()
    cells = np.append(cells, np.full(len(integrals) - len(cells), count))
    shares = np.bincount(cells, integrals, minlength=count + 1)
    kept = np.linalg.norm(draws, axis=1) > 0.5
    found = cell(draws[kept], pole)
    found[(draws[kept] @ other >= np.cos(CONE)) & apart] = count
    counts = np.bincount(found, minlength=len(shares))
    mean = len(draws) * np.append(shares, 1.0 - shares.sum())
    observed = np.append(counts, len(draws) - kept.sum())
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
    """Integrals of a density over all patches around a pole, and over the patches of a cone around
    a second pole.

    For each patch, the number of nodes per axis increases along `nodes` until two results agree up
    to `close`, in the patch and next to it: an edge of a density may pass between few nodes.
    """
    frames = np.stack(list(map(axes, poles)))
    whole = (INNER + CELLS) * CELLS
    rings = INNER + CELLS + INNER * (len(poles) - 1)
    integrals, waiting = np.zeros(rings * CELLS), np.arange(rings * CELLS)
    for count in nodes:
        local, area = patches(count)
        which, about = waiting % whole, waiting // whole
        w = local[which] @ frames[about]
        area = area[which]
        for other in poles[1:]:
            area = area * ((about > 0)[:, np.newaxis] | (w @ other < np.cos(CONE)))
        found = (density(w.reshape(-1, 3)).reshape(area.shape) * area).sum(axis=1)
        unsure = np.zeros((rings, CELLS), bool)
        unsure.flat[waiting] = np.abs(found - integrals[waiting]) > close
        integrals[waiting] = found
        for axis in (0, 1):
            unsure |= np.roll(unsure, 1, axis) | np.roll(unsure, -1, axis)
        if not len(waiting := np.flatnonzero(unsure)):
            break
    return integrals


@lru_cache(maxsize=len(ORDERS))
def patches(nodes: int) -> tuple[Array, Array]:
    """Directions around the z-axis (P, M, 3) and solid angles (P, M) of the Gauss-Legendre nodes of each patch."""
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
    hosts=lambda spec, host: host_row(host).way == "pairs" and host_row(host).target in TARGETS,
)


# fmt: off
ROWS = (
    PATHS(key="pdf",
          claim="A path tracer draws by the density that it states, which integrates to the share of draws it keeps.",
          applies=DRAWN, measure=pdf,
          tolerance=single(
              MOST_DEVIATIONS, Quantity.DEVIATIONS,
              "chance reaches 6 once in 10^7 draws of a chi-square"),
          control=controls.with_values(
              "a tenth of the density is that of a lobe, even in all directions, that is never drawn",
              lambda batch, values: 0.9 * values + 0.1 / (4.0 * np.pi)),
          explain=lambda case: diagnosis.defect(
              "drawn_density",
              *dict.fromkeys(
                  PLACES[inside] for score, inside, _ in scores(case) if score > MOST_DEVIATIONS))),
    PATHS(key="sample",
          claim="A draw's weight times its density is the value in its direction, and its density that of material_pdf.",
          applies=DRAWN, measure=lambda case: (each for _, each in parts(case)), tolerance=SAMPLE,
          control=controls.scale("weights are 0.01 % too large", 1.0001),
          explain=lambda case: diagnosis.causes_of(parts(case), SAMPLE)),
    PATHS(key="path_value",
          claim="A path tracer's value, opacity and emission are the rasterizer's, in any frame.",
          applies=DRAWN - DARK, measure=path_value,
          tolerance=sum_of(roundings(
              64, "of two directions and their frame, times 1 + the inverse of the lobe's own alpha")),
          control=controls.scale("values are 0.1 % too large", 1.001),
          explain=diagnosis.defect("other_path_value"),
          methods=lambda spec, methods: not methods.distributed),  # distributed layers change sums above 1
    PATHS(key="path_emission",
          claim="A path tracer's emission is the node's equation, from both sides of surfaces along each axis.",
          applies=check.family(emission.EmissionSpec), measure=path_emission, tolerance="value",
          control=controls.scale("values are 0.1 % too large", 1.001),
          explain=diagnosis.defect("other_path_emission"), requires=NO_ABILITY),
    PATHS(key="path_random",
          claim="The random numbers of a tracer's text are those of pcg4d.",
          applies=check.family(LobeSpec, lambda spec: spec.node == "eon_diffuse_bsdf"), measure=path_random,
          tolerance=single(0.0, Quantity.VALUE, "the same bits"),
          control=controls.scale("numbers are half as large", 0.5),
          explain=diagnosis.defect("other_random_numbers")),
    PATHS(key="path_inside",
          claim="Light inside a solid is reflected and refracted as outside of one of the inverse index.",
          applies=GLASSY & check.Specs(lambda spec: spec.node in GLASS), measure=path_inside,
          tolerance=sum_of(roundings(
              256, "of an index that OpenPBR takes from its reflectance, near a critical angle")),
          control=controls.scale("values are 0.1 % too large", 1.001),
          explain=diagnosis.defect("inside_is_not_outside")),
    PATHS(key="path_albedo",
          claim="Draws from outside carry the light that a rasterizer reflects and transmits.",
          applies=SURFACES, measure=path_albedo,
          tolerance=ALBEDO.plus(DRAWN_SUM),
          control=controls.scale("values are 10 % too large", 1.1),
          explain=diagnosis.defect("other_path_albedo"),
          methods=lambda spec, methods: (
              with_directions(spec, methods) and methods.transmission == "refraction")),
    PATHS(key="path_energy",
          claim="Draws at a clear solid carry all light, from outside and from inside.",
          applies=CLEAR, measure=path_energy, tolerance=PASSING.plus(DRAWN_SUM),
          control=controls.scale("values are 10 % too large", 1.1),
          explain=diagnosis.defect("light_from_inside")),
    PATHS(key="path_leaving",
          claim="From inside a clear solid, draws that leave it carry what enters by the same paths.",
          applies=CLEAR, measure=path_leaving, tolerance=THROUGHPUT.plus(DRAWN_SUM),
          control=controls.scale("values are 10 % too large", 1.1),
          explain=diagnosis.defect("light_from_inside")),
)
# fmt: on
