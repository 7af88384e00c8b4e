# SPDX-License-Identifier: Apache-2.0
"""Material documents. The module `reading` reads documents, and `policy` limits documents."""
