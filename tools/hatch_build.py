# SPDX-License-Identifier: Apache-2.0
"""Adds the ledger of defects to the wheel, because the package reads the ledger's pages."""

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class Pages(BuildHookInterface):
    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the pages to a standard wheel. An editable install reads pages in the checkout."""
        if version == "standard":
            for file in Path(self.root, "docs", "upstream").iterdir():
                if file.suffix in (".md", ".json"):
                    build_data["force_include"][str(file)] = f"mxeon/data/upstream/{file.name}"
