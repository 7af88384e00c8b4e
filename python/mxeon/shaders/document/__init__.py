# SPDX-License-Identifier: Apache-2.0
"""Material documents: `reading` reads them, `policy` limits them."""
