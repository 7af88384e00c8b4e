# SPDX-License-Identifier: Apache-2.0
"""The data of a page, field for field the types of `explorer/src/data.ts`, which describes the fields."""

from dataclasses import dataclass, field
from typing import TypeAlias

from mxeon.shaders.document.values import Plain

Direction: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True)
class Models:
    """Names of the models that a node has with energy_compensation true and false."""

    on: str
    off: str


@dataclass(frozen=True)
class ModelSource:
    """A material that is one model."""

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
    """An image with 8 bits for each of red, green, blue and alpha."""

    width: int
    height: int
    rgba: str


@dataclass(frozen=True)
class ShaderInput:
    """A public input of a shader."""

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
    """Largest errors that a shader may have, from the errors of a spec."""

    direct: float
    white: float


@dataclass(frozen=True)
class ShaderForm:
    """Another function that a shader may have instead of a model."""

    title: str
    permitted: bool
    direct: tuple[float, ...] = ()
    white: tuple[float, ...] = ()


@dataclass(frozen=True)
class ReferenceTable:
    """What the models make of a material, in float64, rounded to the digits of `references.py`."""

    direct: tuple[float, ...]
    white: tuple[float, ...]
    bounds: ReferenceBounds
    forms: tuple[ShaderForm, ...] = ()


@dataclass(frozen=True)
class Checked:
    """What `mxeon check` finds of a material that has no table: its pictures on gl against the reference's."""

    kind: str  # "correct", "wrong", or "unknown" where the reference has no model either
    text: str


@dataclass(frozen=True)
class ShaderSource:
    """A material as generated ESSL."""

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
    checked: Checked | None = None
    paths: str = ""
    kind: str = "shader"


@dataclass(frozen=True)
class Still:
    """A picture for browsers without WebGL2: its title, and a PNG as a data: address."""

    title: str
    picture: str


@dataclass(frozen=True)
class PageData:
    """Everything that a page holds beside its program."""

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
