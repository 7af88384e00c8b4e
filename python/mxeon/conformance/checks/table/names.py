# SPDX-License-Identifier: Apache-2.0
"""Names of the models that several checks hold for."""

from mxeon.models.pbrlib import NODES
from mxeon.models.pbrlib.combinations import COMBINATIONS

OTHERS = (*(row.name for row in NODES), "burley_lambert")
COMBINATION = tuple(row.name for row in COMBINATIONS)
