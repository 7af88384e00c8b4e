# SPDX-License-Identifier: Apache-2.0
"""Runs MaterialX's tests with the stock libraries, and with eonlib loaded before these libraries.

python -m tools.materialx_suite CHECKOUT BUILD WORK [NAME=VALUE ...]

CHECKOUT is a clone of MaterialX in the version of the installed package. BUILD is a build of the
clone with MATERIALX_BUILD_TESTS and the GLSL renderer. CHECKOUT and BUILD stay unchanged, because
each library gets a folder in WORK with links. NAME=VALUE changes an option of the suite. For OpenGL
on a CPU, renderGeometry=dome.obj selects half a sphere of 60 faces. Results in WORK are reused, so
a second call only writes docs/materialx_suite.md and the pictures of that page.
"""

import math
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import MaterialX as mx
import numpy as np
from numpy.typing import NDArray
from PIL import Image

from mxeon.conformance.results import VISIBLE
from mxeon.io.images import difference
from mxeon.io.srgb import srgb_decoded
from mxeon.shaders.library import SOURCE_FOLDERS, documents_folder, source_folder
from tools.site import DOCS, in_percent

PAGE, PICTURES = DOCS / "materialx_suite.md", DOCS / "images" / "suite"
OPTIONS = "resources/Materials/TestSuite/_options.mtlx"
DOME = "dome.obj"
NOTE = " (half a sphere of 60 faces, whose normals turn away from the viewer at the rim)"
STOCK, EONLIB, RENDER_TEST = "stock", "eonlib", "Render: GLSL TestSuite"
SIZE, QUALITY = 128, 80  # width of a tile in pixels, and WebP quality
HEAD = """<!-- Made by `python -m tools.materialx_suite`. -->
# MaterialX's own test suite with eonlib

The C++ tests of MaterialX {version} on its own documents, with its libraries as published (*stock*) and with eonlib
loaded before them:

| failed | stock | eonlib |
|---|---|---|
| C++ test cases | {cases} |
| pictures of the C++ render test | {blank} |

- Failed with both: {both}.
- Failed with eonlib alone: {new}.
- Implementations of eonlib that no document of the suite uses: {untested}. With its option `checkImplCount`, the suite's
  tests of generated GLSL fail if there are any. They cannot notice [nodes that have no
  implementation](upstream/genglsl_missing_nodes.md), like all of these but `eon_diffuse_bsdf` in stock GLSL.

Of {drawn} pictures, {visible} change by more than 1 % of white somewhere: those [below](#pictures-that-change). The suite writes eight bits, so brighter values
are cut at white, and one step near white is 0.9 %. Options of the suite that were changed: {options}. Files
that the checkout lacked, without which some tests fail: {absent}.

To make this page from your checkout and build, which stay as they are:

    python -m tools.materialx_suite CHECKOUT BUILD WORK

## Pictures that change

They change because of defects of MaterialX's shaders that eonlib's do not have; [the ledger](upstream/README.md) lists them by
node. A change is right if the node then agrees with a float64 reference: [Results](results.md) judges each node, [the
wall](wall.md) shows materials, and [`mxeon check`](check.md#materialxs-test-suite) judges these documents.

Stock is on the left, eonlib on the right.

<div class="wall pairs">
{figures}</div>

*Changed* is the share of a picture's pixels that change by more than 1 % of white.

| document: element | largest change | changed |
|---|---|---|
{lines}"""

Codes = NDArray[np.uint8]


def slug(text: str) -> str:
    return re.sub(r"\W+", "_", text)


def change(stock: Codes, eonlib: Codes) -> tuple[float, float]:
    """Largest signed change of a picture, relative to white, and fraction of changed pixels."""
    changed = difference(srgb_decoded(eonlib / 255.0), srgb_decoded(stock / 255.0))
    largest = changed.flat[np.abs(changed).argmax()]
    return float(largest), float(np.mean(np.abs(changed) > VISIBLE))


