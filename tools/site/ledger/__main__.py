# SPDX-License-Identifier: Apache-2.0
"""Write the pages of the ledger."""

from tools.site.ledger.pages import main

main()
