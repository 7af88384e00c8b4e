# SPDX-License-Identifier: Apache-2.0
"""Conformance: hosts and libraries judged by the table of checks, documents by their pictures.

The only package that sees both chains, the shaders and the models. The public functions are
`check` (`mxeon.conformance.run`), `check_brdf` and `brdf_test` (`mxeon.conformance.callables`).

A *subject* is what is judged: a node in one mode, with its inputs and their ranges (`nodes`). A *probe* is a
subject on a host: its samples, the host's values for them and the expected ones (`probes.probe.Probe`). A
*check* is a claim about a probe, how it is measured, and a control that it has to fail (`checks`). Its bound is
the tolerance of its quantity in the probe's row of `accuracy.accuracy.ACCURACY`, with a derivation. docs/design.md
says where the rest stands.
"""
