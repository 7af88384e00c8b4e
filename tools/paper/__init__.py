# SPDX-License-Identifier: Apache-2.0
"""The claims of [Portsmouth2025], measured: the page "The paper, checked"."""
