# SPDX-License-Identifier: Apache-2.0
"""The page of a report as one self-contained HTML file. The extra `report` must be installed."""

from collections import Counter
from collections.abc import Callable, Generator, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any, TypeAlias

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from mxeon.conformance import words
from mxeon.conformance.results import (
    DIFFERS,
    DIRECT,
    FAILED,
    NOT_RUN,
    PASSED,
    PORTRAIT,
    SHADER_FUNCTIONS,
    SOURCE,
    VISIBLE,
    Picture,
    Result,
    Run,
    Verdict,
    grouped,
    node_of,
)
from mxeon.conformance.results.quantities import Quantity
from mxeon.io.images import difference, difference_scale
from mxeon.io.srgb import pbr_neutral, srgb_encoded
from mxeon.report import in_threads, pieces
from mxeon.report.formats import causes_of, linked, nearest, vector
from mxeon.shaders.scene import STUDIO

# Maximum number of materials with embedded pictures, which take about a megabyte for each material.
# The page only links to other materials.
SHOWN_MATERIALS = 60
LARGE = 512  # pixels on a side of a studio picture
LEAST_SCALE = 1e-3  # smallest scale of a difference map: 0.1 % of white
OPEN_MATERIALS = 8  # maximum number of materials that are shown unfolded
OPEN_ROWS = 20  # maximum number of failed checks that are shown unfolded
WORST_FIRST: tuple[Verdict, ...] = (FAILED, NOT_RUN, DIFFERS, PASSED)

Place: TypeAlias = tuple[str, str]  # host and library
# Results by material (the path of a document, or PORTRAIT, and an element), host and library.
Verdicts: TypeAlias = Mapping[tuple[tuple[str, str], str, str], Result]


@dataclass(frozen=True)
class CheckResults:
    """The results of one check on one host with one library; never empty."""

    key: str
    anchor: str  # identifier of an element on the page
    results: tuple[Result, ...]

    @property
    def verdict(self) -> Verdict:
        """The worst verdict of the results."""
        return worst(self.results)

    @property
    def tables(self) -> dict[Quantity | None, list[Result]]:
        """Results grouped by quantity, worst results first."""
        results = sorted(self.results, key=lambda each: WORST_FIRST.index(each.verdict))
        return grouped(results, lambda each: each.quantity)


def worst(results: Iterable[Result]) -> Verdict:
    return min((each.verdict for each in results), key=WORST_FIRST.index)


def tally(results: Iterable[Result]) -> str:
    """Counts of verdicts, worst first: "2 failed, 1 allowed, 5 passed"."""
    verdicts = Counter(each.verdict for each in results)
    return ", ".join(
        f"{verdicts[each]} {'allowed' if each == DIFFERS else each}"
        for each in WORST_FIRST
        if verdicts[each]
    )


def checks_by_place(
    results: Iterable[Result], prefix: str = "check"
) -> dict[Place, list[CheckResults]]:
    """Group checks by host and library, in order of appearance. `prefix` begins each anchor."""
    places = grouped(results, lambda each: (each.host, each.library))
    return {
        place: [
            CheckResults(check, f"{prefix}-{column}-{row}", tuple(members))
            for row, (check, members) in enumerate(grouped(group, lambda each: each.check).items())
        ]
        for column, (place, group) in enumerate(places.items())
    }


def matrix(
    places: Mapping[Place, Sequence[CheckResults]],
) -> list[tuple[str, list[CheckResults | None]]]:
    """Rows of the table of checks: the key, and CheckResults or None by host and library."""
    columns = [{check.key: check for check in checks} for checks in places.values()]
    keys = dict.fromkeys(key for column in columns for key in column)
    return [(key, [column.get(key) for column in columns]) for key in keys]


def causes(results: Iterable[Result]) -> list[tuple[Markup, list[Result]]]:
    """Group failed checks of nodes by cause; causes with most failures come first."""
    pairs = (
        (cause, each)
        for each in results
        if each.verdict == FAILED and each.check != "picture"
        for cause in causes_of(each)
    )
    groups = grouped(pairs, lambda pair: pair[0])
    rows = [(cause, [each for _, each in group]) for cause, group in groups.items()]
    return sorted(rows, key=lambda row: -len(row[1]))


