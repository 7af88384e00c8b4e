# SPDX-License-Identifier: Apache-2.0
"""Checks the shader sources of a document before MaterialX opens the sources.

MaterialX opens whatever a source includes, recursively. So mxeon first follows the includes to any
depth, and resolves each name as MaterialX does.
"""

import os
import re
from collections.abc import Callable, Mapping

import MaterialX as mx
import MaterialX.PyMaterialXGenShader as mx_gen

from mxeon.errors import DocumentError, InputError
from mxeon.shaders.document import references
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.document.values import label, location
from mxeon.shaders.library_tree import decode_source, included, read_source

UNREAD = "genmdl"  # MDL's generator derives a module name from `file` and opens nothing
TOKEN = re.compile(r"\$[a-zA-Z0-9]+")  # token in an include that the generator replaces


def check_sources(
    document: mx.Document,
    context: mx_gen.GenContext,
    policy: Policy,
    tokens: Callable[[], Mapping[str, str]],
    shaders: int,
    nodes: int,
) -> None:
    """Check a document's sources for a target, all included files, and the length of the code.

    `tokens` returns the generator's replacements for tokens in includes. `shaders` and `nodes` are
    the numbers of shaders and nodes that will be generated. Raise DocumentError if a source or an
    included file exceeds a limit, is not a regular UTF-8 text file, or lies where the document may
    not name files.
    """
    title, code = label(document), references.foreign_code(document)
    rule = f"{title}: must have"
    size = 0  # total bytes of all files
    functions = 0  # characters of function sources with their includes
    expressions = max((len(each.getAttribute("sourcecode")) for each in code), default=0)
    known: set[tuple[str, str]] = set()  # names, with the folders of the including files
    read: set[str] = set()
    target = context.getShaderGenerator().getTarget()
    code = [each for each in code if each.hasFile() and target != UNREAD]
    targets = document.getTargetDef(target).getMatchingTargets() if code else ()
    # Each entry has the name of a file, the folder of the including file, a prefix for messages,
    # and the depth of inclusion. The depth is None if the file contains an expression instead of
    # functions.
    waiting = [
        (
            each.getFile(),
            os.path.dirname(each.getActiveSourceUri()),
            location(each),
            0 if each.hasFunction() else None,
        )
        for each in reversed(code)
        if any(mx.targetStringsMatch(each.getTarget(), other) for other in targets)
    ]
    while waiting:
        name, local, prefix, depth = waiting.pop()
        if (name, local) in known:
            continue
        known.add((name, local))
        policy.check_limit("elements", len(known), rule, "includes in its sources")
        opened = TOKEN.sub(lambda token: tokens().get(token[0], token[0]), name)
        path = os.path.abspath(context.resolveSourceFile(opened, local).asString())
        path = path.partition("\0")[0]  # the operating system cuts names at a null character
        missing = not os.path.lexists(path)  # MaterialX itself reports missing files
        if path in read or missing or references.library_path(path):
            continue
        read.add(path)
        references.check_inside(path, references.folder(document), policy, prefix)
        policy.check_limit("includes", depth or 0, f"{path}: must be included by", "nested files")
        try:
            data = read_source(path, policy.size - size)
            size += len(data)
            unit = "bytes, with all sources of its document"
            policy.check_limit("size", size, f"{path}: must have", unit)
            text = decode_source(data, path)
        except InputError as error:
            raise DocumentError(f"{title}: source {error}") from None
        if depth is None:
            expressions = max(expressions, len(text))
            continue
        functions += len(text)
        waiting += [
            (inner, os.path.dirname(path), f"{path}: include", depth + 1)
            for line in reversed(text.split("\n"))
            if (inner := included(line))
        ]
    total = functions * shaders + expressions * nodes
    policy.check_limit("text", total, rule, "characters of its own code in all its shaders")
