# SPDX-License-Identifier: Apache-2.0
"""Marks of the pages: what puts a number of their sentences there.

A mark is a comment directly behind a number, which no reader of the built page sees:

    0.11<!--color82-->       the figure of this name, measured by the function of the page in `figures.py`
    0.061<!--row 1-->        the figure in a row of the page's table of checks
    `file.glsl:59`<!--at TEXT-->, line 59<!--at TEXT-->
                             the line of the file named last that alone holds the text; `TEXT #2` is
                             the second of the lines that hold it
    0.2<!--given-->          a value that was chosen: an input, or a range of inputs
    3.5<!--text-->           a number printed in a specification, a paper or a thread that the page names
    1000<!--source-->        a number that stands in the source of the program that the page is about
    24<!--command-->         printed by the command that the page names
    38<!--recorded-->        measured with a program or by hand at the version that the page names; no
                             command of this repository repeats it

`python -m tools.site.upstream.update` rewrites numbers of the first three kinds, and
`tests/test_upstream.py` fails where one of them is another, or where a number has no mark.
"""

import re
from collections import Counter
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path

import MaterialX as mx

from mxeon.errors import NotRun
from mxeon.hosts.browser import packages_folder

NUMBER = r"-?\d+(?:\.\d+)?(?:e-?\d+)?"
MARK = re.compile(rf"({NUMBER})(`?)<!--([^>\n]+?)-->( %)?")
ROUNDING = 1e-3  # units
DECLARED = ("given", "text", "source", "command", "recorded")
SOURCE = re.compile(r"[\w@/.-]+\.(?:glsl(?:\.js)?|mtlx|osl|js|h)(?=[:`])")
MODULES = packages_folder() / "node_modules"
LIBRARIES = Path(mx.getDefaultDataSearchPath().find("libraries").asString())
CYCLES = Path(__file__).parents[3] / ".venv-cycles"
# Files that pages name: the beginning of the name, the root, and the folder that takes its place there.
ROOTS = (
    ("three/examples/", MODULES, "three/examples/"),
    ("Shaders", MODULES, "@babylonjs/core/Shaders"),
    ("src/shader/", MODULES, "three-gpu-pathtracer/src/shader/"),
    (
        "intern/cycles/kernel/",
        CYCLES,
        "lib/*/site-packages/bpy/*/scripts/addons_core/cycles/source/kernel/",
    ),
)


def source_path(name: str) -> Path:
    """The installed file that a page names, in part or whole.

    Raises
    ------
    NotRun
        If its program is not installed.
    FileNotFoundError
        If not exactly one of its files has the name.
    """
    roots = [
        (root, f"{folder}{name[len(start) :]}")
        for start, root, folder in ROOTS
        if name.startswith(start)
    ]
    root, pattern = (*roots, (LIBRARIES, f"**/{name.removeprefix('libraries/')}"))[0]
    if not root.is_dir():
        raise NotRun(f"no folder {root}")
    found = list(root.glob(pattern))
    if len(found) != 1 or not found[0].is_file():
        raise FileNotFoundError(f"{name} must be one installed file; found {len(found)}")
    return found[0]


@cache
def line_of(name: str, mark: str) -> int:
    """The number of the line of a file that a mark `at` asks for, from 1.

    Raises
    ------
    ValueError
        If not exactly one line holds the text, or fewer than its ordinal.
    """
    text, _, ordinal = mark.partition(" #")
    lines = source_path(name).read_text(encoding="utf-8").splitlines()
    found = [number for number, line in enumerate(lines, 1) if text in line]
    if ordinal and len(found) >= int(ordinal):
        return found[int(ordinal) - 1]
    if ordinal or len(found) != 1:
        raise ValueError(f"one line of {name} must hold {text!r}; found {found}")
    return found[0]


def as_printed(value: float, like: str) -> str:
    """A number with the digits of another one."""
    if "e" in like:
        mantissa = like.split("e")[0]
        digits, power = f"{value:.{_decimals(mantissa)}e}".split("e")
        return f"{digits}e{int(power)}"
    if "." in like:
        return f"{value:.{_decimals(like)}f}"
    return f"{float(f'{value:.{_significant(like) - 1}e}'):.0f}"


def _decimals(text: str) -> int:
    return len(text.partition(".")[2])


def _significant(integer: str) -> int:
    """Digits of an integer without the zeros at its end, which may be none of the measurement."""
    return len(integer.lstrip("-").rstrip("0")) or 1


