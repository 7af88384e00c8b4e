# SPDX-License-Identifier: Apache-2.0
"""An imitation of testrender: reads its files, and renders planes by the reference.

    python testrender.py -r WIDTH HEIGHT -aa N SCENE.xml PICTURE.exr

Written from what testrender's source says of its camera, lights and files, not from the host.
"""

import re
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import OpenImageIO as oiio

from mxeon.models import table as reference

MODELS = {True: "eon", False: "qon"}


def testrender(arguments):
    """Render a scene."""
    width, height = map(int, arguments[1:3])
    world = ElementTree.parse(arguments[-2]).getroot()
    groups = {each.get("name"): each.text for each in world.iter("ShaderGroup")}
    eye, ray = camera(world.find("Camera").attrib, width, height)
    points = eye - ray * (eye[2] / ray[:, 2:])
    surface = Surface(groups["plane"])
    wo = unit(eye - points)
    if "light" in groups:
        pixels = surface.lit(wo, *light(world, groups["light"], points))
    else:
        pixels = radiance(groups["sky"]) * surface.albedo(wo)
    write(arguments[-1], pixels.reshape(height, width, 3))


def camera(given, width, height):
    """Position of the camera and a direction for each pixel center, the top row first."""
    eye, ahead, up = (vector(given[name]) for name in ("eye", "dir", "up"))
    ahead = ahead / np.linalg.norm(ahead)
    scale = np.tan(np.radians(float(given["fov"])) / 2.0)
    right = np.cross(ahead, up)
    right = right / np.linalg.norm(right)
    above = np.cross(right, ahead)
    column, row = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    across = (column / width - 0.5) * (width / height) * scale
    upward = (0.5 - row / height) * scale
    return eye, ahead + across.reshape(-1, 1) * right + upward.reshape(-1, 1) * above


def light(world, group, points):
    """Directions towards the light's middle, and its irradiance on what faces it."""
    quad = world.findall("Quad")[1]
    corner, x, y = (vector(quad.get(name)) for name in ("corner", "edge_x", "edge_y"))
    away = corner + 0.5 * (x + y) - points
    squared = (away**2).sum(axis=1)
    area = np.cross(x, y)
    return unit(away), radiance(group) * np.abs(unit(away) @ area) / squared


class Surface:
    """What a group of shaders makes of the plane."""

    def __init__(self, group):
        name = re.search(r"shader (\w+) material ;", group)[1]
        assert "connect material.out root.material ;" in group
        text = Path(f"{name}.oso").read_text()
        self.weight, self.roughness = (
            number(text, f"lobe_{key}") for key in ("weight", "roughness")
        )
        self.color = triple(text, "lobe_color")
        given = "vector lobe_normal" in text
        self.normal = triple(text, "lobe_normal") if given else np.array([0.0, 0.0, 1.0])
        flag = re.search(r"int lobe_energy_compensation = (\d)", text)
        told = '"energy_compensation"' in text
        self.model = reference.model(MODELS[told and (flag is None or flag[1] == "1")])

    def lit(self, wo, wi, irradiance):
        """Radiance towards wo."""
        axes = np.linalg.qr(np.column_stack([self.normal, np.eye(3)[:, :2]]))[0][:, [1, 2, 0]]
        axes[:, 2] = self.normal
        wo, wi = wo @ axes, wi @ axes
        seen = (wo[:, 2] > 0.0) & (wi[:, 2] > 0.0)
        value = np.zeros((len(wo), 3))
        brdf = self.model.brdf(wo[seen], wi[seen], self.color, self.roughness)
        value[seen] = brdf * (wi[seen, 2:] * irradiance[seen, np.newaxis])
        return self.weight * value

    def albedo(self, wo):
        """Radiance towards wo in an environment of radiance 1."""
        return self.weight * self.model.albedo_dir(wo[:, 2], self.color, self.roughness)


def number(text, name):
    """Value of a float parameter."""
    return float(re.search(rf"float {name} = ([-\d.e]+)", text)[1])


def triple(text, name):
    """Value of a color or vector parameter, or of each component."""
    found = re.search(rf"(?:color|vector) {name} = (?:\w+\()?([^)\n]*)\)?", text)[1]
    numbers = [float(each) for each in found.split(",") if each]
    return np.array(numbers if len(numbers) == 3 else 3 * numbers)


def radiance(group):
    """The parameter of that name."""
    return float(re.search(r"param float radiance ([-\d.e+]+) ;", group)[1])


def vector(text):
    """Numbers with commas between them."""
    return np.array([float(each) for each in text.split(",")])


def unit(vectors):
    """Each row at length 1."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def write(path, pixels):
    """A picture of half floats."""
    image = oiio.ImageOutput.create(path)
    image.open(path, oiio.ImageSpec(pixels.shape[1], pixels.shape[0], 3, "half"))
    image.write_image(pixels.astype(np.float32))
    image.close()


if __name__ == "__main__":
    testrender(sys.argv[1:])
