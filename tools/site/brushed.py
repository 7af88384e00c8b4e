# SPDX-License-Identifier: Apache-2.0
"""Pictures and tables of docs/brushed_metal.md: `python -m tools.site.brushed`, some minutes.

The gallery's studio becomes a grid of distant lights, and their pictures are summed: stock and eonlib on the host
`gl`, Smith at the geometric mean and the exact lobe by the float64 models.
"""

import json
import sys
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image, ImageDraw, ImageFont
from scipy.interpolate import RectBivariateSpline
from scipy.ndimage import distance_transform_edt

from mxeon.conformance.reference import HostValues, Reference
from mxeon.conformance.samples import directions_at
from mxeon.hosts import open_host
from mxeon.io.srgb import srgb_encoded
from mxeon.models import microfacet
from mxeon.models.microfacet.defects import FITTED, MICROFACET_DEFECTS
from mxeon.shaders.document.policy import DEFAULT
from mxeon.shaders.methods import UNCHOSEN, Methods
from mxeon.shaders.scene import SIDE, sphere, tangents
from tools.fits import ggx_anisotropic
from tools.site import DOCS, with_block
from tools.site.gallery import BACKGROUND, QUALITY, studio

PAGE = DOCS / "brushed_metal.md"
FOLDER = DOCS / "images" / "brushed"
FIGURES = FOLDER / "figures.json"
DOCUMENT = FOLDER / "brushed.mtlx"
COLORS = {
    "aluminium": (0.91, 0.92, 0.92),
    "steel": (0.67, 0.64, 0.6),
    "vinyl": (0.08, 0.016, 0.012),
}
ALPHAS = {"aluminium": (0.1, 0.4), "steel": (0.06, 0.6), "vinyl": (0.12, 0.6)}
INDEX = 1.54  # refractive index of vinyl
COLUMNS = ("stock", "June 2026", "eonlib (July 2026)", "exact")
SIZE = 256  # pixels of one sphere
BLOCKS = (4, 4)  # rows and columns of the studio's picture for one light
FULL = 0.3  # relative difference from exact that is shown as pure red or blue
JUNE = next(each.lobe for each in MICROFACET_DEFECTS if each.name == "smith_mean")
WHITE_ALPHAS = ((0.1, 0.4), (0.06, 0.6))
WHITE_METAL = """<?xml version="1.0"?>
<materialx version="1.39">
  <generalized_schlick_bsdf name="lobe" type="BSDF">
    <input name="color0" type="color3" value="1, 1, 1" />
    <input name="roughness" type="vector2" value="{}, {}" />
  </generalized_schlick_bsdf>
  <surface name="surface" type="surfaceshader"><input name="bsdf" type="BSDF" nodename="lobe" /></surface>
  <surfacematerial name="white" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="surface" />
  </surfacematerial>
</materialx>
"""
COSINES = (0.5, 0.2, 0.05)
# Libraries whose environments are measured; the last one searches `genglsl/environment`.
SURROUNDED = (("stock", UNCHOSEN), ("eonlib", UNCHOSEN), ("eonlib", Methods(searched=True)))


def lights():
    """Distant lights that represent the studio: unit vectors (N, 3), and radiance times solid angle (N, 3)."""
    radiance = studio()
    rows, columns = radiance.shape[:2]
    polar = (np.arange(rows)[:, None] + 0.5) / rows * np.pi
    azimuth = ((np.arange(columns) + 0.5) / columns * 2.0 - 1.0) * np.pi
    solid = np.sin(polar)[..., None] * (np.pi / rows) * (2.0 * np.pi / columns)
    ring, up = np.broadcast_arrays(np.sin(polar), np.cos(polar))[0], np.cos(polar) + 0.0 * azimuth
    towards = np.stack([ring * np.sin(azimuth), up, ring * np.cos(azimuth)], axis=-1)

    def block_sums(values):
        edges = [np.arange(0, n, step) for n, step in zip((rows, columns), BLOCKS, strict=True)]
        return np.add.reduceat(np.add.reduceat(values, edges[0], 0), edges[1], 1).reshape(-1, 3)

    power = block_sums(radiance * solid)
    middle = block_sums(towards * (radiance * solid).sum(axis=-1, keepdims=True))
    unit = middle / np.linalg.norm(middle, axis=1, keepdims=True)
    seen = unit[:, 2] > -0.995
    return unit[seen], power[seen]