def stage(folder: Path, checkout: Path, build: Path) -> None:
    """Create a folder in which the suite runs. The folder has the name of the tested library."""
    if folder.exists():
        return
    for name in ("libraries", "resources"):
        shutil.copytree(checkout / name, folder / name, copy_function=os.symlink)
    (folder / OPTIONS).unlink()  # a link, which `run_tests` replaces by a file
    (folder / "bin").mkdir()
    shutil.copy(build / "bin" / "MaterialXTest", folder / "bin")  # reads data from the folder
    # MaterialX reads files before subfolders, so documents of eonlib take precedence.
    for path in documents_folder().rglob("*.mtlx") if folder.name == EONLIB else ():
        (folder / "libraries" / path.name).symlink_to(path)
    for name in SOURCE_FOLDERS:  # needed, because documents refer to "../../genglsl"
        if not (folder.parent / name).exists():
            (folder.parent / name).symlink_to(source_folder(EONLIB) / name)


def option_text(value: str) -> str:
    """Short text for the value of an option, such as "b/c.hdr" for "a/b/c.hdr"."""
    names = ["/".join(Path(each.strip()).parts[-2:]) for each in value.split(",")]
    documents = f"{len(names)} documents" if names[0].endswith(".mtlx") else ", ".join(names)
    return documents + NOTE * (names[0] == DOME)


def write_dome(path: Path) -> None:
    """Write half a sphere as OBJ, with 60 faces instead of 3600 for faster software rendering."""
    rings, sectors = 5, 12
    lines = []
    for ring, sector in np.ndindex(rings + 1, sectors + 1):
        theta, phi = 0.999 * ring / rings * math.pi / 2, sector / sectors * math.tau
        x, y, z = math.sin(theta) * math.cos(phi), math.sin(theta) * math.sin(phi), math.cos(theta)
        u, v = math.atan2(-x, -z) / math.tau % 1.0, math.acos(-y) / math.pi
        lines += [f"v {x:f} {y:f} {z:f}", f"vt {u:f} {v:f}", f"vn {x:f} {y:f} {z:f}"]
    for ring, sector in np.ndindex(rings, sectors):
        first = ring * (sectors + 1) + sector + 1
        face = [first, first + sectors + 1, first + sectors + 2, first + 1][: 4 if ring else 3]
        lines.append(" ".join(["f", *(f"{each}/{each}/{each}" for each in face)]))
    path.write_text("\n".join(lines) + "\n")


def set_options(suite: mx.Document, options: dict[str, str]) -> None:
    for name, value in options.items():
        suite.getNodeDef("TestSuiteOptions").getInput(name).setValueString(value)


def run_tests(folder: Path, suite: mx.Document, case: str) -> None:
    name = slug(case)
    if (folder / f"{name}.xml").exists():
        return
    set_options(suite, {"outputDirectory": str(folder / name)})
    mx.writeToXmlFile(suite, str(folder / OPTIONS))
    program = [str(folder / "bin" / "MaterialXTest"), case, "-r", "xml", "-o", "unfinished"]
    with (folder / f"{name}.txt").open("w") as printed:
        subprocess.run(program, cwd=folder, stdout=printed, stderr=printed)
    (folder / "unfinished").replace(folder / f"{name}.xml")


def pictures(folder: Path) -> dict[str, Path]:
    """Paths of all pictures of the render test, by document and element."""
    out = folder / slug(RENDER_TEST)
    return {
        f"{shader.relative_to(out).parts[0]}: {name}": shader.with_name(f"{name}_glsl.png")
        for shader in out.rglob("*_ps.glsl")
        for name in [shader.stem.removesuffix("_ps")]
    }


def codes(picture: Path) -> Codes:
    return np.asarray(Image.open(picture).convert("RGB"))


