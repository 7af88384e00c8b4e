# SPDX-License-Identifier: Apache-2.0
"""OSL's own programs: generated OSL compiled by oslc and rendered by testrender.

The picture is of a plane, on which every pixel is a pair of directions that is known exactly.
testshade evaluates functions.
"""

from __future__ import annotations

from pathlib import Path
from tempfile import TemporaryDirectory

import MaterialX as mx
import numpy as np
from numpy.typing import ArrayLike, NDArray

from mxeon.errors import NotRun, ShaderError
from mxeon.hosts import base, fragment
from mxeon.hosts.base import Array, Identity
from mxeon.hosts.testrender import calls, planes
from mxeon.hosts.testrender.programs import find_program, output, version
from mxeon.io.images import read_image, write_image
from mxeon.shaders import functions
from mxeon.shaders.generation import Shader
from mxeon.shaders.scene import Scene

# Squared, the paths of a pixel. The light is a point as far as float32 can tell, the sky is not.
LIGHT_SAMPLES, SKY_SAMPLES = 1, 8
HELPERS = {
    "mxeon_root": "shader mxeon_root(closure color material = 0) { Ci = material; }",
    "mxeon_light": "shader mxeon_light(float radiance = 1.0) { Ci = radiance * emission(); }",
    "mxeon_sky": "shader mxeon_sky(float radiance = 1.0) { Ci = radiance * background(); }",
}


class Host(base.Host):
    """oslc, testrender and testshade, on PATH or named by variables; see `programs.VARIABLES`.

    Raises
    ------
    NotRun
        If one of them is missing, or oslc does not start.
    """

    name = "testrender"
    target = "osl"
    language = "osl"

    def __init__(self) -> None:
        self._oslc, self._testrender = map(find_program, ("oslc", "testrender"))
        self._version = version(self._oslc)
        self._temporary = TemporaryDirectory(prefix="mxeon-testrender-")
        self._folder = Path(self._temporary.name)
        self._compiled: dict[str, str] = {}

    def identity(self) -> Identity:
        """Version of oslc; the device is the CPU."""
        return Identity(self.name, self._version, "CPU")

    def plane(self, shader: Shader, scene: Scene) -> Array:
        """Radiance of a plane with the shader on it, at `mxeon.shaders.plane.plane_pairs`.

        Parameters
        ----------
        shader : Shader
        scene : Scene
            A distant light, in the plane's frame, or a uniform environment.

        Returns
        -------
        ndarray, shape (size * size, 3), float64
            pi f cos(theta_i), or radiance.
        """
        self.refuse_paths(scene)
        # Compile the shaders, and write the scene.
        for name, text in {shader.name: shader.stages["pixel"], **HELPERS}.items():
            self._compile(name, text)
        for name, text in planes.files(shader.name, scene).items():
            (self._folder / name).write_text(text, encoding="utf-8")
        # Render it.
        samples = SKY_SAMPLES if scene.light is None else LIGHT_SAMPLES
        # A worker has one core.
        options = ["-t", "1", "-aa", str(samples), "--res", str(scene.size), str(scene.size)]
        pixels = self._image([self._testrender, *options, planes.SCENE])
        # Divide by the light that falls on each pixel.
        radiance = pixels[..., :3].reshape(-1, 3)
        if scene.light is None:
            return radiance
        return radiance / planes.irradiance(scene.light, scene.size)[:, np.newaxis]

    def execute(self, source: str, function: str, *arguments: ArrayLike) -> Array:
        """Values of an OSL function; see `mxeon.hosts.base.Host`."""
        # Compile a shader that calls the function.
        parameters = functions.parameters(source, function)
        kinds = {name: kind for kind, name in parameters}
        self._compile(calls.SHADER, calls.text(source, function, parameters))
        # Write the arguments as textures.
        values = {name: (kinds[name], value) for name, value in zip(kinds, arguments, strict=True)}
        columns = fragment.columns(values)
        count, (width, height) = fragment.frame(columns)
        for name, rows in columns.items():
            image = fragment.texels(rows, (width, height))
            write_image(self._folder / calls.texture(name), image, {})
        # Run it for each pixel.
        size = ["-t", "1", "--res", str(width), str(height)]
        pixels = self._image([find_program("testshade"), *size, *calls.OPTIONS])
        return pixels.reshape(-1, 3)[:count]

    def close(self) -> None:
        """Remove the host's files."""
        self._temporary.cleanup()

    def _compile(self, name: str, text: str) -> None:
        """Compile a shader, unless its text is that of the last one of its name."""
        if self._compiled.get(name) == text:
            return
        (self._folder / f"{name}.osl").write_text(text, encoding="utf-8")
        header = mx.getDefaultDataSearchPath().find("libraries/stdlib/genosl/include/mx_funcs.h")
        include = f"-I{header.getParentPath().asString()}"
        output([self._oslc, "-q", include, f"{name}.osl"], self._folder, ShaderError)
        self._compiled[name] = text

    def _image(self, command: list[str]) -> NDArray[np.float64]:
        """Pixels that a program writes; TIFF, since its EXR files have half floats."""
        picture = self._folder / "picture.tif"
        picture.unlink(missing_ok=True)
        output([*command, picture.name], self._folder)
        try:
            return read_image(picture).astype(np.float64)
        except ValueError as error:
            raise NotRun(f"testrender: {error}") from None
