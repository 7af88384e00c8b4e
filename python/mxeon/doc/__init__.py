# SPDX-License-Identifier: Apache-2.0
"""Port tables of nodes: from node definitions into Markdown, and compared with a specification's."""

from mxeon.doc.compare import Difference, compare
from mxeon.doc.markdown import fill, read_tables
from mxeon.doc.ports import PortRow, Table, library_tables

__all__ = ["Difference", "PortRow", "Table", "compare", "fill", "library_tables", "read_tables"]
