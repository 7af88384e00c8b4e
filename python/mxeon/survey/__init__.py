# SPDX-License-Identifier: Apache-2.0
"""Renderers with materials of their own: their nodes, and how they are asked about them.

Importing it adds them to `mxeon.conformance`, which knows none of them.
"""

from mxeon.survey import backends as backends
from mxeon.survey import checks as checks
