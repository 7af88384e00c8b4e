# SPDX-License-Identifier: Apache-2.0
"""Material documents: read by `reading`, and limited by `policy`."""
