# SPDX-License-Identifier: Apache-2.0
"""Conformance: hosts and libraries judged by the table of checks, documents by their pictures.

The only package that sees both chains, the shaders and the models. The public functions are
`check` (`mxeon.conformance.run`), `check_brdf` and `brdf_test` (`mxeon.conformance.callables`).
"""