def filled(text: str, figures: Callable[[], Mapping[str, float]], rows: list[float]) -> str:
    """A page with the numbers that are measured, or found in files.

    Parameters
    ----------
    text : str
        The page.
    figures : callable
        Measures the figures of the page by name; called where a mark asks for one.
    rows : list of float
        Figures of the page's table.
    """

    def number(found: re.Match[str]) -> str:
        if found[3] in DECLARED:
            return found[0]
        value = _value(found, figures, rows)
        printed = str(value) if isinstance(value, int) else as_printed(value, found[1])
        return found[0].replace(found[1], printed, 1)

    return MARK.sub(number, text)


def wrong(text: str, figures: Callable[[], Mapping[str, float]], rows: list[float]) -> list[str]:
    """Marks of a page whose numbers are not those measured here, rounded, or not the lines of files."""
    return [
        f"{found[0]} is {value:.6g}"
        for found in MARK.finditer(text)
        if found[3] not in DECLARED
        for value in [_value(found, figures, rows)]
        if abs(float(found[1]) - value) > (0.0 if isinstance(value, int) else _half_unit(found[1]))
    ]


def _value(
    found: re.Match[str], figures: Callable[[], Mapping[str, float]], rows: list[float]
) -> float:
    """What belongs in the place of a mark's number; a line is an integer."""
    mark, scale = found[3], 100.0 if found[4] else 1.0
    if mark.startswith("at "):
        name = SOURCE.findall(found.string[: found.start()])[-1]
        return line_of(name, mark.removeprefix("at "))
    if mark.startswith("row "):
        return scale * rows[int(mark.removeprefix("row ")) - 1]
    return float(scale * figures()[mark])


def _half_unit(printed: str) -> float:
    """Half a unit of the last digit of a number, and what libraries of sines part by."""
    mantissa, _, power = printed.partition("e")
    unit = 10.0 ** -_decimals(mantissa)
    if "." not in mantissa and not power:
        unit = 10.0 ** (len(mantissa.lstrip("-")) - _significant(mantissa))
    return 0.5 * unit * 10.0 ** int(power or 0) * (1.0 + ROUNDING)


def kinds(text: str) -> Counter[str]:
    """How many numbers of a page have a mark of each kind."""
    marks = [found[3] for found in MARK.finditer(text)]
    names = [each.split()[0] for each in marks]
    return Counter(each if each in (*DECLARED, "row", "at") else "measured" for each in names)


# What needs no mark: code and formulas, names and versions, and limits.
BLOCK = re.compile(r"<!-- measured(?: \w+)? -->\n.*?<!-- end -->", re.DOTALL)
NO_PROSE = (
    BLOCK,
    re.compile(rf"{NUMBER}(?=`?<!--[^>\n]+?-->)"),  # with a mark
    re.compile(r"<!--.*?-->", re.DOTALL),
    re.compile(r"^    .*$", re.MULTILINE),
    re.compile(r"`[^`]*`"),
    re.compile(r"\]\([^)]*\)"),
    re.compile(r"\[[A-Z]\w+\d{4}\]"),
    re.compile(r"\b(?:June|July|March|May) \d+, (?:19|20)\d\d|\b(?:19|20)\d\d\b"),
    re.compile(r"\d+\.\d+\.\d+"),
    re.compile(  # names with a number
        r"(?:#|requests? |[Ii]ssues? |Rec\. |CIE |MDL |Eq\. |slangpy |revision )\(?\d[\d.]*"
        r"(?: and \(?\d[\d.]*)?"
    ),
    re.compile(  # values of inputs
        r"(?:roughness|alpha|sigma|mu|color\d*|reflectance|index|ior|exponent|anisotropy|radius|"
        r"variance|cosine|weight|temperature|g|melanin_\w+|cosines|colors|anisotropies) "
        rf"(?:of |from |at |above |below |up to |at least )?{NUMBER}"
        rf"(?:(?:,| and| or| to) {NUMBER})*"
    ),
    re.compile(r"[\w)]\^\(?-?\d+|\b\d+/\d+\b|\b\d+ ?/ ?\(?\d*|pi/\d|\(\d+ [a-z]"),  # formulas
)


def unmarked(text: str, rows: list[float]) -> list[str]:
    """Numbers of a page's sentences that neither have a mark nor are a name, an input or 0, 1 or 2.

    A number of the title has a mark if one of the page's numbers with a mark, or of its table, rounds
    to it.
    """
    held = [float(found[1]) for found in MARK.finditer(text)] + rows
    for each in NO_PROSE:
        text = each.sub(" ", text)
    title, _, sentences = text.partition("\n")
    known = {as_printed(each, number) for number in _numbers(title) for each in held}
    return [each for each in _numbers(title) if each not in known] + _numbers(sentences)


def _numbers(text: str) -> list[str]:
    numbers = re.findall(rf"(?<![\w.#])(?<![A-Za-z]-){NUMBER}(?![\w/]|\.\d)", text)
    return [each for each in numbers if each not in ("0", "1", "2", "-1")]
