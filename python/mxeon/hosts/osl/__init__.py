# SPDX-License-Identifier: Apache-2.0
"""Generated OSL that prints the closures of a shader, for checks that need no renderer.

1. `carriers` provides OSL that turns the closures of generated text into labels.
2. OSL in Blender runs the text and prints a line for each point.
3. `trees` turns the lines into trees of arrays.
4. `mxeon.conformance.reference.closures` computes the values of a tree by the reference models.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from mxeon.errors import NotRun, ShaderError
from mxeon.hosts import base
from mxeon.hosts.cycles import process
from mxeon.hosts.osl import carriers, points
from mxeon.hosts.osl.points import Column, row
from mxeon.hosts.osl.trees import TreeRows, read_trees, whole_label
from mxeon.shaders.generation import Shader

LINE = re.compile(r"^mxeon (\d+) (\S+) (.*)$")  # matches the row of a point, a label, and a text
VERSION = "float version(float x)\n{\n    return OSL_VERSION;\n}\n"
# The global variable I of OSL points towards the surface. A macro replaces I, because a function
# that reads a global variable would not see a local variable of the same name.
VIEW = """
vector mxeon_view()
{{
    {read}
    return -view;
}}
#define I mxeon_view()
"""
TROUBLE = ("ERROR", "WARNING")  # first words of Blender's messages about errors
ROOT = "root"
SHADERS, POINTS = 8, 1 << 14  # cached shaders, and cached points per shader
VIEWED = re.compile(r"\bI\b")  # matches texts that read the view
# Statement that prints the label of a color or a closure.
PRINT = f'printf("mxeon %d {ROOT} %s\\n", MXEON_ROW, mxeon_text({{0}}));'
LAST = f"    {PRINT.format('{output}')}\n    {{output}} = 0;\n"


class OslHost(base.Host):
    """OSL in Blender, which runs a shader at each pixel of a plane."""

    name = "osl"
    target = "osl"
    language = "osl"

    def __init__(self) -> None:
        self._blender = process.Blender(self.name)
        self._labels = lru_cache(maxsize=SHADERS)(lambda text, names: dict[bytes, str]())

    def close(self) -> None:
        self._blender.close()

    def identity(self) -> base.Identity:
        osl = self._version  # starts Blender
        return base.Identity(self.name, f"{osl} in Blender {self._blender.version}", "CPU")

    @cached_property
    def _version(self) -> str:
        number = int(self.execute(VERSION, "version", 0.0)[0, 0])
        return f"OSL {number // 10000}.{number // 100 % 100}.{number % 100}"

    def trees(self, shader: Shader, wo: base.Array, inputs: base.Inputs) -> tuple[TreeRows, ...]:
        """Trees of a shader's closures, with their arguments and weights.

        `wo`, shape (N, 3), and `inputs` are as in `evaluate`. Points whose closures differ only in
        numbers share a tree. Raises ShaderError for a closure that OSL does not document.
        """
        text, columns = shader.stages["pixel"], points.columns_of(shader, inputs)
        view = Column("vector", wo)
        # Many points have equal values, because closures never read wi and rarely read wo.
        read = [*columns.values(), *([view] if VIEWED.search(text) else [])]
        values = [np.broadcast_to(each.rows, (len(wo), each.rows.shape[1])) for each in read]
        keys = [row.tobytes() for row in np.concatenate(values, axis=1)]
        known = self._labels(text, tuple(columns))
        if len(known) > POINTS:
            known.clear()
        if missing := {key: row for row, key in enumerate(keys) if key not in known}:
            rows = np.array([*missing.values()], np.intp)
            taken = {name: each.take(rows) for name, each in columns.items()}
            labels = self._run(shader, taken, view.take(rows), len(rows))
            known.update(zip(missing, labels, strict=True))
        return read_trees([known[key] for key in keys])

    def _run(
        self, shader: Shader, columns: Mapping[str, Column], view: Column, count: int
    ) -> list[str]:
        """The label of the shader's closure at each point."""
        with self._blender.temporary() as name:
            folder, place = Path(name), process.PLACE
            [read] = points.statements({"view": view}, folder / "view.tif", count, place)
            variables = columns, folder / points.IMAGE, count, place
            text = VIEW.format(read=read) + points.with_variables(shader, *variables, LAST)
            return [whole_label(each, ROOT) for each in self._printed(folder, text, count)]

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> base.Array:
        with self._blender.temporary() as name:
            place, output = (Path(name, points.IMAGE), process.PLACE), "output closure color out"
            text, count = points.call_text(source, function, arguments, *place, output, PRINT)
            rows = self._printed(Path(name), text, count)
        return np.array([row[ROOT].strip("[]").split(",") for row in rows], np.float32)

    def _printed(self, folder: Path, text: str, count: int) -> list[dict[str, str]]:
        """Lines that a shader prints at each point, by label."""
        rows: list[dict[str, str]] = [{} for _ in range(count)]
        text = f"{row(count, process.PLACE)}{carriers.prelude(text)}{text}"
        frame = process.request(process.DARK, ()) | {"body": "plane", "size": points.side(count)}
        lines = self._blender.render(folder, text, **frame)
        for line in lines:
            if line.startswith(TROUBLE) or "Assertion" in line:
                raise ShaderError(f"osl: {line.partition(', called from')[0]}")
        for match in map(LINE.match, lines):
            if match and int(match[1]) < count:
                rows[int(match[1])][match[2]] = match[3]
        if missing := sum(ROOT not in each for each in rows):
            raise NotRun(f"osl: {missing} of {count} points were not printed")
        return rows
