# SPDX-License-Identifier: Apache-2.0
"""Specs of surface shaders, which are compared with the layer equation of all lobes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from mxeon.conformance import samples, spec
from mxeon.conformance.results.quantities import Quantity
from mxeon.conformance.samples import WHITE, Array, Batch, Counts, Values, generator
from mxeon.conformance.spec import CHANGED_COLOR, Input, draw
from mxeon.conformance.specs import lobes, microfacets
from mxeon.conformance.specs.microfacets import FILM_ERRORS, sum_over
from mxeon.conformance.tolerance import Term, Tolerance, mean_scaled, roundings, sum_in, sum_of
from mxeon.shaders.nodes import document_text, input_text, node_text

if TYPE_CHECKING:  # avoid loading MaterialX
    import MaterialX as mx

    from mxeon.shaders.generation import Shader

# Ranges by kind of input. The value `materials` makes all lobes of a material contribute. The value
# `change` differs from every input's default.
RANGES = {
    "color": spec.color("", (0.5, 0.6, 0.7), edges=(1.0,)),
    "share": Input("", edges=(0.0, 1.0), change=0.7, materials=(0.5,)),
    "rough": Input("", low=0.1, change=0.73, materials=(0.4,)),
    "sheen_rough": Input("", low=0.15, change=0.745, materials=(0.5,)),
    "fuzz_rough": Input("", low=0.4, change=0.82, materials=(0.5,)),
    "index": Input("", low=1.1, high=2.5, change=2.08),
    "thickness": Input("", high=1000.0, change=700.0, materials=(400.0,)),
    "film": Input("", low=100.0, high=1000.0, change=730.0, materials=(400.0,)),
}
# Mean free paths have no effect on a plane, the only shape that is evaluated.
FREE_PATHS = ("subsurface_radius", "subsurface_scale", "subsurface_radius_scale")


def ports_by_range(**names: str) -> tuple[Input, ...]:
    """Inputs with ranges from RANGES. `key="name1 name2"` gives two inputs the range of `key`."""
    rows = ((key, name) for key, words in names.items() for name in words.split())
    return tuple(replace(RANGES[key], name=name) for key, name in rows)


def _ones(names: str) -> Values:
    """1 for each named number, and white for each named color."""
    return {name: WHITE if "color" in name.lower() else 1.0 for name in names.split()}


LIGHT_ALPHA = 0.3  # alpha of the GGX lobe from which half of the light directions are sampled
# tools/fits/surface_shaders.py measures a shader's largest error due to the fits of all lobes, over
# 32 sets of samples. The error is a third of the sum of the lobes' largest errors, because no
# material has all of the largest errors at once.
VALUE = sum_of(Term(3.5e-3, "the fits of all lobes of a material, over 32 sets of 256 pairs"))
FITS = Term(2.7e-3, "the fits of all lobes of a material, over 32 sets of 64 views")
ALBEDO = sum_in(Quantity.ALBEDO, FITS, sum_over(1024))
STRETCHED_FIT = 0.019  # largest error of an anisotropic lobe's value due to fits
# Environment sums for different views have independent errors, so the mean over 64 views has an
# eighth of the error.
MEAN = sum_of(
    Term(2.4e-4, "the mean error of the fits, over 32 sets of 64 views"),
    Term(sum_over(1024).value / 8.0, "sums over 1024 directions, divided by sqrt(64 views)"),
    quantity=Quantity.MATERIAL_MEAN,
    metric=mean_scaled,
)
# A reflecting lobe of albedo E over a transmitting lobe passes (1 - E)^2 of the light. The
# derivative of (1 - E)^2 has a magnitude of at most 2.
GLASS = sum_in(
    Quantity.ALBEDO,
    Term(2.0 * microfacets.LOBE_FIT, "twice the fit of a lobe's albedo"),
    Term(2.0 * sum_over(1024).value, "two sums over 1024 directions"),
)
COUNTS = Counts(256, albedos=64, materials=1 << 11)  # one material per pair
ERRORS = {
    "value": VALUE,
    "albedo": ALBEDO,
    "lobes_mean": MEAN,
    "glass": GLASS,
    "states": sum_of(roundings(32, "of the same parts in two programs")),
    "lobes_film": sum_of(
        VALUE.term("all lobes of a material"), FILM_ERRORS["value"].term("a film")
    ),
}


@dataclass(frozen=True, eq=False, kw_only=True)
class SurfaceShaderSpec(spec.LobeSpec):
    """A surface shader to whose values all lobes contribute."""

    requires = spec.Ability.MATERIAL
    plain = ("frame", "shape", "lobes", "inputs from an image")

    judged: tuple[Input, ...]  # inputs whose effect on values is compared with the reference
    others: tuple[Input, ...]  # inputs that only the checks of energy and films vary
    # Inputs without an effect in rasterizers; see docs/upstream/surface_inputs.md.
    without_effect: tuple[str, ...]
    white: Values  # inputs with which the layer equation loses no light
    glass: Values  # inputs of clear glass
    finish: tuple[str, ...]  # inputs of glass that may vary: roughness and IOR
    # For each input that has no effect alone, values of other inputs that enable the input.
    needs: Mapping[str, Values] = field(default_factory=dict)
    errors: Mapping[str, Tolerance] = field(default_factory=lambda: ERRORS)
    counts: Counts = COUNTS
    # Inputs that are not varied. Opacity blends the surface with the background, and every
    # evaluation sets the occlusion.
    fixed_inputs: tuple[str, ...] = ()
    library: str = "eonlib"  # library whose definition of the node the reference evaluates

    @property
    def varied(self) -> tuple[Input, ...]:
        return (*self.judged, *self.others)

    @property
    def film(self) -> tuple[Input, ...]:
        names = "thin_film", "iridescence"
        return tuple(each for each in self.others if each.name.startswith(names))

    @cached_property
    def _ports(self) -> tuple[mx.Input, ...]:
        from mxeon.shaders.library import load_library

        return tuple(load_library("stock").getMatchingNodeDefs(self.node)[0].getActiveInputs())

    @cached_property
    def changed_inputs(self) -> Values:
        """For each input that can have an effect, a value other than the default."""
        values = dict[str, ArrayLike]()
        for each in self.varied:
            if each.change is not None and each.name not in FREE_PATHS:
                values[each.name] = each.change
        skipped = {*values, *FREE_PATHS, *self.fixed_inputs}
        for port in self._ports:
            name, kind, default = port.getName(), port.getType(), port.getValue()
            if name in skipped:
                continue
            if kind == "vector3":
                values[name] = (0.6, 0.8, 0.0) if "tangent" in name else (0.48, 0.36, 0.8)
            elif kind == "color3":
                values[name] = CHANGED_COLOR
            else:
                values[name] = 0.5 + (default or 0.0) if kind == "float" else not default
        return values

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.changed_inputs)

    @property
    def changes(self) -> Mapping[str, samples.Changes]:
        material, _ = spec.materials(*self.varied)
        before = {name: {**material, **self.needs.get(name, {})} for name in self.names}
        changed = self.changed_inputs
        return {name: (each, {**each, name: changed[name]}) for name, each in before.items()}

    def within(self, library: str) -> SurfaceShaderSpec:
        return replace(self, library=library)

    @property
    def types(self) -> dict[str, str]:
        return {port.getName(): port.getType() for port in self._ports}

    def document(self, inputs: Values | None = None) -> str:
        types = self.types
        ports = (input_text(name, types[name], value) for name, value in (inputs or {}).items())
        return document_text(node_text(self.node, "surfaceshader", "shading", "".join(ports)))

    def value(self, batch: Batch) -> Array:
        return np.pi * self._reference(batch, "direct")

    def albedo(self, batch: Batch) -> Array:
        return self._reference(batch, "environment")

    def transmitted(self, batch: Batch, opacity: bool) -> Array:
        """Transmitted environment light. If `opacity`, opacity replaces refraction."""
        return self._reference(batch, "opacity" if opacity else "transmission")

    def clear(self, batch: Batch) -> Batch:
        """Replace the materials of a batch by glass of the same roughness and IOR."""
        finish = {name: batch.inputs[name] for name in self.finish}
        return replace(batch, inputs=finish).altered(**self.glass)

    @cached_property
    def _shader(self) -> Shader:
        from mxeon.shaders.generation import generate

        [shader] = generate(self.document(), "glsl", library=self.library)
        return shader

    def _reference(self, batch: Batch, branch: str) -> Array:
        from mxeon.conformance.reference import Reference

        return Reference().evaluate(self._shader, batch.wo, batch.wi, batch.inputs, branch)

    def random_inputs(self, rng: samples.Rng, count: int, edged: bool = False) -> dict[str, Array]:
        """Random values of the judged inputs or, if `edged`, often extreme values of all inputs."""
        return draw(rng, count, self.varied if edged else self.judged, edged)

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        """Random pairs and materials. Half of the lights are near the mirror direction."""
        rng, count = generator(), counts.pairs
        wo, wi = _views(rng, count), samples.directions(rng, count)
        alpha = np.full((count, 2), LIGHT_ALPHA)
        near = microfacets.reflected(wo, alpha, rng.random(count), rng.random(count))
        replaced = (np.arange(count) % 2 == 0) & (near[:, 2] > 0.0)
        wi = np.where(replaced[:, np.newaxis], near, wi)
        batch = Batch(wo, wi, self.random_inputs(rng, count))
        isotropic, inputs = np.arange(count) % 4 < 2, batch.inputs
        changed = {name: np.where(isotropic, 0.0, inputs[name]) for name in _anisotropies(batch)}
        return (batch.altered(**changed),)

    few = spec.ValueSpec.few

    def views(self, batches: tuple[Batch, ...], counts: Counts) -> tuple[Batch, ...]:
        """Views of isotropic materials, without metals whose Fresnel curve falls below 0.

        MaterialX clamps such a curve in direct light, but not in an environment.
        """
        batch = _isotropic(batches[0].first(counts.albedos))
        if "base_metalness" in self.names:  # only OpenPBR's metal has a color at 82 degrees
            color0 = batch.inputs["base_color"] * batch.inputs["base_weight"][:, np.newaxis]
            color82, color90 = batch.inputs["specular_color"], np.ones((1, 3))
            curve = {"color0": color0, "color82": color82, "color90": color90}
            curve["exponent"] = np.full(1, 5.0)
            batch = batch.where(~microfacets.falls_below_0(curve))
        return (batch,)

    def edges(self, counts: Counts) -> Batch:
        """Views of materials in which all lobes contribute, with extreme inputs."""
        rng, count = generator(), counts.materials
        wo, inputs = _views(rng, count), self.random_inputs(rng, count, edged=True)
        # Set the diffuse roughness to 0, because QON gains up to 1.4 % of light at grazing views.
        inputs |= {name: 0.0 * inputs[name] for name in inputs if name == "diffuse_roughness"}
        return _isotropic(Batch(wo, wo, inputs))

    def films(self, counts: Counts) -> Batch:
        """Random pairs with random isotropic materials under random films."""
        batch = _isotropic(self.batches(counts)[0])
        return batch.altered(**draw(generator(), len(batch.wo), self.film))


def _views(rng: samples.Rng, count: int) -> Array:
    """Random views with a cosine of at least LEAST_VIEW, below which the sheen gains energy."""
    wo = samples.directions(rng, count)
    wo = samples.float32(np.where(wo[:, 2:] < lobes.LEAST_VIEW, [0.6, 0.0, 0.8], wo))
    wo[0] = samples.directions_at(lobes.LEAST_VIEW, 0.0)
    return wo


def _anisotropies(batch: Batch) -> list[str]:
    return [each for each in batch.inputs if "anisotropy" in each and "rotation" not in each]


def stretched(batch: Batch) -> samples.Mask:
    """Mask of the pairs with an anisotropic lobe."""
    mask = np.zeros(len(batch.wo), bool)
    for name in _anisotropies(batch):
        mask |= batch.inputs[name] != 0.0
    return mask


def _isotropic(batch: Batch) -> Batch:
    return batch.altered(**dict.fromkeys(_anisotropies(batch), np.zeros(len(batch.wo))))


def _names(node: str) -> spec.Names:
    return {"title": f"{node}, every lobe", "node": node, "model": node}


# fmt: off
SURFACE_SHADERS = (
    SurfaceShaderSpec(
        **_names("standard_surface"),
        judged=ports_by_range(
            share="base diffuse_roughness metalness specular specular_anisotropy specular_rotation sheen coat coat_anisotropy coat_rotation coat_affect_color coat_affect_roughness",
            color="base_color specular_color sheen_color coat_color",
            rough="specular_roughness coat_roughness", index="specular_IOR coat_IOR",
            sheen_rough="sheen_roughness"),
        others=ports_by_range(
            share="transmission transmission_extra_roughness subsurface subsurface_scale",
            color="transmission_color subsurface_color subsurface_radius",
            thickness="thin_film_thickness", index="thin_film_IOR"),
        without_effect=(
            "transmission_depth", "transmission_scatter", "transmission_scatter_anisotropy",
            "transmission_dispersion", "subsurface_anisotropy"),
        needs={"emission_color": {"emission": 1.0}},
        fixed_inputs=("opacity",),
        glass={"transmission": 1.0, "base": 0.0},
        finish=("specular_roughness", "specular_IOR"),
        white={**_ones("base base_color sheen coat"), "specular_roughness": 0.4}),
    SurfaceShaderSpec(
        **_names("open_pbr_surface"),
        judged=ports_by_range(
            share="base_weight base_diffuse_roughness base_metalness specular_weight specular_roughness_anisotropy coat_weight coat_roughness_anisotropy coat_darkening fuzz_weight",
            color="base_color specular_color coat_color fuzz_color",
            rough="specular_roughness coat_roughness", index="specular_ior coat_ior",
            sheen_rough="fuzz_roughness"),
        others=ports_by_range(
            share="transmission_weight subsurface_weight subsurface_radius thin_film_weight thin_film_thickness",
            color="transmission_color subsurface_color subsurface_radius_scale",
            index="thin_film_ior"),
        without_effect=(
            "transmission_scatter", "transmission_scatter_anisotropy", "transmission_dispersion_scale",
            "transmission_dispersion_abbe_number", "subsurface_scatter_anisotropy"),
        needs={
            # Change a color, because the default colors of subsurface and base are equal.
            "subsurface_weight": {"subsurface_color": CHANGED_COLOR},
            "emission_color": {"emission_luminance": 1000.0}},
        fixed_inputs=("geometry_opacity",),
        glass={"transmission_weight": 1.0},
        finish=("specular_roughness", "specular_ior"),
        white={
            **_ones("base_weight base_color coat_weight fuzz_weight fuzz_color"),
            "base_diffuse_roughness": 0.5, "coat_roughness": 0.3, "coat_darkening": 0.0}),
    SurfaceShaderSpec(
        **_names("gltf_pbr"),
        judged=ports_by_range(
            color="base_color specular_color sheen_color",
            share="metallic specular anisotropy_strength anisotropy_rotation clearcoat",
            rough="roughness clearcoat_roughness", index="ior", fuzz_rough="sheen_roughness"),
        others=ports_by_range(
            share="transmission iridescence", index="iridescence_ior", film="iridescence_thickness"),
        without_effect=("thickness", "attenuation_distance", "attenuation_color", "dispersion"),
        needs={"emissive_strength": {"emissive": CHANGED_COLOR}},
        fixed_inputs=("occlusion", "alpha", "alpha_mode", "alpha_cutoff"),
        glass={"transmission": 1.0, "metallic": 0.0, "base_color": WHITE},
        finish=("roughness", "ior"),
        white={
            **_ones("base_color sheen_color clearcoat"), "metallic": 0.0, "roughness": 0.5,
            "sheen_roughness": 0.6, "clearcoat_roughness": 0.4}),
    SurfaceShaderSpec(
        **_names("UsdPreviewSurface"),
        judged=ports_by_range(
            color="diffuseColor specularColor", share="metallic clearcoat",
            rough="roughness clearcoatRoughness", index="ior"),
        others=ports_by_range(share="opacity"),
        without_effect=("displacement",),
        glass={"opacity": 0.0, "diffuseColor": WHITE},
        finish=("roughness", "ior"),
        white={**_ones("diffuseColor clearcoat"), "clearcoatRoughness": 0.4},
        needs={"specularColor": {"useSpecularWorkflow": 1}},
        fixed_inputs=("occlusion",)),
)
# fmt: on
