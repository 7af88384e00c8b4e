# SPDX-License-Identifier: Apache-2.0
"""llvmpipe's machine code of the forms of EON: instructions of the timed loop, and a processor's cycles.

python -m tools.benchmarks.machine_code [PROCESSOR ...]     names as those of `llvm-mca -mcpu`

The driver's code is read from the memory of this process. objdump takes it apart; llvm-mca models a
processor that need not be here. What the loop alone has is subtracted.
"""

import os
import re
import subprocess
import sys
import tempfile
from collections import Counter
from mmap import PAGESIZE
from unittest.mock import patch

from tools.benchmarks.check import CACHE
from tools.benchmarks.rivals import BASES, RIVALS
from tools.benchmarks.shaders import Device

FORMS = ("EON, quartic", "EON, eonlib", "EON, printed", "EON, stock")
PROCESSORS = ("znver3", "skylake-avx512")
KINDS = {
    "products and sums": r"v(mul|add|sub)ps",
    "divisions": r"vdivps",
    "square roots": r"vsqrtps",
    "others": r"",
}
LINE = re.compile(r"\s*([0-9a-f]+):\t[0-9a-f ]+\t(\S+)[ \t]*([^#\n]*)")
ROOT = "vsqrtps"  # which the loop around a form has for its directions, and no other loop


def executable():
    """Pages of this process's memory that hold code of no file: contents by address."""
    with open("/proc/self/maps", encoding="ascii") as file:
        rows = [line.split() for line in file]
    found = (row[0].split("-") for row in rows if "x" in row[1] and len(row) < 6)
    pages = {}
    with open("/proc/self/mem", "rb") as memory:
        for start, end in found:
            memory.seek(int(start, 16))
            for address in range(int(start, 16), int(end, 16), PAGESIZE):
                pages[address] = memory.read(PAGESIZE)
    return pages


def machine_code(device, statement):
    """The code that the driver makes for a loop around a statement.

    By pages: the kernel joins a range of addresses with one beside it, and the driver may use one again.
    """
    before = executable()
    device.run(device.kernel(statement), calls=1)
    pages = sorted(executable().items())
    return b"".join(content for address, content in pages if before.get(address) != content)


def loop(code):
    """Name and operands of each instruction of the shortest loop that has a root, jumps left out."""
    with tempfile.NamedTemporaryFile(suffix=".bin") as file:
        file.write(code)
        file.flush()
        command = ["objdump", "-D", "-b", "binary", "-mi386:x86-64", file.name]
        text = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    rows = [(int(each[1], 16), each[2], each[3].strip()) for each in LINE.finditer(text)]
    places = {place: index for index, (place, *_) in enumerate(rows)}
    back = [
        (places[int(target, 16)], index)
        for index, (place, name, target) in enumerate(rows)
        if name.startswith("j") and target.startswith("0x") and int(target, 16) in places
    ]
    rooted = [(a, b) for a, b in back if any(name == ROOT for _, name, _ in rows[a:b])]
    start, end = min(rooted, key=lambda each: each[1] - each[0])
    return [row[1:] for row in rows[start:end] if not row[1].startswith("j")]


def kinds(instructions):
    """Number of instructions by kind."""
    return Counter(
        next(kind for kind, names in KINDS.items() if re.match(names, name))
        for name, _ in instructions
    )


def cycles(instructions, processor):
    """Cycles of one pass of a loop as llvm-mca models a processor."""
    command = ["llvm-mca", f"-mcpu={processor}", "-march=x86-64", "-iterations=200"]
    text = "\n".join(" ".join(each) for each in instructions)
    run = subprocess.run(command, input=text, capture_output=True, text=True, check=True)
    return int(re.search(r"Total Cycles:\s+(\d+)", run.stdout)[1]) / 200


def main(processors):
    """Print the table, in Markdown."""
    statements = {each.name: each.statement for each in RIVALS if each.name in FORMS}
    with patch.dict(os.environ, {CACHE: "true"}):
        device = Device(64)
        base, *codes = (
            loop(machine_code(device, each)) for each in (BASES["value"], *statements.values())
        )
    columns = [*KINDS, *(f"cycles, {each}" for each in processors)]
    print(f"| form | {' | '.join(columns)} |\n|{'---|' * (1 + len(columns))}")
    for name, code in zip(statements, codes, strict=True):
        counts = [f"{kinds(code)[kind] - kinds(base)[kind]}" for kind in KINDS]
        modeled = [f"{cycles(code, each) - cycles(base, each):.1f}" for each in processors]
        print(f"| {name} | {' | '.join([*counts, *modeled])} |")


if __name__ == "__main__":
    main(sys.argv[1:] or PROCESSORS)
