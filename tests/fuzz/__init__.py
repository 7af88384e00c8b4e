# SPDX-License-Identifier: Apache-2.0
"""Fuzzer for forbidden effects of `mxeon`, whatever the document, the command line or the files."""
