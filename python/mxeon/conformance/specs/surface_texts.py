# SPDX-License-Identifier: Apache-2.0
"""Sentences from the specifications of four surface shaders, with materials to test each sentence.

Each row fixes some inputs, draws other inputs at random, and compares the shader with a model of
the specification in `mxeon.models.surfaces`. `permitted` lists alternative formulas that the
specification permits. `wrong` lists erroneous formulas that a diagnosis can recognize.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType

import numpy as np

from mxeon.conformance import samples, tolerance
from mxeon.conformance.samples import WHITE, Array, Batch, Candidate, Counts, Values, generator
from mxeon.conformance.spec import ZERO, Ability, Input, ValueSpec, draw
from mxeon.conformance.specs import microfacets, surface_shaders
from mxeon.models.surfaces import gltf, lobes, open_pbr, standard_surface, usd_preview
from mxeon.shaders.nodes import document_text, node_text

Forms = tuple[str, ...]  # names of a model's alternative formulas
PAIRS = 24  # number of direction pairs, each of which takes a millisecond
GRAZING = 0.05  # the direction SLANTED replaces directions with smaller cosines
SLANTED = samples.float32([0.6, 0.0, 0.8])
TILTED = (0.48, 0.36, 0.8)
DIRECT, ENVIRONMENT = ("direct", "response", np.pi), ("environment", "response", 1.0)
THROUGH, EMITTED = ("transmission", "response", 1.0), ("emission", "radiance", 1.0)
ERRORS = {
    DIRECT: surface_shaders.VALUE,
    ENVIRONMENT: surface_shaders.ALBEDO,
    THROUGH: surface_shaders.GLASS,
    EMITTED: tolerance.sum_of(tolerance.roundings(64, "of a color and two factors")),
}
STRETCHED = tolerance.Term(surface_shaders.STRETCHED_FIT, "the fits for two alphas")
FILMED = microfacets.FILM_ERRORS["value"].term("a film")


@dataclass(frozen=True, eq=False, kw_only=True)
class SentenceSpec(ValueSpec):
    """A sentence of a specification, tested with the inputs `fixed` and random `inputs`."""

    requires = Ability.MATERIAL

    text: Text
    section: str
    permitted: tuple[Forms, ...]
    wrong: tuple[Forms, ...]

    def document(self, inputs: Values | None = None) -> str:
        return document_text(node_text(self.text.node, "surfaceshader", "shading"))

    def value(self, batch: Batch) -> Array:
        return self.form()(batch)

    def form(self, *formulas: str) -> Callable[[Batch], Array]:
        """Values of the specification's model, in which alternatives replace some formulas."""
        branch, output, factor = self.evaluated
        model = self.text.model
        function = model.emission if output == "radiance" else model.surface

        def values(batch: Batch) -> Array:
            wi = batch.wi if branch == "direct" else None
            light = lobes.Light(batch.wo, wi, branch == "transmission")
            parameters = model.parameters(**{**self.fixed, **batch.inputs})
            return np.asarray(factor * function(light, parameters, formulas))

        return values

    @property
    def value_candidates(self) -> tuple[Candidate, ...]:
        forms = (
            Candidate(" and ".join(each), self.form(*each), each in self.permitted)
            for each in (*self.permitted, *self.wrong)
        )
        return (Candidate(self.text.name, self.value), *forms, ZERO)

    def batches(self, counts: Counts) -> tuple[Batch, ...]:
        rng = generator()
        pairs = (samples.directions(rng, PAIRS) for _ in range(2))
        wo, wi = (np.where(each[:, 2:] < GRAZING, SLANTED, each) for each in pairs)
        return (Batch(wo, wi, draw(rng, PAIRS, self.inputs)),)


