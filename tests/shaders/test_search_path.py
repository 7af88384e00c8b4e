# SPDX-License-Identifier: Apache-2.0
"""Files that documents name are found on the search path, and missing files are reported."""

from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.cli import batch, main
from mxeon.errors import DocumentError
from mxeon.shaders.document.notes import MissingFileWarning
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.document.reading import read_document
from mxeon.shaders.generation import generate
from mxeon.shaders.scene import Paths
from tests.support.documents import including, lobe, material, textured, written

TINT = (0.25, 0.5, 0.75)


def picture(path, channels=TINT):
    path.parent.mkdir(parents=True, exist_ok=True)
    oiio.ImageBuf(np.full((2, 2, len(channels)), channels, dtype=np.float32)).write(str(path))


@pytest.fixture
def home(tmp_path):
    """Folder for a document, beside a folder `shared` with pictures and another document."""
    picture(tmp_path / "shared/maps/a.exr")
    picture(tmp_path / "shared/set.1001.exr")
    picture(tmp_path / "shared/tile.u1_v1.exr")
    picture(tmp_path / "private/b.exr")
    (tmp_path / "shared/part.mtlx").write_text(material(lobe()))
    (tmp_path / "home").mkdir()
    return tmp_path / "home"


def searched(home):
    return Policy(path=(str(home.parent / "none"), str(home.parent / "shared")))


def test_an_image_is_looked_for_on_the_path_and_may_lie_there(home):
    path = written(home, textured(["maps/a.exr"]))
    image = read_document(path, policy=searched(home)).content.getDescendant("i0/file")
    assert image.getValueString() == str(home.parent / "shared/maps/a.exr")
    with pytest.warns(MissingFileWarning, match="must name a file that exists; got maps/a.exr"):
        assert generate(path, "osl")


def test_a_name_that_leads_out_of_the_path_is_refused(home):
    path = written(home, textured(["../private/b.exr"]))
    with pytest.raises(DocumentError, match="on the search path or in the libraries"):
        read_document(path, policy=searched(home))


def test_an_include_is_looked_for_on_the_path(home):
    path = written(home, including("part.mtlx"))
    assert read_document(path, policy=searched(home)).content.getNode("lobe")
    with pytest.raises(DocumentError, match="include must name a file that exists; got part.mtlx"):
        read_document(path)


def test_the_environment_names_folders_too(home, monkeypatch):
    monkeypatch.setenv("MATERIALX_SEARCH_PATH", f"{home.parent / 'none'}:{home.parent / 'shared'}:")
    assert Policy().path == searched(home).path


@pytest.mark.parametrize("workers", ["0", "1"])
def test_the_command_searches_folders(home, workers, capfd, monkeypatch):
    monkeypatch.chdir(home.parent)
    written(home, textured(["maps/a.exr"]))
    options = ["--workers", workers, "--outputPath", "out", "--target", "osl", "--path", "shared"]
    assert main(["generate", "home/look.mtlx", *options]) == 0
    assert capfd.readouterr().err == ""
    assert str(home.parent / "shared/maps/a.exr") in Path("out/look.look.osl").read_text()


@pytest.mark.parametrize("name", ["set.&lt;UDIM&gt;.exr", "set.<UDIM>.exr", "tile.<UVTILE>.exr"])
@pytest.mark.parametrize("host", ["gl", "reference"])
def test_a_set_of_textures_is_shown_as_its_first_tile(home, host, name):
    rest = ("front", None, 16, "sphere", None, "eonlib", searched(home), Paths())
    paths = (written(home, textured([each])) for each in (name, "maps/a.exr"))
    shown, expected = (batch.picture(str(each), host, *rest)[0] for each in paths)
    assert expected.any() and np.array_equal(shown, expected)
