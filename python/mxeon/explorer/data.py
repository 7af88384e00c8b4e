# SPDX-License-Identifier: Apache-2.0
"""The data of a page, field for field the types of `explorer/src/data.ts`."""

from dataclasses import dataclass, field
from typing import TypeAlias

from mxeon.shaders.document.values import Plain

Direction: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True)
class Models:
    """Names of the models that a node has with energy_compensation true and false.

    Attributes
    ----------
    on, off : str
        Names of rows of `mxeon.models.table`; equal where the node has no such input.
    """

    on: str
    off: str


@dataclass(frozen=True)
class ModelSource:
    """A material that is one model.

    Attributes
    ----------
    id : str
        Names it in the address of a view.
    title, group, note : str
        Its name, the heading it stands under, and one sentence about it.
    model, meant : str
        The model that it is, and the one that it should be.
    pages : tuple of str
        Names of the pages of `docs/upstream` on its defects.
    """

    id: str
    title: str
    group: str
    model: str
    meant: str
    note: str = ""
    pages: tuple[str, ...] = ()
    kind: str = "model"


@dataclass(frozen=True)
class Texels:
    """An image with 8 bits for each of red, green, blue and alpha.

    Attributes
    ----------
    width, height : int
    rgba : str
        Bytes in base64, row 0 at the bottom.
    """

    width: int
    height: int
    rgba: str


@dataclass(frozen=True)
class ShaderInput:
    """A public input of a shader.

    Attributes
    ----------
    name : str
        Of the uniform.
    type : str
        MaterialX's name.
    value : bool, int, float, tuple or None
        None for a file.
    path : str
        Name path of the input in the document.
    label : str
        Name for readers.
    min, max : float or None
        Range that its definition recommends.
    image : Texels or None
        Of a file that can be read.
    shown : bool
        Whether it is a number or a switch that readers may want to move.
    """

    name: str
    type: str
    value: Plain
    path: str
    label: str
    min: float | None = None
    max: float | None = None
    image: Texels | None = None
    shown: bool = True


@dataclass(frozen=True)
class Controls:
    """Uniforms that the controls of the page set; "" for none."""

    color: str = ""
    roughness: str = ""
    flag: str = ""


@dataclass(frozen=True)
class ReferenceBounds:
    """Largest errors that a shader may have, from `mxeon.conformance.accuracy`."""

    direct: float
    white: float


@dataclass(frozen=True)
class ShaderForm:
    """Another function that a shader may have in place of a model.

    Attributes
    ----------
    title : str
    permitted : bool
        Whether the specification leaves it open.
    direct, white : tuple of float
        As those of `ReferenceTable`, or empty.
    """

    title: str
    permitted: bool
    direct: tuple[float, ...] = ()
    white: tuple[float, ...] = ()


@dataclass(frozen=True)
class ReferenceTable:
    """What the models make of a material, in float64, rounded to the digits of `references.py`.

    Attributes
    ----------
    direct : tuple of float
        pi f cos(theta_i) for each pair of a page, 3 each.
    white : tuple of float
        What it returns of white surroundings to each view of a page, 3 each.
    bounds : ReferenceBounds
    forms : tuple of ShaderForm
        What shaders have in its place; empty for more than one lobe.
    """

    direct: tuple[float, ...]
    white: tuple[float, ...]
    bounds: ReferenceBounds
    forms: tuple[ShaderForm, ...] = ()


@dataclass(frozen=True)
class ShaderSource:
    """A material as generated ESSL.

    Attributes
    ----------
    id, title, group, note : str
        As those of `ModelSource`.
    library : str
        "eonlib" or "stock".
    pixel : str
        The text of its pixel stage.
    inputs : tuple of ShaderInput
    controls : Controls
    document : str
        The document, as MaterialX text.
    meant, actual : Models or None
        What the node should be and what this library makes of it, where it is one diffuse node.
    pages : tuple of str
        As those of `ModelSource`.
    reference : ReferenceTable or None
        None where no model covers all of its lobes.
    """

    id: str
    title: str
    group: str
    note: str
    library: str
    pixel: str
    inputs: tuple[ShaderInput, ...]
    controls: Controls
    document: str
    meant: Models | None = None
    actual: Models | None = None
    pages: tuple[str, ...] = ()
    reference: ReferenceTable | None = None
    kind: str = "shader"


@dataclass(frozen=True)
class Still:
    """A picture for browsers without WebGL2: its title, and a PNG as a data: address."""

    title: str
    picture: str


@dataclass(frozen=True)
class PageData:
    """Everything that a page holds beside its program.

    Attributes
    ----------
    version, materialx : str
        Of mxeon and of MaterialX.
    functions : str
        eonlib's GLSL functions of the whole family and of its samplers.
    sources : tuple of ModelSource and ShaderSource
        What can be compared.
    stills : tuple of Still
    pairs, views : tuple
        Pairs of directions, wo and wi of each, and views, in the local frame, of every reference.
    pages : str
        Address of a page on a defect, {} for its name; "" where there is none.
    """

    version: str
    materialx: str
    functions: str
    sources: tuple[ModelSource | ShaderSource, ...]
    stills: tuple[Still, ...] = field(default=())
    pairs: tuple[tuple[Direction, Direction], ...] = ()
    views: tuple[Direction, ...] = ()
    pages: str = ""

    @property
    def judged(self) -> bool:
        """Whether every shader that is meant to be a model is known to be one, or another."""
        shaders = (source for source in self.sources if isinstance(source, ShaderSource))
        return all(source.actual or not source.meant for source in shaders)
