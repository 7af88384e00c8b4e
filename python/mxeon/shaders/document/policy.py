# SPDX-License-Identifier: Apache-2.0
"""Permissions and limits of untrusted material documents."""

import os
from dataclasses import dataclass, field

from mxeon.errors import DocumentError, InputError
from mxeon.io.files import names_of

SEARCH_PATH = "MATERIALX_SEARCH_PATH"  # an environment variable of MaterialX

# The limits, and what each limit counts. Each limit is also a command-line option.
LIMITS = {
    "size": "bytes in a document and everything it includes",
    "length": "characters in one attribute",
    "depth": "levels of nested elements, nodegraphs, or definitions",
    "elements": "elements in a document and everything it includes",
    "attributes": "attributes in a document and everything it includes",
    "inputs": "inputs of one element",
    "tokens": "tokens in a document",
    "includes": "levels of nested includes",
    "nodes": "nodes in all shaders of a document, nodegraphs expanded",
    "chain": "nodes in a chain of connections",
    "shaders": "renderable elements",
    "ports": "node inputs in all shaders, each nodegraph counted as one node",
    "text": "characters of the document's own shader code, counted once for each shader that uses it",
    "texels": "pixels in all images that a document reads",
}


def environment_path() -> tuple[str, ...]:
    """Folders in MATERIALX_SEARCH_PATH, as absolute paths."""
    names = os.environ.get(SEARCH_PATH, "").split(os.pathsep)
    return tuple(os.path.abspath(name) for name in names if name)


@dataclass(unsafe_hash=True)  # instances are never modified
class Policy:
    """Permissions and limits of a document, as plain data that can be pickled.

    - `outside`: Whether a document may name files outside its own folder and the libraries.
    - `code`: Whether a document may contain its own shader code, in text or in files.
    - `definitions`: Folders of definitions that are added to the library, and trusted like the
      library.
    - `path`: Further folders in which a document may name files, searched after the document's own
      folder. The default is the environment variable MATERIALX_SEARCH_PATH.
    - All other fields are limits; see LIMITS. `size` and `includes` also apply to the document's
      source code, and `elements` also applies to the number of sources. `text` counts each function
      once per shader and the longest expression once per node. `texels` counts each file once.

    Raises ValueError if a limit is negative.

    The limits keep MaterialX 1.39.5 below 15 s and 512 MiB for the worst known documents. Reading
    images for pictures takes less than another 15 s and 2.75 GiB. The slowest documents at a limit
    have 9,800 names of files with tokens (12 s), a node of 2,490 inputs in 80 shaders (9 s), or 7
    unused nodegraphs of 2,500 inputs (7 s).

    The time grows with the square of each of these numbers: file names (94 s at 50,000), outputs of
    a nodegraph, unused inputs of an element, and definitions that inherit each other (50 s at
    10,000). The time also grows with the product of the numbers of tokens and of file names. The
    time doubles with each nodegraph that uses another nodegraph twice, which `nodes` limits. A
    stack of 8 MiB was enough for chains of 100,000 nodes and for 3,000 nested nodegraphs; a thread
    may have a hundredth of that stack.
    """

    outside: bool = False
    code: bool = False
    path: tuple[str, ...] = field(default_factory=environment_path)
    definitions: tuple[str, ...] = ()
    size: int = 16 * 2**20
    length: int = 65_536
    depth: int = 64
    elements: int = 20_000
    attributes: int = 200_000
    inputs: int = 2_500
    tokens: int = 100
    includes: int = 16
    nodes: int = 50_000
    chain: int = 1_000
    shaders: int = 3_000
    ports: int = 200_000
    text: int = 64 * 2**20
    texels: int = 64 * 2**20

    def __post_init__(self) -> None:
        self.path, self.definitions = (
            tuple(map(os.path.abspath, names_of(name, folders, least=0)))
            for name, folders in (("path", self.path), ("definitions", self.definitions))
        )
        for name in LIMITS:
            if getattr(self, name) < 0:
                raise InputError(f"{name} must be at least 0; got {getattr(self, name)}")

    @property
    def options(self) -> dict[str, str]:
        """Values of the policy, keyed by command-line option."""
        prefixes = dict.fromkeys(LIMITS, "max") | {"outside": "allow", "code": "allow"}
        folders = {"path": self.path, "definitions": self.definitions}
        values = vars(self) | {n: os.pathsep.join(each) or "none" for n, each in folders.items()}
        return {
            f"--{prefixes[n]}{n.capitalize()}" if n in prefixes else f"--{n}": str(value)
            for n, value in values.items()
        }

    def check_limit(self, name: str, value: int, rule: str, unit: str) -> None:
        """Raise DocumentError if a value exceeds a limit."""
        limit = getattr(self, name)
        if value > limit:
            raise DocumentError(
                f"{rule} at most {limit} {unit}; got {value}: "
                f"raise it with --max{name.capitalize()}"
            )


DEFAULT = Policy()
