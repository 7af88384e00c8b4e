# SPDX-License-Identifier: Apache-2.0
"""Checks of documents, and pictures beside the reference's."""
