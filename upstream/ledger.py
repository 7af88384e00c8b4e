# SPDX-License-Identifier: Apache-2.0
"""The figures of the pages, made by the suite: `python -m upstream.ledger` writes them anew.

Each page has a block between two markers, which nothing but this program writes.
"""

import re
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import MaterialX as mx
import numpy as np

from mxeon import albedo
from mxeon.conformance.checks import CHECKS
from mxeon.conformance.ledger import DEFECTS
from mxeon.conformance.nodes import judge_subject
from mxeon.conformance.probes import PROBES
from mxeon.conformance.sources import check_sources
from mxeon.conformance.subjects import SUBJECTS
from mxeon.hosts import open_host
from mxeon.library import load_library
from mxeon.writing import write_text

FOLDER = Path(__file__).parent
BEGIN, END = "<!-- measured -->\n", "<!-- end -->\n"
HEAD = "| check | subject | measured | allowed | unit |\n|---|---|---|---|---|\n"
COLOR = np.array([0.8, 0.4, 0.1])


@dataclass(frozen=True)
class Cause:
    """Where a defect lies in MaterialX's data.

    Attributes
    ----------
    file : str
        Below the folder `libraries`.
    line : int
        Of the file, from 1.
    word : str
        Occurs there.
    """

    file: str
    line: int
    word: str


MICROFACET = "pbrlib/genglsl/lib/mx_microfacet_diffuse.glsl"
# Page -> cause, where the source is part of MaterialX's data.
CAUSES = {
    "genglsl_clamped_dot": Cause("pbrlib/genglsl/mx_oren_nayar_diffuse_bsdf.glsl", 22, "LdotV"),
    "genglsl_qon_albedo_fit": Cause(MICROFACET, 21, "dir_albedo_analytic"),
    "genglsl_albedo_acos": Cause(MICROFACET, 92, "mx_acos"),
    "genosl_dropped_flag": Cause(
        "pbrlib/genosl/pbrlib_genosl_impl.mtlx", 5, "oren_nayar_diffuse_bsdf({{normal}}"
    ),
}

THIN_WALLED = "openpbr_thin_walled"
THIN_WALLED_LOBE = "NG_open_pbr_surface_surfaceshader/subsurface_thin_walled_reflection_bsdf"
THIN_WALLED_CAUSE = Cause("bxdf/open_pbr_surface.mtlx", 140, "subsurface_thin_walled_reflection")
PRINTED_B = "pbrlib_printed_b"


def stock_path(cause):
    """The file of a cause in the MaterialX that is installed."""
    return Path(mx.getDefaultDataSearchPath().find(f"libraries/{cause.file}").asString())


def judged(host):
    """Results of the checks that show defects, of stock MaterialX on a host or on "source".

    Raises
    ------
    NotRun
        If the host cannot run here.
    """
    subjects = [subject for subject in SUBJECTS if subject.stock]
    if host == "source":
        return check_sources(subjects, "stock")
    keys = {key for defect in DEFECTS if defect.host == host for key, _ in defect.rows}
    checks = [check for check in CHECKS if check.key in keys]
    with closing(open_host(host)) as engine:
        probes = [PROBES[host](engine, subject, "stock") for subject in subjects]
        return sum((judge_subject(probe, checks) for probe in probes), ())


def shown(defect, results):
    """The results that show a defect, in the order of its rows."""
    found = {(each.check, each.subject): each for each in results}
    return [found[row] for row in defect.rows]


def block(results):
    """Results as the table of a page, with what the first is named as."""
    rows = [
        f"| {each.check} | {each.subject} "
        f"| {each.figure:.2g} | {each.tolerance:.2g} | {each.unit} |"
        for each in results
    ]
    return HEAD + "\n".join(rows) + f"\n\nThe suite says: {_rounded(results[0].diagnosis)}.\n"


def _rounded(text):
    """A diagnosis without the distances, which drivers change."""
    return re.sub(r" \([^()]*\d[^()]*\)", "", text)


def thin_walled_flag():
    """What OpenPBR's thin-walled lobe says of energy_compensation in stock MaterialX."""
    lobe = load_library("stock").getDescendant(THIN_WALLED_LOBE)
    given = lobe.getInput("energy_compensation")
    return bool(given and given.getValue())


def thin_walled_block():
    """The lobe's albedo head-on as it is, against that of the base lobe beside it."""
    qon = COLOR * albedo.qon_albedo_dir(1.0, 1.0)
    eon = albedo.eon_albedo_dir(1.0, COLOR, 1.0)
    return _quantities("albedo head-on, color 0.8 0.4 0.1, roughness 1", qon, eon)


def printed_b_block():
    """A + B s/t for a surface of slope deviation 0, lit and seen at 60 degrees from one side."""
    sine, tangent = np.sin(np.pi / 3.0), np.tan(np.pi / 3.0)
    printed = 1.0 + (1.0 - 0.45 * 0.0) * sine * tangent
    return _quantities("pi f / rho at sigma 0, both directions at 60 degrees", [printed], [1.0])


def _quantities(name, measured, expected):
    text = [" ".join(f"{each:.3f}" for each in values) for values in (measured, expected)]
    head = "| quantity | measured | expected |\n|---|---|---|\n"
    return f"{head}| {name} | {text[0]} | {text[1]} |\n"


def written(page):
    """The block that a page holds."""
    text = (FOLDER / f"{page}.md").read_text(encoding="utf-8")
    return text.split(BEGIN)[1].split(END)[0]


def main():
    """Write the blocks of all pages."""
    results = {host: judged(host) for host in dict.fromkeys(each.host for each in DEFECTS)}
    blocks = {each.page: block(shown(each, results[each.host])) for each in DEFECTS}
    blocks |= {THIN_WALLED: thin_walled_block(), PRINTED_B: printed_b_block()}
    for page, text in blocks.items():
        path = FOLDER / f"{page}.md"
        head, rest = path.read_text(encoding="utf-8").split(BEGIN)
        write_text(path, head + BEGIN + text + END + rest.split(END)[1])


if __name__ == "__main__":
    main()