@dataclass(frozen=True)
class Text:
    """The specification of a surface shader: a name, the implementing node, and a model."""

    name: str
    node: str
    model: ModuleType

    def says(
        self,
        key: str,
        section: str,
        claim: str,
        evaluated: tuple[str, str, float] = DIRECT,
        fixed: Values | None = None,
        permitted: tuple[str | Forms, ...] = (),
        wrong: tuple[str | Forms, ...] = (),
        terms: tuple[tolerance.Term, ...] = (),
        inputs: tuple[Input, ...] = (),
        **ranges: str,
    ) -> SentenceSpec:
        """The spec of a sentence, whose tolerance includes `terms`.

        The random inputs are `inputs` and the inputs that `ranges` names; see `ports_by_range`.
        """
        return SentenceSpec(
            title=f"{self.name}, {key}",
            node=self.name,
            text=self,
            section=section,
            claim=claim,
            evaluated=evaluated,
            fixed=fixed or {},
            inputs=inputs + surface_shaders.ports_by_range(**ranges),
            permitted=tuple(map(_forms, permitted)),
            wrong=tuple(map(_forms, wrong)),
            errors={"value": ERRORS[evaluated].plus(*terms)},
        )


def _forms(names: str | Forms) -> Forms:
    return (names,) if isinstance(names, str) else names


TWICE, TINTED = "reflection taken twice", "tinted light below the {}"
FAR = 1e6  # transmission depth at which a medium absorbs nearly no light
# The logarithm of the color must be finite, so the color is at least 0.05.
THROUGH_COLOR = Input("transmission_color", "color3", low=0.05)
WEIGHT = Input("specular_weight", high=2.0)
OPENPBR = Text("OpenPBR Surface", "open_pbr_surface", open_pbr)
STANDARD = Text("Standard Surface", "standard_surface", standard_surface)
GLTF = Text("glTF", "gltf_pbr", gltf)
USD = Text("USD Preview Surface", "UsdPreviewSurface", usd_preview)
MATTE: Values = {"specular_weight": 0.0}
COATED: Values = {"coat_weight": 1.0, "coat_darkening": 0.0, **MATTE}
SCHLICK_EMISSION = "Schlick's factor of the coat"
DARKENING = ("the Fresnel average at the normal", "a rough base")

