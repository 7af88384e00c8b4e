# SPDX-License-Identifier: Apache-2.0
"""Benchmarks of eonlib and mxeon, with results and goals in docs/performance.md.

| command (`...`: as in the first row) | what it writes | minutes |
|---|---|---|
| `python -m tools.benchmarks [GROUP ...]` | figures, goals and checks of each group, to the terminal | 16 |
| `... shaders` | time of a call of EON in GLSL | 0.1 |
| `... materials` | times of first and later frames of generated materials, eonlib / stock | 8 |
| `... registers` | registers and cycles of generated materials on an AMD GPU, by Mesa's compiler | 1 |
| `... models` | values per second of the NumPy models | 1 |
| `... command` | time of imports and `--help`, time and memory of `mxeon check` | 6 |
| `python -m tools.benchmarks.sampling` | the tables of docs/sampling.md, to the terminal | 2 |
| `python -m tools.benchmarks.mitsuba_pictures` | the tables of docs/mitsuba.md, and the table of a path tracer in docs/sampling.md | 5 |
| `python -m tools.benchmarks.mutants` | for each mutant of eonlib, the check that detects the mutant, to `out/mutants` | hours |
"""
