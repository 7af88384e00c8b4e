# SPDX-License-Identifier: Apache-2.0
"""Shader sources of a document: read and checked here, and passed to MaterialX as copies.

MaterialX opens whatever a source includes, recursively. So mxeon reads the sources of a
document itself, to any depth, and writes copies into a temporary folder. Copies only include copies
and library files, so MaterialX opens no path that a document names.
"""

import os
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from pathlib import Path

import MaterialX as mx
import MaterialX.PyMaterialXGenShader as mx_gen

from mxeon.errors import DocumentError, InputError
from mxeon.jobs.signals import temporary_folder
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.document.references import check_inside, folder, foreign_code, library_path
from mxeon.shaders.document.values import label, location
from mxeon.shaders.library_tree import decode_source, included, read_source

UNREAD = "genmdl"  # MDL's generator derives a module name from `file` and opens nothing
TOKEN = re.compile(r"\$[a-zA-Z0-9]+")  # token in an include that the generator replaces


@contextmanager
def copied_sources(
    document: mx.Document,
    context: mx_gen.GenContext,
    policy: Policy,
    tokens: Callable[[], Mapping[str, str]],
) -> Iterator["Sources"]:
    """Make the implementations of a document use copies of their sources while the block runs.

    `tokens` returns the generator's replacements for tokens in includes. DocumentError if a source
    of that target, or one that it includes, lies where the document may not name files, is not a regular
    UTF-8 text file, or exceeds a limit.
    """
    target = context.getShaderGenerator().getTarget()
    code = [] if target == UNREAD else foreign_code(document)
    files = [(each, each.getFile()) for each in code if each.hasFile()]
    with temporary_folder("mxeon-sources-") if files else nullcontext("") as copies:
        sources = Sources(document, context, policy, copies, tokens)
        try:
            targets = document.getTargetDef(target).getMatchingTargets() if files else ()
            for element, _ in files:
                used = any(mx.targetStringsMatch(element.getTarget(), each) for each in targets)
                element.setFile(sources.copy(element) if used else sources.missing())
            yield sources
        finally:
            for element, name in files:
                element.setFile(name)


class Sources:
    """Copies of the sources of one document, for one target."""

    def __init__(
        self,
        document: mx.Document,
        context: mx_gen.GenContext,
        policy: Policy,
        copies: str,
        tokens: Callable[[], Mapping[str, str]],
    ) -> None:
        self._document, self._context, self._policy = document, context, policy
        self._home, self._folder, self._tokens = folder(document), Path(copies), tokens
        self._found: dict[tuple[str, str], str] = {}  # copies by name and including folder
        self._copies: dict[str, str] = {}  # copies by the path that MaterialX would open
        self._names: dict[str, str] = {}  # the document's names of copies
        self._size = 0  # total bytes of all files
        self._functions = 0  # characters of function sources, includes counted
        self._expressions = 0  # characters of the longest expression

    def copy(self, element: mx.Implementation) -> str:
        """Path of the copy of an implementation's source; library sources keep their own path."""
        local = os.path.dirname(element.getActiveSourceUri())
        depth = 0 if element.hasFunction() else None
        return self._copy(element.getFile(), local, location(element), depth)

    def missing(self) -> str:
        """Path of a nonexistent copy, for sources that the target does not use."""
        return str(self._folder / "none.txt")

    def in_words(self, reason: str) -> str:
        """A MaterialX message with the document's names instead of the copies'."""
        for copy, name in self._names.items():
            reason = reason.replace(copy, name)
        return reason

    def check_limit(self, shaders: int, nodes: int) -> None:
        """Raise DocumentError if the document's code may be too long over all shaders."""
        inline = (each.getAttribute("sourcecode") for each in foreign_code(self._document))
        longest = max(map(len, inline), default=0)
        total = self._functions * shaders + max(self._expressions, longest) * nodes
        unit = "characters of its own code in all its shaders"
        self._policy.check_limit("text", total, f"{label(self._document)}: must have", unit)

    def _copy(self, name: str, local: str, title: str, depth: int | None) -> str:
        """Path of the copy of a file; `depth` counts nested includes, and is None for expressions."""
        if (name, local) not in self._found:
            self._found[name, local] = self._new_copy(name, local, title, depth)
            rule, unit = f"{label(self._document)}: must have", "includes in its sources"
            self._policy.check_limit("elements", len(self._found), rule, unit)
        return self._found[name, local]

    def _new_copy(self, name: str, local: str, title: str, depth: int | None) -> str:
        """Path of the copy of a file under a new name."""
        tokens = self._tokens()
        opened = TOKEN.sub(lambda token: tokens.get(token[0], token[0]), name)
        path = os.path.abspath(self._context.resolveSourceFile(opened, local).asString())
        if "\0" in path:  # the system ends the name there, MaterialX does not
            return self.missing()
        if library := library_path(path):
            return library
        if path not in self._copies:
            copy = str(self._folder / f"{len(self._copies)}.txt")
            self._copies[path], self._names[copy] = copy, name
            if os.path.lexists(path):  # MaterialX reports a missing one if used
                check_inside(path, self._home, self._policy, title)
                self._write(copy, path, depth)
        return self._copies[path]

    def _write(self, copy: str, path: str, depth: int | None) -> None:
        """Check a file and everything it includes, and write a copy that includes copies."""
        rule, title = f"{path}: must", label(self._document)
        self._policy.check_limit("includes", depth or 0, f"{rule} be included by", "files in a row")
        try:
            data = read_source(path, self._policy.size - self._size)
            self._size += len(data)
            unit = "bytes, with all sources of its document"
            self._policy.check_limit("size", self._size, f"{rule} have", unit)
            text = decode_source(data, path)
        except InputError as error:
            raise DocumentError(f"{title}: source {error}") from None
        if depth is None:
            self._expressions = max(self._expressions, len(text))
        else:
            self._functions += len(text)
            lines = text.split("\n")
            for number, line in enumerate(lines):
                if name := included(line):
                    start, end = line.index('"') + 1, line.rindex('"')
                    inner = self._copy(name, os.path.dirname(path), f"{path}: include", depth + 1)
                    lines[number] = f"{line[:start]}{inner}{line[end:]}"
            text = "\n".join(lines)
        Path(copy).write_text(text, encoding="utf-8", newline="")
