# SPDX-License-Identifier: Apache-2.0
"""Checks of the text for path tracers: what it draws has the density that it states, and the weight of its value.

What smooth transmission draws is nearly one direction, about which draws are counted.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.conformance.cache import Recent, contents
from mxeon.conformance.case import Case
from mxeon.conformance.check import check, scale, with_values
from mxeon.conformance.diagnosis import Diagnosis
from mxeon.conformance.samples import Array, Batch, generator
from mxeon.conformance.spec import LobeSpec, Spec, materials
from mxeon.conformance.specs.diffuse import SurfaceLobe
from mxeon.conformance.specs.surface_shaders import SurfaceShaderSpec
from mxeon.conformance.tolerance import Compared, Measurement, Term, given, sum_of
from mxeon.hosts import host_row
from mxeon.hosts.base import Host

CALL = """
vec3 path_tracer(float what, vec3 wo, vec3 wi, vec3 u, float inside)
{{
    Point p;
    p.position = vec3(0.0);
    p.normal = vec3(0.0, 0.0, 1.0);
    p.tangent = vec3(1.0, 0.0, 0.0);
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
ASKED = ("evaluate", "pdf", "wi", "weight", "density", "opacity", "emission")
TARGETS = ("glsl", "essl", "vulkan", "slang")  # of mxeon.shaders.path_tracing
DRAWS, WEIGHED = 1 << 15, 1 << 12
ANSWERS = Recent[Array](4)  # to what a check and its control ask
VIEW = np.array([0.7642691, 0.2364137, 0.6])


@dataclass(frozen=True)
class Paths:
    """The text for path tracers of a document's one material, on a host."""

    host: Host
    text: str

    def ask(
        self,
        what: str,
        wo: ArrayLike,
        wi: ArrayLike = (0.0, 0.0, 1.0),
        u: ArrayLike = (0.0, 0.0, 0.0),
        inside: bool = False,
    ) -> Array:
        """Answers (N, 3) of a function, one of ASKED; 0 where nothing is drawn."""
        number = ASKED.index(what)
        rows = [np.atleast_2d(each) for each in (float(number), wo, wi, u, float(inside))]
        text = self.text + CALL.format(answer=SCATTERED if number < 5 else PASSED)
        return ANSWERS.value(
            (self, *map(contents, rows)),
            lambda: self.host.execute(text, "path_tracer", *rows).astype(np.float64),
        )


@lru_cache(maxsize=2)
def paths(host: Host, document: str, library: str = "eonlib") -> Paths:
    from mxeon.shaders.generation import generate

    [shader] = generate(document, host.target, profile="path", library=library)
    return Paths(host, shader.stages["pixel"])


def paths_of(case: Case) -> Paths:
    """The material that has another value than the default in each input but switches; all lobes of a surface shader."""
    spec = case.spec
    if isinstance(spec, SurfaceShaderSpec):
        values, _ = materials(*spec.judged, *spec.others)
    else:
        changes = {each.name: each.change for each in spec.inputs if each.type != "boolean"}
        values = {name: value for name, value in changes.items() if value is not None}
    return paths(case.host, spec.document(values), case.library)


def random(count: int, rng: np.random.Generator) -> Array:
    """Numbers in [0, 1) with the 24 bits that a shader's generator gives, (N, 3)."""
    return rng.integers(0, 1 << 24, (count, 3)).astype(np.float64) * 2.0**-24


def refracted(wo: Array, index: float = 1.5) -> Array:
    """Where the smooth transmission of UsdPreviewSurface goes."""
    x, y, _ = -wo / index
    return np.array([x, y, -np.sqrt(1.0 - x * x - y * y)])


def is_drawn(spec: Spec) -> bool:
    return isinstance(spec, LobeSpec) and not isinstance(spec, SurfaceLobe)


def has_paths(spec: Spec, host: str) -> bool:
    return host_row(host).target in TARGETS


@check(
    is_drawn,
    with_values(
        "a tenth of the density is that of a lobe, even in all directions, that is never drawn",
        lambda batch, values: 0.9 * values + 0.1 / (4.0 * np.pi),
    ),
    tolerance=given(
        6.0, "standard deviations", "chance reaches 6 once in 10^7 draws of a chi-square"
    ),
    pairs=True,
    profile="path",
    hosts=has_paths,
    diagnose=lambda case: Diagnosis("what is drawn has another density than the one stated"),
)
def pdf(case: Case) -> Measurement:
    """What a path tracer draws has the density that it is told, which integrates to the share of draws kept."""
    text, draws = paths_of(case), random(DRAWS, generator())

    def density(w: Array) -> Array:
        batch = Batch(np.broadcast_to(VIEW, w.shape), w, {})
        return case.measured(lambda each: text.ask("pdf", VIEW, each.wi), batch)[:, 0]

    return Measurement(deviation(text.ask("wi", VIEW, u=draws), density, refracted(VIEW)), {})


@check(
    is_drawn,
    scale("weights are 1 % too large", 1.01),
    tolerance=sum_of(
        Term(2e-3, "a direction's rounding of 6e-8, times the slope of a lobe of alpha 1e-4"),
        unit="of the value",
    ),
    pairs=True,
    profile="path",
    hosts=has_paths,
    diagnose=lambda case: Diagnosis("the weight of a draw is not its value over its density"),
)
def sample(case: Case) -> Compared:
    """A draw's weight times its density is the value in its direction."""
    text, u = paths_of(case), random(WEIGHED, generator())
    wi, weight, density = (text.ask(what, VIEW, u=u) for what in ("wi", "weight", "density"))
    kept = density[:, 0] > 0.0
    batch = Batch(np.broadcast_to(VIEW, wi.shape), wi, {}).where(kept)
    expected = text.ask("evaluate", VIEW, batch.wi)
    size = expected.max(axis=1, keepdims=True)
    return Compared(batch, case.outputs(batch, (weight * density)[kept]) / size, expected / size)


# --- directions against a density: a chi-square test on the sphere -------------------------------

# Cells divide the angle from a pole, and the azimuth about it. The first ring is narrow, for a lobe that is
# nearly a single direction: let the pole be that direction.
CELLS = 32  # of the angle, and of the azimuth
NODES = 8  # of the quadrature of a cell, on each axis
CONE = 0.02  # radian, the first ring
LEAST = 1e-7  # radian, below which a density is constant
RARE = 10.0  # expected draws, below which cells are put together


def deviation(
    draws: Array, density: Callable[[Array], Array], pole: Array, nodes: int = NODES
) -> float:
    """Standard deviations by which the counts of draws leave a density, 0 for any less than chance brings.

    Infinite for a density that is no number.

    The cube root of chi-square over its degrees of freedom is nearly normal [WilsonHilferty1931].

    - `draws`: Unit vectors, (N, 3); zeros for draws that are lost, whose share is 1 minus the integral.
    - `density`: Of unit vectors (M, 3), in 1/sr, (M,).
    """
    w, area, cells = quadrature(tuple(pole), nodes)
    shares = np.bincount(cells, density(w) * area, minlength=(CELLS + 1) * CELLS)
    kept = np.linalg.norm(draws, axis=1) > 0.5
    counts = np.bincount(cell(draws[kept], pole), minlength=len(shares))
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


@lru_cache(maxsize=1)
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
