# SPDX-License-Identifier: Apache-2.0
"""Material documents: reading them (`reading`), and refusing what they may not do (`policy`)."""
