# SPDX-License-Identifier: Apache-2.0
"""Locations of the data libraries, and the order in which MaterialX has to load the libraries.

MaterialX silently ignores later definitions of a name, so eonlib is loaded before the standard
libraries. `assert_eonlib` then checks which implementations MaterialX chooses.

No version of MaterialX is refused because of its number. Instead, mxeon checks that the methods in
REQUIRED exist, and that generated code calls closures as eonlib's sources define them.
"""

import os
import warnings
from collections.abc import Iterator
from functools import cache, lru_cache
from pathlib import Path

import MaterialX as mx
import MaterialX.PyMaterialXGenShader as mx_gen

import mxeon
from mxeon.errors import InputError, LibraryError, PackageError, assert_known
from mxeon.io.files import AnyPath, Names, names_of, one_name
from mxeon.names import meant
from mxeon.shaders import library_tree
from mxeon.shaders.library_tree import LIBRARIES, OVERLAY, check_files, root, tree

SOURCE_FOLDERS = ("genglsl", "genosl")

PROFILES = {"cycles": "genosl", "path": "genglsl"}  # subfolder of each profile's sources
LOADED = 16  # maximum number of cached libraries, about 10 MB each

# Targets of MaterialX 1.39.5. Earlier versions have fewer targets. The target genoslnetwork only
# supports nodegraphs.
TARGETS = ("genglsl", "essl", "genmsl", "genslang", "genosl", "genmdl", "genoslnetwork")


@cache
def data_folder() -> Path:
    """The folder that contains eonlib: the data of the installed package, or else the checkout."""
    installed = Path(__file__).resolve().parents[1] / "data"
    return installed if installed.is_dir() else Path(__file__).resolve().parents[3]


def eonlib_folder() -> Path:
    """Folder of eonlib that a C++ host, USD or generateshader loads before MaterialX's libraries."""
    installed = data_folder() / "eonlib"
    return installed if installed.is_dir() else data_folder() / "libraries"


def documents_folder(part: str = "eonlib") -> Path:
    """Folder of eonlib's MaterialX documents, or the subfolder for the part "diffuse"."""
    # A folder with the name `libraries` would hide MaterialX's folder of the same name.
    installed = eonlib_folder() / "documents"
    folder = installed if installed.is_dir() else eonlib_folder()
    return folder / part if part == "diffuse" else folder


@cache
def kind_of(library: str) -> str:
    """The entry of LIBRARIES that a library equals or copies; OVERLAY for other folders.

    A folder that replaces some or all of MaterialX's libraries counts as "stock".
    """
    if library in LIBRARIES:
        return library
    if tree(library).kind != OVERLAY:
        return "stock"
    documents = {
        Path(path).name for path in tree(library).own if path.endswith(library_tree.DOCUMENT)
    }
    for name in ("eonlib", "diffuse"):
        if documents == {path.name for path in documents_folder(name).rglob("*.mtlx")}:
            return name
    return OVERLAY


def source_folder(library: str) -> Path:
    """The folder that contains a library's folders genglsl and genosl.

    The candidates are the library's own folder, its parent and its grandparent.
    """
    folder = eonlib_folder() if library in LIBRARIES else Path(library)
    homes = (folder, *folder.parents[:2])
    return next(
        (each for each in homes if any((each / name).is_dir() for name in SOURCE_FOLDERS)), folder
    )


def environment_folders(library: str) -> list[Path]:
    """A list with the folder of a library's sources for environment lookups, or an empty list."""
    folder = source_folder(library) / "genglsl" / "environment"
    return [folder] if library != "stock" and folder.is_dir() else []


def library_folders(library: str) -> list[Path]:
    """The folder of a library's documents, and the folders of the library's sources."""
    sources = (source_folder(library) / name for name in SOURCE_FOLDERS)
    return [Path(library), *(folder for folder in sources if folder.is_dir())]


def profile_documents(library: str, profile: str) -> list[Path]:
    """A library's MaterialX documents for a profile, to be loaded before all other documents.

    The documents' names end in .xml, so programs that load a whole folder skip the documents.
    """
    if kind_of(library) == "stock":
        return []
    return sorted((source_folder(library) / PROFILES[profile] / profile).glob("*.xml"))


def has_profile(library: str, profile: str) -> bool:
    """Whether a library has its own implementations for a profile."""
    return bool(profile_documents(library, profile))


