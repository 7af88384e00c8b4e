# SPDX-License-Identifier: Apache-2.0
"""Fuzzer for effects that `mxeon` must never have, with any document, command line or file."""
