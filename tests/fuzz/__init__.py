# SPDX-License-Identifier: Apache-2.0
"""Mutated documents and command lines, and what `mxeon` must never do with them.

    python -m tests.fuzz [--cases N] [--seed S] [--case NUMBER]

A case is made from a seed and a number alone, so any can be tried again.
"""
