# SPDX-License-Identifier: Apache-2.0
"""Checks what a client binds to a shader besides the material, such as lights and shadow maps.

A frame is a picture drawn by the whole generated main(), with point and spot lights, a shadow map,
ambient occlusion and transparency. A frame has one state, such as "a point light", for each axis of
AXES, such as "lights". Any two states of different axes occur together in some frame.

No specification describes lights, shadows and alpha, so the expected values follow MaterialX's
shader code. The intensity of a light at distance d is divided by (1 + d)^decay, a spot light falls
off smoothly between two cosines, and shadows use Chebyshev's bound.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import lru_cache, partial
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from mxeon.conformance import check, controls, diagnosis, results
from mxeon.conformance.case import Case
from mxeon.conformance.checks.states import covering, named, shared
from mxeon.conformance.samples import RIM, Array, Batch
from mxeon.conformance.specs.clients import BACK, FRONT, FrameSpec
from mxeon.conformance.tolerance import Compared
from mxeon.hosts import host_row
from mxeon.shaders.methods import GENERATED, UNCHOSEN, Methods
from mxeon.shaders.scene import VIEW, Client, Lamp, Matrix, Scene, sphere

if TYPE_CHECKING:  # the import loads MaterialX
    from mxeon.shaders.generation import Shader

SIZE = 16  # width and height of a frame in pixels
WHITE_MAP, WARM_MAP = (np.full((1, 1, 3), each, np.float32) for each in (1.0, (0.75, 0.5, 0.25)))
# Paths of the document's inputs, and the names by which the function `material` sets the inputs.
NAMES = {"shading/mix": "mix", "front/opacity": "front", "back/opacity": "back"}
LEAST_VARIANCE = 1e-5  # smallest variance of depths in a shadow map
TRANSPARENT = 0.3333  # weight of each color channel in the alpha of a transparent surface
# A shadow matrix that maps the sphere's depths into [0.2, 0.7]. The homogeneous coordinate w is
# 1.5, so shaders must divide by w.
SHADOW: Matrix = (1.2, 0.1, 0.3, 0.0, 0.2, 1.1, 0.2, 0.0, 0.1, 0.3, -0.6, 0.0, 0.0, 0.0, 0.0, 1.5)


class Frame(NamedTuple):
    """A client's bindings, the lighting methods of the generator, and inputs of the material."""

    client: Client = Client()
    methods: Methods = UNCHOSEN
    inputs: Mapping[str, float] = {}


Build = Callable[[Frame], Frame]


def same(frame: Frame) -> Frame:
    return frame


def premultiplied(frame: Frame) -> Frame:
    """A frame without an environment. Since MaterialX 1.39.5, mixes scale the weights of lobes."""
    from mxeon.shaders.options import offers

    methods = Methods("none", "opacity", premultiplied=offers("premultiplied") or None)
    return frame._replace(methods=methods)


def bound(**bindings: Any) -> Build:
    return lambda frame: frame._replace(client=replace(frame.client, **bindings))


def material(**inputs: float) -> Build:
    """A state that sets inputs of the material: `mix`, and the opacities `front` and `back`."""
    return lambda frame: frame._replace(inputs={**frame.inputs, **inputs})


SUN = Lamp(direction=(0.6, 0.0, -0.8), color=(1.0, 0.5, 0.2))
BULB = Lamp(type=2, position=(1.0, 2.0, 1.5), color=(0.5, 1.0, 0.2), intensity=20.0)
# fmt: off
SPOT = Lamp(type=3, position=(0.0, 1.0, 2.5), direction=(0.0, -0.6, -0.8), color=(0.2, 0.5, 1.0),
            intensity=30.0, inner_angle=0.95, outer_angle=0.8, decay_rate=1.5)
# States of a frame by axis. The first state of an axis is the default, which other checks use.
# States with the same words before a colon form a group that a diagnosis can name.
AXES: dict[str, dict[str, Build]] = {
    "methods": {"the default methods": same, "premultiplied mixes without an environment": premultiplied},
    "lights": {
        "no light": same,
        "a directional light": bound(lamps=(SUN,)),
        "a point light": bound(lamps=(BULB,)),
        "a point light: without decay": bound(lamps=(replace(BULB, decay_rate=0.0),)),
        "a spot light": bound(lamps=(SPOT,)),
        "three lights": bound(lamps=(BULB, SPOT, SUN)),
        "three lights: in another order": bound(lamps=(SUN, BULB, SPOT)),
    },
    "environment": {
        "no environment": same,
        "an environment": bound(radiance=WHITE_MAP, irradiance=WHITE_MAP),
        "an environment: colored": bound(radiance=WARM_MAP, irradiance=WARM_MAP),
    },
    "bound": {
        "what the generator sets": same,
        "another intensity of the environment": bound(intensity=1.75),
        "a shadow map": bound(shadow=SHADOW, moments=(0.4, 0.18)),
        "ambient occlusion": bound(ambient=0.4, gain=0.75),
    },
    "opacity": {
        "opaque surfaces": same,
        "an opacity below 1": material(front=0.6, back=0.75),
        "an opacity below 1: 0": material(front=0.0, back=0.75),
    },
    "surfaces": {
        "one surface": same,
        "the other of two surfaces": material(mix=0.0),
        "a mix of surfaces": material(mix=0.3),
    },
}
# fmt: on


