# SPDX-License-Identifier: Apache-2.0
"""Values of a node on a host, over batches of pairs, by what the host can show."""