def nodes_of(results: Iterable[Result]) -> str:
    """Names of the nodes that results judge, without duplicates."""
    return ", ".join(dict.fromkeys(node_of(each.subject) for each in results))


def materials(run: Run) -> tuple[list[list[Picture]], Verdicts]:
    """The pictures of each material, and verdicts.

    Materials of documents come before portraits of nodes, and failed materials before others.
    """
    verdicts: dict[tuple[tuple[str, str], str, str], Result] = {}
    for each in run.results:
        if each.check in ("picture", "finite", *DIRECT):
            node = PORTRAIT, each.subject
            shown = node if each.check in DIRECT else (each.document, each.element)
            verdicts[shown, each.host, each.library] = each
    groups = grouped(run.pictures, lambda picture: picture.shown)
    failed = {shown for (shown, *_), each in verdicts.items() if each.verdict == FAILED}
    largest = dict.fromkeys(groups, 0.0)
    for (shown, *_), each in verdicts.items():
        if shown in largest and each.difference:
            largest[shown] = max(largest[shown], abs(each.difference.largest))
    order = sorted(
        groups,
        key=lambda shown: (is_portrait(groups[shown]), shown not in failed, -largest[shown]),
    )
    return [groups[shown] for shown in order], verdicts


def is_portrait(pictures: Sequence[Picture]) -> bool:
    """Whether pictures show a node, not a user's document."""
    return pictures[0].document == PORTRAIT


def material(verdicts: Verdicts, pictures: Sequence[Picture]) -> dict[str, Any]:
    """Data of a material for the page: a sentence per host and library, and rows of pictures."""
    # Stock MaterialX comes first, because users have stock MaterialX even without eonlib.
    pictures = sorted(pictures, key=lambda each: each.library != "stock")
    by_row = grouped(pictures, lambda each: (each.host, each.scene))
    found = {
        (each.host, each.library): verdicts.get((each.shown, each.host, each.library))
        for each in pictures
    }
    tolerances = [each.tolerance or 0.0 for each in found.values() if each]
    pairs = [_pair(each) for (_, scene), each in by_row.items() if scene == STUDIO.name]
    rows = [
        _row(each, max(tolerances, default=0.0))
        for (_, scene), each in by_row.items()
        if scene != STUDIO.name
    ]
    rows.sort(key=lambda row: -max(row["largest"], default=0.0))
    answers = []
    for place, result in found.items():
        sentence = words.look(result) if result else "no reference"
        if result and result.measured:
            sentence += f"; {words.unchecked(result.measured)}"
        answers.append((place, result, sentence))
    return {
        "document": pictures[0].document,
        "element": pictures[0].element,
        "answers": answers,
        "pair": next(iter(pairs), None),
        "rows": rows,
    }


def _pair(pictures: Sequence[Picture]) -> dict[str, Any]:
    """The first two pictures of the studio in a large size, and their relative difference."""
    figures = [
        _figure("image", title_of(one.library), "", srgb_encoded(pbr_neutral(one.image)), LARGE)
        for one in pictures[:2]
    ]
    scale = VISIBLE
    if len(figures) == 2:
        differences = np.abs(difference(*(np.asarray(one.image) for one in pictures[:2])))
        scale = max(scale, difference_scale(differences))
        pixels = pieces.difference_pixels(differences, scale)
        figures.append(_figure("difference", "Difference of the two", "", pixels, LARGE))
    return {"figures": figures, "scale": scale}


def _row(pictures: Sequence[Picture], tolerance: float) -> dict[str, Any]:
    """Figures of a scene on a host: a picture for each library, the reference, and differences.

    All difference maps have a common scale of at least the tolerance, so correct pixels are dark.
    """
    figures: list[dict[str, Any]] = []
    differences: list[tuple[Picture, NDArray[np.float64]]] = []
    reference = None
    for one in pictures:
        # For a stored run, each access to pixels reads a file, so access pixels only once.
        figures.append(_figure("image", title_of(one.library), "", srgb_encoded(one.image)))
        if one.reference is not None:
            reference = one.reference if reference is None else reference
            differences.append((one, one.difference_map()))
    if reference is not None:
        pixels = srgb_encoded(np.asarray(reference))
        judged = any(each.judged is not None for each in pictures)
        note = f"NumPy, float64{', at the compared pixels' if judged else ''}"
        figures.append(_figure("reference", "Reference", note, pixels))
    largest = [abs(one.difference.largest) for one, _ in differences if one.difference]
    scale = max([LEAST_SCALE, tolerance, *(difference_scale(values) for _, values in differences)])
    scale = max([scale, *(each for each in largest if each < 2.0 * scale)])
    for one, values in differences:
        note = words.size(one.difference) if one.difference else ""
        if one.judged is not None:
            note += f" at the {np.count_nonzero(one.judged):,} pixels that were compared"
        pixels = pieces.difference_pixels(values, scale)
        figures.append(_figure("difference", f"Difference, {one.library}", note, pixels))
    scene = words.LIGHTS.get(pictures[0].scene, pictures[0].scene)
    common = {"host": pictures[0].host, "scene": scene}
    return common | {"figures": figures, "largest": largest, "scale": scale}