@lru_cache(maxsize=1)
def frames() -> tuple[tuple[set[str], Frame], ...]:
    """All frames, with names of states. Frames with equal lighting methods are consecutive."""
    rows = []
    for states in covering(tuple(map(tuple, AXES.values()))):
        frame = Frame()
        for axis, state in zip(AXES.values(), states, strict=True):
            frame = axis[state](frame)
        rows.append((named(states, AXES), frame))
    return tuple(sorted(rows, key=lambda row: str(row[1].methods)))


def lamp_light(lamp: Lamp, position: Array) -> tuple[Array, Array]:
    """Direction to a light, and irradiance of a surface facing the light, at positions (N, 3)."""
    direction = np.broadcast_to(np.negative(lamp.direction), position.shape)
    irradiance = np.broadcast_to(np.multiply(lamp.color, lamp.intensity), position.shape)
    if lamp.type == 1:
        return direction, irradiance
    direction = lamp.position - position
    distance = np.linalg.norm(direction, axis=1, keepdims=True)
    direction, irradiance = direction / distance, irradiance / (distance + 1.0) ** lamp.decay_rate
    if lamp.type == 2:
        return direction, irradiance
    low, high = min(lamp.inner_angle, lamp.outer_angle), lamp.inner_angle
    cosine = direction @ np.negative(lamp.direction)[:, np.newaxis]
    t = np.clip((cosine - low) / (high - low), 0.0, 1.0)
    return direction, irradiance * t * t * (3.0 - 2.0 * t)


def shadow(client: Client, position: Array) -> Array:
    """Fraction of the first light that the shadow map passes to each position, (N, 1)."""
    x = np.insert(position, 3, 1.0, axis=1) @ np.reshape(client.shadow, (4, 4))
    mean, square = client.moments
    behind = np.maximum(0.5 + 0.5 * x[:, 2:3] / x[:, 3:] - mean, 0.0)
    variance = max(square - mean * mean, LEAST_VARIANCE)
    return np.asarray(variance / (variance + behind * behind))


def light(client: Client, methods: Methods, normal: Array) -> Array:
    """Radiance of a white, matte unit sphere, (N, 3), at positions that equal the normals."""
    total = np.zeros_like(normal)
    for number, lamp in enumerate(client.lamps):
        direction, irradiance = lamp_light(lamp, normal)
        cosine = np.maximum(np.sum(direction * normal, axis=1, keepdims=True), 0.0)
        total += irradiance / np.pi * cosine * (shadow(client, normal) if number == 0 else 1.0)
    if methods.environment != "none" and client.irradiance is not None:
        ambient = 1.0 + client.gain * (client.ambient - 1.0)
        total += ambient * client.intensity * client.irradiance[0, 0]
    return total


def drawn(case: Case) -> Iterator[tuple[set[str], Compared]]:
    """Compare colors and then alphas of each frame, and yield the names of the frame's states.

    If alphas are compared, the names include "alpha".
    """
    from mxeon.hosts.raster import ALPHA_THRESHOLD  # loads MaterialX
    from mxeon.shaders.generators import CLIENT_OPTIONS

    points = sphere(SIZE)
    normal = points.normal[points.mask]
    view = np.broadcast_to(VIEW, normal.shape)
    batch = Batch(view, view, {"normal": normal})
    shaders: dict[Methods, Shader] = {}
    for states, (client, methods, inputs) in frames()[:: 6 if case.control else 1]:
        if methods not in shaders:
            make = partial(case.host.compile, library=case.library, client=CLIENT_OPTIONS)
            [shaders[methods]] = make(case.spec.document(), methods=methods)
        ports = (
            replace(each, value=inputs.get(NAMES.get(each.path, ""), each.value))
            for each in shaders[methods].inputs
        )
        shader = replace(shaders[methods], inputs=tuple(ports))
        share, front, back = (inputs.get(name, 1.0) for name in NAMES.values())
        front, back = share * front, (1.0 - share) * back
        color = (front * FRONT + back * BACK) * light(client, methods.over(GENERATED), normal)
        opacity = 1.0 - 3.0 * TRANSPARENT * (1.0 - front - back)
        opacity *= opacity >= ALPHA_THRESHOLD  # pixels below the threshold are discarded
        for alpha, expected in ((False, color), (True, np.full_like(color, opacity))):
            scene = Scene("client", size=SIZE, client=replace(client, alpha=alpha))
            measured = case.host.picture(shader, scene)[points.mask].astype(np.float64)
            compared = Compared(batch, case.outputs(batch, measured), expected)
            yield states | {"alpha"} if alpha else states, compared.where(normal[:, 2] >= RIM)


def diagnose(case: Case) -> results.Diagnosis:
    tolerance, rows = case.tolerance("frame"), list(drawn(case))
    wrong = np.array([tolerance.wrong(compared).any() for _, compared in rows])
    common = shared(wrong, [states for states, _ in rows])
    common = replace(common, key=f"{common.key}_of_frames")
    return results.Diagnosis((common, *diagnosis.not_finite([compared for _, compared in rows])))


# fmt: off
ROWS = (
    check.Check(key="client",
          claim="A rendered frame has every light, the environment, shadows and occlusion that a client binds, and alpha.",
          applies=check.family(FrameSpec), measure=lambda case: (compared for _, compared in drawn(case)),
          tolerance="frame", control=controls.scale("values are 1 % too large", 1.01),
          explain=diagnose, hosts=lambda spec, host: bool(host_row(host).scenes),
          methods=lambda spec, methods: methods == GENERATED),
)
# fmt: on
