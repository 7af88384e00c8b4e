# SPDX-License-Identifier: Apache-2.0
"""Write what the first example of the page for researchers prints.

python tools/site/research.py
"""

import contextlib
import io
import re
from pathlib import Path

from mxeon.io.files import write_text

PAGE = Path(__file__).resolve().parents[2] / "docs" / "research.md"
BLOCK = re.compile(r"(<!-- fitted -->\n).*?(<!-- end -->)", re.DOTALL)


def blocks(text):
    """Blocks of Python, in order."""
    return re.findall(r"```python\n(.*?)```", text, re.DOTALL)


def printed(text):
    """What the first block prints."""
    with contextlib.redirect_stdout(io.StringIO()) as output:
        exec(blocks(text)[0], {})
    return output.getvalue()


def page(text):
    """The page with that output as it is now."""
    return BLOCK.sub(lambda match: f"{match[1]}```text\n{printed(text)}```\n{match[2]}", text)


if __name__ == "__main__":
    write_text(PAGE, page(PAGE.read_text(encoding="utf-8")))