def title_of(library: str) -> str:
    return "Stock MaterialX" if library == "stock" else f"With {library}"


def _figure(
    kind: str, title: str, note: str, pixels: NDArray[np.uint8], size: int = pieces.SHOWN_SIZE
) -> dict[str, Any]:
    return {"kind": kind, "title": title, "note": note, "image": pieces.picture_uri(pixels, size)}


def _is_audit(result: Result) -> bool:
    """Whether a check judges the library's functions and source text instead of nodes."""
    return result.host == SOURCE or result.subject == SHADER_FUNCTIONS


def render(run: Run, file_of: Callable[[Picture], str]) -> Generator[str, None, None]:
    """Generate a run's page in pieces; `file_of` returns the file of a picture.

    Pictures are read one by one. The page loads no files, runs only its own script, and also works
    without the script. Text from documents, shaders and hosts is escaped.
    """
    # If no document uses the inputs of a failure, the failure comes last.
    results = sorted(run.results, key=run.is_elsewhere)
    audits = [each for each in results if _is_audit(each)]
    checked = [each for each in results if not _is_audit(each)]
    places, audit = checks_by_place(checked), checks_by_place(audits, "audit")
    sections = [*places.items(), *audit.items()]
    failed_rows = sum(
        len(check.results) for _, checks in sections for check in checks if check.verdict == FAILED
    )
    pictures, verdicts = materials(run)
    shown = pictures[:SHOWN_MATERIALS]
    opened = [each for each in shown if not is_portrait(each)][:OPEN_MATERIALS] or shown[:1]
    folded = shown[len(opened) :]
    nodes = sum(map(is_portrait, folded))
    titles = []
    if len(folded) > nodes:
        titles.append(words.counted(len(folded) - nodes, "more material"))
    if nodes:
        titles.append(
            f"{words.counted(nodes, 'node')} rendered without a document, as pictures only"
        )
    filters: dict[str, Callable[..., Any]] = {
        "vector": vector,
        "linked": linked,
        "nearest": nearest,
        "tally": tally,
        "title": title_of,
        "worst": worst,
        "nodes": nodes_of,
    }
    not_run = (each for each in run.results if each.verdict == NOT_RUN)
    with in_threads(partial(material, verdicts), shown) as drawn:
        yield from pieces.generate_page(
            "mxeon.report",
            "report",
            filters,
            run=run,
            failed_rows=failed_rows,
            judged=list(
                dict.fromkeys(each.library for each in checked if each.library not in run.compared)
            ),
            sections=sections,
            located=checks_by_place(run.results),
            places=places,
            audit=audit,
            matrix=matrix(places),
            reasons=grouped(not_run, lambda each: each.reason),
            causes=[] if run.contents else causes(run.results),
            open_checks=failed_rows <= OPEN_ROWS,
            open_count=len(opened),
            folded_count=len(folded),
            folded_title=", ".join(titles),
            linked_materials=pictures[SHOWN_MATERIALS:],
            next_material=drawn.__next__,
            file_of=file_of,
            compared=[
                (name, worst(each for each in run.results if each.library == name))
                for name in run.compared
                if any(each.library == name for each in run.results)
            ],
            counted=words.counted,
            sentences=words,
            VISIBLE=VISIBLE,
            gradient=Markup(pieces.difference_gradient()),
            FAILED=FAILED,
            PASSED=PASSED,
            DIFFERS=DIFFERS,
            NOT_RUN=NOT_RUN,
        )
