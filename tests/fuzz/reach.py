# SPDX-License-Identifier: Apache-2.0
"""Finds the attributes of a document whose text reaches generated shader source.

The document contains every kind of element. Each attribute gets a unique word, and reaches the
source if the word occurs in a shader of any target. Attributes that refer to each other are changed
together.
"""

import re
import warnings
from collections import defaultdict
from copy import deepcopy
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from xml.etree import ElementTree

import MaterialX as mx

from mxeon.errors import DocumentError, InterfaceError
from mxeon.shaders.document.words import NAMES
from mxeon.shaders.generation import TARGETS, generate
from mxeon.shaders.library import load_library
from tests.fuzz.documents import ATTRIBUTES

XI = "http://www.w3.org/2001/XInclude"
ElementTree.register_namespace("xi", XI)
EVERY = Path(__file__).with_name("every.mtlx")
POISON = "poison"
GAP = "gap00000gap"  # placeholder that is replaced by hostile text
# Hostile texts. BREAKING texts end a string or a line. MEANING texts change the meaning of code.
BREAKING = tuple(each + POISON for each in ("\n#define ", "\r", '"', "\\", '\\"', "\x7f"))
MEANING = tuple(each + POISON for each in (" ", "//", "/*", "*/", *";(),=#${-"))
MARK = re.compile(r"mark\d{5}x|77\d{5}")
QUOTED = re.compile(r'"[^"]*"')


# Attributes by which elements refer to each other, and the attribute `value`. Attributes of
# different names are tested separately.
APART = NAMES | {"name", "value"}


@dataclass(frozen=True)
class Place:
    """An attribute, as the index of an element in a document and the attribute's name."""

    number: int
    attribute: str


def documents():
    """Roots of two documents with every kind of element. The second document has no materials."""
    whole, outputs = (ElementTree.parse(EVERY).getroot() for _ in range(2))
    for kind in ("surfacematerial", "surface", "backdrop", "look", "lookgroup"):
        outputs.remove(outputs.find(kind))
    return {"materials": whole, "outputs": outputs}


def furnish(folder):
    """Create the files that the documents name, in the working folder."""
    for name in ("f/a.png", "f/c.png", "b.png"):
        path = Path(folder, name)
        path.parent.mkdir(exist_ok=True)
        path.touch()
    Path(folder, "part.mtlx").write_text('<materialx version="1.39"/>')


@cache
def attributes(root):
    """Attribute names that occur in a document, in MaterialX, or in the fuzzer."""
    kinds = [kind for kind in vars(mx).values() if isinstance(kind, type)]
    constants = {
        (each, name) for each in kinds for name in dir(each) if name.endswith("_ATTRIBUTE")
    }
    named = {getattr(kind, name) for kind, name in constants}
    used = {name for each in root.iter() for name in each.attrib}
    library = {name for each in load_library().traverseTree() for name in each.getAttributeNames()}
    return sorted(named | used | library | set(ATTRIBUTES))


def present(root):
    """Attributes that a document has, in groups of attributes that are tested together."""
    groups = defaultdict(list)
    for number, element in enumerate(root.iter()):
        for name in element.attrib:
            groups[name if name in APART else ""].append(Place(number, name))
    return tuple(groups.values())


def absent(root):
    """Attributes that a document lacks but could have, in groups that are tested together."""
    elements = list(root.iter())
    return tuple(
        [Place(number, name) for number, each in enumerate(elements) if name not in each.attrib]
        for name in attributes(root)
        if name not in APART
    )


def reached(root, groups, targets=TARGETS):
    """Attributes whose words occur in shader source, with contexts: bare, quoted or comment."""
    found = defaultdict(set)
    for places in groups:
        _search(root, places, targets, found)
    return dict(found)


