# SPDX-License-Identifier: Apache-2.0
"""Tables of the equal-noise times of `tools.benchmarks.noise`, in Markdown."""

TEXT = """A ball of EON at reflectance 0.8 is lit by each light. The variance of one sample is its mean
over the pixels and over the roughnesses 0.25, 0.5 and 1. It is an integral, without random numbers; a
test compares it with random samples. For the scene of figure 1, with its distant light, floor and even
surroundings, it is the variance between pictures of the path tracer at roughness 1.

The lights are defined in `tools/benchmarks/lights.py`. The overcast sky is that of the CIE, (1 + 2 y) / 3. The
clear sky is even, with a sun of 0.53 degrees and five times its irradiance. The half space is the right
half of all directions. The window is a square of 30 degrees on the left, the horizon band ends at
10 degrees, and the retro lamp is a disk of 20 degrees around the viewer. A sampler "+ light" draws half
of its samples from the light and divides by the mean of both densities: multiple importance sampling by
the balance heuristic.

Each number is variance times time, relative to the least of the three samplers alone.
"""
KINDS = {
    "paths": "Time of a path of the tracer: one reflection among the objects of figure 1, or 50 in "
    "its scene. It has intersections as well as sample, density and value",
    "functions": "Time of sample, density and value alone",
}
ALONE = ("cosine", "CLTC", "exact")
NEAR = 1.05  # of the best


def table(group):
    """Equal-noise times, and the variances and times behind them."""
    found = {each.name: each.median for each in group.figures}
    parts = [name.split(": ") for name in found if name.startswith("variance: ")]
    lights = dict.fromkeys(light for _, light, _ in parts)
    names = dict.fromkeys(name for _, _, name in parts)
    lines = [f"## {group.title}", "", TEXT]
    for kind, title in KINDS.items():
        rows = {light: [found.get(f"{kind}: {light}: {n}") for n in names] for light in lights}
        lines += [f"{title}.", "", *_rows("light", names, rows, _factor)]
        lines += [*_rows("", (), {"time, ns": [found[f"{kind}: {n}"] for n in names]}, _short)]
        lines += ["", *_verdicts(found, kind, lights)]
    rows = {light: [found.get(f"variance: {light}: {n}") for n in names] for light in lights}
    return "\n".join([*lines, *_rows("variance", names, rows, _short)]) + "\n"


def _rows(first, names, rows, text):
    """Rows of cells, below a head if there are names."""
    head = [f"| {first} | {' | '.join(names)} |", "|---" * (1 + len(names)) + "|"] if names else []
    return head + [f"| {title} | {' | '.join(map(text, row))} |" for title, row in rows.items()]


def _verdicts(found, kind, lights):
    """Under which lights exact sampling is the best of the three, alone or combined."""
    alone = [light for light in lights if found[f"{kind}: {light}: exact"] <= NEAR]
    combined = [
        light
        for light in lights
        if light not in alone and found.get(f"{kind}: {light}: exact + light", NEAR + 1.0) <= NEAR
    ]
    rest = [light for light in lights if light not in (*alone, *combined)]
    return [
        f"Exact sampling alone is the best of the three, or within 5 % of it, under {len(alone)} of "
        f"{len(lights)} lights: {'; '.join(alone)}. Combined with the light, it is better than all "
        f"three alone under {len(combined)} more: {'; '.join(combined) or 'none'}. It is neither "
        f"under {len(rest)}: {'; '.join(rest) or 'none'}.",
        "",
    ]


def _factor(value):
    """A ratio; beyond a hundred its digits say nothing."""
    if value is None:
        return ""
    return "> 100" if value > 100.0 else f"{value:.2f}" if value >= 0.01 else f"{value:.1g}"


def _short(value):
    return "" if value is None else f"{value:.3g}"
