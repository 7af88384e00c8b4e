# SPDX-License-Identifier: Apache-2.0
"""Blender's Cycles: eonlib's two closures against the stock closure, time to equal noise.

A sphere in a white furnace, whose picture is the directional albedo: what differs from that is
noise. Time is processor time of Blender's process beyond a picture of one sample, which leaves the
scene and the compilation of the shader out. To halve the noise takes four times the samples, so
that time x variance compares what does not cost the same.
"""

import os
from dataclasses import replace
from functools import partial

import numpy as np

from mxeon.hosts import cycles
from mxeon.models.diffuse.albedo import eon_albedo_dir
from mxeon.models.diffuse.known_defect_albedos import eon_rho_cubed_albedo_dir
from mxeon.shaders.generation import generate
from mxeon.shaders.nodes import FLAG, OREN_NAYAR, material_text
from mxeon.shaders.scene import FURNACE, Paths, sphere
from tools.benchmarks.rounds import Check, Group, figure, interleave, less, ratio, scaled

SIZE = 128
SAMPLES = (64, 512)
COLOR, ROUGHNESS = (0.8, 0.4, 0.1), 1.0
# Expected values: stock's multiple-scattering lobe carries one factor of rho too many.
ALBEDOS = {"eonlib": eon_albedo_dir, "stock": eon_rho_cubed_albedo_dir}

# The rim is left out, where a pixel's point is least certain.
RIM = 0.1

# A pixel of 64 samples is off by 3e-3 rms, and the mean of 12,000 by less than a tenth of that.
MEAN = 3e-4


def shader(library):
    """The generated OSL of the material."""
    inputs = {"color": COLOR, "roughness": ROUGHNESS, FLAG: True}
    text = material_text(OREN_NAYAR, inputs)
    profile = "cycles" if library == "eonlib" else None
    return generate(text, "osl", library=library, profile=profile)[0]


def render(host, generated, size, samples):
    """The picture of so many samples a pixel, rendered anew."""
    host.forget()
    return host.picture(generated, replace(FURNACE, size=size, paths=Paths(samples)))


def error(picture, library):
    """Picture less directional albedo, on the sphere without its rim."""
    points = sphere(len(picture))
    mu = np.minimum(points.normal[..., 2], 1.0)
    inner = points.mask & (mu > RIM)
    return picture[inner] - ALBEDOS[library](mu[inner], COLOR, ROUGHNESS)


def processor_seconds(pid):
    """Processor time that a process has taken so far."""
    with open(f"/proc/{pid}/stat", encoding="ascii") as file:
        fields = file.read().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def _ticks(seconds):
    """Times of at least one tick of the processor's clock, which a small picture may not take."""
    tick = 1.0 / os.sysconf("SC_CLK_TCK")
    return [max(each, tick) for each in seconds]


def measure(rounds=5, size=SIZE, samples=SAMPLES):
    """The `Group` of both closures."""
    figures, checks = [], []
    with cycles.Host() as host:
        title = f"Cycles, {host.identity().version}, white furnace, {size} x {size}"
        made = {name: shader(name) for name in ALBEDOS}
        runs = {
            (name, count): partial(render, host, each, size, count)
            for count in (1, *samples)
            for name, each in made.items()
        }
        seconds = interleave(runs, rounds, partial(processor_seconds, host.worker.pid))
        for count in samples:
            off = {name: error(runs[name, count](), name) for name in made}
            time = {name: _ticks(less(seconds[name, count], seconds[name, 1])) for name in made}
            figures += compared(count, off, time)
            mean = {name: np.abs(each.mean(axis=0)).max() for name, each in off.items()}
            checks += [
                Check(f"{n}, {count} samples, mean", float(e), MEAN) for n, e in mean.items()
            ]
    return Group("cycles", title, tuple(figures), tuple(checks))


def compared(count, off, time):
    """Figures of one number of samples: noise, time, and time x variance."""
    noise = {name: float(np.sqrt(np.mean(each**2))) for name, each in off.items()}
    label = f"{count} samples"
    cost = {name: [noise[name] ** 2 * t for t in each] for name, each in time.items()}
    return [
        *(figure(f"noise, {name}, {label}", "rms", [each]) for name, each in noise.items()),
        *(scaled(f"{name}, {label}", "s", each, 1.0) for name, each in time.items()),
        ratio(f"time, eonlib / stock, {label}", time["eonlib"], time["stock"]),
        ratio(f"time x variance, eonlib / stock, {label}", cost["eonlib"], cost["stock"]),
    ]