class Points:
    """Visible points of the sphere, and the two forms of a material's lobe there, components first."""

    def __init__(self, name, lines):
        self.name, self.mask = name, sphere(SIZE).mask
        normal = sphere(SIZE).normal[self.mask]
        along = tangents(normal)
        self.axes = np.stack([along, np.cross(normal, along), normal], axis=0)
        self.wo = self.axes[..., 2]
        self.roughness = np.array(ALPHAS[name])[:, None]
        self.color = np.array(COLORS[name])[:, None] * lines
        # (1 - E_ss) / E_ss, and the light that the base of vinyl receives, each for June's masking and exact.
        self.missing = [self._spread(microfacet.missing_of, mean) for mean in (True, False)]
        if name == "vinyl":
            self.curve = microfacet.DIELECTRIC_CURVE
            self.material = {"ior": np.full(1, INDEX), "tint": np.ones((1, 1))}
            self.passed = [self._spread(self._passed, mean) for mean in (True, False)]
        else:
            one = np.ones((3, 1))
            self.curve = microfacet.SCHLICK_CURVE
            self.material = {
                "color0": self.color,
                "color82": one,
                "color90": one,
                "exponent": 5.0 * one[0],
            }

    def _spread(self, of, mean):
        """A function of view and roughness at all points, interpolated by splines in the root of
        the cosine and in the azimuth.
        """
        roots, azimuths = np.linspace(0.05, 1.0, 49), np.linspace(0.0, 0.5 * np.pi, 25)
        mu, phi = (each.ravel() for each in np.meshgrid(roots**2, azimuths, indexing="ij"))
        ring = np.sqrt(1.0 - mu * mu)
        own = np.broadcast_to(self.roughness, (2, mu.size))
        alpha = np.broadcast_to(microfacet.ggx.mean_alpha(own), own.shape) if mean else own
        values = of(np.stack([ring * np.cos(phi), ring * np.sin(phi), mu]), alpha)
        table = RectBivariateSpline(roots, azimuths, values.reshape(49, 25))
        x, y, z = np.abs(self.wo)  # lobes are symmetric
        return table.ev(np.sqrt(z), np.arctan2(y, x))

    @staticmethod
    def _passed(wo, alpha):
        unit = wo / np.linalg.norm(wo, axis=0)
        inputs = {"tint": 1.0, "roughness": alpha.T, "ior": INDEX}
        return 1.0 - microfacet.node_albedo("dielectric_bsdf", unit.T, inputs)[..., 0]

    def value(self, direction):
        """pi f mu_i of June and exact, (2, 3, N)."""
        wi = self.axes @ direction
        lit = wi[2] > 0.0
        wi, wo, color = wi[:, lit], self.wo[:, lit], self.color[:, lit]
        material = self.material
        if self.name != "vinyl":
            material = material | {"color0": color}
        wh, cosine = microfacet.ggx.half_vector(wo, wi)
        facets = self.curve.at(cosine, **material) * microfacet.ggx.ndf(wh, self.roughness)
        average = self.curve.average(**material)
        pair = microfacet.Pair(wo, wi, self.roughness, cosine, microfacet.WHITE_CURVE, {})
        found = np.zeros((2, 3, len(lit)))
        for k, lobe in enumerate((JUNE, microfacet.Lobe())):
            f = facets * lobe.visibility(pair) * (1.0 + average * self.missing[k][lit])
            if self.name == "vinyl":
                f = f + self.passed[k][lit] * color / np.pi
            found[k][:, lit] = np.pi * wi[2] * f
        return found


def spheres(host, name):
    """Linear pictures of the four columns (4, SIZE, SIZE, 3) in the light of the studio."""
    shaders = [host.compile(DOCUMENT, name, library=each)[0] for each in ("stock", "eonlib")]
    values = HostValues(host, shaders[1], "eonlib", DEFAULT)
    [lines] = [shaders[1].document.getNode("lines")]
    pattern = values(SIZE, [lines], "float")[..., 0]
    points = Points(name, pattern[sphere(SIZE).mask])
    # Check that the models of this file equal the reference.
    expected = Reference().expected(shaders[1], replace(SIDE, size=SIZE), values=values, stride=16)
    judged = expected.judged[points.mask]
    own = points.value(np.array(SIDE.light))[1].T[judged]
    right = expected.image[expected.judged]
    assert np.allclose(own, right, rtol=1e-4, atol=1e-6), name

    total = np.zeros((4, SIZE, SIZE, 3))
    for direction, power in zip(*lights(), strict=True):
        lit = replace(SIDE, light=tuple(map(float, direction)), size=SIZE)
        drawn = [host.picture(each, lit) for each in shaders]
        june, exact = (points.value(direction) * power[:, None] / np.pi).transpose(0, 2, 1)
        total[0] += drawn[0] * power / np.pi
        total[1][points.mask] += june
        total[2] += drawn[1] * power / np.pi
        total[3][points.mask] += exact
    return np.where(points.mask[..., None], total, 0.0)