def examples_folder() -> Path:
    """Folder of the bundled example documents."""
    return data_folder() / "examples"


def own_folders(library: str) -> list[str]:
    """The folders of a library that are loaded before MaterialX's libraries."""
    if library in LIBRARIES:
        return [] if library == "stock" else [str(documents_folder(library))]
    return [] if root(library) else [os.path.abspath(library)]


def library_name(library: str | os.PathLike[str]) -> str:
    """The name of a built-in data library, or the absolute path of a library's folder.

    Raise InputError if a folder cannot be combined with MaterialX's files, or contains a file that
    is not UTF-8 text.
    """
    if library in LIBRARIES:
        return str(library)
    if not os.path.isdir(library):
        raise InputError(
            f"library must be one of {', '.join(LIBRARIES)}, or a folder that exists; "
            f"got {str(library)!r}{meant(library, LIBRARIES)}"
        )
    library = os.path.abspath(library)
    known = tree(library)
    if known.kind == OVERLAY:
        profiles = [file for each in PROFILES for file in profile_documents(library, each)]
        sources = [
            path
            for folder in library_folders(library)[1:]
            for path in sorted(folder.rglob("*.*"))
            if path.suffix in library_tree.FILES and not path.is_dir()
        ]
        rule = (
            f"library {library}: must hold MaterialX documents, or files named as MaterialX's own"
        )
        check_files([*_documents(library, rule), *sources, *profiles])
    else:
        check_files(os.path.join(library, path) for path in known.own)
    return library


def load_library(
    library: AnyPath = "eonlib", profile: str | None = None, definitions: Names = ()
) -> mx.Document:
    """A MaterialX document with the standard libraries and, by default, eonlib.

    The document is cached and shared, so attach the document with `Document.setDataLibrary`.

    - `library`: "eonlib", "stock" for unmodified MaterialX, or a folder. A folder replaces some or
      all of MaterialX's libraries, or is loaded before MaterialX's libraries; see
      `mxeon.shaders.library_tree`.
    - `profile`: "cycles" for eonlib's OSL implementations for Blender's Cycles.
    - `definitions`: Folders of additional definitions, which must not replace definitions of the
      library.

    Raises ValueError if the library or the profile is unknown, or if a folder has no definitions or
    replaces definitions of the library; ImportError if MaterialX is too old (see `check_version`);
    LibraryError if MaterialX chooses an implementation other than eonlib's.

    Warns UntestedVersionWarning if the version of MaterialX is not in TESTED.
    """
    library = one_name("library", library)
    if library not in LIBRARIES and os.path.isdir(library):
        library = os.path.abspath(library)
    profile = profile if profile is None else one_name("profile", profile)
    folders = map(os.path.abspath, names_of("definitions", definitions, least=0))
    return read_library(library, profile, tuple(folders))


@lru_cache(maxsize=LOADED)
def read_library(library: str, profile: str | None, definitions: tuple[str, ...]) -> mx.Document:
    """Cached part of `load_library`. No argument has a default, so equal calls have equal keys."""
    check_version()
    if profile is not None:
        assert_known("profile", profile, PROFILES)
    if note := untested(mx.getVersionString()):
        warnings.warn(UntestedVersionWarning(note), stacklevel=3)
    library = library_name(library)
    document = mx.createDocument()
    for folder in definitions:
        check_files(_documents(folder, f"definitions {folder}: must hold MaterialX documents"))
    path, options = library_tree.search_path(library), library_tree.read_options()
    try:
        if definitions:  # an empty list makes MaterialX load everything
            mx.loadLibraries(list(definitions), path, document, readOptions=options)
        # MaterialX does not sort the files of a folder, so the documents of a profile or of a
        # partial library are loaded before all other documents.
        first = profile_documents(library, profile) if profile else []
        if not first and library not in LIBRARIES and tree(library).kind == library_tree.PART:
            home, own = Path(root(library), "libraries"), tree(library).own
            first = [home / each for each in own if each.endswith(library_tree.DOCUMENT)]
        for file in first:
            mx.loadLibrary(mx.FilePath(str(file)), document, path, options)
        folders = [*own_folders(library), *mx.getDefaultDataLibraryFolders()]
        mx.loadLibraries(folders, path, document, readOptions=options)
    except (mx.Exception, mx.ExceptionParseError, LookupError) as error:
        reason = library_tree.with_user_paths(library, str(error))
        raise InputError(f"{' '.join(('library', library, *definitions))}: {reason}") from None
    # Remove materials, because they would replace nodes of the same name in other documents.
    used = {each.getNodeGraph() for each in document.getImplementations()}
    for graph in document.getNodeGraphs():
        if not graph.getNodeDefString() and graph.getName() not in used:
            document.removeChild(graph.getName())
    for node in document.getNodes():
        document.removeChild(node.getName())
    if library not in LIBRARIES:
        library_tree.check_sources(document, root(library) or library, path)
    if definitions:
        library_tree.check_definitions(document, load_library(library, profile), definitions, path)
    if library in ("eonlib", "diffuse"):
        assert_eonlib(document, library, profile)
    return document


