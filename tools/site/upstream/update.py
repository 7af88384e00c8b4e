# SPDX-License-Identifier: Apache-2.0
"""Measure the figures of the upstream pages: `python -m tools.site.upstream.update` rewrites them.

With names of hosts, it rewrites the pages of these, and those whose figures need no check. Each page
has a block between two markers, which only this program writes; numbers of the sentences have marks:
`tools.site.upstream.marks`.
"""

import re
import sys
from contextlib import closing, contextmanager
from functools import cache
from pathlib import Path

import MaterialX as mx
import numpy as np

from mxeon.conformance.nodes.utilities import UTILITY_SUBJECTS
from mxeon.conformance.results import SOURCE
from mxeon.conformance.results.known_issues import ISSUES, RENDERERS
from mxeon.conformance.results.known_issues.issue import STOCK
from mxeon.conformance.run.judge import Judge
from mxeon.conformance.run.plan import make_plan
from mxeon.conformance.run.selection import ALL
from mxeon.errors import NotRun
from mxeon.io.files import write_text
from mxeon.models.diffuse import albedo, formulas
from mxeon.models.diffuse import brdf as models
from mxeon.models.media import emission
from mxeon.shaders.document.policy import DEFAULT
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import OREN_NAYAR, SURFACE, document_text, input_text, node_text
from tools.site.upstream import patches
from tools.site.upstream.average_quantities import OF_AVERAGES
from tools.site.upstream.figures import FIGURES, TABLES
from tools.site.upstream.film_quantities import OF_FILMS
from tools.site.upstream.ledger import generated
from tools.site.upstream.light_quantities import light_block
from tools.site.upstream.marks import filled, wrong
from tools.site.upstream.pbr_quantities import OF_PBRLIB
from tools.site.upstream.storm_quantities import OF_STORM
from tools.site.upstream.subsurface_quantities import OF_SUBSURFACE
from tools.site.upstream.surface_quantities import OF_SURFACES
from tools.site.upstream.testrender_quantities import OF_TESTRENDER
from tools.site.upstream.transmission_quantities import OF_TRANSMISSION

FOLDER = Path(__file__).parents[3] / "docs" / "upstream"
SPECIFICATION = FOLDER.parent / "specification.md"
BEGIN, END = "<!-- measured -->\n", "<!-- end -->\n"
HEAD = "| check | subject | measured | allowed | unit |\n|---|---|---|---|---|\n"
MEASURED = 2  # column of a row's figure

# Issues whose pages have a table of checks.
CHECKED = tuple(each for each in ISSUES if each.rows)
# Pages whose figures are errors of the driver that they name.
OF_DRIVERS = ("genglsl_albedo_acos",)


def judged(host):
    """Results of the checks that show defects on a host or on "source".

    Returns
    -------
    results : list of Result
    place : str
        Device and versions with which they were measured.

    Raises
    ------
    NotRun
        If the host cannot run here.
    """
    rows = {row for issue in CHECKED if issue.host == host for row in issue.rows}
    tasks = make_plan((), () if host == SOURCE else (host,), (STOCK,), nodes=(ALL,)).tasks
    chosen = [
        each
        for each in tasks
        if each.host == host and (host == SOURCE or (each.check, each.subject) in rows)
    ]
    with closing(Judge(DEFAULT)) as judge:
        findings = [judge.work(task) for task in chosen]
    devices = [f"{each.device}, {each.version}" for each in findings[0].hosts]
    own = host in RENDERERS and host != "cycles"  # its nodes need no MaterialX
    place = ", ".join([*devices, *([] if own else [f"MaterialX {mx.__version__}"])])
    return [result for each in findings for result in each.results], place


def shown(defect, results):
    """The results that show a defect, in the order of its rows."""
    found = {(each.check, each.subject): each for each in results}
    return [found[row] for row in defect.rows]


