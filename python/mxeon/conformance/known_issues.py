# SPDX-License-Identifier: Apache-2.0
"""Known defects of stock MaterialX: the page of `docs/upstream/` that each failing check belongs to."""

from dataclasses import dataclass, replace

from mxeon.conformance.checks.source import WITH_BSDF
from mxeon.conformance.results import FAILED, PASSED

STOCK = "stock"
NODE = "oren_nayar_diffuse_bsdf, energy_compensation"


@dataclass(frozen=True)
class Defect:
    """A page of the ledger, and the results that show its defect.

    Attributes
    ----------
    page : str
        Its name without suffix.
    host : str
        Where it was found; "source" for generated text.
    rows : tuple of (str, str)
        Key of the check and subject of each result, all of which fail.
    also : tuple of str
        Other hosts that show it.
    implied : tuple of (str, str)
        Key and subject of other results that fail for it, on those hosts or in the text.
    """

    page: str
    host: str
    rows: tuple[tuple[str, str], ...]
    also: tuple[str, ...] = ()
    implied: tuple[tuple[str, str], ...] = ()


DEFECTS = (
    Defect(
        "genglsl_clamped_dot",
        "gl",
        (("value", f"{NODE} true"), ("albedo", f"{NODE} true"), ("lobe", "open_pbr_surface")),
        ("webgl", "vulkan", "slang", "source"),
        (
            ("flag", f"{NODE} true"),
            ("flag", f"{NODE} false"),
            *(("clamp", f"{NODE} true, {target}") for target in WITH_BSDF),
        ),
    ),
    Defect(
        "genglsl_qon_albedo_fit",
        "gl",
        (("environment", f"{NODE} false"),),
        ("webgl", "vulkan", "slang"),
    ),
    Defect("genglsl_albedo_acos", "gl", (("environment", f"{NODE} true"),), ("webgl", "vulkan")),
    Defect(
        "genosl_dropped_flag",
        "source",
        (("source", f"{NODE} true, osl"), ("source", f"{NODE} false, osl")),
    ),
    Defect("openpbr_thin_walled", "gl", (("lobe", "open_pbr_surface, thin-walled"),)),
    Defect("openpbr_thin_walled_tint", "gl", (("lobe", "open_pbr_surface, thin-walled"),)),
    Defect("genmdl_white_lobe", "source", (("tint", f"{NODE} true, mdl"),)),
    Defect(
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
)


def referred(result):
    """A result whose diagnosis ends with the page of the ledger that explains it, if one does."""
    pages = [
        f"see upstream/{defect.page}.md" for defect in _found(result) if result.verdict == FAILED
    ]
    return replace(result, diagnosis="; ".join(filter(None, (result.diagnosis, *pages))))


def repaired(results, software):
    """Notes on defects that are gone, all of whose rows pass: a text and a page for each.

    Parameters
    ----------
    results : sequence of Result
    software : dict of str to str
        The versions that were judged, by name.

    Returns
    -------
    tuple of (str, str)
    """
    verdicts = {
        (each.host, each.check, each.subject): each.verdict
        for each in results
        if each.library == STOCK
    }
    return tuple(
        (
            f"repaired in {_judged(defect, software)}, so that its page can go",
            f"upstream/{defect.page}.md",
        )
        for defect in DEFECTS
        if all(verdicts.get((defect.host, *row)) == PASSED for row in defect.rows)
    )


def _judged(defect, software):
    return f"MaterialX {software['MaterialX']}" if defect.host != "cycles" else "this Blender"


def _found(result):
    """Defects whose rows a result of the stock library is one of."""
    return [
        defect
        for defect in DEFECTS
        if result.library == STOCK
        and result.host in (defect.host, *defect.also)
        and (result.check, result.subject) in (*defect.rows, *defect.implied)
    ]
