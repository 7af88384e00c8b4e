# SPDX-License-Identifier: Apache-2.0
"""Names by which messages point to a document and to its elements."""

import MaterialX as mx

TEXT = "document text"


def label(document: mx.Document) -> str:
    """File that a document was read from, or TEXT."""
    return document.getSourceUri() or TEXT


def location(element: mx.Element) -> str:
    """Document, category and name path of an element."""
    return f'{label(element.getDocument())}: {element.getCategory()} "{element.getNamePath()}"'
