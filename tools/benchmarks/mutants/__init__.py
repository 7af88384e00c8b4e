# SPDX-License-Identifier: Apache-2.0
"""Mutation tests: copies of eonlib with one wrong change each, and the checks that detect them."""
