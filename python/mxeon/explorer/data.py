# SPDX-License-Identifier: Apache-2.0
"""Types of a page's data. `explorer/src/data.ts` has the same types and describes the fields."""

from dataclasses import dataclass
from typing import TypeAlias

from mxeon.shaders.document.values import Plain

Direction: TypeAlias = tuple[float, float, float]


@dataclass(frozen=True)
class Models:
    """Names of a node's models with the input energy_compensation on and off."""

    on: str
    off: str


@dataclass(frozen=True)
class ModelSource:
    id: str
    title: str
    group: str
    model: str
    meant: str
    pages: tuple[str, ...] = ()
    kind: str = "model"


@dataclass(frozen=True)
class Texels:
    width: int
    height: int
    rgba: str


@dataclass(frozen=True)
class ShaderInput:
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
    """Names of the uniforms that the page's controls set; "" for none."""

    color: str = ""
    roughness: str = ""
    flag: str = ""


@dataclass(frozen=True)
class ReferenceBounds:
    """Tolerances of a shader's values, in direct light and in a white environment."""

    direct: float
    white: float


@dataclass(frozen=True)
class ShaderForm:
    """A known function that a shader may implement instead of the model."""

    title: str
    permitted: bool
    direct: tuple[float, ...] = ()
    white: tuple[float, ...] = ()


@dataclass(frozen=True)
class ReferenceTable:
    """Reference values of a material for the pairs and views of `PageData`."""

    direct: tuple[float, ...]
    white: tuple[float, ...]
    bounds: ReferenceBounds
    forms: tuple[ShaderForm, ...] = ()


@dataclass(frozen=True)
class Checked:
    """Verdict of `mxeon check` for a material on the host gl.

    - `kind`: "correct", "wrong", "differs" (the specification permits the difference), "within"
      (the difference is visible, but within the tolerance), or "unknown" (there is no reference).
    """

    kind: str
    text: str


@dataclass(frozen=True)
class ShaderSource:
    id: str
    title: str
    group: str
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
class PageData:
    version: str
    materialx: str
    functions: str
    sources: tuple[ModelSource | ShaderSource, ...]
    pairs: tuple[tuple[Direction, Direction], ...] = ()
    views: tuple[Direction, ...] = ()
    pages: str = ""
    served: bool = False
    warnings: tuple[str, ...] = ()
    sky: Texels | None = None

    @property
    def judged(self) -> bool:
        """Whether the actual model is known for every shader with an intended model."""
        shaders = (source for source in self.sources if isinstance(source, ShaderSource))
        return all(source.actual or not source.meant for source in shaders)
