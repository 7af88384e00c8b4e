# SPDX-License-Identifier: Apache-2.0
"""Expected frames of a client: a matte sphere in MaterialX's lights, in float64.

Lights, shadows and alpha follow MaterialX's text, since no specification describes them: at distance d a light is
divided by (1 + d)^decay, a spot light falls off smoothly between two cosines, and shadows use Chebyshev's bound.
"""

import numpy as np

from mxeon.conformance.samples import Array, sky
from mxeon.hosts.base import TURN
from mxeon.shaders.methods import Methods
from mxeon.shaders.scene import Client, Lamp

LEAST_VARIANCE = 1e-5  # least variance of depths in a shadow map
TRANSPARENT = 0.3333  # weight of each channel of the transparency in alpha


def lamp_light(lamp: Lamp, position: Array) -> tuple[Array, Array]:
    """Direction to a light, and the irradiance of a surface facing it, at positions (N, 3)."""
    direction = np.broadcast_to(np.negative(lamp.direction), position.shape)
    irradiance = np.broadcast_to(np.multiply(lamp.color, lamp.intensity), position.shape)
    if lamp.type == 1:
        return direction, irradiance
    away = lamp.position - position
    distance = np.linalg.norm(away, axis=1, keepdims=True)
    to, irradiance = away / distance, irradiance / (distance + 1.0) ** lamp.decay_rate
    if lamp.type == 2:
        return to, irradiance
    low, high = min(lamp.inner_angle, lamp.outer_angle), lamp.inner_angle
    t = np.clip((to @ np.negative(lamp.direction) - low) / (high - low), 0.0, 1.0)[:, np.newaxis]
    return to, irradiance * t * t * (3.0 - 2.0 * t)


def shadow(client: Client, position: Array) -> Array:
    """Share of the first light that reaches positions, (N, 1)."""
    matrix = np.reshape(client.shadow, (4, 4)).T
    x = np.concatenate([position, np.ones((len(position), 1))], axis=1) @ matrix.T
    mean, square = client.moments
    behind = np.maximum(0.5 + 0.5 * x[:, 2:3] / x[:, 3:] - mean, 0.0)
    variance = max(square - mean * mean, LEAST_VARIANCE)
    return np.asarray(variance / (variance + behind * behind))


def environment(client: Client, normal: Array) -> Array:
    """Irradiance over pi from the environment; the uneven map is `mxeon.conformance.samples.sky`, (N, 3)."""
    if client.irradiance is None:
        return np.zeros_like(normal)
    if client.irradiance.shape[0] == 1:
        return np.broadcast_to(client.intensity * client.irradiance[0, 0], normal.shape)
    turned = normal @ np.reshape(client.turn, (4, 4))[:3, :3] @ TURN[:3, :3]
    return np.asarray(client.intensity * sky(turned))


def light(client: Client, methods: Methods, normal: Array) -> Array:
    """Light reflected by a white matte point of the unit sphere, (N, 3)."""
    total = np.zeros_like(normal)
    for number, lamp in enumerate(client.lamps):
        to, irradiance = lamp_light(lamp, normal)
        cosine = np.maximum(np.sum(to * normal, axis=1, keepdims=True), 0.0)
        total += irradiance / np.pi * cosine * (shadow(client, normal) if number == 0 else 1.0)
    if methods.environment != "none":
        ambient = 1.0 + client.gain * (client.ambient - 1.0)
        total += ambient * environment(client, normal)
    return total


def alpha_of(covered: float) -> float:
    """Alpha of a surface that covers a share of its background."""
    return 1.0 - 3.0 * TRANSPARENT * (1.0 - covered)
