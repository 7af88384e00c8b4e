# SPDX-License-Identifier: Apache-2.0
"""Conformance tests for rendering engines and for libraries of MaterialX nodes.

The package compares results of shaders with results of models, and pictures of documents with
reference pictures. The public functions are `check` in `mxeon.conformance.run` and `check_brdf` in
`mxeon.survey.callables`.

A *spec* defines input ranges, models, errors and samples for a node in one mode (`specs`). A
*backend* evaluates a spec on an engine (`backends`). A *case* is a spec on an engine with a library
(`case.Case`). A *check* is a claim about a case, with a measurement and a negative control, which
must fail (`checks`). A tolerance is the sum of the spec's error and the backend's precision.
docs/design.md describes the rest of the package.
"""
