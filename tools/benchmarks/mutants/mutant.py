# SPDX-License-Identifier: Apache-2.0
"""The mutants in `table/*.toml`, which are single textual changes of eonlib.

For each mutated file, a negative control changes only the first comment. No check may detect a
negative control.
"""

import re
import tomllib
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from mxeon.shaders.functions import STEMS

TABLE = Path(__file__).with_name("table")
ROOT = Path(__file__).resolve().parents[3]
TWINS = (*STEMS, "hair_parameters")  # files with the same functions in GLSL and OSL
FOLDERS = ("libraries", "genglsl", "genosl")  # folders of eonlib
CONTROLS = "Negative controls"
COMMENT = "SPDX-License-Identifier"  # the first comment of every file has this text


@dataclass(frozen=True)
class Mutant:
    """A single wrong change in a file of eonlib."""

    name: str  # unique name in the table
    group: str  # title of the mutated implementation
    file: str  # path of the mutated file from the root
    old: str  # text to replace; must occur once in the file
    new: str  # replacement of `old`
    reason: str  # why the change is wrong, or why values stay the same
    host: str  # cheapest host that detects the mutant; "text" if no host is needed
    equivalent: bool  # whether no valid input reveals the change
    survives: bool  # whether the mutant is known to pass all checks
    tests: tuple[str, ...] = ()  # tests to run first if the reference is mutated
    operator: str = ""  # name of the operator that made the mutant
    place: tuple[int, int] = (0, 0)  # start and end of the mutated code in `file`

    def texts(self) -> dict[str, str]:
        """Texts of the mutated files by path, including the OSL version of a GLSL file."""
        texts = {self.file: self._replaced(self.file, re.escape(self.old), self.new)}
        twin = self.file.replace("glsl", "osl")
        if self.file.startswith("genglsl/") and Path(self.file).stem in TWINS:
            old = re.sub(r"\bvec3\b", "(?:color|vector)", re.escape(self.old))
            texts[twin] = self._replaced(twin, old, re.sub(r"\bvec3\b", "color", self.new))
        return texts

    def _replaced(self, file: str, old: str, new: str) -> str:
        text, count = re.subn(old, lambda _: new, (ROOT / file).read_text(encoding="utf-8"))
        if count != 1:
            rule = f"the old text must occur once in {file}"
            raise ValueError(f"{self.name}: {rule}; got {count} times")
        return text

    @property
    def control(self) -> bool:
        """Whether the mutant is a negative control, which only changes a comment."""
        return self.group == CONTROLS

    @property
    def digest(self) -> str:
        return sha256("".join(self.texts().values()).encode()).hexdigest()[:16]


def read_table() -> tuple[Mutant, ...]:
    """All mutants of the table, and a negative control for each mutated file."""
    files = [tomllib.loads(path.read_text(encoding="utf-8")) for path in TABLE.glob("*.toml")]
    table = [
        Mutant(
            name,
            group["title"],
            part["file"],
            old,
            new,
            reason,
            group["host"],
            key == "equivalents",
            key != "mutants",
            tuple(part.get("tests", ())),
        )
        for group in sorted(files, key=lambda group: group["order"])
        for part in group["files"]
        for key in ("mutants", "survivors", "equivalents")
        for name, old, new, reason in part.get(key, ())
    ]
    reason = "Only a comment changes."
    controls = (
        Mutant(
            *(f"control: {file}", CONTROLS, file, COMMENT, COMMENT.lower(), reason, "", True, True),
            tests=mutant.tests,
        )
        for file, mutant in {mutant.file: mutant for mutant in table}.items()
    )
    return (*table, *controls)
