# SPDX-License-Identifier: Apache-2.0
"""The ledger: what the suite finds wrong upstream, one page each; see README.md."""
