# SPDX-License-Identifier: Apache-2.0
"""Things that execute a shader, one module each; all offer the same verbs.

    identity()                                   -> Identity
    picture(shader, scene)                       -> ndarray (size, size, 3) float32, linear, 0 off the sphere
    evaluate(shader, wo, wi, inputs, branch)     -> ndarray (N, 3), f cos(theta_i) in 1/sr, or the albedo
    call(function, *arguments)                   -> ndarray (N, 3), a function of the shader twins

each as far as that host can. A host that cannot do something here raises NotRun with the reason.
"""

from dataclasses import dataclass
from importlib import import_module

import MaterialX as mx

from mxeon.errors import InputError, NotRun
from mxeon.shaders.generation import TARGETS
from mxeon.shaders.library import TESTED


@dataclass(frozen=True)
class Identity:
    """Who executed: the host's name, its version and the device it ran on."""

    name: str
    version: str
    device: str


# Name on the command line, which is that of a module of this package with a class `Host`.
HOSTS = ("gl", "webgl", "vulkan", "slang", "cycles", "cycles-native", "testrender", "reference")

MODULES = {name: f"shaders.hosts.{name}" for name in HOSTS}
MODULES |= {"cycles-native": "shaders.hosts.cycles.native", "reference": "conformance.reference"}

# Targets whose text is generated and checked, and what it would take to run it.
TEXT_ONLY = {
    "msl": "Metal, which macOS alone has",
    "mdl": "a renderer that compiles MDL",
    "wgsl": "MaterialX's WGSL in place of the GLSL that it writes, which WebGPU does not take",
}


def open_host(name):
    """The host called `name`, started.

    Raises
    ------
    ValueError
        If there is no such host; lists the known ones.
    NotRun
        If it cannot run on this machine.
    """
    if name in TEXT_ONLY:
        raise NotRun(f"{name}: running it needs {TEXT_ONLY[name]}; its text is checked")
    if name not in HOSTS:
        raise InputError(f"host must be one of {', '.join((*HOSTS, *TEXT_ONLY))}; got {name!r}")
    host = import_module(f"mxeon.{MODULES[name]}").Host
    if host.target not in TARGETS:
        raise NotRun(
            f"{name}: MaterialX must have a generator for {host.target}; {mx.__version__} has none: "
            f"pip install materialx=={TESTED[-1]}"
        )
    return host()
