# SPDX-License-Identifier: Apache-2.0
"""Checks of the text for path tracers: draws have the density that it states, and the weight of their value.

Views are from both sides of the surface. What smooth transmission draws is nearly one direction, about which draws are
counted; and so is what it reflects.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.conformance import controls
from mxeon.conformance.cache import Recent, contents
from mxeon.conformance.case import Case
from mxeon.conformance.check import Check, Specs, always, family
from mxeon.conformance.checks.lobes import BELOW, CLEAR, DARK, TRANSMITTING
from mxeon.conformance.checks.surface_shaders import MATERIALS
from mxeon.conformance.diagnosis import defect
from mxeon.conformance.results import Cause, Diagnosis, Kind
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.samples import Array, Batch, Values, float32, generator
from mxeon.conformance.spec import Ability, LobeSpec, Spec, materials
from mxeon.conformance.specs.microfacets import LEAST_TANGENT_COSINE, PASSING, TransmissionSpec
from mxeon.conformance.specs.surface_shaders import SurfaceShaderSpec
from mxeon.conformance.tolerance import Compared, Measurement, Term, given, roundings, sum_of
from mxeon.hosts import host_row
from mxeon.hosts.base import Host

CALL = """
vec3 path_tracer(float what, vec3 wo, vec3 wi, vec3 u, float inside, vec3 normal, vec3 tangent)
{{
    Point p;
    p.position = vec3(0.0);
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
# Apart, since a driver copies the material to each call.
PASSED = "return what < 5.5 ? vec3(material_shadow(p, wo)) : material_emitted(p, wo);"
FUNCTIONS = ("evaluate", "pdf", "wi", "weight", "density", "opacity", "emission")
TARGETS = ("glsl", "essl", "vulkan", "slang")  # of mxeon.shaders.path_tracing
DRAWS, WEIGHED, PAIRS = 1 << 15, 1 << 12, 1 << 12
ANSWERS = Recent[Array](64)  # to what a check and its control ask
# Two views whose facets below the critical angle are many and few, and one from which a smooth solid lets no light out.
VIEWS = np.array([[0.7642691, 0.2364137, 0.6], [-0.19, 0.25, 0.9495], [0.3, -0.9367497, 0.18]])
VIEWS /= np.linalg.norm(VIEWS, axis=1, keepdims=True)
UPRIGHT = np.eye(3)
TURNED = np.array(
    [[0.6, 0.64, -0.48], [-0.8, 0.48, -0.36], [0.0, 0.6, 0.8]]
)  # tangent, bitangent, normal
# Of the all-lobes materials: alpha below 1, and an emission.
MEAN_WEIGHT = 0.3333  # of a channel in the mean by which MaterialX turns a transparency into alpha
OPACITY, EMISSION = 0.6, 0.3
THIN: dict[str, float | str] = {
    **dict.fromkeys(("opacity", "geometry_opacity", "alpha"), OPACITY),
    **dict.fromkeys(("emission", "emission_luminance", "emissive", "emissiveColor"), EMISSION),
    "alpha_mode": "2",
}

# Glass, and the name of its index of refraction. UsdPreviewSurface reflects by Schlick's curve, which has no index of
# a denser side.
GLASS: dict[str, tuple[str, Values]] = {
    "dielectric_bsdf": ("ior", {"tint": (0.9, 0.8, 0.7), "roughness": (0.4, 0.4)}),
    "standard_surface": ("specular_IOR", {"transmission": 1.0, "specular_roughness": 0.5}),
    "open_pbr_surface": ("specular_ior", {"transmission_weight": 1.0, "specular_roughness": 0.5}),
}
INDEX = 2.0  # whose inverse is exact
DRAWN = family(LobeSpec) - BELOW
GLASSY = TRANSMITTING | MATERIALS  # which let light into a solid, and out of it
# Glass of that index, a tint, and its curve from outside.
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
GRID = 16  # draws along each of three random numbers


@dataclass(frozen=True)
class Paths:
    """The text for path tracers of a document's one material, on a host."""

    host: Host
    text: str

    def values(
        self,
        what: str,
        wo: ArrayLike,
        wi: ArrayLike = (0.0, 0.0, 1.0),
        u: ArrayLike = (0.0, 0.0, 0.0),
        inside: bool = False,
        frame: Array = UPRIGHT,
    ) -> Array:
        """Answers (N, 3) of a function, one of FUNCTIONS; 0 where nothing is drawn.

        - `frame`: Tangent, bitangent and normal of the surface; directions are those of the world.
        """
        number = FUNCTIONS.index(what)
        values = (float(number), wo, wi, u, float(inside), frame[2], frame[0])
        rows = [np.atleast_2d(each) for each in values]
        text = self.text + CALL.format(answer=SCATTERED if number < 5 else PASSED)
        return ANSWERS.value(
            (self, *map(contents, rows)),
            lambda: self.host.execute(text, "path_tracer", *rows).astype(np.float64),
        )


@lru_cache(maxsize=4)
def paths(host: Host, document: str, library: str = "eonlib") -> Paths:
    from mxeon.shaders.generation import generate

    [shader] = generate(document, host.target, profile="path", library=library)
    return Paths(host, shader.stages["pixel"])


def documents(spec: LobeSpec) -> tuple[str, ...]:
    """Materials that have another value than the default in each input; all lobes of a surface shader.

    Of a node there are two: one with a normal and a tangent of its own, one with switches.
    """
    if isinstance(spec, SurfaceShaderSpec):
        values, _ = materials(*spec.judged, *spec.others)
        thin: dict[str, ArrayLike] = {
            name: (value,) * 3 if spec.types[name] == "color3" else value
            for name, value in THIN.items()
            if name in spec.types and name not in values
        }
        return (spec.document({**values, **thin}),)
    changed = [(each, each.change) for each in spec.inputs if each.change is not None]
    own = {each.name: change for each, change in changed if each.type != "boolean"}
    switched = {
        each.name: change
        for each, change in changed
        if each.type != "vector3" and each.name not in spec.mode
    }
    return spec.document(own), spec.document(switched)


def texts_of(case: Case) -> Iterator[Paths]:
    return (paths(case.host, each, case.library) for each in documents(case.lobe))


def sides(spec: Spec) -> tuple[bool, ...]:
    """Whether a view is inside a solid: of what transmits there are both."""
    return (False, True) if GLASSY(spec) else (False,)


def random(count: int, rng: np.random.Generator) -> Array:
    """Numbers in [0, 1) with the 24 bits that a shader's generator gives, (N, 3)."""
    return rng.integers(0, 1 << 24, (count, 3)).astype(np.float64) * 2.0**-24


def refracted(wo: Array, index: float = 1.5) -> Array:
    """Where the smooth transmission of UsdPreviewSurface goes; straight on beyond the critical angle."""
    x, y, _ = -wo / index
    return np.array([x, y, -np.sqrt(1.0 - x * x - y * y)]) if x * x + y * y < 1.0 else -wo


def has_paths(spec: Spec, host: str) -> bool:
    return host_row(host).target in TARGETS


def steepness(density: Array) -> Array:
    """What a rounding of a direction is multiplied by: 1 and the inverse of alpha of a lobe of that density.

    GGX facets reflect into 1 / (4 pi alpha^2) at most, whose slope is about the inverse of alpha.
    """
    return 1.0 + np.sqrt(4.0 * np.pi * density)


def place(inside: bool) -> str:
    return "inside" if inside else "outside"


def scores(case: Case) -> Iterator[tuple[float, bool, Array]]:
    """Standard deviations by which draws leave their density, at each view; at one for a control.

    A coarse quadrature takes an eighth of the time: what it finds few is few.
    """
    u = random(DRAWS, generator())
    for text in texts_of(case):
        for inside in sides(case.spec):
            for view in VIEWS[:1] if case.control else VIEWS:

                def density(w: Array, text: Paths = text, inside: bool = inside) -> Array:
                    batch = Batch(np.broadcast_to(view, w.shape), w, {})  # noqa: B023
                    return case.measured(
                        lambda each: text.values("pdf", each.wo[:1], each.wi, inside=inside), batch
                    )[:, 0]

                drawn = text.values("wi", view, u=u, inside=inside)
                straight = np.linalg.norm(drawn + view, axis=1, keepdims=True) < 1e-6
                pole = refracted(view, 1.0 / 1.5 if inside else 1.5)
                mirror = view * [-1.0, -1.0, 1.0]
                score = deviation(drawn * ~straight, density, pole, mirror, COARSE)
                if score > SUSPECT and not case.control:
                    score = deviation(drawn * ~straight, density, pole, mirror)
                yield score, inside, view


def pdf(case: Case) -> Measurement:
    score, inside, view = max(scores(case), key=lambda each: each[0])
    return Measurement(score, {"wo": view.tolist(), "inside": [float(inside)]})


def halves(case: Case) -> Iterator[tuple[bool, Compared, Compared]]:
    """Weights times densities against values, and densities against those of material_pdf, over what each is."""
    u = random(WEIGHED, generator())
    for text in texts_of(case):
        for inside in sides(case.spec):
            for view in VIEWS:
                wi, weight, density = (
                    text.values(what, view, u=u, inside=inside)
                    for what in ("wi", "weight", "density")
                )
                kept = density[:, 0] > 0.0
                if not kept.any():
                    continue
                batch = Batch(np.broadcast_to(view, wi.shape), wi, {}).where(kept)
                value = text.values("evaluate", view, batch.wi, inside=inside)
                stated = text.values("pdf", view, batch.wi, inside=inside)[:, :1]
                size = value.max(axis=1, keepdims=True)
                size[size <= 0.0] = 1.0
                steep = steepness(stated)
                found = case.outputs(batch, (weight * density)[kept]) / size
                right, one = value / size, np.ones_like(stated)
                ratio = density[kept, :1] / np.maximum(stated, 1e-30)
                yield (
                    inside,
                    Compared(batch, right + (found - right) / steep, right),
                    Compared(batch, one + (ratio - one) / steep, one),
                )


SAMPLE = sum_of(
    roundings(16, "of a weight and a density, times 1 + the inverse of the lobe's own alpha"),
    quantity=Quantity.DRAWN,
)


def _wrong_half(case: Case) -> Diagnosis:
    """Which of the two is wrong, and from where."""
    causes: dict[Cause, None] = {}
    for inside, weights, densities in halves(case):
        for key, compared in (("drawn_weight", weights), ("sampled_density", densities)):
            if SAMPLE.wrong(compared).any():
                causes[Cause(Kind.DEFECT, key, (place(inside),))] = None
    return Diagnosis(tuple(causes))


def sample(case: Case) -> Iterator[Compared]:
    for _, weights, densities in halves(case):
        yield weights
        yield densities


def random_directions(rng: np.random.Generator, count: int) -> Array:
    w = rng.normal(size=(count, 3))
    return float32(w / np.linalg.norm(w, axis=1, keepdims=True))


def path_value(case: Case) -> Iterator[Compared]:
    document, rng = documents(case.lobe)[-1], generator()
    text, [shader] = (
        paths(case.host, document, case.library),
        case.host.compile(document, library=case.library),
    )
    wo, wi = random_directions(rng, PAIRS), random_directions(rng, PAIRS)
    high = np.minimum(abs(wo[:, 2]), abs(wi[:, 2])) > LEAST_TANGENT_COSINE
    wo, wi = wo[high], wi[high]
    wi[:8] = wo[:8]
    if GLASSY(case.spec):  # light from behind is not the rasterizer's
        wi[:, 2] = np.copysign(wi[:, 2], wo[:, 2])
    world = {"wo": wo @ TURNED, "wi": wi @ TURNED, "frame": TURNED}
    thin = isinstance(case.spec, SurfaceShaderSpec) and case.spec.node != "UsdPreviewSurface"
    share = OPACITY if thin else 1.0
    opacity = 1.0 - 3.0 * MEAN_WEIGHT * (1.0 - share)
    batch, steep = Batch(wo, wi, {}), steepness(text.values("pdf", **world)[:, :1])
    value = case.host.evaluate(shader, wo, wi, {}, "direct")
    found = case.outputs(batch, text.values("evaluate", **world))
    yield Compared(batch, np.pi * found / steep, opacity * np.pi * value / steep)
    yield Compared(batch, text.values("opacity", **world), np.full((len(wo), 1), opacity))
    emitted = np.zeros((len(wo), 3))
    if isinstance(case.spec, SurfaceShaderSpec):
        emitted = case.host.evaluate(shader, wo, wi, {}, "emission", output="radiance")
    yield Compared(batch, text.values("emission", **world), share * emitted)


def path_inside(case: Case) -> Iterator[Compared]:
    name, values = GLASS[case.spec.node]
    solid, inverse = (
        paths(case.host, case.spec.document({**values, name: index}), case.library)
        for index in (INDEX, 1.0 / INDEX)
    )
    u = random(PAIRS, generator())
    for view in VIEWS:
        wi = inverse.values("wi", view, u=u)
        batch = Batch(np.broadcast_to(view, wi.shape), wi, {}).where(np.any(wi != 0.0, axis=1))
        steep = steepness(inverse.values("pdf", view, batch.wi)[:, :1])
        for what in ("evaluate", "pdf"):
            found = solid.values(what, view, batch.wi, inside=True)
            expected = inverse.values(what, view, batch.wi)
            scale = steep * np.maximum(1.0, expected.max(axis=1, keepdims=True))
            yield Compared(batch, case.outputs(batch, found) / scale, expected / scale)


def path_energy(case: Case) -> Iterator[Compared]:
    spec = case.of(TransmissionSpec)
    values, tint, curve = SOLIDS[spec.node]
    text = paths(case.host, spec.document(values), case.library)
    middles = (np.arange(GRID) + 0.5) / GRID
    u = np.stack(np.meshgrid(middles, middles, middles), axis=-1).reshape(-1, 3)
    alpha = float(np.ravel(values["roughness"])[0])
    passed = spec.reversed(VIEWS[:, 2], alpha, INDEX, curve)
    for view, expected in zip(VIEWS, passed, strict=True):
        wi, weight = (text.values(what, view, u=u, inside=True) for what in ("wi", "weight"))
        batch = Batch(view[np.newaxis], view[np.newaxis], {})
        weight = weight / np.asarray(tint.get("tint", 1.0))
        left = (weight * (wi[:, 2:] < 0.0)).mean(axis=0, keepdims=True)
        total = weight.mean(axis=0, keepdims=True)
        yield Compared(batch, case.outputs(batch, left), np.full((1, 3), expected))
        yield Compared(batch, case.outputs(batch, total), np.ones((1, 3)))


# --- directions against a density: a chi-square test on the sphere -------------------------------

# Cells divide the angle from a pole, and the azimuth about it. The first ring is narrow, for a lobe that is
# nearly a single direction: let the pole be that direction. A density that is off by a share e everywhere
# adds N e^2 to chi-square, whose deviation is the root of twice the cells: of 2^15 draws in these, six
# deviations are an e of 6.5 %.
CELLS = 16  # of the angle, and of the azimuth
CELL_NODES = 16  # of the quadrature of a cell, on each axis
COARSE = 4  # nodes of a first look, whose own error only makes the deviation larger
SUSPECT = 3.0  # standard deviations, which chance reaches once in 700 times
CONE = 0.02  # radian, the first ring
LEAST = 1e-7  # radian, below which a density is constant
RARE = 10.0  # expected draws, below which cells are put together


def deviation(
    draws: Array,
    density: Callable[[Array], Array],
    pole: Array,
    other: Array | None = None,
    nodes: int = CELL_NODES,
) -> float:
    """Standard deviations by which the counts of draws leave a density, 0 for any less than chance brings.

    Infinite for a density that is no number.

    The cube root of chi-square over its degrees of freedom is nearly normal [WilsonHilferty1931].

    - `draws`: Unit vectors, (N, 3); zeros for draws that are lost, whose share is 1 minus the integral.
    - `density`: Of unit vectors (M, 3), in 1/sr, (M,).
    - `pole`, `other`: Directions about which nearly all draws of a smooth lobe may lie. A cone about
      the other is one cell, if it lies apart.
    """
    w, area, cells = quadrature(tuple(pole), nodes)
    count = (CELLS + 1) * CELLS
    if other is not None and pole @ other < np.cos(2.0 * CONE):
        rest = w @ other < np.cos(CONE)
        near, small, ring = quadrature(tuple(other), nodes)
        near, small = near[ring < CELLS], small[ring < CELLS]
        w, area = np.concatenate([w[rest], near]), np.append(area[rest], small)
        cells = np.append(cells[rest], np.full(len(near), count))
    shares = np.bincount(cells, density(w) * area, minlength=count + 1)
    kept = np.linalg.norm(draws, axis=1) > 0.5
    found = cell(draws[kept], pole)
    if other is not None:
        found[(draws[kept] @ other >= np.cos(CONE)) & (found >= CELLS)] = count
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
    """Two unit vectors across the pole, and the pole, (3, 3)."""
    across = np.cross(pole, np.eye(3)[np.argmin(np.abs(pole))])
    across /= np.linalg.norm(across)
    return np.stack([across, np.cross(pole, across), pole])


def cell(w: Array, pole: Array) -> NDArray[np.int64]:
    """Number of the cell of each direction."""
    x, y, z = axes(pole) @ w.T
    angle, azimuth = np.arctan2(np.hypot(x, y), z), np.arctan2(y, x) / (2.0 * np.pi) % 1.0
    ring = np.floor((angle - CONE) / (np.pi - CONE) * CELLS).clip(-1, CELLS - 1) + 1
    sector = np.minimum(np.floor(azimuth * CELLS), CELLS - 1)
    number: NDArray[np.int64] = (ring * CELLS + sector).astype(np.int64)
    return number


@lru_cache(maxsize=8)
def quadrature(pole: tuple[float, ...], nodes: int) -> tuple[Array, Array, NDArray[np.int64]]:
    """Directions, solid angles and cells of a midpoint rule; in the first ring its steps grow by a factor."""
    inner = np.append(0.0, np.geomspace(LEAST, CONE, 8 * nodes))
    edges = np.append(inner, np.linspace(CONE, np.pi, CELLS * nodes + 1)[1:])
    angle, height = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
    turn = 2.0 * np.pi / (CELLS * nodes)
    azimuth = turn * (np.arange(CELLS * nodes) + 0.5)
    ring = np.stack([np.cos(azimuth), np.sin(azimuth)])
    z = np.broadcast_to(np.cos(angle)[:, np.newaxis], (len(angle), len(azimuth)))
    local = np.stack([*(np.sin(angle)[:, np.newaxis] * each for each in ring), z], axis=-1)
    area = 2.0 * np.sin(angle) * np.sin(height) * turn
    w = local.reshape(-1, 3) @ axes(np.array(pole))
    return w, np.repeat(area, len(azimuth)), cell(w, np.array(pole))


# fmt: off
ROWS = (
    Check(key="pdf",
          claim="A path tracer draws by the density that it states, which integrates to the share of draws it keeps.",
          applies=DRAWN, measure=pdf,
          tolerance=given(
              6.0, Quantity.DEVIATIONS, "chance reaches 6 once in 10^7 draws of a chi-square"),
          control=controls.with_values(
              "a tenth of the density is that of a lobe, even in all directions, that is never drawn",
              lambda batch, values: 0.9 * values + 0.1 / (4.0 * np.pi)),
          explain=lambda case: defect(
              "drawn_density",
              *dict.fromkeys(place(inside) for score, inside, _ in scores(case) if score > 6.0)),
          requires=Ability.PAIRS, profile="path", hosts=has_paths),
    Check(key="sample",
          claim="A draw's weight times its density is the value in its direction, and its density that of material_pdf.",
          applies=DRAWN, measure=sample, tolerance=SAMPLE,
          control=controls.scale("weights are 0.01 % too large", 1.0001), explain=_wrong_half,
          requires=Ability.PAIRS, profile="path", hosts=has_paths),
    Check(key="path_value",
          claim="A path tracer's value, opacity and emission are the rasterizer's, in any frame.",
          applies=DRAWN - DARK, measure=path_value,
          tolerance=sum_of(roundings(
              64, "of two directions and their frame, times 1 + the inverse of the lobe's own alpha")),
          control=controls.scale("values are 0.1 % too large", 1.001),
          explain=always(defect("other_path_value")), requires=Ability.PAIRS, profile="path",
          hosts=has_paths,
          methods=lambda spec, methods: not methods.distributed),  # which changes sums above 1
    Check(key="path_inside",
          claim="Light inside a solid is reflected and refracted as outside of one of the inverse index.",
          applies=GLASSY & Specs(lambda spec: spec.node in GLASS), measure=path_inside,
          tolerance=sum_of(roundings(
              256, "of an index that OpenPBR takes from its reflectance, near a critical angle")),
          control=controls.scale("values are 0.1 % too large", 1.001),
          explain=always(defect("inside_is_not_outside")), requires=Ability.PAIRS, profile="path",
          hosts=has_paths),
    Check(key="path_energy",
          claim="From inside a clear solid, draws carry all light, and those that leave it what enters by the same paths.",
          applies=CLEAR, measure=path_energy,
          tolerance=PASSING.plus(Term(5e-3, "draws on a grid of 16 x 16 x 16")),
          control=controls.scale("values are 10 % too large", 1.1),
          explain=always(defect("light_from_inside")), requires=Ability.PAIRS, profile="path",
          hosts=has_paths),
)
# fmt: on
