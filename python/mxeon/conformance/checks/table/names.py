# SPDX-License-Identifier: Apache-2.0
"""Names of the models that several checks hold for."""

from mxeon.models.pbrlib import NODES
from mxeon.models.pbrlib.combinations import COMBINATIONS
from mxeon.models.pbrlib.hair import HAIR_NODE

OTHERS = (*(row.name for row in NODES), "burley_lambert", HAIR_NODE.name)
COMBINATION = tuple(row.name for row in COMBINATIONS)
