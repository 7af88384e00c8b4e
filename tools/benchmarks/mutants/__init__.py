# SPDX-License-Identifier: Apache-2.0
"""Mutation tests, which run the checks on copies of eonlib that have one wrong change each."""
