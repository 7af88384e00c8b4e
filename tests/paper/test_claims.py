# SPDX-License-Identifier: Apache-2.0
"""The page on claims marks exactly the claims as refuted that the measurements refute."""

import re

import pytest

from tools.paper.__main__ import SECTIONS
from tools.paper.claims import page, sampling

# Claims of the paper that the measurements refute.
REFUTED = {
    "with it the albedo stays at most 1",
    "its exact albedo is exact in float32, to 1e-6",
    "the variance of cosine sampling has a peak",
    "no sample below the horizon",
    "defined for u1 in [0, 1] and r in [0, 1]",
    "within 0.3 %",
}


@pytest.mark.whole
def test_measurements_refute_these_claims_and_no_others(monkeypatch):
    monkeypatch.setattr(sampling, "DEGREES", sampling.DEGREES[[*range(0, 30, 2), -2, -1]])
    row = re.compile(r"^\| [^|]* \| ([^|]*) \| [^|]* \| [^|]* \| \*\*fails\*\* \|$", re.MULTILINE)
    assert set(row.findall(page(SECTIONS))) == REFUTED
