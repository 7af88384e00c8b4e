# SPDX-License-Identifier: Apache-2.0
"""Fuzzer that searches for documents, command lines and files with which `mxeon` does harm."""
