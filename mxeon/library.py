# SPDX-License-Identifier: Apache-2.0
"""The data libraries: where they lie and in which order MaterialX has to load them.

MaterialX keeps the first definition of a name and says nothing of the others, so our folder is
loaded before the standard one. What was found is then checked: see `implementations`.
"""

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import MaterialX as mx

from mxeon.errors import Failure

# Versions of MaterialX whose shaders hand a closure its data as eonlib's sources expect it.
VERSIONS = ("1.39.3", "1.39.4", "1.39.5")

LIBRARIES = ("eonlib", "stock")
PROFILES = ("cycles",)

# Nodes that eonlib implements, and the targets a generator asks for; 1.39.5 alone has all.
NODES = ("ND_oren_nayar_diffuse_bsdf", "ND_eon_diffuse_bsdf")
TARGETS = ("genglsl", "essl", "genmsl", "genslang", "genosl", "genmdl")


class LibraryError(Failure):
    """The library that was loaded is not the one that was asked for."""

    status = 1


@dataclass(frozen=True)
class Implementation:
    """What MaterialX found for a node on a target.

    Attributes
    ----------
    node, target : str
        Name of the nodedef and of the target.
    name : str
        Name of the implementation element, or "" if there is none.
    document : str
        The file that holds it.
    """

    node: str
    target: str
    name: str
    document: str

    @property
    def ours(self):
        """Whether it lies in one of eonlib's folders."""
        folders = {eonlib_folder(), data_folder() / "profiles"}
        return bool(self.document) and not folders.isdisjoint(Path(self.document).resolve().parents)


def data_folder():
    """Folder that holds eonlib and its sources: inside an installed package, else the checkout."""
    installed = Path(__file__).resolve().parent / "data"
    return installed if installed.is_dir() else Path(__file__).resolve().parents[1]


def eonlib_folder():
    """Folder of eonlib's MaterialX documents: what a C++ host, USD or generateshader loads first.

    It is called `eonlib` in an installed package and `libraries` in a checkout.
    """
    installed = data_folder() / "eonlib"
    return installed if installed.is_dir() else data_folder() / "libraries"


def profile_folder(profile):
    """Folder of a profile's MaterialX documents, to be loaded before eonlib's."""
    return data_folder() / "profiles" / profile


def examples_folder():
    """Folder of the bundled example documents."""
    return data_folder() / "examples"


def _folders(library, profile):
    """Library folders in load order: the most particular first, MaterialX's own last."""
    if library not in LIBRARIES:
        raise ValueError(f"library must be one of {', '.join(LIBRARIES)}; got {library!r}")
    if profile is not None and profile not in PROFILES:
        raise ValueError(f"profile must be one of {', '.join(PROFILES)}; got {profile!r}")
    ours = [] if library == "stock" else [eonlib_folder()]
    if profile is not None and library != "stock":
        ours.insert(0, profile_folder(profile))
    return [str(folder) for folder in ours] + list(mx.getDefaultDataLibraryFolders())


@lru_cache(maxsize=None)
def load_library(library="eonlib", profile=None):
    """A MaterialX document holding the standard libraries, with eonlib in front.

    Loaded once per argument pair and shared: attach it with `Document.setDataLibrary`.

    Parameters
    ----------
    library : str
        "eonlib", or "stock" for MaterialX as it comes.
    profile : str or None
        "cycles" for the OSL implementations made for Blender's Cycles.

    Returns
    -------
    MaterialX.Document

    Raises
    ------
    ValueError
        If the library or the profile is unknown; lists the known ones.
    ImportError
        If this MaterialX is none of VERSIONS.
    LibraryError
        If it finds another implementation than eonlib's.
    """
    assert_version()
    document = mx.createDocument()
    mx.loadLibraries(_folders(library, profile), mx.getDefaultDataSearchPath(), document)
    if library == "eonlib":
        assert_ours(document)
    return document


def assert_version():
    """Nothing, if this MaterialX is one of VERSIONS.

    Raises
    ------
    ImportError
        Otherwise: its shaders would call eonlib's functions wrongly.
    """
    if mx.getVersionString() not in VERSIONS:
        raise ImportError(
            f"MaterialX must be one of {', '.join(VERSIONS)}, whose closure interface eonlib is "
            f"written for; got {mx.getVersionString()}: pip install materialx=={VERSIONS[-1]}"
        )


def implementations(document):
    """What a document, with its data library, finds for every node of eonlib on every target.

    Returns
    -------
    tuple of Implementation
        One for each pair of NODES and those TARGETS that this MaterialX has.
    """
    data = document.getDataLibrary() or document
    known = {each.getName() for each in data.getTargetDefs()} or TARGETS
    targets = [target for target in TARGETS if target in known]
    return tuple(_found(document, node, target) for node in NODES for target in targets)


def _found(document, node, target):
    definition = document.getNodeDef(node)
    found = definition and definition.getImplementation(target)
    if not found:
        return Implementation(node, target, "", "")
    return Implementation(node, target, found.getName(), found.getActiveSourceUri())


def assert_ours(document):
    """Nothing, if every implementation that `document` finds for eonlib's nodes is eonlib's.

    Raises
    ------
    LibraryError
        Otherwise; names the node, the target and the file that was found instead.
    """
    for found in implementations(document):
        if not found.ours:
            where = found.document or "nothing"
            raise LibraryError(
                f"implementation of {found.node} for {found.target} must be eonlib's; got {where}: "
                f"load {eonlib_folder()} before the standard libraries"
            )