def block(results, place):
    """The block of a page: a table of results, device and versions, and the first diagnosis."""
    rows = [
        f"| {each.check} | {each.subject} | {_figure(each)} | {each.tolerance:.2g} | {each.unit} |"
        for each in results
    ]
    text = f"Measured with {place}.\n\nThe suite says: {_rounded(results[0].diagnosis)}.\n"
    return HEAD + "\n".join(rows) + f"\n\n{text}"


def _figure(result):
    """The error of a result in print, a count with all digits."""
    return f"{result.error:.0f}" if result.unit == "values" else f"{result.error:.2g}"


def figures(text):
    """Figures of the rows of a block."""
    return [float(row.split(" | ")[MEASURED]) for row in _rows(text)]


def rows_of(text):
    """Figures of the table of a page, of checks or quantities, by row; NaN where there is no number."""
    lines = (
        text.split(BEGIN)[1].split(END)[0].split("\n\n")[0].splitlines() if BEGIN in text else []
    )
    column = MEASURED if lines and lines[0].startswith("| check") else 1
    return [_number(line.strip("| ").split(" | ")[column]) for line in lines[2:]]


def _number(cell):
    try:
        return float(cell)
    except ValueError:
        return float("nan")


def without_figures(text):
    """Rows of a block without their figures, and the diagnosis."""
    rows = [row.split(" | ") for row in _rows(text)]
    return [row[:MEASURED] + row[MEASURED + 1 :] for row in rows], text.split("\n\n")[2:]


def _rows(text):
    return text.removeprefix(HEAD).split("\n\n")[0].splitlines()


def _rounded(text):
    """A diagnosis without page and distances, which depend on the driver."""
    return re.sub(r" \([^()]*\d[^()]*\)", "", text.split("; see ")[0])


def printed_b_block():
    """A + B s/t for a surface of slope deviation 0, lit and seen at 60 degrees from one side."""
    sine, tangent = np.sin(np.pi / 3.0), np.tan(np.pi / 3.0)
    printed = 1.0 + (1.0 - 0.45 * 0.0) * sine * tangent
    return _quantities("pi f / rho at sigma 0, both directions at 60 degrees", [printed], [1.0])


def printed_angles_block():
    """QON lit and seen at 60 degrees from either side, with polar angles where azimuths belong."""
    sigma, angle = 1.0, np.pi / 3.0
    wo, wi = ([side * np.sin(angle), 0.0, np.cos(angle)] for side in (1.0, -1.0))
    a, b = formulas.qon_a(sigma), formulas.qon_b(sigma)
    printed = a + b * np.cos(angle - angle) * np.sin(angle) * np.tan(angle)
    right = np.pi * models.qon_brdf(wo, wi, [1.0], sigma)
    name = "pi f / rho at sigma 1, directions at 60 degrees on either side"
    return _quantities(name, [printed], right)


def printed_pi_block():
    """Albedo head-on of a white surface whose multiple scattering has been divided by pi."""
    single = albedo.fon_albedo_dir(1.0, 1.0)
    printed = single + (1.0 - single) / np.pi
    return _quantities("albedo head-on, reflectance 1, roughness 1", [printed], [1.0])


def dropped_normal_block():
    """Whether generated GLSL holds a normal that is a literal value of the document."""
    normal = input_text("normal", "vector3", (0.25, 0.5, 0.75))
    lobe = node_text(OREN_NAYAR, "BSDF", "lobe", normal)
    [shader] = generate(document_text(lobe + SURFACE), "glsl", library=STOCK)
    return _quantities(
        "shaders, of 1, that hold the value", [float("0.25" in shader.stages["pixel"])], [1.0]
    )


def slang_constant_block():
    """Matrices outside of functions in the Slang of a black body that are no static constants."""
    [subject] = [each for each in UTILITY_SUBJECTS if each.node == "blackbody"]
    [shader] = generate(subject.document(), "slang", library=STOCK)
    found = re.findall(r"^const float3x3 \w+ =", shader.stages["pixel"], re.MULTILINE)
    return _quantities("constants outside of functions without static", [float(len(found))], [0.0])


