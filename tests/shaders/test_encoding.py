# SPDX-License-Identifier: Apache-2.0
"""Text of documents: what MaterialX reads is read alike, in one line what it cannot."""

import MaterialX as mx
import pytest

from mxeon.errors import DocumentError
from mxeon.shaders.document.reading import read_document
from tests.support.documents import lobe, material

TEXT = material(lobe()).split("\n", 1)[1].replace("<surface ", '<surface doc="{}" ')
WORDS = "löök \N{GREEK SMALL LETTER RHO}"
DECLARED = '<?xml version="1.0" encoding="{}"?>\n'
READ = {
    "UTF-8": ("UTF-8", "utf-8", WORDS),
    "UTF-8 with its mark": ("utf-8", "utf-8-sig", WORDS),
    "UTF-16": ("UTF-16", "utf-16", WORDS),
    "UTF-16 without a mark": ("UTF-16", "utf-16-le", WORDS),
    "UTF-16, high bytes first": ("UTF-16BE", "utf-16-be", WORDS),
    "UTF-16 in name alone": ("utf-16", "utf-8", WORDS),
    "UTF-32": ("UTF-32", "utf-32", WORDS),
    "UTF-32, high bytes first": ("UTF-32", "utf-32-be", WORDS),
    "ISO-8859-1": ("ISO-8859-1", "latin-1", "löök"),
    "Latin1": ("Latin1", "latin-1", "löök"),
    "Windows, but ASCII": ("windows-1252", "ascii", "look"),
    "ASCII": ("us-ascii", "ascii", "look"),
}
REFUSED = ["ebcdic", "UCS-4", "zlib", "rot13", "unicode_escape", "utf-7", "cp037"]


def stock(path):
    """A document as MaterialX reads it, as text."""
    document = mx.createDocument()
    mx.readFromXmlFile(document, str(path))
    return mx.writeToXmlString(document)


def written(folder, data):
    path = folder / "look.mtlx"
    path.write_bytes(data)
    return path


@pytest.mark.parametrize("name, encoding, words", READ.values(), ids=READ)
def test_an_encoding_is_read_as_materialx_reads_it(tmp_path, name, encoding, words):
    text = DECLARED.format(name) + TEXT.format(words)
    path = written(tmp_path, text.encode(encoding))
    document = read_document(path).content
    assert document.getNode("shading").getDocString() == words
    assert mx.writeToXmlString(document) == stock(path)


@pytest.mark.parametrize("name", [*REFUSED, "a" * 5000])
def test_an_encoding_that_is_not_read_is_refused_in_one_line(tmp_path, name):
    path = written(tmp_path, (DECLARED.format(name) + TEXT.format("look")).encode())
    with pytest.raises(DocumentError) as refused:
        read_document(path)
    said = f"{path}: must be in an encoding that MaterialX reads, UTF-8, UTF-16, UTF-32 or ISO"
    assert str(refused.value).startswith(said) and "\n" not in str(refused.value)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-16", "utf-32"])
def test_bytes_that_are_no_text_are_refused_with_their_place(tmp_path, encoding):
    data = TEXT.format("löök").encode(encoding) + b"\xff\xff\xff"
    with pytest.raises(DocumentError, match=r"must be a MaterialX document in UTF.*byte \d"):
        read_document(written(tmp_path, data))


@pytest.mark.parametrize("end", ["<!-- open", '<a name="<', "<![CDATA[", "<?open", "<a <b>/>", "&"])
def test_what_materialx_does_not_read_is_refused(tmp_path, end):
    path = written(tmp_path, TEXT.format("look").replace("</materialx>", end).encode())
    with pytest.raises(DocumentError, match="must be a MaterialX document; XML parse error"):
        read_document(path)


def test_lines_keep_their_numbers(tmp_path):
    path = written(tmp_path, b"<!-- a\nb -->\n<materialx>\n\n<a")
    with pytest.raises(DocumentError, match="line 5"):
        read_document(path)
