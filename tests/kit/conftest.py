# SPDX-License-Identifier: Apache-2.0
"""Helpers that write kits with pictures of known models, and that read results."""

import re
from functools import cache
from pathlib import Path

import numpy as np
import OpenImageIO as oiio
import pytest

from mxeon.io.images import write_exr
from mxeon.kit import check as judging
from mxeon.kit import questions
from mxeon.kit.expected import expected, judged, pixel_means
from mxeon.kit.export import export_kit
from mxeon.kit.views import views
from mxeon.models import table as reference

SIZE = 64
VIEWS = {view.name: view for view in views(SIZE)}
EON, QON, CUBED = (reference.diffuse_model(name).title for name in ("eon", "qon", "eon_rho_cubed"))


@pytest.fixture(scope="module", autouse=True)
def remembered():
    """Cache the expected values of models in views for all tests of a module."""
    with pytest.MonkeyPatch.context() as patch:
        for function in (expected, pixel_means):
            once = cache(function)
            for module in (questions, judging):
                if hasattr(module, function.__name__):
                    patch.setattr(module, function.__name__, once)
        yield


@cache
def means(model, name):
    """Mean values of a model over each judged pixel of a view."""
    return pixel_means(reference.diffuse_model(model), VIEWS[name])


EXPORTED = {}  # contents of a kit's files by name, exported once


def write_kit(folder):
    """Write a kit without pictures to an empty folder, or over another kit."""
    if not EXPORTED:
        export_kit(folder, SIZE)
        for file in filter(Path.is_file, folder.rglob("*")):
            EXPORTED[file.relative_to(folder)] = file.read_bytes()
    for name, data in EXPORTED.items():
        (folder / name).parent.mkdir(exist_ok=True)
        (folder / name).write_bytes(data)


def write_pictures(folder, true="eon", false="qon", noise=0.0, seed=1):
    """Write a kit with pictures of two models; `noise` is the relative noise of each pixel."""
    rng = np.random.default_rng(seed)
    write_kit(folder)
    for view in VIEWS.values():
        model = true if view.material.energy_compensation else false
        mask, image = judged(view.scene), np.zeros((SIZE, SIZE, 3))
        values = means(model, view.name)
        image[mask] = values * (1.0 + noise * rng.standard_normal(values.shape))
        write_exr(folder / "renders" / f"{view.name}.exr", image, {})


@pytest.fixture
def kit(tmp_path):
    """Folder of a kit with pictures of EON and QON."""
    write_pictures(tmp_path)
    return tmp_path


def render(kit, name):
    return kit / "renders" / f"{name}.exr"


def read(path):
    return oiio.ImageBuf(str(path)).get_pixels(oiio.FLOAT)


def result_of(run, check, subject):
    """The single result of a check whose subject starts with the given text."""
    (result,) = [
        each for each in run.results if each.check == check and each.subject.startswith(subject)
    ]
    return result


def names(run):
    """Best matching model in each note, by subject."""
    pattern = r"(.*): best match: (.*) \(rms .*?\), then (.*) \("
    return {match[1]: match[2] for match in map(re.compile(pattern).match, run.notes) if match}
