# SPDX-License-Identifier: Apache-2.0
"""Puts the pages on upstream defects into the wheel: answers and reports link to them."""

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class Pages(BuildHookInterface):
    """Adds each page."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Add the pages to a wheel; an editable one finds them in the checkout."""
        if version == "standard":
            for page in Path(self.root, "docs", "upstream").glob("*.md"):
                build_data["force_include"][str(page)] = f"mxeon/data/upstream/{page.name}"
