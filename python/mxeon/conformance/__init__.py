# SPDX-License-Identifier: Apache-2.0
"""Conformance: hosts and libraries judged by the table of checks, documents by their pictures.

The only package that sees both chains, the shaders and the models. The public functions are
`check` (`mxeon.conformance.run`), `check_brdf` and `brdf_test` (`mxeon.survey.callables`).

A *spec* is what a node in one mode is judged by: its inputs and their ranges, models, errors and samples (`specs`).
A *backend* is a way of asking an engine (`backends`), a *case* a spec on an engine with a library (`case.Case`), and a
*check* a claim about a case, what it measures, and a control that it has to fail (`checks`). A tolerance is the spec's
error plus the backend's precision. docs/design.md says where the rest stands.
"""
