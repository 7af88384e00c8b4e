# SPDX-License-Identifier: Apache-2.0
"""Updates the output of the first example in docs/research.md."""

import contextlib
import io
import re

from tools.site import DOCS, with_block

PAGE = DOCS / "research.md"


def blocks(text):
    return re.findall(r"```python\n(.*?)```", text, re.DOTALL)


def page(text):
    with contextlib.redirect_stdout(io.StringIO()) as output:
        exec(blocks(text)[0], {})
    return with_block(text, "fitted", f"```text\n{output.getvalue()}```\n")
