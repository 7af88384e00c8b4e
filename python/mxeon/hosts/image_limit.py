# SPDX-License-Identifier: Apache-2.0
"""The limit of all images that the shaders of a document read together."""

from collections.abc import Iterable
from pathlib import Path

from mxeon.hosts.textures import texels_of
from mxeon.shaders.document.policy import Policy
from mxeon.shaders.document.references import files
from mxeon.shaders.document.values import label
from mxeon.shaders.generation import Shader


def image_files(shaders: Iterable[Shader]) -> tuple[str, ...]:
    """Names of the images that shaders read, each once."""
    inputs = (port for shader in shaders for port in shader.inputs)
    names = (str(port.value) for port in inputs if port.type == "filename" and port.value)
    return tuple(dict.fromkeys(names))


def check_images(shaders: Iterable[Shader], policy: Policy) -> None:
    """Refuse images of a document that are too large in total, before any of them is read.

    Raises DocumentError if they have more pixels than the policy permits; ImageError if one is no
    image, or has more channels than a color.
    """
    shaders, texels = tuple(shaders), 0
    for file in {file for name in image_files(shaders) for file in files(Path(name))}:
        texels += texels_of(file)
        rule = f"{label(shaders[0].document)}: images must have"
        policy.check_limit("texels", texels, rule, "pixels together")
