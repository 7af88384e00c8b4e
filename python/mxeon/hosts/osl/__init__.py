# SPDX-License-Identifier: Apache-2.0
"""OSL without a renderer: compile and run generated OSL, and print its closures.

    generated text --carriers--> labels instead of closures --Blender's OSL--> a line for each point
    --trees--> one tree of arrays --`mxeon.conformance.reference.closures`--> values by the models

This checks MaterialX's text independently of any renderer.
"""

from __future__ import annotations

import os
import re
from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from mxeon.errors import NotRun
from mxeon.hosts import base
from mxeon.hosts.osl import carriers, points
from mxeon.hosts.osl.engines import VARIABLES, Blender, Testshade
from mxeon.hosts.osl.points import Column, row
from mxeon.hosts.osl.trees import KeptTrees, TreeRows, keys_of, read_trees, whole_label, with_roots
from mxeon.shaders.generation import Shader

LINE = re.compile(r"^mxeon (\d+) (\S+) (.*)$")  # row of a point, label, text of the label
VERSION = "float version(float x)\n{\n    return OSL_VERSION;\n}\n"
# OSL's I points to the surface. A macro replaces it, since functions that read it do not see local variables.
VIEW = """
vector mxeon_view()
{{
    {read}
    return -view;
}}
#define I mxeon_view()
"""
ROOT = "root"
SHADERS = 8  # size of the cache of closures
PRINT = f'printf("mxeon %d {ROOT} %s\\n", MXEON_ROW, mxeon_text({{0}}));'


class OslHost(base.Host):
    """Blender's OSL, or the testshade that MXEON_TESTSHADE names."""

    name = "osl"
    target = "osl"
    language = "osl"

    def __init__(self) -> None:
        self._engine = Testshade() if os.environ.get(VARIABLES["testshade"]) else Blender()
        self._kept = lru_cache(maxsize=SHADERS)(lambda text, names: KeptTrees())

    def close(self) -> None:
        self._engine.close()

    def identity(self) -> base.Identity:
        return base.Identity(self.name, f"{self._version} in {self._engine.version}", "CPU")

    @cached_property
    def _version(self) -> str:
        number = int(self.execute(VERSION, "version", 0.0)[0, 0])
        return f"OSL {number // 10000}.{number // 100 % 100}.{number % 100}"

    def trees(self, shader: Shader, wo: base.Array, inputs: base.Inputs) -> tuple[TreeRows, ...]:
        """Trees of a shader's closures, with their arguments and weights.

        `wo`, shape (N, 3), and `inputs` are as in `evaluate`. Points whose closures differ only in numbers share a tree.
        ShaderError for a closure that OSL does not document.
        """
        columns, view = points.columns_of(shader, inputs), Column("vector", wo)
        keys = keys_of(shader.stages["pixel"], columns, view, len(wo))
        kept = self._kept(shader.stages["pixel"], tuple(columns))
        rows = kept.missing(keys)
        if len(rows):
            some = {name: each.some(rows) for name, each in columns.items()}
            kept.add(
                [keys[row] for row in rows], self._run(shader, some, view.some(rows), len(rows))
            )
        return kept.of(keys)

    def _run(
        self, shader: Shader, columns: Mapping[str, Column], view: Column, count: int
    ) -> tuple[TreeRows, ...]:
        """A shader's closures for each value of its variables."""
        with self._engine.folder() as name:
            folder, place = Path(name), self._engine.place
            block = points.statements(columns, folder / points.IMAGE, count, place)
            [read] = points.statements({"view": view}, folder / "view.tif", count, place)
            shown = points.with_variables(shader, block, f"    {PRINT}\n    {{0}} = 0;\n".format)
            text = VIEW.format(read=read) + points.with_header(shown, shader)
            rows = self._printed(folder, text, count)
        found = read_trees([whole_label(each, ROOT) for each in rows])
        if not self._engine.rooted:
            return found
        return tuple(replace(each, tree=with_roots(each.tree)) for each in found)

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> base.Array:
        with self._engine.folder() as name:
            place, output = (
                (Path(name, points.IMAGE), self._engine.place),
                "output closure color out",
            )
            text, count = points.call_text(source, function, arguments, *place, output, PRINT)
            rows = self._printed(Path(name), text, count)
        return np.array([row[ROOT].split() for row in rows], np.float32)

    def _printed(self, folder: Path, text: str, count: int) -> list[dict[str, str]]:
        """Lines that a shader prints at each point, by label."""
        rows: list[dict[str, str]] = [{} for _ in range(count)]
        engine = self._engine
        head = f"{row(count, engine.place)}{carriers.prelude(text, engine.carrier)}"
        lines = engine.printed(folder, f"{head}{text}", count)
        for match in map(LINE.match, lines):
            if match and int(match[1]) < count:
                rows[int(match[1])][match[2]] = match[3]
        if missing := sum(ROOT not in each for each in rows):
            raise NotRun(f"osl: {missing} of {count} points were not printed")
        return rows
