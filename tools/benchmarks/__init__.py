# SPDX-License-Identifier: Apache-2.0
"""Benchmarks of eonlib and mxeon; docs/performance.md has results, goals and conclusions.

| command | what it writes | minutes |
|---|---|---|
| `python -m tools.benchmarks [GROUP ...]` | figures, goals and checks of each group, to the terminal | 16 |
| `... shaders` | EON in GLSL, per call | 0.1 |
| `... materials` | frame and first frame of generated materials, eonlib / stock | 8 |
| `... registers` | registers and cycles of these materials on an AMD GPU, by Mesa's compiler | 1 |
| `... models` | the NumPy models: values a second | 1 |
| `... command` | imports, `--help`; `mxeon check`: time and memory | 6 |
| `python -m tools.benchmarks.sampling` | the tables of docs/sampling.md, to the terminal | 2 |
| `python -m tools.benchmarks.mitsuba_pictures` | the tables of docs/mitsuba.md and of a path tracer in docs/sampling.md | 5 |
| `python -m tools.benchmarks.mutants` | which check notices each wrong library, to `out/mutants` | hours |
"""
