# SPDX-License-Identifier: Apache-2.0
"""Extension of griffe: a docstring that refers to a sibling's has the sibling's text on the site.

A function refers to others in two ways. Both name a function of its module, or by the whole path.

- A paragraph: "Parameters and errors as those of `eon_brdf`. Result as that of `qon_brdf`."
- An entry of its parameters: names, and below them "As those of `eon_brdf`."
"""

import re
from collections.abc import Iterator

import griffe

SECTION = re.compile(r"^(\w[\w ]*)\n-+\n", re.MULTILINE)
WORDS = r"(?:Parameters|Result|Errors)(?:(?:, | and )(?:parameters|result|errors))*"
SENTENCE = re.compile(rf"({WORDS}) as (?:those|that) of `([\w.]+)`\.\s*")
ENTRY = re.compile(r"^(\S.*)\n +As (?:those|that) of `([\w.]+)`\.$", re.MULTILINE)
TITLES = {"parameters": "Parameters", "result": "Returns", "errors": "Raises"}
ORDER = ("", "Parameters", "Attributes", "Returns", "Yields", "Raises")  # then as they come


class Siblings(griffe.Extension):
    """Complete the docstrings of a package once it is loaded."""

    def on_package(self, *, pkg: griffe.Module, **_: object) -> None:
        """Give each function its whole docstring."""
        for function in functions(pkg):
            if function.docstring:
                function.docstring.value = complete(function)


def functions(module: griffe.Module) -> Iterator[griffe.Function]:
    """The functions that a module and the modules below it define."""
    for member in module.members.values():
        if isinstance(member, griffe.Module):
            yield from functions(member)
        elif isinstance(member, griffe.Function):
            yield member


def complete(function: griffe.Object) -> str:
    """The docstring of a function with what it takes from others."""
    parts = sections(function.docstring.value if function.docstring else "")
    for words, name in SENTENCE.findall(parts[""]):
        theirs = sections(complete(sibling(function, name)))
        titles = [
            TITLES[word] for word in re.findall(r"[a-z]{3,}", words.lower()) if word in TITLES
        ]
        parts |= {title: theirs[title] for title in titles if title in theirs}
    parts[""] = SENTENCE.sub("", parts[""]).rstrip()
    if "Parameters" in parts:
        parts["Parameters"] = ENTRY.sub(lambda match: entries(function, match), parts["Parameters"])
    titles = sorted(parts, key=lambda each: ORDER.index(each) if each in ORDER else len(ORDER))
    texts = [f"{title}\n{'-' * len(title)}\n{parts[title]}" for title in titles if title]
    return "\n\n".join([parts[""], *texts])


def sections(text: str) -> dict[str, str]:
    """Text of each section of a docstring by its title; what stands before them has none."""
    before, *rest = SECTION.split(text)
    return {"": before.rstrip()} | {
        title: body.strip("\n") for title, body in zip(rest[::2], rest[1::2], strict=True)
    }


def sibling(function: griffe.Object, name: str) -> griffe.Object:
    """The function or class of a name, in the module of another one or by its path."""
    module = function.module
    found = module.package[name.partition(".")[2]] if "." in name else module[name]
    return found.final_target if isinstance(found, griffe.Alias) else found


def entries(function: griffe.Object, match: re.Match[str]) -> str:
    """Parameters of a sibling, or attributes of a class, in the place of an entry that refers to it."""
    wanted = set(names(match[1]))
    theirs = sections(complete(sibling(function, match[2])))
    described = theirs.get("Parameters") or theirs.get("Attributes", "")
    texts = re.findall(r"^(\S.*)((?:\n+ .*)*)", described, re.MULTILINE)
    chosen = [(heading, body) for heading, body in texts if wanted & set(names(heading))]
    known = {name for heading, _ in chosen for name in names(heading)}
    if not wanted <= known:
        return match[0]
    return "\n".join(f"{only(heading, wanted)}{body}" for heading, body in chosen)


def only(heading: str, wanted: set[str]) -> str:
    """The heading of an entry without the names that are not wanted."""
    chosen = [name.strip() for name in heading.partition(" : ")[0].split(",")]
    chosen = [name for name in chosen if name.strip("*") in wanted]
    return ", ".join(chosen) + "".join(heading.partition(" : ")[1:])


def names(heading: str) -> list[str]:
    """Names of the parameters that an entry describes."""
    return [name.strip(" *") for name in heading.partition(" : ")[0].split(",")]
