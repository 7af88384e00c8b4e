# SPDX-License-Identifier: Apache-2.0
"""Documents in UTF-8 are read as in MaterialX; other encodings are refused in one line."""

import re

import MaterialX as mx
import pytest

from mxeon.shaders.document.reading import read_document
from tests.support.documents import lobe, material, refusal, written

TEXT = material(lobe()).split("\n", 1)[1].replace("<surface ", '<surface doc="{}" ')
WORDS = "löök \N{GREEK SMALL LETTER RHO}"
DECLARED = '<?xml version="1.0" encoding="{}"?>\n'
READ = {
    "UTF-8": ("UTF-8", "utf-8", WORDS),
    "UTF-8 with its mark": ("utf-8", "utf-8-sig", WORDS),
    "Windows, but ASCII": ("windows-1252", "ascii", "look"),
    "ASCII": ("us-ascii", "ascii", "look"),
    "ASCII by another name": ("UTF-16", "ascii", "look"),
}
REFUSED = ("utf-16", "utf-16-le", "utf-32", "utf-32-be", "latin-1")


def stock(path):
    """Text of a document after MaterialX itself has read it."""
    document = mx.createDocument()
    mx.readFromXmlFile(document, str(path))
    return mx.writeToXmlString(document)


@pytest.mark.parametrize("name, encoding, words", READ.values(), ids=READ)
def test_an_encoding_is_read_as_materialx_reads_it(tmp_path, name, encoding, words):
    text = DECLARED.format(name) + TEXT.format(words)
    path = written(tmp_path, text.encode(encoding))
    document = read_document(path).content
    assert document.getNode("shading").getDocString() == words
    assert mx.writeToXmlString(document) == stock(path)


@pytest.mark.parametrize("encoding", REFUSED)
def test_other_encodings_are_refused_in_one_line(tmp_path, encoding):
    text = DECLARED.format(encoding) + TEXT.format("löök")
    for data in (text.encode(encoding), text.encode()):
        message = refusal(written(tmp_path, data))
        assert re.search("must be (a MaterialX document )?in UTF-8; |XML parse error", message)


def test_bytes_that_are_no_text_are_refused_with_their_place(tmp_path):
    message = refusal(written(tmp_path, TEXT.format("löök").encode() + b"\xff\xff\xff"))
    assert re.search(r"must be a MaterialX document in UTF-8.*byte \d", message)


@pytest.mark.parametrize("end", ["<!-- open", '<a name="<', "<![CDATA[", "<?open", "<a <b>/>", "&"])
def test_what_materialx_does_not_read_is_refused(tmp_path, end):
    path = written(tmp_path, TEXT.format("look").replace("</materialx>", end).encode())
    assert "must be a MaterialX document; XML parse error" in refusal(path)


def test_lines_keep_their_numbers(tmp_path):
    assert "line 5" in refusal(written(tmp_path, b"<!-- a\nb -->\n<materialx>\n\n<a"))
