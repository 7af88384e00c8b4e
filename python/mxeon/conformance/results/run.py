# SPDX-License-Identifier: Apache-2.0
"""Everything that one `mxeon check` measured."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

from mxeon.conformance.results.pictures import AlbedoCurve, Picture, image_names
from mxeon.conformance.results.result import FAILED, NOT_RUN, Result
from mxeon.conformance.results.summary import Summary, counted, summarize
from mxeon.hosts.base import Identity


@dataclass(frozen=True)
class Run:
    """Everything that one `mxeon check` measured.

    Attributes
    ----------
    version : str
        Of mxeon.
    software : dict of str to str
        Versions of what took part (Python, NumPy, MaterialX, ...).
    hosts : tuple of Identity
    results : tuple of Result
    pictures : tuple of Picture
    curves : tuple of AlbedoCurve
    notes : tuple of str
        Warnings a reader has to see, e.g. what a host cannot express.
    refused : dict of str to tuple of str
        The faults of each document that could not be judged, a line each, by its path; if other
        libraries can read it, the key names the library behind it: "clay.mtlx with stock".
    documents : tuple of Path
    contents : dict of str to tuple of str
        Titles of the nodes of each document that the user gave, by its path.
    unreached : dict of str to dict of str to tuple of str
        For each of these, by title of a node, the regions that its inputs are not in, as diagnoses
        name them.
    missing : tuple of str
        Tasks that are not done yet, where the run was interrupted.
    libraries : dict of str to dict of str to tuple of str
        By folder that was judged as a library: its files, under "folder", and those of MaterialX that
        complete it, under "MaterialX", unless it is loaded before all of them.
    compared : tuple of str
        Libraries judged for comparison; the verdict ignores their failures.
    """

    version: str
    software: dict[str, str]
    hosts: tuple[Identity, ...]
    results: tuple[Result, ...]
    pictures: tuple[Picture, ...] = ()
    curves: tuple[AlbedoCurve, ...] = ()
    notes: tuple[str, ...] = ()
    refused: dict[str, tuple[str, ...]] = field(default_factory=dict)
    documents: tuple[Path, ...] = ()
    contents: dict[str, tuple[str, ...]] = field(default_factory=dict)
    missing: tuple[str, ...] = ()
    unreached: dict[str, dict[str, tuple[str, ...]]] = field(default_factory=dict)
    libraries: dict[str, dict[str, tuple[str, ...]]] = field(default_factory=dict)
    compared: tuple[str, ...] = ()

    @cached_property
    def summary(self) -> Summary:
        """The verdict on this run."""
        judged = [each for each in self.results if each.library not in self.compared]
        elsewhere = sum(map(self.is_elsewhere, judged))
        summary = summarize(judged, self.missing, tuple(self.refused), elsewhere)
        for library in self.compared:
            results = [
                each for each in self.results if each.library == library and each.verdict != NOT_RUN
            ]
            failed = sum(each.verdict == FAILED for each in results)
            words = f" For comparison, {failed} of {len(results)} failed with {library}."
            if results:
                summary = replace(summary, sentence=summary.sentence + words)
        return summary

    @property
    def errors(self) -> tuple[str, ...]:
        """The faults of all documents that were refused."""
        return tuple(line for lines in self.refused.values() for line in lines)

    def is_elsewhere(self, result: Result, *documents: str) -> bool:
        """Whether a check fails for inputs alone that no document has that shows its node."""
        region = result.diagnosis.split(";")[0]
        shown = [
            self.unreached.get(each, {}).get(result.subject, ())
            for each in documents or self.contents
            if result.subject in self.contents[each]
        ]
        return (
            result.verdict == FAILED
            and bool(shown)
            and all(any(region.endswith(name) for name in names) for names in shown)
        )

    @property
    def sentence(self) -> str:
        """The verdict, and the MaterialX that was judged, with its folder if it is not the installed one."""
        version, folder = (self.software.get(name) for name in ("MaterialX", "MaterialX folder"))
        judged = f" MaterialX {version}{f', from {folder}' if folder else ''}." if version else ""
        return self.summary.sentence + judged

    @property
    def origins(self) -> tuple[str, ...]:
        """For each folder judged as a library, how many files are its own and how many MaterialX's."""
        return tuple(
            f"library {folder}: {counted(len(files['folder']), 'file')} from the folder, "
            + (
                f"{len(files['MaterialX']) or 'none'} from"
                if "MaterialX" in files
                else "loaded before"
            )
            + f" MaterialX {self.software['MaterialX']}"
            for folder, files in self.libraries.items()
        )

    @cached_property
    def image_names(self) -> tuple[str, ...]:
        """File names for the pictures, without suffix: ASCII, and different whatever the case."""
        return image_names(self.pictures)
