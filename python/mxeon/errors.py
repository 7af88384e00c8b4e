# SPDX-License-Identifier: Apache-2.0
"""Errors with a message for the user.

The command prints the message in one line and exits with the error's status. Every other exception
is a bug of mxeon and prints its traceback.
"""

import re
from collections.abc import Iterable, Iterator, Sequence

from mxeon.names import unknown

PASSED, FAILED, MISUSE, NOT_RUN = 0, 1, 2, 3  # exit statuses of the command

LONGEST = 1000  # maximum length of a message, which may quote a document
MOST = 20  # maximum number of faults in a message
CUT = " [...]"  # end of a truncated message
# Control characters, characters that override the text direction, and surrogates.
STEERING = re.compile(
    "[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]"
)
# Prefixes of commands to GitHub's runner, either at the start of a line or anywhere.
COMMAND = re.compile(r"(?:^|(?<=\r))\s*::|##\[", re.MULTILINE)


def install(extra: str) -> str:
    """The command that installs the additional requirements of a part of mxeon.

    >>> install("fit")
    "pip install '.[fit]' in a checkout of mxeon"
    """
    return f"pip install '.[{extra}]' in a checkout of mxeon"


class MxeonError(Exception):
    """An error whose message is one line for the user."""

    status = MISUSE  # exit status of a command that ends with this error


class InputError(MxeonError, ValueError):
    """An argument, name or file that cannot be used. The message states the rule and the value."""


class DocumentError(InputError):
    """A document for which no shader can be generated. The arguments are the document's faults."""

    def __init__(self, *faults: str) -> None:
        super().__init__(*_shortened(faults, "faults"))

    def __str__(self) -> str:
        return "\n".join(self.args)


class ImageError(InputError):
    """An image that cannot be used. `reason` is the message of the system or of OpenImageIO."""

    def __init__(self, message: str, reason: str = "") -> None:
        super().__init__(f"{message}; {reason}" if reason else message)
        self.reason = reason


class CheckError(MxeonError, RuntimeError):
    """A run that did not pass.

    The arguments are lines with the verdict, and with what was refused or failed.

    - `status`: The exit status of the run.
    """

    def __init__(self, *lines: str, status: int = FAILED) -> None:
        super().__init__(*_shortened(lines, "lines"))
        self.status = status

    def __str__(self) -> str:
        return "\n".join(self.args)


class PackageError(MxeonError, ImportError):
    """A Python package that is missing or too old for mxeon."""


class LibraryError(MxeonError, RuntimeError):
    """A data library that differs from the requested library."""

    status = FAILED


class ShaderError(MxeonError, RuntimeError):
    """A shader that the host's compiler rejects. The error contains the compiler's message."""

    status = FAILED


# Compiler messages have the form "0:12(3): error: words" or "ERROR: 0:12: words". Slang's messages
# quote a line of the shader instead.
REFUSED = re.compile(
    r"error\[\w+\]: (?P<slang>.+)\n.*\n.*\n\d+ \| (?P<line>.+)|"
    r"[:(](?P<number>\d+)[:()\d]*:\s*(?:error\b[^:]*:\s*)?(?P<words>.+)"
)
FUNCTION = re.compile(r"^\w[\w ]* (\w+)\([^;]*$", re.MULTILINE)


def refused(host: str, words: str, text: str) -> ShaderError:
    """The error for a rejected shader, with the function, the line and the first compiler message.

    >>> str(refused("gl", "0:2(1): warning: no use\\n0:3(1): error: no x", "float f()\\n{\\n    return x;\\n}\\n"))
    "gl: the shader does not compile, in f: 'return x;': no x"
    """
    lines = text.split("\n")
    found = REFUSED.search("\n".join(each for each in words.split("\n") if "warning" not in each))
    number = 0
    if found:
        number = int(found["number"] or text[: text.find(found["line"])].count("\n") + 1)
    if not found or not 0 < number <= len(lines):
        return ShaderError(f"{host}: the shader does not compile: {words.strip()}")
    functions = FUNCTION.findall("\n".join(lines[:number]))
    place = f"in {functions[-1]}: " if functions else ""
    line, message = lines[number - 1].strip(), (found["slang"] or found["words"]).strip()
    return ShaderError(f"{host}: the shader does not compile, {place}{line!r}: {message}")


class NotRun(MxeonError, RuntimeError):
    """Something that cannot run here. The message states what cannot run, and the reason."""

    status = NOT_RUN


class Unsupported(NotRun):
    """An operation that a host does not support."""


class Implied(NotRun):
    """A measurement that is impossible because of another failure, which has its own result."""


class OutsideModel(NotRun):
    """A value outside the range of a model. `input` is the path of the input in the document."""

    def __init__(self, message: str, input: str = "") -> None:
        super().__init__(message)
        self.input = input


class InterfaceError(NotRun):
    """An installed MaterialX that calls closures differently from eonlib's definitions."""


def _shortened(lines: Sequence[str], noun: str) -> Iterator[str]:
    """The first MOST lines, and a line with the number of the remaining lines."""
    if len(lines) > MOST + 1:
        lines = (*lines[:MOST], f"and {len(lines) - MOST} more {noun}")
    return map(one_line, lines)


def assert_known(rule: str, name: object, known: Iterable[str], listing: str = "") -> None:
    """Raise InputError unless a name is known. The message is from `mxeon.names.unknown`."""
    if message := unknown(rule, name, known, listing=listing):
        raise InputError(message)


# Separates the reason why a process ended from what the process printed last.
LAST_OUTPUT = "; last output: "


def printable(text: str) -> str:
    """Text in which U+FFFD replaces surrogates and characters that control terminals or GitHub."""
    return COMMAND.sub("\ufffd", STEERING.sub("\ufffd", text))


def as_output(text: str) -> str:
    """JSON text that has the same value and cannot contain commands to GitHub's runner."""
    return text.replace("##[", "#\\u0023[")


def one_line(text: object) -> str:
    """The message as one readable line without control characters."""
    line = " ".join(printable(str(text)).split())
    return line if len(line) <= LONGEST else f"{line[: LONGEST - len(CUT)]}{CUT}"