def edf_sides_block():
    """Factor of generalized_schlick_edf at 60 degrees from the normal, on both sides."""
    cosines = np.array([0.5, -0.5])
    printed = 1.0 - (1.0 - cosines) ** 5
    wo = np.stack([np.sqrt(0.75) + 0.0 * cosines, 0.0 * cosines, cosines], axis=-1)
    right = emission.generalized_schlick_edf(wo, [1.0], [1.0], [0.0], 5.0)[:, 0]
    return _quantities("factor at cosine 0.5 in front and -0.5 behind", printed, right)


def _quantities(name, measured, expected):
    text = [" ".join(f"{each:.3f}" for each in values) for values in (measured, expected)]
    head = "| quantity | measured | expected |\n|---|---|---|\n"
    return f"{head}| {name} | {text[0]} | {text[1]} |\n"


OF_QUANTITIES = {
    "dropped_normal": dropped_normal_block,
    "genglsl_light_scope": light_block,
    "genslang_blackbody_constant": slang_constant_block,
    "openpbr_printed_pi": printed_pi_block,
    "pbrlib_edf_sides": edf_sides_block,
    "pbrlib_printed_angles": printed_angles_block,
    "pbrlib_printed_b": printed_b_block,
    **OF_AVERAGES,
    **OF_PBRLIB,
    **OF_SUBSURFACE,
    **OF_TRANSMISSION,
    **OF_FILMS,
    **OF_SURFACES,
    **OF_STORM,
    **OF_TESTRENDER,
}


def written(page):
    """The block of a page."""
    text = (FOLDER / f"{page}.md").read_text(encoding="utf-8")
    return text.split(BEGIN)[1].split(END)[0]


def main():
    """Write the blocks of all pages, or of those that show on the named hosts; and what comes from rows."""
    for path, text in generated().items():
        write_text(path, text)
    issues = [each for each in CHECKED if not sys.argv[1:] or each.host in sys.argv[1:]]
    blocks = {}
    for host in dict.fromkeys(each.host for each in issues):
        with _where_it_runs():
            results, place = judged(host)
            shows = [each for each in issues if each.host == host]
            blocks |= {each.page: block(shown(each, results), place) for each in shows}
    for page, measure in OF_QUANTITIES.items():
        with _where_it_runs():
            blocks[page] = measure()
    for page, text in blocks.items():
        path = FOLDER / f"{page}.md"
        head, rest = path.read_text(encoding="utf-8").split(BEGIN)
        write_text(path, head + BEGIN + text + END + rest.split(END, 1)[1])
    for path in pages():
        write_text(path, remeasured(path))
    patches.main()  # whose messages have words and figures of the pages


@contextmanager
def _where_it_runs():
    """Leave a page as it is where its host cannot run, and say so."""
    try:
        yield
    except NotRun as reason:
        print(f"not run: {reason}", file=sys.stderr)


def pages():
    """Files whose sentences have numbers with marks."""
    return [*sorted(set(FOLDER.glob("*.md")) - {FOLDER / "README.md"}), SPECIFICATION]


@cache
def _figures(page):
    """The measurement of a page's figures, done once."""
    return cache(FIGURES.get(page, dict))


def wrong_numbers(path):
    """Marked numbers of a file that are not those measured here."""
    text = path.read_text(encoding="utf-8")
    return wrong(text, _figures(path.stem), rows_of(text))


def remeasured(path):
    """A file with its tables beside that of checks, and with the marked numbers of its sentences."""
    text = path.read_text(encoding="utf-8")
    for (page, name), table in TABLES.items():
        if page == path.stem:
            begin = f"<!-- measured {name} -->\n"
            head, rest = text.split(begin)
            text = head + begin + table() + END + rest.split(END, 1)[1]
    return filled(text, _figures(path.stem), rows_of(text))


if __name__ == "__main__":
    main()
