# SPDX-License-Identifier: Apache-2.0
"""Measures the EON paper's claims, and writes docs/paper_checked.md: `python -m tools.paper`."""

from pathlib import Path

from tools.paper.claims import inversion, models, page, sampling

PAGE = Path(__file__).resolve().parents[2] / "docs" / "paper_checked.md"
SECTIONS = (models.SECTION, sampling.SECTION, inversion.SECTION)

if __name__ == "__main__":
    PAGE.write_text(page(SECTIONS), encoding="utf-8")
