# SPDX-License-Identifier: Apache-2.0
"""Known issues of rough diffuse nodes, of stock MaterialX and of renderers' own."""

from mxeon.conformance.checks.text.sources import WITH_BSDF
from mxeon.conformance.known_issues.issue import OWN, Issue

NODE = "oren_nayar_diffuse_bsdf, energy_compensation"
LOADED = tuple(f"{node}, MaterialXLoader" for node in ("open_pbr_surface", "standard_surface"))
BABYLON = tuple(
    f"{material}, {engine}"
    for material in ("PBRMaterial E_OREN_NAYAR", "OpenPBRMaterial")
    for engine in ("WebGL2", "WebGPU")
)
WEBGL_LOBE = "WebGLPathTracer, diffuseEval"
BURLEY = tuple(f"PBRMaterial BURLEY, {engine}" for engine in ("WebGL2", "WebGPU"))

DIFFUSE_ISSUES = (
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