def difference_colors(ratio):
    """sRGB codes: gray where the ratio is 1, red where it is larger, blue where it is smaller."""
    t = np.clip((ratio - 1.0) / FULL, -1.0, 1.0)[..., None]
    gray, red, blue = (np.array(each, float) for each in ((225,) * 3, (190, 20, 30), (25, 70, 190)))
    return np.round(gray + np.where(t > 0, t * (red - gray), -t * (blue - gray))).astype(np.uint8)


def with_smooth_rim(codes):
    """Spheres (..., SIZE, SIZE, 3) on the background: each pixel of the rim by its share of the sphere."""
    side = 8  # rows and columns of samples in a pixel
    share = sphere(side * SIZE).mask.reshape(SIZE, side, SIZE, side).mean(axis=(1, 3))[..., None]
    rows, columns = distance_transform_edt(
        ~sphere(SIZE).mask, return_distances=False, return_indices=True
    )
    extended = codes[..., rows, columns, :]
    return np.round(share * extended + (1.0 - share) * BACKGROUND).astype(np.uint8)


def labeled(images):
    """Picture with labels: the spheres, and below how far each is from exact."""
    mask = sphere(SIZE).mask
    ratio = images.mean(axis=-1) / np.where(mask, images[3].mean(axis=-1), 1.0)
    scale = 0.85 / np.percentile(images[3][mask], 97)
    top = with_smooth_rim(srgb_encoded(np.minimum(scale * images, 1.0)))
    low = with_smooth_rim(difference_colors(ratio))
    strip = difference_colors(1.0 + FULL * np.linspace(-1.0, 1.0, SIZE - 88))
    low[3] = BACKGROUND
    low[3][SIZE // 2 - 12 : SIZE // 2 + 12, 44:-44] = strip
    bar = 26
    sheet = np.full((2 * (SIZE + bar), 4 * SIZE, 3), BACKGROUND, np.uint8)
    for k in range(4):
        at = np.s_[k * SIZE : (k + 1) * SIZE]
        sheet[bar : bar + SIZE, at], sheet[2 * bar + SIZE :, at] = top[k], low[k]
    picture = Image.fromarray(sheet)
    draw, font = ImageDraw.Draw(picture), ImageFont.load_default(16)

    def text(column, y, words):
        draw.text(((column + 0.5) * SIZE, y), words, "white", font, anchor="ma")

    for k, words in enumerate(COLUMNS):
        text(k, 5, words)
        if k < 3:
            text(k, SIZE + bar + 5, f"{words} / exact")
    for place, words in ((-0.35, f"{1 - FULL:g}"), (0.0, "1"), (0.35, f"{1 + FULL:g}")):
        text(3 + place, SIZE + bar + SIZE // 2 + 45, words)
    text(3, SIZE + bar + SIZE // 2 - 12, "radiance / exact")
    return picture, ratio[:, mask]


def white_albedo(lobe, wo, alpha, count=1024):
    """Albedo of a white lobe by a midpoint rule over the visible normals."""
    u, v = np.meshgrid(*2 * [(np.arange(count) + 0.5) / count])
    stretch = np.array([*alpha, 1.0])[:, None, None]
    view = wo[:, None, None] * np.ones_like(u)
    own = stretch * view / np.linalg.norm(stretch * view, axis=0)
    z = (1.0 - v) * (1.0 + own[2]) - own[2]
    ring = np.sqrt(np.maximum(1.0 - z * z, 0.0))
    h = np.stack([ring * np.cos(2.0 * np.pi * u), ring * np.sin(2.0 * np.pi * u), z]) + own
    h = stretch * h / np.linalg.norm(stretch * h, axis=0)
    cosine = np.sum(view * h, axis=0)
    wi = 2.0 * cosine * h - view
    above = wi[2] > 0.0
    pair = microfacet.Pair(
        view,
        wi,
        np.array(alpha)[:, None, None],
        cosine,
        microfacet.WHITE_CURVE,
        {"tint": np.ones(1)},
    )
    G1 = 2.0 * wo[2] / (wo[2] + np.linalg.norm(stretch[:, 0, 0] * wo))
    with np.errstate(all="ignore"):
        f = lobe.visibility(pair) * lobe.factor(pair) * 4.0 * wi[2] * wo[2] / G1
    return float(np.where(above, f, 0.0).mean())


def eonlib_white(wo, alpha):
    """White metal in the direct light of eonlib: exact E_ss over its fit."""
    wo, alpha = wo[:, None], np.array(alpha)[:, None]
    factor = 1.0 + np.tensordot(ggx_anisotropic.MISSED, ggx_anisotropic.terms(wo, alpha)[1], axes=1)
    fit = 1.0 - ggx_anisotropic.missed(wo, alpha) * factor
    return float((ggx_anisotropic.exact(wo, alpha) / fit)[0])


def white_rows(host, folder):
    """White metal's albedos, and the ranges of errors in an environment over views with cosines >= 0.05."""
    rows, ranges = [], []
    mu, phi = np.meshgrid(np.linspace(0.05, 1.0, 96), np.linspace(0.0, 0.5 * np.pi, 33))
    grid = directions_at(mu.ravel(), phi.ravel())
    document = folder / "white.mtlx"
    for alpha in WHITE_ALPHAS:
        document.write_text(WHITE_METAL.format(*alpha), encoding="utf-8")
        shaders = [
            host.compile(document, library=library, methods=methods)[0]
            for library, methods in SURROUNDED
        ]

        def surrounded(views, shaders=shaders):
            return [host.evaluate(each, views, views, {}, "environment")[:, 0] for each in shaders]

        ranges.append(
            [[float(f(each)) - 1.0 for f in (np.min, np.max)] for each in surrounded(grid)]
        )
        for name, turn in (("along", 0.0), ("across", 0.5 * np.pi)):
            for mu in COSINES:
                [wo] = directions_at(np.array([mu]), turn)
                direct = [white_albedo(FITTED, wo, alpha), white_albedo(JUNE, wo, alpha)]
                around = [each[0] for each in surrounded(wo[np.newaxis])]
                values = [*direct, eonlib_white(wo, alpha), 1.0, *around]
                rows.append((*alpha, name, mu, *map(float, values)))
    return rows, ranges


def percent(low, high):
    return f"{100 * low:+.1f} to {100 * high:+.1f} %"


def measure_white(host):
    """Rows of white metal's table, ranges in an environment, and the error of eonlib's direct light."""
    with TemporaryDirectory() as folder:
        rows, ranges = white_rows(host, Path(folder))
    return {"rows": rows, "ranges": ranges, "fit": ggx_anisotropic.largest_error()}


def measure_material(host, name):
    """Write a material's picture; per column the error that 1 % of the pixels exceed, and its range."""
    picture, ratio = labeled(spheres(host, name))
    picture.save(FOLDER / f"{name}.webp", quality=QUALITY, method=6)
    return [
        (float(np.percentile(abs(each), 99)), float(each.min()), float(each.max()))
        for each in ratio[:3] - 1.0
    ]


def page(text):
    found = json.loads(FIGURES.read_text(encoding="utf-8"))
    shown = "| material | stock | June 2026 | eonlib |\n|---|---|---|---|\n"
    for name in COLORS:
        cells = (f"{100 * off:.1f} %, {percent(*span)}" for off, *span in found[name])
        shown += f"| {name} | {' | '.join(cells)} |\n"
    white = (
        "| alphas | view tilts | cosine | stock | eonlib | stock, environment | eonlib, environment "
        "| with `genglsl/environment` |\n"
        "|---|---|---|---|---|---|---|---|\n"
    ) + "".join(
        f"| {a:g}, {b:g} | {name} | {mu:g} | {' | '.join(f'{each:.3f}' for each in (stock, own, *around))} |\n"
        for a, b, name, mu, stock, _, own, _, *around in found["white"]["rows"]
    )
    white += (
        f"\n- In eonlib's direct light, white metal is within {100 * found['white']['fit']:.1f} % of exact where one "
        "alpha is up to 50 times the other, at cosines from 0.01.\n"
    )
    for (a, b), (stock, own, searched) in zip(WHITE_ALPHAS, found["white"]["ranges"], strict=True):
        white += (
            f"- In a white environment, alphas {a:g} and {b:g}, all views with a cosine of at least 0.05: stock is "
            f"{percent(*stock)} off, eonlib {percent(*own)}, with `genglsl/environment` {percent(*searched)}.\n"
        )
    return with_block(with_block(text, "pictures", f"\n{shown}\n"), "white", f"\n{white}\n")


def main(names):
    """Measure these materials, or all and white metal, and write the page."""
    with open_host("gl") as host:
        for name in names or (*COLORS, "white"):
            measured = measure_white(host) if name == "white" else measure_material(host, name)
            found = json.loads(FIGURES.read_text(encoding="utf-8")) if FIGURES.is_file() else {}
            FIGURES.write_text(
                json.dumps(found | {name: measured}, indent=1) + "\n", encoding="utf-8"
            )
    if PAGE.is_file():
        PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