def unjudged(root, found, targets=TARGETS):
    """Hostile texts that reach a shader, or that are refused without naming the element."""
    elements = list(root.iter())
    ways, alike = defaultdict(set), {}
    for place, each in found.items():
        element = elements[place.number]
        kind = element.tag, place.attribute, element.get("type")
        ways[kind] |= each
        alike[kind] = place
    wrong = []
    for kind, place in alike.items():
        written = _written(root, place)
        texts = (*BREAKING, *(() if ways[kind] == {"quoted"} else MEANING))
        for text in texts:
            document = written.replace(GAP, _escaped(text))
            if not _judged(elements[place.number], place, document, targets):
                wrong.append((kind[0], place.attribute, text))
    return wrong


def _written(root, place):
    """XML of a document in which the placeholder GAP is appended to an attribute."""
    root = deepcopy(root)
    element = list(root.iter())[place.number]
    element.set(place.attribute, element.get(place.attribute, "") + GAP)
    return ElementTree.tostring(root, encoding="unicode")


def _escaped(text):
    line = ElementTree.tostring(ElementTree.Element("x", a=text), encoding="unicode")
    return line.removeprefix('<x a="').removesuffix('" />')


def _judged(element, place, document, targets):
    """Whether hostile text reaches no source, or is refused with a line that names the element."""
    for target in targets:
        try:
            sources = _sources(document, target)
        except DocumentError as error:
            said = str(error)
            if "must give" in said:  # only this target refuses the text
                continue
            # If a file prefix is bad, the message names the file instead of the element.
            named = "file" if place.attribute == "fileprefix" else element.tag
            return named in said and "must" in said and all(map(str.isprintable, error.args))
        except ValueError:  # the hostile text made a malformed number
            continue
        except InterfaceError:  # `$` in source raises this error
            return False
        if any(POISON in source for source in sources):
            return False
    return True


def _search(root, places, targets, found):
    """Mark all `places` at once. If a target refuses the document, mark each half separately."""
    refused = []
    text, marks = _marked(root, places)
    for target in targets:
        try:
            sources = _sources(text, target)
        except DocumentError as error:
            refused.append(target)
            if "must give" not in str(error):  # every target refuses the document
                refused = list(targets)
                break
            continue
        for source in sources:
            _note(source, marks, found)
    if refused and len(places) > 1:
        half = len(places) // 2
        _search(root, places[:half], refused, found)
        _search(root, places[half:], refused, found)


def _sources(document, target):
    with warnings.catch_warnings(action="ignore"):
        shaders = generate(document, target)
    return [source for each in shaders for source in each.stages.values()]


def _note(source, marks, found):
    for line in source.splitlines():
        if "mark" not in line and "77" not in line:  # a fast test before the regular expression
            continue
        for mark in MARK.finditer(line):
            before = line[: mark.start()]
            place = marks.get(mark[0])
            if place:
                found[place].add(_context(before))


def _context(before):
    """Context of a mark (quoted, comment or bare), given the preceding text of the line."""
    if "//" in QUOTED.sub("", before):
        return "comment"
    return "quoted" if before.count('"') % 2 else "bare"


def _marked(root, places):
    """XML of a document with a mark in each attribute in `places`, and the attributes by mark."""
    root, marks, aliases = deepcopy(root), {}, {}
    elements = list(root.iter())
    for place in places:
        element = elements[place.number]
        old = element.get(place.attribute, "")
        new, mark = _word(old, len(marks), place)
        marks[mark] = place
        element.set(place.attribute, new)
        if place.attribute in ("name", "node"):
            aliases[old] = new
    for element in elements:
        for name, value in element.attrib.items():
            element.set(name, aliases.get(value, value) if value else value)
        element.tag = aliases.get(element.tag, element.tag)
    return ElementTree.tostring(root, encoding="unicode"), marks


def _word(old, number, place):
    """New value of the same kind as the old value, and the mark that the new value contains."""
    if old.strip().isdigit():
        return f"77{number:05}", f"77{number:05}"
    mark = f"mark{number:05}x"
    return (re.sub(r"\bw\b", mark, old), mark) if re.search(r"\bw\b", old) else (mark, mark)
