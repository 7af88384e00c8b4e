# SPDX-License-Identifier: Apache-2.0
"""Exported copies of eonlib are self-contained and work with every version of MaterialX."""

import json
import zipfile
from pathlib import Path

import pytest

import mxeon
from mxeon.shaders.library import SOURCE_FOLDERS, TESTED, data_folder
from mxeon.shaders.library_export import export_library, recipes
from tests.support.availability import program
from tests.support.command import output
from tests.support.verdicts import PASSED
from tests.support.wheels import run_with


@pytest.fixture(scope="module")
def copy(tmp_path_factory):
    return export_library(tmp_path_factory.mktemp("export") / "copy")


def contents(folder):
    files = filter(Path.is_file, Path(folder).rglob("*"))
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in files}


def test_a_copy_is_eonlib_with_its_license_and_recipes(copy):
    found, whole = contents(copy), {}
    for name in ("libraries", *SOURCE_FOLDERS):
        # A folder with the name `libraries` would hide MaterialX's folder of that name.
        inside = name.replace("libraries", "documents")
        files = contents(data_folder() / name)
        whole |= {f"{inside}/{file}": data for file, data in files.items()}
    license_text = (data_folder() / "LICENSE").read_bytes()
    readme = found.pop("README.txt").decode()
    assert mxeon.__version__ in readme and recipes(copy).replace(str(copy), "FOLDER") in readme
    assert found == whole | {"LICENSE": license_text}


def test_an_archive_is_a_copy_under_its_name_and_the_same_each_time(copy, tmp_path):
    first, again = (export_library(tmp_path / each / "eonlib-1.0.zip") for each in "ab")
    assert first.read_bytes() == again.read_bytes()
    with zipfile.ZipFile(first) as archive:
        archive.extractall(tmp_path)
    assert contents(tmp_path / "eonlib-1.0") == contents(copy)


# --- versions of MaterialX ------------------------------------------------------------------------


@pytest.mark.parametrize("version", TESTED)
def test_the_shaders_of_every_node_of_a_copy_compile(copy, tmp_path, version):
    run_with(version, "tests.support.client", copy, tmp_path)
    shaders = sorted(tmp_path.glob("*.frag"))
    assert len(shaders) == 23
    output(program("glslangValidator"), *shaders)


# In older versions, GLSL adds the transmission of a medium to the transmission of the layer above.
MEDIA = dict.fromkeys(TESTED[:-1], "transmittance, ")


@pytest.mark.whole
@pytest.mark.parametrize("version", [TESTED[0], "main"])
def test_every_node_has_the_values_of_the_models(copy, version):
    verdicts = json.loads(run_with(version, "tests.support.every_node", copy))
    wrong = [key for key, verdict in verdicts.items() if verdict != PASSED]
    assert len(verdicts) >= 65
    assert wrong == [key for key in verdicts if key.startswith(MEDIA.get(version, "none"))]
