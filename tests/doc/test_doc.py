# SPDX-License-Identifier: Apache-2.0
"""Tables of nodes: complete in a template, and every difference from a specification is detected."""

import json

import pytest

from mxeon.cli import main
from mxeon.doc import compare, fill, library_tables, read_tables
from mxeon.errors import DocumentError

NODES = ("oren_nayar_diffuse_bsdf", "dielectric_bsdf", "generalized_schlick_bsdf", "sheen_bsdf")
SHEEN = """### `sheen_bsdf`

|Port       |Description   |Type   |Default      |Accepted Values     |
|-----------|--------------|-------|-------------|--------------------|
|`weight`   |Factor        |float  |1            |[0, 1]              |
|`color`    |Reflectivity  |color3 |1, 1, 1      |                    |
|`roughness`|Of the surface|float  |0.3          |                    |
|`normal`   |Of the surface|vector3|Nworld       |                    |
|`mode`     |Of the model  |string |conty_kulla  |zeltner, conty_kulla|
|`out`      |Output        |BSDF   |__zero__     |                    |
"""


@pytest.fixture(scope="module")
def tables():
    return library_tables("stock")


def differences(text, tables):
    """Differences by port."""
    return {each.port: each.subject for each in compare(read_tables(text), tables)}


def test_a_template_is_filled_and_nothing_else_changes(tables):
    template = "".join(f"### {node}\n@MX_TABLE_{node}@\n\ntext\n" for node in NODES)
    text = fill(template, tables)
    assert "@" not in text and text.count("\ntext\n") == len(NODES)
    assert read_tables(text) == {node: tables[node] for node in NODES}
    assert "|`scatter_mode`      |           |string |R            |R, T, RT       |" in text


@pytest.mark.parametrize(
    "old, new, port, subject",
    [
        ("|float  |1            |", "|color3 |1            |", "weight", "type"),
        ("|0.3          |", "|0.31         |", "roughness", "default"),
        ("|Nworld       |", "|Tworld       |", "normal", "default"),
        ("|[0, 1]              |", "|[0, 1)              |", "weight", "accepted values"),
        ("|zeltner, conty_kulla|", "|zeltner             |", "mode", "accepted values"),
        ("|`roughness`|", "|`alpha`    |", "roughness", "port"),
        ("|`roughness`|", "|`alpha`    |", "alpha", "port"),
    ],
)
def test_a_difference_is_noticed(tables, old, new, port, subject):
    assert old in SHEEN
    assert differences(SHEEN.replace(old, new), tables)[port] == subject


@pytest.mark.parametrize("text", ["no table", "|Channel|\n|-|\n|X|\n", SHEEN + SHEEN, SHEEN[18:]])
def test_a_text_without_tables_of_ports_is_refused(text):
    with pytest.raises(DocumentError, match="must"):
        read_tables(text)


def test_the_command_compares(tmp_path, capsys):
    path = tmp_path / "specification.md"
    path.write_text(SHEEN)
    assert main(["doc", "--compare", str(path)]) == 0
    assert capsys.readouterr().out == "no difference\n"
    path.write_text(SHEEN.replace("0.3 ", "0.5 "))
    assert main(["doc", "--compare", str(path), "--json"]) == 1
    (difference,) = json.loads(capsys.readouterr().out)
    assert difference["port"] == "roughness" and difference["library"] == "0.3"


UNKNOWN = b"text\n@MX_TABLE_no@", "line 2: @MX_TABLE_no@ must name a node"


@pytest.mark.parametrize("content, words", [(b"\xff\xfe", ""), UNKNOWN])
def test_bad_input_is_one_line(tmp_path, capsys, content, words):
    path = tmp_path / "template.md"
    path.write_bytes(content)
    assert main(["doc", str(path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and str(path) in error and words in error
