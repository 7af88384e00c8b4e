# SPDX-License-Identifier: Apache-2.0
"""Known issues of stock MaterialX and of renderers: the page of `docs/upstream/` on each failing check."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from mxeon.conformance.checks.text.sources import WITH_BSDF
from mxeon.conformance.results import DIFFERS, FAILED, PASSED, Result

STOCK = "stock"
OWN = "its own nodes"  # in the place of a library
NODE = "oren_nayar_diffuse_bsdf, energy_compensation"
LOADED = tuple(f"{node}, MaterialXLoader" for node in ("open_pbr_surface", "standard_surface"))
BABYLON = tuple(
    f"{material}, {engine}"
    for material in ("PBRMaterial E_OREN_NAYAR", "OpenPBRMaterial")
    for engine in ("WebGL2", "WebGPU")
)
WEBGL_LOBE = "WebGLPathTracer, diffuseEval"
RENDERERS = {
    "cycles": "this Blender",
    "three": "this three.js",
    "babylon": "this Babylon.js",
    "luxcore": "this LuxCoreRender",
    "three-gpu-pathtracer": "this three-gpu-pathtracer",
}
BURLEY = tuple(f"PBRMaterial BURLEY, {engine}" for engine in ("WebGL2", "WebGPU"))
HARDWARE = ("webgl", "vulkan", "wgsl", "slang")  # hosts whose text comes from that of GLSL
CONTY_KULLA, ZELTNER = (f"sheen_bsdf, mode {mode}" for mode in ("conty_kulla", "zeltner"))
DIELECTRIC, SCHLICK = (
    f"{node}_bsdf, scatter_mode R" for node in ("dielectric", "generalized_schlick")
)
MICROFACETS = (DIELECTRIC, "conductor_bsdf", SCHLICK)
SURFACES = tuple(
    f"{node}, every lobe"
    for node in ("standard_surface", "open_pbr_surface", "gltf_pbr", "UsdPreviewSurface")
)
FILMS = tuple(
    f"{node}_bsdf, thin film" for node in ("dielectric", "conductor", "generalized_schlick")
)
TRANSMITTING = tuple(
    f"{node}_bsdf, scatter_mode {mode}"
    for node in ("dielectric", "generalized_schlick")
    for mode in ("T", "RT")
)


@dataclass(frozen=True)
class Issue:
    """An issue upstream: its page, and the results that show it.

    Attributes
    ----------
    page : str
        Its name without suffix.
    host : str
        The host that shows it; "source" for generated text.
    rows : tuple of (str, str)
        Key of the check and subject of each result, all of which fail.
    also : tuple of str
        Other hosts that show it.
    implied : tuple of (str, str)
        Key and subject of other results that fail for it, on those hosts or in the text.
    library : str
        The library that has it; OWN for a renderer's own nodes.
    """

    page: str
    host: str
    rows: tuple[tuple[str, str], ...]
    also: tuple[str, ...] = ()
    implied: tuple[tuple[str, str], ...] = ()
    library: str = STOCK


def _product(checks: Sequence[str], subjects: Sequence[str]) -> tuple[tuple[str, str], ...]:
    """Each of some checks of each of some subjects."""
    return tuple((check, subject) for check in checks for subject in subjects)


HAIR = "chiang_hair_bsdf"
HAIR_ISSUES = (
    Issue(
        "genglsl_hair_uniform_lobe",
        "gl",
        (("each_lobe", HAIR),),
        HARDWARE,
        _product(("value", "integral"), (HAIR,)),
    ),
    Issue(
        "genglsl_hair_longitudinal",
        "gl",
        _product(("narrow_lobes", "tilted_lobes"), (HAIR,)),
        HARDWARE,
        _product(("value", "black", "integral", "finite"), (HAIR,)),
    ),
    Issue("genglsl_hair_roughness", "gl", (("wide_lobes", HAIR),), HARDWARE),
    Issue(
        "genglsl_hair_azimuth", "gl", (("straight_views", HAIR),), HARDWARE, (("each_lobe", HAIR),)
    ),
    Issue("genglsl_hair_grazing", "gl", (("finite", HAIR),), HARDWARE, (("value", HAIR),)),
    Issue("genglsl_hair_environment", "gl", (("environment", HAIR),), HARDWARE),
)
BSDF_ISSUES = (
    Issue("genglsl_zeltner_normal", "gl", (("value", ZELTNER),), HARDWARE),
    Issue(
        "genglsl_sheen_throughput",
        "gl",
        (("layering", ZELTNER), ("transmission", ZELTNER), ("transmission", CONTY_KULLA)),
        HARDWARE,
        (
            ("layering", CONTY_KULLA),
            ("layer", CONTY_KULLA),
            ("layer", ZELTNER),
            *_product(("lobes", "lobes_albedo"), SURFACES[:3]),
        ),
    ),
    Issue(
        "genglsl_conty_kulla_fit",
        "gl",
        (("environment", CONTY_KULLA), ("value", CONTY_KULLA)),
        HARDWARE,
        _product(("layering", "layer"), (CONTY_KULLA,)),
    ),
    Issue(
        "genglsl_multiply_throughput",
        "gl",
        _product(("combined_throughput",), ("multiply, in2 float", "multiply, in2 color3")),
        HARDWARE,
    ),
    Issue(
        "genglsl_subsurface_circle",
        "gl",
        (("value", "subsurface_bsdf"),),
        HARDWARE,
        _product(("integral", "energy"), ("subsurface_bsdf",)),
    ),
    Issue("genglsl_burley_fit", "gl", (("environment", "burley_diffuse_bsdf"),), HARDWARE),
    Issue("genglsl_translucent_side", "gl", (("frame", "translucent_bsdf"),), HARDWARE),
    Issue(
        "genglsl_ior_zero",
        "gl",
        (("finite", DIELECTRIC),),
        HARDWARE,
        (
            ("finite", "conductor_bsdf"),
            *_product(("transmitted_finite",), TRANSMITTING[:2]),
        ),
    ),
    Issue(
        "genglsl_transmission_masking",
        "gl",
        (("transmitted", TRANSMITTING[1]), ("clear", TRANSMITTING[1])),
        HARDWARE,
        _product(("transmitted", "clear"), TRANSMITTING),
    ),
    Issue(
        "genglsl_refraction_nan",
        "gl",
        (("transmitted_finite", TRANSMITTING[3]),),
        HARDWARE,
        (
            *_product(("transmitted_finite",), TRANSMITTING),
            *_product(("transmitted", "clear"), TRANSMITTING[2:]),
        ),
    ),
    Issue(
        "genglsl_microfacet_throughput",
        "gl",
        (("layering", DIELECTRIC), ("transmission", DIELECTRIC), ("transmission", SCHLICK)),
        HARDWARE,
        (
            ("layering", SCHLICK),
            ("layer", DIELECTRIC),
            ("layer", SCHLICK),
            *_product(("lobes", "lobes_albedo", "lobes_furnace", "lobes_energy"), SURFACES),
        ),
    ),
    Issue(
        "genglsl_ggx_fit",
        "gl",
        (("lossless", DIELECTRIC),),
        HARDWARE,
        _product(("lossless", "layering", "transmission", "layer"), MICROFACETS),
    ),
    Issue(
        "genglsl_microfacet_compensation",
        "gl",
        (("value", DIELECTRIC), ("environment", DIELECTRIC)),
        HARDWARE,
        _product(("value", "environment", "integral", "shape"), MICROFACETS),
    ),
    Issue(
        "genglsl_film_half",
        "gl",
        _product(("film", "film_limit"), FILMS[2:]),
        HARDWARE,
        _product(("film_environment", "film_throughput"), FILMS[2:]),
    ),
    Issue(
        "genglsl_film_throughput",
        "gl",
        (("film_throughput", FILMS[0]),),
        HARDWARE,
        (("film_throughput", FILMS[2]), *_product(("lobes_energy",), SURFACES[:3])),
    ),
    Issue(
        "genglsl_film_choices",
        "gl",
        _product(("film", "film_limit"), FILMS[1:2]),
        HARDWARE,
        (*_product(("film", "film_limit"), FILMS[:1]), ("film_environment", FILMS[1])),
    ),
)
EMISSION_ISSUES = (
    Issue(
        "genglsl_missing_nodes",
        "gl",
        _product(
            ("implemented",),
            (
                "conical_edf",
                "measured_edf",
                "absorption_vdf",
                "mix, VDF",
                "add, VDF",
                "multiply, VDF, in2 float",
                "multiply, VDF, in2 color3",
            ),
        ),
        (*HARDWARE, "cycles"),
    ),
    Issue(
        "genglsl_medium_scattering",
        "gl",
        _product(("transmittance", "inputs"), ("anisotropic_vdf",)),
        HARDWARE,
    ),
    Issue("genglsl_emission_opacity", "gl", (("opacity", "surface, an EDF alone"),), HARDWARE),
)
HAIR_ROUGHNESS = tuple(f"chiang_hair_roughness, roughness_{lobe}" for lobe in ("R", "TT", "TRT"))
HAIR_UTILITIES = (
    *HAIR_ROUGHNESS,
    "deon_hair_absorption_from_melanin",
    "chiang_hair_absorption_from_color",
)
UTILITY_ISSUES = (
    Issue(
        "genglsl_blackbody_cold",
        "gl",
        (("output", "blackbody"),),
        HARDWARE,
        _product(("output_inputs", "output_finite"), ("blackbody",)),  # of Slang, see the page
    ),
    Issue("genglsl_black_pigment", "gl", (("output_finite", HAIR_UTILITIES[3]),), HARDWARE),
    Issue(
        "genosl_hair_constants",
        "cycles",
        _product(("output",), HAIR_UTILITIES),
        ("testrender",),
        _product(("output_inputs",), HAIR_UTILITIES),
    ),
)
ISSUES = (
    *BSDF_ISSUES,
    *EMISSION_ISSUES,
    *HAIR_ISSUES,
    *UTILITY_ISSUES,
    Issue(
        "genglsl_clamped_dot",
        "gl",
        (("value", f"{NODE} true"), ("albedo", f"{NODE} true"), ("lobe", "open_pbr_surface")),
        ("webgl", "vulkan", "wgsl", "slang", "source"),
        (
            ("flag", f"{NODE} true"),
            ("flag", f"{NODE} false"),
            *(("clamp", f"{NODE} true, {target}") for target in WITH_BSDF),
        ),
    ),
    Issue(
        "genglsl_qon_albedo_fit",
        "gl",
        (("environment", f"{NODE} false"),),
        ("webgl", "vulkan", "wgsl", "slang"),
    ),
    Issue(
        "genglsl_albedo_acos",
        "gl",
        (("environment", f"{NODE} true"),),
        ("webgl", "vulkan", "wgsl", "slang"),
    ),
    Issue(
        "genosl_dropped_flag",
        "source",
        (("source", f"{NODE} true, osl"), ("source", f"{NODE} false, osl")),
        also=("testrender",),
        implied=(
            ("closure", f"{NODE} true, osl"),
            *((check, f"{NODE} true") for check in ("value", "environment", "furnace")),
            *(
                (check, f"{NODE} {flag}")
                for check in ("flag", "inputs")
                for flag in ("true", "false")
            ),
            ("lobe", "open_pbr_surface"),
        ),
    ),
    *(
        Issue(page, "gl", (("lobe", "open_pbr_surface, thin-walled"),), ("testrender",))
        for page in ("openpbr_thin_walled", "openpbr_thin_walled_tint")
    ),
    Issue("genmdl_white_lobe", "source", (("closure", f"{NODE} true, mdl"),)),
    Issue(
        "cycles_rho_cubed",
        "cycles",
        (("value", f"{NODE} true"), ("value", f"{NODE} false"), ("flag", f"{NODE} true")),
        implied=(
            ("environment", f"{NODE} true"),
            ("flag", f"{NODE} false"),
            ("inputs", f"{NODE} true"),
            ("inputs", f"{NODE} false"),
        ),
    ),
    Issue(
        "three_materialx_roughness",
        "three",
        tuple((check, LOADED[0]) for check in ("value", "inputs")),
        implied=(
            *((check, LOADED[0]) for check in ("environment", "lambert")),
            *((check, LOADED[1]) for check in ("value", "environment", "lambert", "inputs")),
        ),
        library=OWN,
    ),
    Issue(
        "babylon_reflectance_floor",
        "babylon",
        (("value", BABYLON[0]), ("value", BABYLON[3])),
        implied=(("value", BABYLON[1]), ("value", BABYLON[2])),
        library=OWN,
    ),
    Issue(
        "babylon_flat_surroundings",
        "babylon",
        (("environment", BABYLON[0]), ("environment", BABYLON[3])),
        implied=tuple(("environment", subject) for subject in (*BABYLON[1:3], *BURLEY)),
        library=OWN,
    ),
    Issue(
        "pathtracer_webgl_retro",
        "three-gpu-pathtracer",
        tuple((check, f"{WEBGL_LOBE}, shorter wh") for check in ("value", "reciprocity")),
        library=OWN,
    ),
    Issue(
        "pathtracer_webgl_nan",
        "three-gpu-pathtracer",
        tuple((check, WEBGL_LOBE) for check in ("black", "value", "reciprocity")),
        library=OWN,
    ),
    Issue(
        "luxcore_sigma_unit",
        "luxcore",
        (
            ("value", "roughmatte, sigma in degrees"),
            ("environment", "roughmatte, sigma in degrees"),
        ),
        library=OWN,
    ),
    *(
        Issue(page, "luxcore", (("value", "disney"), ("environment", "disney")), library=OWN)
        for page in ("luxcore_disney_cosine", "luxcore_disney_roughness")
    ),
)


def with_page(result: Result) -> Result:
    """A result whose diagnosis ends with the page of the issue that explains it, if one does."""
    pages = [f"see docs/upstream/{issue.page}.md" for issue in _issues(result)]
    return replace(result, diagnosis="; ".join(filter(None, (result.diagnosis, *pages))))


def repaired(results: Sequence[Result], software: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
    """Notes on issues that are repaired, all of whose rows pass: a text and a page for each.

    Parameters
    ----------
    results : sequence of Result
    software : dict of str to str
        The versions of the packages, by name.

    Returns
    -------
    tuple of (str, str)
    """
    verdicts = {
        (result.library, result.host, result.check, result.subject): result.verdict
        for result in results
    }
    return tuple(
        (
            f"repaired in {_software_of(issue, software)}, so that its page can go",
            f"docs/upstream/{issue.page}.md",
        )
        for issue in ISSUES
        if all(verdicts.get((issue.library, issue.host, *row)) == PASSED for row in issue.rows)
    )


def _software_of(issue: Issue, software: Mapping[str, str]) -> str:
    """The software that has an issue, in words."""
    return RENDERERS.get(issue.host, f"MaterialX {software['MaterialX']}")


def _issues(result: Result) -> list[Issue]:
    """Issues that a result shows that failed or differs, if it is of the library that has them."""
    if result.verdict not in (FAILED, DIFFERS):
        return []
    return [
        issue
        for issue in ISSUES
        if result.library == issue.library
        and result.host in (issue.host, *issue.also)
        and (result.check, result.subject) in (*issue.rows, *issue.implied)
    ]
