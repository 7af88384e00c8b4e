# SPDX-License-Identifier: Apache-2.0
"""Known issues of stock MaterialX's nodes of pbrlib beside the rough diffuse ones."""

from mxeon.conformance.known_issues.issue import HARDWARE, Issue, product

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
LAYERED_SUM = "layer, under a mix of a sum"
HAIR = "chiang_hair_bsdf"
HAIR_ISSUES = (
    Issue(
        "genglsl_hair_uniform_lobe",
        "gl",
        (("each_lobe", HAIR),),
        HARDWARE,
        product(("value", "integral"), (HAIR,)),
    ),
    Issue(
        "genglsl_hair_longitudinal",
        "gl",
        product(("narrow_lobes", "tilted_lobes"), (HAIR,)),
        HARDWARE,
        product(("value", "black", "integral", "finite"), (HAIR,)),
    ),
    Issue("genglsl_hair_roughness", "gl", (("wide_lobes", HAIR),), HARDWARE),
    Issue(
        "genglsl_hair_azimuth", "gl", (("straight_views", HAIR),), HARDWARE, (("each_lobe", HAIR),)
    ),
    Issue("genglsl_hair_grazing", "gl", (("finite", HAIR),), HARDWARE, (("value", HAIR),)),
    Issue(
        "genglsl_hair_environment",
        "gl",
        (("environment", HAIR),),
        HARDWARE,
        (("surroundings", HAIR),),
    ),
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
            *product(("lobes", "lobes_albedo"), SURFACES[:3]),
        ),
    ),
    Issue(
        "genglsl_conty_kulla_fit",
        "gl",
        (("environment", CONTY_KULLA), ("value", CONTY_KULLA)),
        HARDWARE,
        product(("layering", "layer"), (CONTY_KULLA,)),
    ),
    Issue(
        "genglsl_multiply_throughput",
        "gl",
        product(
            ("combined_throughput",),
            ("multiply, in2 float", "multiply, in2 color3", "multiply, of a sum"),
        ),
        HARDWARE,
    ),
    Issue(
        "genglsl_add_throughput",
        "gl",
        (
            ("combined_throughput", "mix, of a sum"),
            ("combined_throughput", "mix, of a layer under a sum"),
            *product(("combination", "combined_albedo", "combined_throughput"), (LAYERED_SUM,)),
        ),
        HARDWARE,
    ),
    Issue(
        "genglsl_subsurface_circle",
        "gl",
        (("value", "subsurface_bsdf"),),
        HARDWARE,
        product(("integral", "energy", "sphere"), ("subsurface_bsdf",)),
    ),
    Issue("genglsl_burley_fit", "gl", (("environment", "burley_diffuse_bsdf"),), HARDWARE),
    Issue(
        "genglsl_translucent_side",
        "gl",
        (("frame", "translucent_bsdf"),),
        HARDWARE,
        (("surroundings", "translucent_bsdf"),),
    ),
    Issue(
        "genglsl_ior_zero",
        "gl",
        (("finite", DIELECTRIC),),
        HARDWARE,
        (
            ("finite", "conductor_bsdf"),
            *product(("transmitted_finite",), TRANSMITTING[:2]),
        ),
    ),
    Issue(
        "genglsl_transmission_masking",
        "gl",
        (("transmitted", TRANSMITTING[1]), ("clear", TRANSMITTING[1])),
        HARDWARE,
        product(("transmitted", "clear"), TRANSMITTING),
    ),
    Issue(
        "genglsl_refraction_nan",
        "gl",
        (("transmitted_finite", TRANSMITTING[3]),),
        HARDWARE,
        (
            *product(("transmitted_finite",), TRANSMITTING),
            *product(("transmitted", "clear"), TRANSMITTING[2:]),
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
            *product(("lobes", "lobes_albedo", "lobes_furnace", "lobes_energy"), SURFACES),
        ),
    ),
    Issue(
        "genglsl_ggx_fit",
        "gl",
        (("lossless", DIELECTRIC),),
        HARDWARE,
        product(("lossless", "layering", "transmission", "layer"), MICROFACETS),
    ),
    Issue(
        "genglsl_microfacet_compensation",
        "gl",
        (("value", DIELECTRIC), ("environment", DIELECTRIC)),
        HARDWARE,
        (
            *product(("value", "environment", "integral", "shape"), MICROFACETS),
            *product(("film_average",), FILMS),
        ),
    ),
    Issue(
        "genglsl_film_half",
        "gl",
        product(("film", "film_limit"), FILMS[2:]),
        HARDWARE,
        product(("film_environment", "film_visible", "film_throughput"), FILMS[2:]),
    ),
    Issue(
        "genglsl_film_throughput",
        "gl",
        (("film_throughput", FILMS[0]),),
        HARDWARE,
        (("film_throughput", FILMS[2]), *product(("lobes_energy",), SURFACES[:3])),
    ),
    Issue(
        "genglsl_film_choices",
        "gl",
        product(("film", "film_limit"), FILMS[1:2]),
        HARDWARE,
        (
            *product(("film", "film_limit"), FILMS[:1]),
            *product(("film_environment", "film_visible"), FILMS[:2]),
        ),
    ),
)
EMISSION_ISSUES = (
    Issue(
        "genglsl_missing_nodes",
        "gl",
        product(
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
        product(("transmittance", "inputs"), ("anisotropic_vdf",)),
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
        product(("output_inputs", "output_finite"), ("blackbody",)),  # of Slang, see the page
    ),
    Issue("genglsl_black_pigment", "gl", (("output_finite", HAIR_UTILITIES[3]),), HARDWARE),
    Issue(
        "genosl_hair_constants",
        "cycles",
        product(("output",), HAIR_UTILITIES),
        ("testrender",),
        product(("output_inputs",), HAIR_UTILITIES),
    ),
)
