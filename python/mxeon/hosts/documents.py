# SPDX-License-Identifier: Apache-2.0
"""Base class of hosts whose renderers read MaterialX documents in a separate process.

Such a renderer generates the shader again, sets lights and uniforms, and draws quads.
"""

from __future__ import annotations

import inspect
import json
from abc import abstractmethod
from collections.abc import Sequence
from functools import lru_cache
from hashlib import sha256
from pathlib import Path
from typing import ClassVar

import MaterialX as mx
import numpy as np
from numpy.typing import NDArray

from mxeon.errors import NotRun
from mxeon.hosts import base, process, raster
from mxeon.shaders.generation import Shader
from mxeon.shaders.inner_lobes import SUBSURFACE, inner_lobes
from mxeon.shaders.methods import UNCHOSEN
from mxeon.shaders.scene import Scene, sphere

SPREAD = 1.0 / 64.0  # factor that reduces the change of texture coordinates in a quad
CORNERS = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
# Quads at the rim are less steep than the tangent plane, which would extend beyond the frame. The
# slope is computed with a cosine (between normal and view) of at least this value.
STEEPEST = 0.05


def quads(size: int, place: tuple[float, float] = (0.0, 0.0)) -> dict[str, NDArray[np.float32]]:
    """Vertices of a quad for each pixel of a picture of `size` x `size` pixels.

    Each quad is as wide as a pixel and lies in the sphere's tangent plane at one point, so that
    positions have the same derivatives as on the sphere. `place` is the offset of this point from
    the quad's center, in half widths. Texture coordinates vary less than on the sphere, so textures
    are read at full size. Quads are ordered by row from the top, vertices counterclockwise.
    `center` is the point that the middle of the picture must show, which centers each quad in its
    pixel.
    """
    points = sphere(size)
    normal = points.normal[points.mask][:, np.newaxis]
    # Each corner lies in the tangent plane, at a given offset in x and y from the exact point.
    offset = np.broadcast_to((CORNERS - place) / size, (len(normal), 4, 2))
    rise = -(normal[..., :2] * offset).sum(axis=-1) / np.maximum(normal[..., 2], STEEPEST)
    position = normal + np.concatenate([offset, rise[..., np.newaxis]], axis=-1)
    # Texture coordinates are longitude and latitude, linearized around the exact point.
    x, y, z = np.moveaxis(normal, -1, 0)
    dx, dy, dz = SPREAD * np.moveaxis(position - normal, -1, 0)
    squared = x * x + z * z
    u = 0.5 + (np.arctan2(x, z) + (z * dx - x * dz) / squared) / (2.0 * np.pi)
    v = 0.5 + (np.arctan2(y, np.sqrt(squared)) + dy / np.sqrt(squared)) / np.pi
    columns = {
        "position": position,
        "normal": np.broadcast_to(normal, position.shape),
        "texcoord": np.stack([u, v], axis=-1),
    }
    vertices = {
        name: values.reshape(-1, values.shape[-1]).astype(np.float32)
        for name, values in columns.items()
    }
    return vertices | {"center": -np.asarray(place, np.float32) / np.float32(size)}


# If a triangle must cover a block of 2 x 2 pixels, each quad has 4 x 4 pixels. Only one pixel is
# read, at the offset PLACE from the center in half widths.
PIXEL_BLOCK, PLACE = 4, (0.25, -0.25)
PICTURES = 64  # maximum number of cached pictures, which the checks of a node share


class DocumentHost(base.Host):
    """A renderer that reads documents. One process runs at a time, with one library of nodes.

    The script `worker.py` is in the same folder as the host's module. The first argument of the
    script is a folder whose `libraries` replace the libraries of MaterialX, or "". The other
    arguments are folders of libraries to load first.
    """

    target: ClassVar[str] = "glsl"

    def __init__(self) -> None:
        self._folders: tuple[str, ...] = ("",)
        self.worker = self._worker()
        self._picture = lru_cache(maxsize=PICTURES)(self._drawn)

    def close(self) -> None:
        self.worker.close()

    def identity(self) -> base.Identity:
        self.worker.start()
        return base.Identity(self.name, str(self.worker.version), self.worker.device)

    def picture(self, shader: Shader, scene: Scene) -> base.Array:
        """Picture of the sphere. The worker process generates the shader again."""
        self.refuse_paths(scene)
        self.refuse_shape(scene)
        if isinstance(scene.environment, (str, Path)):
            raise NotRun(f"{self.name}: environment must be uniform; got an image")
        return self._shown(shader, scene)

    def _shown(self, shader: Shader, scene: Scene, card: bool = False) -> base.Array:
        folders = (shader.root, *shader.folders)
        if folders != self._folders:
            self.worker.close()
            self._folders = folders
            self.worker = self._worker()
        text, element = self._document(shader)
        request: dict[str, object] = {
            "element": element,
            "light": scene.light,
            "environment": scene.environment,
        }
        if shader.methods != UNCHOSEN:
            request["methods"] = shader.methods.settings
        if card:
            request["card"] = True
        blocks = self._needs_blocks(shader)
        return self._picture(folders, text, json.dumps(request), scene.size, blocks)

    def approximations(self, shader: Shader, scene: Scene) -> tuple[str, ...]:
        return (*raster.approximations(shader), *filter(None, [self.unread(shader)]))

    def unread(self, shader: Shader) -> str:
        """Report subsurface lobes, which depend on a curvature that flat quads do not have."""
        if SUBSURFACE in inner_lobes(shader):
            return (
                f"subsurface scattering depends on the curvature, and {self.name} draws flat quads"
            )
        return ""

    @abstractmethod
    def _interpreter(self) -> Path:
        """Path of the Python interpreter that can import the renderer."""

    @abstractmethod
    def _check(self, error: str, printed: Sequence[str]) -> None:
        """Raise NotRun or ShaderError if the reply or the printed lines report an error."""

    def _document(self, shader: Shader) -> tuple[str, str]:
        """Text of a shader's document, and the name path of the element to show."""
        return mx.writeToXmlString(shader.document), shader.element

    def _needs_blocks(self, shader: Shader) -> bool:
        """Whether a triangle must cover a block of 2 x 2 pixels, which takes longer to render."""
        return False

    def _worker(self) -> process.Worker:
        script = Path(inspect.getfile(type(self))).with_name("worker.py")
        return process.Worker(self.name, self._interpreter(), script, *self._folders)

    def _drawn(
        self, folders: tuple[str, ...], text: str, request: str, size: int, blocks: bool
    ) -> base.Array:
        # Each document needs its own file name, because OpenUSD caches files.
        folder = self.worker.folder
        document = folder / f"{sha256(text.encode()).hexdigest()}.mtlx"
        document.write_text(text, encoding="utf-8")
        output, place = folder / "output.npy", PLACE if blocks else (0.0, 0.0)
        mesh = folder / f"quads{size}{place}.npz"
        if not mesh.exists():
            np.savez(mesh, **quads(size, place))  # type: ignore[arg-type]  # mypy expects a bool
        reply = self.worker.ask(
            output=str(output),
            mesh=str(mesh),
            document=str(document),
            size=size * (PIXEL_BLOCK if blocks else 1),
            **json.loads(request),
        )
        self._check(reply.get("error", ""), self.worker.printed())
        pixels = np.load(output)
        if blocks:
            pixels = pixels[PIXEL_BLOCK // 2 :: PIXEL_BLOCK, PIXEL_BLOCK // 2 :: PIXEL_BLOCK]
        image = np.where(sphere(size).mask[..., None], pixels, np.float32(0.0))
        image.flags.writeable = False  # all callers share the cached image
        return image
