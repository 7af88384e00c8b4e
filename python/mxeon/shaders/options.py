# SPDX-License-Identifier: Apache-2.0
"""Options of MaterialX's rasterizing generators, including options without Python bindings.

MaterialX 1.39.5 has no bindings for the directional albedo method, the transmission method and the
number of Airy iterations. In C++, these options are the integers after the member
`hwSpecularEnvironmentMethod`. Versions before 1.39.5 have no Airy iterations. Changing
`hwSpecularEnvironmentMethod` through its binding reveals the offset of the member. The integers are
only written if they hold their defaults, and `mxeon.shaders.methods.assert_generated` compares the
generated text with the chosen methods. So an object with a different layout leads to an error
instead of a wrong shader.
"""

import ctypes

import MaterialX as mx
import MaterialX.PyMaterialXGenShader as mx_gen

ENVIRONMENTS = ("none", "fis", "prefilter")  # order of MaterialX's enumeration
ALBEDOS = ("analytic", "table", "monteCarlo")
TRANSMISSIONS = ("refraction", "opacity")
DEFAULTS = [0, 0, 2]  # analytic albedos, refraction, two Airy iterations
BOUND = {
    "premultiplied": "premultipliedBsdfAdd",
    "distributed": "distributeLayerOverBsdfMix",
}
SIZE = 512  # bytes to search; the object that contains the options is larger
VALUE = 2 * ctypes.sizeof(ctypes.c_void_p)  # offset of pybind11's pointer in a Python object


def offers(name: str) -> bool:
    """Whether the installed MaterialX has the option that BOUND lists for a method."""
    return hasattr(mx_gen.GenOptions, BOUND[name])


def set_options(
    options: mx_gen.GenOptions,
    environment: str = "fis",
    transmission: str = "refraction",
    albedo: str = "analytic",
    airy: int = 2,
    **bound: bool,
) -> None:
    """Set the options in `Methods`. Raise LookupError if MaterialX lacks one of the options."""
    for name, value in bound.items():
        if not offers(name):
            raise LookupError(f"MaterialX {mx.getVersionString()} has no option {BOUND[name]}")
        setattr(options, BOUND[name], value)
    values = [ALBEDOS.index(albedo), TRANSMISSIONS.index(transmission), airy]
    if values != DEFAULTS:
        members = unbound_members(options, len(values) - (airy == DEFAULTS[-1]))
        for place in range(len(members)):
            members[place] = values[place]
    method = mx_gen.HwSpecularEnvironmentMethod(ENVIRONMENTS.index(environment))
    options.hwSpecularEnvironmentMethod = method


def unbound_members(options: mx_gen.GenOptions, count: int) -> "ctypes.Array[ctypes.c_int]":
    """The integers after hwSpecularEnvironmentMethod. Raise LookupError if a default differs."""
    address = ctypes.c_void_p.from_address(id(options) + VALUE).value or 0
    memory = (ctypes.c_int * (SIZE // ctypes.sizeof(ctypes.c_int))).from_address(address)
    states = []
    for value in range(len(ENVIRONMENTS)):
        options.hwSpecularEnvironmentMethod = mx_gen.HwSpecularEnvironmentMethod(value)
        states.append(tuple(memory))
    places = [n for n, each in enumerate(zip(*states, strict=True)) if each == (0, 1, 2)]
    first = places[0] + 1 if len(places) == 1 else len(memory)
    if list(memory[first : first + count]) != DEFAULTS[:count]:
        raise LookupError(
            f"MaterialX {mx.getVersionString()} keeps options without a Python binding elsewhere"
        )
    place = address + first * ctypes.sizeof(ctypes.c_int)
    return (ctypes.c_int * count).from_address(place)
