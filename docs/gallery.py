# SPDX-License-Identifier: Apache-2.0
"""Render the materials of `examples/` and write the gallery page.

python docs/gallery.py           the pictures and gallery.md
python docs/gallery.py --page    gallery.md alone
"""

import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

DOCS = Path(__file__).resolve().parent
EXAMPLES = DOCS.parent / "examples"
PICTURES = DOCS / "images" / "gallery"
SIZE = 192  # pixels

HEAD = """<!-- Made by `python docs/gallery.py`. -->
# Gallery

Every material of the folder `examples/`, rendered with eonlib on the `gl` host: a sphere, lit from
the side by one distant light, or in white surroundings if the document is called a furnace. Below each
document is the command that renders its first material.

"""


def materials(document):
    """Names of the materials in a document, in its order."""
    return [each.get("name") for each in ElementTree.parse(document).iter("surfacematerial")]


def scene(document):
    """Name of the scene that shows a document."""
    return "furnace" if "furnace" in document.stem else "side"


def render(document, material):
    """Render one material into the folder of pictures."""
    command = [sys.executable, "-m", "mxeon", "render", str(document), "--element", material]
    command += ["--host", "gl", "--scene", scene(document), "--size", str(SIZE)]
    subprocess.run([*command, "--output", str(PICTURES / f"{material}.png")], check=True)


def section(document):
    """Heading, description, pictures and command of one document, as Markdown."""
    description = document.read_text(encoding="utf-8").splitlines()[2]
    names = materials(document)
    head = "| " + " | ".join(names) + " |\n" + "|---" * len(names) + "|\n"
    pictures = " | ".join(f"![{name}](images/gallery/{name}.png)" for name in names)
    command = f"    mxeon render examples/{document.name} --element {names[0]} "
    return (
        f"## {document.stem}\n\n{description.removeprefix('<!-- ').removesuffix(' -->')}\n\n"
        f"{head}| {pictures} |\n\n{command}--scene {scene(document)} --output {names[0]}.png\n"
    )


def page():
    """The gallery as Markdown."""
    return HEAD + "\n".join(section(each) for each in sorted(EXAMPLES.glob("*.mtlx")))


def main():
    """Write the pictures, unless `--page` asks for the page alone, and the page."""
    PICTURES.mkdir(parents=True, exist_ok=True)
    for document in () if "--page" in sys.argv else sorted(EXAMPLES.glob("*.mtlx")):
        for material in materials(document):
            render(document, material)
    (DOCS / "gallery.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
