# SPDX-License-Identifier: Apache-2.0
"""What makes the pages of docs/: `python -m tools.site` writes all that need no engine."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"


def with_block(text: str, name: str, made: str) -> str:
    """A page with other text between the comments NAME and end."""
    block = re.compile(rf"(<!-- {name} -->\n).*?(<!-- end -->)", re.DOTALL)
    return block.sub(lambda found: found[1] + made + found[2], text)