def _documents(folder: AnyPath, rule: str) -> list[Path]:
    """MaterialX documents in a folder. Raise InputError with the text `rule` if there are none."""
    documents = sorted(Path(folder).rglob("*.mtlx")) if str(folder) else []
    if not documents:
        empty = not any(names for *_, names in os.walk(folder))
        raise InputError(f"{rule}; {'it is empty' if empty else 'it has no such file'}")
    return documents


def implementations(
    document: mx.Document, library: str = "eonlib", profile: str | None = None
) -> Iterator[tuple[str, str, str]]:
    """The implementations that MaterialX chooses for the nodes of eonlib.

    Each entry has a nodedef, a target and a file. There is an entry for each nodedef that the
    library ("eonlib" or "diffuse") or the profile implements, and for each target of such an
    implementation. The file is "" if MaterialX has no implementation for the target, or only a
    nodegraph for all targets.
    """
    data = document.getDataLibrary() or document
    targets = {each.getName(): each.getMatchingTargets() for each in data.getTargetDefs()}
    for node, target in _shipped(library, profile):
        definition = document.getNodeDef(node)
        for heir in TARGETS:
            if (heir in targets or not targets) and target in ("", heir, *targets.get(heir, ())):
                element = definition and definition.getImplementation(heir)
                found = element and (element.getTarget() or not target)
                yield node, heir, element.getActiveSourceUri() if found else ""


@cache
def _shipped(library: str, profile: str | None) -> tuple[tuple[str, str], ...]:
    """Nodedef and target of each implementation in eonlib's documents; "" means all targets."""
    document = mx.createDocument()
    for file in profile_documents(library, profile) if profile else ():
        mx.loadLibrary(mx.FilePath(str(file)), document)
    mx.loadLibraries(own_folders(library), mx.FileSearchPath(), document)
    elements = (*document.getImplementations(), *document.getNodeGraphs())
    pairs = ((each.getNodeDefString(), each.getTarget()) for each in elements)
    return tuple(dict.fromkeys(pair for pair in pairs if pair[0]))


def assert_eonlib(
    document: mx.Document, library: str = "eonlib", profile: str | None = None
) -> None:
    """Raise LibraryError unless MaterialX chooses eonlib's implementation of every nodedef.

    The error message names the node, the target and the chosen file. The parameters are those of
    `implementations`.
    """
    folders = {eonlib_folder(), *(source_folder("eonlib") / each for each in SOURCE_FOLDERS)}
    for node, target, file in implementations(document, library, profile):
        if not file or folders.isdisjoint(Path(file).resolve().parents):
            raise LibraryError(
                f"implementation of {node} for {target} must be eonlib's; got {file or 'nothing'}: "
                f"load {eonlib_folder()} before the standard libraries"
            )


TESTED = ("1.39.3", "1.39.4", "1.39.5")  # MaterialX versions that run without a warning
REQUIRED = ((mx.Document, "setDataLibrary"), (mx_gen.ShaderGenerator, "registerTypeDefs"))


class UntestedVersionWarning(UserWarning):
    """A version of MaterialX that mxeon has not been tested with."""


def check_version() -> None:
    """Raise ImportError unless this MaterialX has every method of REQUIRED."""
    for owner, method in REQUIRED:
        if not hasattr(owner, method):
            raise PackageError(
                f"MaterialX {mx.getVersionString()} lacks {owner.__name__}.{method}; "
                f"install {TESTED[0]} or later: pip install materialx=={TESTED[-1]}"
            )


def untested(version: str) -> str:
    """A note that mxeon was not tested with a version of MaterialX; "" for tested versions."""
    if version in TESTED:
        return ""
    return f"MaterialX {version} has not been tested with mxeon {mxeon.__version__}"