def failed_tests(folder: Path) -> dict[str, bool]:
    """Whether each C++ test case failed, by name."""
    return {
        case.attrib["name"]: case.find("OverallResult[@success='true']") is None
        for path in folder.glob("*.xml")
        for case in ElementTree.parse(path).getroot().iter("TestCase")
    }


def untested(folder: Path) -> list[str]:
    """Implementations that no document of the suite uses, according to the log of a test."""
    log = folder / slug(f"~{RENDER_TEST}") / "genglsl_glsl_generate_test.txt"
    return re.findall(r"^\t(\w+)$", log.read_text().partition("Untested: ")[2], re.MULTILINE)


def main(checkout: Path, build: Path, work: Path, options: dict[str, str]) -> None:
    suite = mx.createDocument()
    mx.readFromXmlFile(suite, str(checkout / OPTIONS))
    set_options(suite, options)
    if options.get("renderGeometry") == DOME:
        work.mkdir(exist_ok=True)
        write_dome(work / DOME)
        set_options(suite, {"renderGeometry": str(work / DOME)})
    for name in (STOCK, EONLIB):
        stage(work / name, checkout, build)
        for case in (RENDER_TEST, f"~{RENDER_TEST}"):
            run_tests(work / name, suite, case)
    before, after = (pictures(work / name) for name in (STOCK, EONLIB))
    drawn = [e for e in before if e in after and before[e].exists() and after[e].exists()]
    changes = {each: change(codes(before[each]), codes(after[each])) for each in drawn}
    visible = [each for each in drawn if abs(changes[each][0]) > VISIBLE]

    shutil.rmtree(PICTURES, ignore_errors=True)
    PICTURES.mkdir(parents=True)
    figures, lines = "", ""
    for each in sorted(visible, key=lambda each: (-abs(changes[each][0]), each)):
        largest, share = map(in_percent, changes[each])
        lines += f"| {each} | {largest} | {share.removeprefix('+')} |\n"
        file = f"{slug(each)}.webp"
        pair = np.concatenate([codes(before[each]), codes(after[each])], axis=1)
        tile = Image.fromarray(pair).resize((2 * SIZE, SIZE))
        tile.save(PICTURES / file, quality=QUALITY, method=6)
        figures += (
            f'<figure><img src="images/suite/{file}" alt="stock and eonlib">'
            f"<figcaption>{each}</figcaption></figure>\n"
        )
    tests = {name: failed_tests(work / name) for name in (STOCK, EONLIB)}
    failed = {name: [each for each, value in tests[name].items() if value] for name in tests}
    cases = (f"{len(failed[name])} of {len(tests[name])}" for name in tests)
    blank = (
        f"{sum(not path.exists() for path in paths.values())} of {len(paths)}"
        for paths in (before, after)
    )
    new = [each for each in failed[EONLIB] if each not in failed[STOCK]]
    git = ["git", "-C", str(checkout), "ls-files", "--deleted"]
    absent = subprocess.run(git, capture_output=True, text=True).stdout.split()
    PAGE.write_text(
        HEAD.format(
            version=mx.getVersionString(),
            cases=" | ".join(cases),
            blank=" | ".join(blank),
            drawn=len(drawn),
            visible=len(visible),
            both="; ".join(failed[STOCK]) or "nothing",
            new="; ".join(new) or "nothing",
            untested=", ".join(f"`{each}`" for each in untested(work / EONLIB)) or "none",
            figures=figures,
            lines=lines,
            options="; ".join(f"`{name}` {option_text(value)}" for name, value in options.items())
            or "none",
            absent=", ".join(Path(each).name for each in absent) or "none",
        ),
        encoding="utf-8",
    )


if __name__ == "__main__":
    from mxeon.hosts.materialx.worker import open_display

    open_display()
    folders, chosen = sys.argv[1:4], sys.argv[4:]
    main(*(Path(each).resolve() for each in folders), dict(each.split("=", 1) for each in chosen))
