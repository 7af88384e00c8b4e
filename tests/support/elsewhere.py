# SPDX-License-Identifier: Apache-2.0
"""Runs the parts of mxeon that need no engine, with POSIX modules and functions removed.

The program imports every module, then runs each command in the working folder. With the Python
option `-X warn_default_encoding`, opening a file in the platform's encoding is an error.
"""

import os
import signal
import sys
import warnings
from functools import partial
from importlib import import_module
from pkgutil import walk_packages
from types import ModuleType

MODULES = (
    *("crypt", "curses", "fcntl", "grp", "nis", "pty", "pwd", "readline", "resource", "spwd"),
    *("syslog", "termios", "tty"),
)
FUNCTIONS = (
    *("chown", "chroot", "confstr", "fchmod", "fchown", "fork", "forkpty", "getegid", "geteuid"),
    *("getgid", "getgroups", "getloadavg", "getpgid", "getpgrp", "getsid", "getuid", "killpg"),
    *("lchown", "lockf", "mkfifo", "mknod", "nice", "pathconf", "posix_spawn", "posix_spawnp"),
    *("pread", "pwrite", "readv", "register_at_fork", "sched_getaffinity", "sendfile", "setpgid"),
    *("setsid", "statvfs", "sysconf", "wait", "wait3", "wait4", "writev"),
    *("O_CLOEXEC", "O_DIRECTORY", "O_NDELAY", "O_NOCTTY", "O_NOFOLLOW", "O_NONBLOCK", "O_SYNC"),
)
SIGNALS = {"SIGABRT", "SIGFPE", "SIGILL", "SIGINT", "SIGSEGV", "SIGTERM", "SIG_DFL", "SIG_IGN"}
COMMANDS = (
    "--version",
    "library",
    "library --folder",
    "library --export copy",
    "library --export copy.zip",
    "generate --target glsl --target osl --target wgsl --outputPath shaders {examples}/plaster.mtlx",
    "invert 0.8 0.4 0.1 --roughness 0.7",
    "explore {examples}/clay.mtlx --output clay.html --workers 0",
    "kit export kit",
    "check {examples}/clay.mtlx --host msl --workers 0 --report before",
    "check {examples}/clay.mtlx --host msl --workers 0 --report after",
    "report make after",
    "report diff before after",
    "report schema",
)
NOT_RUN = ("check", "report make")  # exit status 3: the shaders for msl are generated, not run


class Windows(ModuleType):
    """Stand-in for the module `sys` that reports the platform as Windows."""

    platform = "win32"

    def __getattr__(self, name: str) -> object:
        return getattr(sys, name)


def hide() -> None:
    warnings.filterwarnings("error", category=EncodingWarning, module="mxeon")
    sys.modules.update(dict.fromkeys(MODULES))  # importing these modules raises ImportError
    for name in FUNCTIONS:
        vars(os).pop(name, None)
    for name in [each for each in vars(signal) if each.startswith(("SIG", "pthread_", "sigw"))]:
        if name not in SIGNALS:
            delattr(signal, name)


def import_all() -> None:
    """Import every module that does not run in a renderer's Python, and pretend to be Windows.

    OpenGL uses EGL without a display, because an X server may end at any time.
    """
    import glcontext

    import mxeon

    glcontext.default_backend = partial(glcontext.get_backend_by_name, "egl")

    for found in walk_packages(mxeon.__path__, "mxeon."):
        if found.name.endswith(("worker", "__main__")) or found.name.startswith("mxeon.mitsuba"):
            continue
        import_module(found.name)
    for name, module in list(sys.modules.items()):
        if name.partition(".")[0] == "mxeon" and vars(module).get("sys") is sys:
            vars(module)["sys"] = Windows("sys")


def main() -> None:
    """Import all modules and run all commands. Exit at the first unexpected status."""
    hide()
    import_all()
    import numpy as np

    import mxeon
    from mxeon.cli import main as run
    from mxeon.shaders.library import examples_folder

    for command in COMMANDS:
        print(f"$ mxeon {command}", flush=True)
        words = [word.format(examples=examples_folder()) for word in command.split()]
        assert run(words) == (3 if command.startswith(NOT_RUN) else 0), command
    eon, wo, options = mxeon.model("eon"), [0.0, 0.6, 0.8], {"color": 0.5, "roughness": 1.0}
    wi, pdf = eon.sample(wo, [0.3, 0.7], **options)
    assert np.isfinite(eon.brdf(wo, wi, **options) / pdf).all()


if __name__ == "__main__":
    main()
