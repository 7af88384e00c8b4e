# SPDX-License-Identifier: Apache-2.0
"""Benchmarks of eonlib and mxeon; docs/performance.md has the figures, the goals and what was learned.

| command | what it writes | minutes |
|---|---|---|
| `python -m tools.benchmarks [GROUP ...]` | figures, goals and checks of each group, to the terminal | 25 |
| `... shaders` | EON and its samplers in GLSL, per call | 0.1 |
| `... sampling` | variance times time of the samplers under six lights, and in a scene | 0.1 |
| `... materials` | frame, first frame and source of generated materials, eonlib / stock | 8 |
| `... registers` | registers and cycles of the same on an AMD GPU, by Mesa's compiler | 1 |
| `... models` | the NumPy models: values a second, EON's time and memory per pair | 4 |
| `... tool` | imports, `--help`, generation against MaterialX's own calls | 0.3 |
| `... check` | `mxeon check`: time and memory | 11 |
| `python -m tools.benchmarks.sampling` | the tables of docs/sampling.md, to the terminal | 2 |
| `python -m tools.benchmarks.sampling chi-square` | 1e9 samples against the density, to the terminal | 6 |
| `python -m tools.benchmarks.mitsuba_pictures` | the tables of docs/mitsuba.md and of a path tracer in docs/sampling.md | 5 |
| `python -m tools.benchmarks.mutants` | which check notices each wrong library, to `out/mutants` | hours |
"""
