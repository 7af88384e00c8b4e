# SPDX-License-Identifier: Apache-2.0
"""Renderers with their own materials: their engines, nodes and checks, and the page that compares them.

`mxeon.hosts` and `mxeon.conformance` name no renderer: they take `ROWS`, and from the module of a row its
`Host` and its `NODES`. `checks` and `backends` add themselves to those of `mxeon.conformance`.
"""

from mxeon.hosts import Row

ROWS = (
    Row("cycles-native", "", "mxeon.survey.cycles_native", "native"),
    Row("three", "", "mxeon.survey.browser.three", "exact"),
    Row("babylon", "", "mxeon.survey.browser.babylon", "exact"),
    Row("three-gpu-pathtracer", "", "mxeon.survey.browser.pathtracer", "facet pairs"),
    Row("mitsuba", "", "mxeon.survey.polyhedron.mitsuba", "facet pairs"),
    Row("eevee", "", "mxeon.survey.polyhedron.eevee", "coarse facets"),
)