PLASTIC: Values = {"base": 1.0, "base_color": (0.8, 0.7, 0.6), "sheen": 0.0, "metalness": 0.0}
BARE: Values = {**PLASTIC, "specular": 0.0}
METAL: Values = {"metalness": 1.0, "sheen": 0.0, "base": 0.8, "base_color": (0.9, 0.7, 0.4)}
CLEAR: Values = {"metallic": 0.0}
METAL_COLOR = Input("diffuseColor", "color3", high=0.95)  # a white metal has an infinite IOR
# fmt: off
SENTENCES = (
    OPENPBR.says("diffuse", "Glossy-diffuse", "The diffuse lobe is EON, scaled by base_weight.", fixed=MATTE,
        share="base_weight base_diffuse_roughness", color="base_color"),
    OPENPBR.says("gloss", "Glossy-diffuse", "The dielectric reflects above the diffuse lobe, which gets 1 - E.",
        color="base_color", index="specular_ior", rough="specular_roughness"),
    OPENPBR.says("specular weight", "Base substrate",
        "specular_weight scales the reflectance along the normal by changing the IOR.",
        fixed={"base_weight": 0.0}, inputs=(WEIGHT,), index="specular_ior", rough="specular_roughness"),
    OPENPBR.says("specular color", "Base substrate",
        "specular_color tints the light that the dielectric reflects above.",
        permitted=("no tint of what specular light leaves",),
        color="specular_color", index="specular_ior", rough="specular_roughness"),
    OPENPBR.says("anisotropy", "Microfacet model", "The mean of the squared alphas is r^4, their ratio 1 - a.",
        fixed={"base_metalness": 1.0}, terms=(STRETCHED,),
        share="specular_roughness_anisotropy", rough="specular_roughness"),
    OPENPBR.says("metal", "Metal", "Metals reflect by F82-tint, scaled by specular_weight.",
        fixed={"base_metalness": 1.0, "specular_color": (0.9, 0.8, 1.0)},
        share="base_weight specular_weight", color="base_color", rough="specular_roughness"),
    OPENPBR.says("metalness", "Base substrate", "base_metalness blends metal and dielectric.",
        share="base_metalness", color="base_color", rough="specular_roughness"),
    OPENPBR.says("transmission", "Reduction to a mixture of lobes",
        "Light that the interface does not reflect passes, tinted by transmission_color at depth 0.",
        evaluated=THROUGH, wrong=(TWICE,),
        share="transmission_weight", color="transmission_color", index="specular_ior", rough="specular_roughness"),
    OPENPBR.says("transmission depth", "Translucent base",
        "With a depth, transmission_color does not tint the interface.", evaluated=THROUGH,
        fixed={"transmission_weight": 1.0, "transmission_depth": FAR}, wrong=(TWICE,),
        inputs=(THROUGH_COLOR,), rough="specular_roughness"),
    OPENPBR.says("film", "Thin-film iridescence",
        "A film of thin_film_thickness micrometers covers thin_film_weight of the dielectric.",
        fixed={"base_weight": 0.0}, terms=(FILMED,),
        share="thin_film_weight thin_film_thickness", index="thin_film_ior", rough="specular_roughness"),
    OPENPBR.says("film on metal", "Thin-film iridescence", "The film also covers metals.",
        fixed={"base_metalness": 1.0}, terms=(FILMED,),
        share="thin_film_weight thin_film_thickness", index="thin_film_ior", rough="specular_roughness"),
    OPENPBR.says("film in transmission", "Thin-film iridescence",
        "What a film reflects does not pass: the transmitted light has the fringes, too.", evaluated=THROUGH,
        fixed={"transmission_weight": 1.0}, wrong=(TWICE,), terms=(FILMED,),
        share="thin_film_weight thin_film_thickness", index="thin_film_ior", rough="specular_roughness"),
    OPENPBR.says("coat", "Coat", "The coat reflects as a dielectric with its own IOR and roughness.",
        fixed={"base_weight": 0.0, **MATTE}, terms=(STRETCHED,),
        share="coat_weight coat_roughness_anisotropy", index="coat_ior", rough="coat_roughness"),
    OPENPBR.says("coat absorption", "View-dependent absorption",
        "The coat absorbs along the refracted path, coat_color at normal incidence.", fixed=COATED,
        permitted=("absorption at the normal",), color="coat_color"),
    OPENPBR.says("coat coverage", "Mixing",
        "coat_weight is coverage: the base is seen through lerp(1, T (1 - E), C).",
        evaluated=ENVIRONMENT, fixed={"coat_darkening": 0.0, "base_color": WHITE, **MATTE},
        wrong=("a partial coat as a product",),
        share="coat_weight", color="coat_color", rough="coat_roughness"),
    OPENPBR.says("base below a coat", "Coat",
        "The base reflects by its IOR relative to the coat's, inverted where the coat's is larger.",
        fixed={"base_weight": 0.0, "coat_darkening": 0.0, "coat_weight": 1.0},
        index="coat_ior specular_ior", rough="specular_roughness"),
    OPENPBR.says("darkening", "Darkening", "Reflections inside the coat darken the base by (1 - K) / (1 - E K).",
        fixed={"coat_weight": 1.0, **MATTE}, permitted=(DARKENING,),
        share="coat_darkening", color="base_color", index="coat_ior"),
    OPENPBR.says("darkening of a dark base", "Darkening", "E is the albedo of the whole base, including base_weight.",
        fixed={"coat_weight": 1.0, **MATTE}, permitted=(DARKENING,),
        wrong=((*DARKENING, "the base's albedo without base_weight"),),
        share="base_weight", color="base_color"),
    OPENPBR.says("roughening", "Roughening", "A rough coat widens the base's lobes to r'^4 = r^4 + 2 r_coat^4.",
        fixed={"base_metalness": 1.0, "coat_darkening": 0.0},
        share="coat_weight", rough="specular_roughness coat_roughness"),
    OPENPBR.says("fuzz", "Fuzz", "The fuzz is Zeltner's sheen, which covers fuzz_weight of the surface.", fixed=MATTE,
        share="fuzz_weight", fuzz_rough="fuzz_roughness", color="base_color"),
    OPENPBR.says("fuzz color", "Fuzz", "fuzz_color tints the fuzz, not the light that passes it.",
        fixed={"fuzz_weight": 1.0, **MATTE}, wrong=(TINTED.format("fuzz"),),
        fuzz_rough="fuzz_roughness", color="fuzz_color"),
    OPENPBR.says("fuzz normal", "Fuzz", "The fuzz has the normal of the layer below: the coat's, if there is a coat.",
        fixed={"fuzz_weight": 1.0, "geometry_coat_normal": TILTED, **COATED},
        wrong=("the fuzz along geometry_normal",),
        fuzz_rough="fuzz_roughness", rough="coat_roughness"),
    OPENPBR.says("frames", "Normal maps", "Base and coat have separate normals and tangents.",
        fixed={"base_metalness": 1.0, "coat_weight": 1.0, "coat_darkening": 0.0, "geometry_coat_normal": TILTED, "geometry_coat_tangent": (0.6, 0.0, -0.8), "geometry_tangent": (0.0, 1.0, 0.0), "specular_roughness_anisotropy": 0.5, "coat_roughness_anisotropy": 0.5},
        terms=(STRETCHED,), rough="specular_roughness coat_roughness"),
    OPENPBR.says("emission", "Emission", "The base emits emission_luminance times emission_color.", evaluated=EMITTED,
        fixed={"emission_luminance": 1.0}, color="emission_color"),
    OPENPBR.says("emission below a coat", "Reduction to a mixture of lobes", "The coat absorbs emitted light.",
        evaluated=EMITTED, fixed={"emission_luminance": 1.0},
        permitted=("the transmittance of one way", "a Fresnel factor of the coat", SCHLICK_EMISSION),
        share="coat_weight", color="coat_color", index="coat_ior"),
    OPENPBR.says("emission below fuzz", "Emission", "The fuzz is above the emission, too.", evaluated=EMITTED,
        fixed={"emission_luminance": 1.0}, permitted=("no fuzz above",),
        share="fuzz_weight", fuzz_rough="fuzz_roughness"),
    OPENPBR.says("thin-walled subsurface", "Thin-walled mode", "A thin wall reflects (1 - g) / 2 of subsurface_color.",
        fixed={"geometry_thin_walled": 1.0, "subsurface_weight": 1.0, **MATTE},
        wrong=("the color twice", ("the color twice", "factors clamped to 1")),
        inputs=(Input("subsurface_scatter_anisotropy", low=-1.0),), color="subsurface_color"),
    OPENPBR.says("thin-walled roughness", "Thin-walled mode", "base_diffuse_roughness shapes the lobes of a thin wall.",
        fixed={"geometry_thin_walled": 1.0, "subsurface_weight": 1.0, "subsurface_color": WHITE, **MATTE},
        wrong=("Oren-Nayar without compensation",), share="base_diffuse_roughness"),
    OPENPBR.says("thin-walled transmission", "Thin-walled mode", "A thin wall passes (1 + g) / 2 of subsurface_color.",
        evaluated=ENVIRONMENT, fixed={"geometry_thin_walled": 1.0, "subsurface_weight": 1.0, **MATTE},
        wrong=("the color twice", ("the color twice", "factors clamped to 1")),
        inputs=(Input("subsurface_scatter_anisotropy", low=-1.0),), color="subsurface_color"),
    OPENPBR.says("thin-walled color", "Thin-walled mode", "transmission_color tints a thin wall, whatever transmission_depth is.",
        evaluated=THROUGH,
        fixed={"geometry_thin_walled": 1.0, "transmission_weight": 1.0, "transmission_depth": FAR, "specular_ior": 1.05},
        wrong=("no color of a thin wall with a depth", (TWICE, "no color of a thin wall with a depth")),
        inputs=(THROUGH_COLOR,)),

    STANDARD.says("diffuse", "Diffuse reflection", "The diffuse lobe is Oren-Nayar's, scaled by base.", fixed=BARE,
        share="base diffuse_roughness", color="base_color"),
    STANDARD.says("specular", "Specular reflection",
        "The specular lobe is a dielectric above all other lobes, scaled by specular * specular_color.", fixed=PLASTIC,
        permitted=("no tint of what specular light leaves",),
        share="specular", color="specular_color", index="specular_IOR", rough="specular_roughness"),
    STANDARD.says("metal", "Metal",
        "Metals reflect base * base_color along the normal; specular * specular_color is Gulbrandsen's edge color.",
        fixed={"metalness": 1.0, "sheen": 0.0, "base": 0.9},
        share="specular", color="base_color specular_color", rough="specular_roughness"),
    STANDARD.says("metalness", "Metal", "metalness blends metal with the dielectric lobes.", fixed={"base": 0.8, "sheen": 0.0},
        share="metalness", color="base_color", rough="specular_roughness"),
    STANDARD.says("rotation", "Metal", "A rotation of 1 turns the anisotropy once around.",
        fixed={**METAL, "specular_anisotropy": 0.6}, permitted=("rotation clockwise",), terms=(STRETCHED,),
        share="specular_rotation", rough="specular_roughness"),
    STANDARD.says("coat rotation", "Coating", "A rotation of 1 turns the coat's anisotropy once around.",
        fixed={**BARE, "base": 0.0, "coat": 1.0, "coat_anisotropy": 0.6}, permitted=("rotation clockwise",),
        terms=(STRETCHED,), share="coat_rotation", rough="coat_roughness"),
    STANDARD.says("transmission", "Specular transmission",
        "Light that the interface does not reflect passes, tinted by transmission_color.", evaluated=THROUGH,
        fixed=PLASTIC, wrong=(TWICE,),
        share="transmission", color="transmission_color", index="specular_IOR", rough="specular_roughness"),
    STANDARD.says("sheen", "Sheen", "The sheen is above the base, which gets 1 - sheen E.", fixed=BARE,
        share="sheen", sheen_rough="sheen_roughness", color="base_color"),
    STANDARD.says("sheen color", "Sheen", "sheen_color tints the sheen, not the light that passes it.",
        fixed={**BARE, "sheen": 1.0}, wrong=(TINTED.format("sheen"),),
        sheen_rough="sheen_roughness", color="sheen_color"),
    STANDARD.says("film", "Metal", "A film of thin_film_thickness nanometers covers the dielectric.",
        fixed={**PLASTIC, "base": 0.0}, terms=(FILMED,),
        film="thin_film_thickness", index="thin_film_IOR", rough="specular_roughness"),
    STANDARD.says("coat", "Coating", "The coat reflects as a white dielectric with its own IOR and roughness.",
        fixed={**BARE, "base": 0.0}, share="coat", index="coat_IOR", rough="coat_roughness"),
    STANDARD.says("coat color", "Coating", "coat_color tints everything below the coat.", fixed={**BARE, "coat": 1.0},
        color="coat_color base_color", rough="coat_roughness"),
    STANDARD.says("coat coverage", "Coating", "The lobes below are seen through lerp(1, coat_color (1 - E), coat).",
        evaluated=ENVIRONMENT, fixed={**BARE, "base_color": WHITE}, wrong=("a partial coat as a product",),
        share="coat", color="coat_color", rough="coat_roughness"),
    STANDARD.says("coat affects color", "Coating", "coat_affect_color raises the base's color to a power.",
        fixed={**BARE, "coat": 1.0}, share="coat_affect_color", color="base_color"),
    STANDARD.says("coat affects roughness", "Coating", "coat_affect_roughness widens the lobes below.",
        fixed={**METAL, "coat": 1.0},
        share="coat_affect_roughness", rough="specular_roughness coat_roughness"),
    STANDARD.says("emission", "Emission", "The surface emits emission times emission_color.", evaluated=EMITTED,
        share="emission", color="emission_color"),
    STANDARD.says("emission below a coat", "Coating",
        "The coat reflects and tints emitted light as it does the light of the base.", evaluated=EMITTED,
        fixed={"emission": 1.0}, permitted=("a Fresnel factor of the coat", SCHLICK_EMISSION),
        share="coat", color="coat_color", index="coat_IOR", rough="coat_roughness"),
    STANDARD.says("thin-walled subsurface", "Diffuse transmission",
        "On a thin wall, subsurface is diffuse transmission.", evaluated=ENVIRONMENT,
        fixed={**BARE, "thin_walled": 1.0}, share="subsurface", color="subsurface_color"),

    GLTF.says("diffuse", "B.2.2", "The diffuse lobe is Lambert's.", fixed={**CLEAR, "specular": 0.0},
        color="base_color"),
    GLTF.says("specular", "KHR_materials_specular",
        "The reflectance is min(F0 specular_color, 1) specular along the normal, and specular at grazing.",
        fixed={**CLEAR, "base_color": (0.0, 0.0, 0.0)},
        share="specular", color="specular_color", index="ior", rough="roughness"),
    GLTF.says("dielectric", "B.2", "The specular lobe is above the diffuse lobe, which gets the remaining light.",
        fixed=CLEAR, color="base_color", index="ior", rough="roughness"),
    GLTF.says("metal", "B.2.1", "Metals reflect by Schlick's curve from base_color to white.",
        color="base_color", rough="roughness"),
    GLTF.says("metallic", "B.2", "metallic blends metal and dielectric.",
        share="metallic", color="base_color", rough="roughness"),
    GLTF.says("anisotropy", "KHR_materials_anisotropy",
        "The strength widens the lobe along the tangent, which the rotation turns counterclockwise.",
        wrong=("rotation clockwise",), terms=(STRETCHED,),
        share="anisotropy_strength anisotropy_rotation", rough="roughness"),
    GLTF.says("clearcoat", "KHR_materials_clearcoat",
        "The clearcoat of IOR 1.5 covers all other lobes, which get the remaining light.", fixed=CLEAR,
        share="clearcoat", rough="clearcoat_roughness roughness", color="base_color"),
    GLTF.says("clearcoat normal", "KHR_materials_clearcoat", "The clearcoat has its own normal.",
        fixed={**CLEAR, "clearcoat": 1.0, "clearcoat_normal": TILTED, "base_color": (0.0, 0.0, 0.0)},
        rough="clearcoat_roughness"),
    GLTF.says("sheen", "KHR_materials_sheen",
        "The sheen, with alpha = sheen_roughness^2, is on top and takes max(sheen_color) E from every channel.",
        fixed=CLEAR, wrong=(TINTED.format("sheen"),),
        color="sheen_color", fuzz_rough="sheen_roughness"),
    GLTF.says("iridescence", "KHR_materials_iridescence",
        "iridescence blends the dielectric's reflection with the reflection under a film.",
        fixed={**CLEAR, "base_color": (0.0, 0.0, 0.0)}, terms=(FILMED,),
        share="iridescence", film="iridescence_thickness", index="iridescence_ior", rough="roughness"),
    GLTF.says("iridescent metal", "KHR_materials_iridescence", "The film also covers metals.", terms=(FILMED,),
        share="iridescence", film="iridescence_thickness", index="iridescence_ior", rough="roughness", color="base_color"),
    GLTF.says("transmission", "KHR_materials_transmission",
        "transmission is the fraction of penetrating light that passes, tinted by base_color.", evaluated=THROUGH,
        fixed=CLEAR, wrong=(TWICE,),
        share="transmission", color="base_color", index="ior", rough="roughness"),
    GLTF.says("emission", "KHR_materials_emissive_strength", "The surface emits emissive times emissive_strength.",
        evaluated=EMITTED, share="emissive_strength", color="emissive"),
    GLTF.says("emission below a clearcoat", "KHR_materials_clearcoat",
        "The clearcoat removes its Fresnel reflectance from emitted light.", evaluated=EMITTED,
        wrong=("emission above the clearcoat",), fixed={"emissive": WHITE}, share="clearcoat"),

    USD.says("specular workflow", "Preview Surface",
        "specularColor is the reflectance along the normal, white at grazing.",
        fixed={"useSpecularWorkflow": 1}, color="specularColor diffuseColor", rough="roughness"),
    USD.says("dielectric", "Preview Surface",
        "Without metallic, the reflectance comes from ior and is white at grazing.",
        color="diffuseColor", rough="roughness", index="ior"),
    USD.says("metal", "Preview Surface", "Metals reflect diffuseColor along the normal and at grazing.",
        fixed={"metallic": 1.0}, wrong=("metal by artist-friendly indices",),
        inputs=(METAL_COLOR,), rough="roughness"),
    USD.says("metallic", "Preview Surface", "Between metallic 0 and 1, both reflectances are interpolated.",
        wrong=("metal by artist-friendly indices",),
        inputs=(METAL_COLOR,), share="metallic", rough="roughness"),
    USD.says("clearcoat", "Preview Surface", "The clearcoat is a second, white specular lobe with the IOR ior.",
        share="clearcoat", rough="clearcoatRoughness", color="diffuseColor", index="ior"),
    USD.says("opacity", "Preview Surface", "The fraction 1 - opacity of light passes, and the surface still reflects.",
        evaluated=THROUGH, wrong=(TWICE,), share="opacity", index="ior", rough="roughness"),
    USD.says("opacity threshold", "Preview Surface", "With a threshold, visible points are opaque.",
        fixed={"opacityThreshold": 0.2, "opacity": 0.5}, color="diffuseColor", rough="roughness"),
    USD.says("emission", "Preview Surface", "The surface emits emissiveColor.", evaluated=EMITTED,
        color="emissiveColor"),
)
# fmt: on
