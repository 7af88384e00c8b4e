# SPDX-License-Identifier: Apache-2.0
"""Prints a random sample of comments and docstrings, for readers who do not see the code.

    python -m tools.comments SEED COUNT FOLDER ...

A reader marks all texts that must be read twice. COUNT is the number of texts per FOLDER.
"""

import ast
import random
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[1]
COMMENT = re.compile(r"(?P<mark>//|#) (?!SPDX|---|noqa|type:|fmt:|ruff:)(?P<text>\S.*)")
SUFFIXES = (".py", ".glsl", ".osl", ".ts")


def texts(path: Path) -> list[str]:
    """Yield the docstrings and comments of a file. Consecutive comment lines are one comment."""
    text, found, last = path.read_text(encoding="utf-8"), [], 0
    if path.suffix == ".py":
        documented = (ast.Module, ast.ClassDef, ast.FunctionDef)
        nodes = [node for node in ast.walk(ast.parse(text)) if isinstance(node, documented)]
        found = [doc for node in nodes if (doc := ast.get_docstring(node))]
    for number, line in enumerate(text.splitlines(), 1):
        match = COMMENT.search(line)
        if not match or (match["mark"] == "#") != (path.suffix == ".py"):
            continue
        is_line = not line[: match.start()].strip()
        if is_line and last == number - 1:
            found[-1] += f" {match['text']}"
        else:
            found.append(match["text"] if is_line else line.strip())
        last = number if is_line else 0
    return found


def main(seed: str, count: str, *folders: str) -> None:
    for folder in folders:
        command = ["git", "ls-files", folder]
        names = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=True).stdout
        files = [name for name in names.splitlines() if name.endswith(SUFFIXES)]
        drawn = [(name, each) for name in files for each in texts(ROOT / name)]
        for name, each in random.Random(seed).sample(drawn, min(int(count), len(drawn))):
            print(f"{name}: {' '.join(each.split())}")


if __name__ == "__main__":
    main(*sys.argv[1:])
