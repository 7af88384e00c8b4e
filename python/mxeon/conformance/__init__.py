# SPDX-License-Identifier: Apache-2.0
"""Conformance: hosts and libraries judged by the table of checks, documents by their pictures.

The only package that sees both chains, the shaders and the models. The public functions are
`check` (`mxeon.conformance.run`), `check_brdf` (`mxeon.survey.callables`).

A *spec* defines how a node in one mode is judged: its inputs with their ranges, models, errors and
samples (`specs`). A *backend* is a way of evaluating a spec on an engine (`backends`), a *case* is
a spec on an engine with a library (`case.Case`), and a *check* is a claim about a case, with a
measurement and a control that must fail (`checks`). A tolerance is the spec's error plus the
backend's precision. docs/design.md describes the rest.
"""
