# SPDX-License-Identifier: Apache-2.0
"""docs/performance.md from the JSON: tables, plots, and the notes on what was tried."""

from pathlib import Path

from tools.benchmarks import noise_page, record

NOTES = Path(__file__).with_name("notes.md")
HEAD = """<!-- Made by `python -m tools.benchmarks --page` from performance.json. -->
# Performance

The tables have medians of interleaved rounds, with quartiles. Each ratio is the median of the ratios
of all rounds of one run. The values that were timed were compared in the same run with the float64
reference, or with the rival's values.
"""

# [Portsmouth2025], Table 1, ns: row, value, with cosine sampling, with CLTC sampling; and the names
# that value and samplers have here.
TABLE_1 = (
    ("Lambert", 1.4, 67.2, None, "Lambert", "Lambert"),
    ("FON", 6.3, 67.2, None, "FON", "FON"),
    ("QON", 6.3, 67.4, None, "QON", "QON"),
    ("fullON", 141.7, 211.218, None, "full Oren-Nayar", "full Oren-Nayar"),
    ("EON (approx)", 20.8, 105.8, 217.0, "EON, quartic", "quartic"),
    ("EON (exact)", 108.7, 193.5, 297.0, "EON, printed", "printed"),
    ("eonlib", None, None, None, "EON, eonlib", "eonlib"),
)
SAMPLERS = ("cosine", "LTC, d = 0", "LTC", "CLTC alone", "CLTC", "exact")


def table_1(group):
    """Table 1 of the paper beside what was measured here, in Markdown."""
    found = {each.name: each.median for each in group.figures}
    head = ["BRDF", "paper: value", "cosine", "CLTC", "here: value", *SAMPLERS]
    rows = [head, ["---"] * len(head)]
    for name, *paper, value, rest in TABLE_1:
        here = [found.get(value), *(found.get(f"{each} + {rest}") for each in SAMPLERS)]
        rows.append([name, *("" if x is None else f"{x:.3g}" for x in (*paper, *here))])
    lines = ["### Table 1 of the paper, and here", "", *(f"| {' | '.join(r)} |" for r in rows)]
    return "\n".join(lines) + "\n"


def table(group):
    """The figures of a group and its worst check, in Markdown."""
    if group.name == "noise":
        return noise_page.table(group)
    lines = [f"## {group.title}", "", "| | median | quartiles | goal | |", "|---|---|---|---|---|"]
    for each in group.figures:
        sign = "≥" if each.at_least else "≤"
        goal = "" if each.goal is None else f"{sign} {each.goal:g}"
        verdict = {None: "", True: "reached", False: "**missed**"}[each.reached]
        quartiles = f"{each.low:.3g} – {each.high:.3g}"
        lines.append(
            f"| {each.name} | {each.median:.3g} {each.unit} | {quartiles} | {goal} | {verdict} |"
        )
    if group.checks:
        right = sum(each.passed for each in group.checks)
        lines += ["", f"Values: {right} of {len(group.checks)} within tolerance."]
        lines += ["", "| values of | largest error | tolerance |", "|---|---|---|"]
        lines += [f"| {c.name} | {c.error:.2g} | {c.tolerance:.2g} |" for c in group.checks]
    return "\n".join(lines) + "\n"


def goals(groups):
    """How many goals each group reaches, and those that it misses, in Markdown."""
    lines = ["## Goals", "", "| group | reached | missed |", "|---|---|---|"]
    for group in groups:
        aims = [each for each in group.figures if each.goal is not None]
        missed = [
            f"{each.name} ({each.median:.3g} {each.unit}, goal {each.goal:g})"
            for each in aims
            if not each.reached
        ]
        if aims:
            count = f"{len(aims) - len(missed)} of {len(aims)}"
            lines.append(f"| {group.title} | {count} | {'; '.join(missed)} |")
    return "\n".join(lines) + "\n"


def plot(group, folder):
    """Plots of a group's series, one for each unit; the files."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    files = []
    for unit in sorted({name.split(":")[0] for name in group.series}):
        figure, axes = pyplot.subplots(figsize=(9.0, 4.0), layout="constrained")
        for name, points in group.series.items():
            if name.split(":")[0] == unit:
                x, y = zip(*points, strict=True)
                axes.plot(x, y, "o-", label=name.partition(": ")[2] or group.title)
        axes.set(xscale="log", xlabel=LABELS[group.name], ylabel=unit)
        # One unit at least, or noise fills the plot.
        axes.set_ylim(0.0, max(1.0, axes.get_ylim()[1]))
        figure.legend(loc="outside right upper", fontsize="small")
        files.append(folder / f"performance_{group.name}_{unit}.png")
        folder.mkdir(parents=True, exist_ok=True)
        figure.savefig(files[-1], dpi=100)
        pyplot.close(figure)
    return files


LABELS = {"models": "pairs", "tool": "documents"}


def write(folder, file):
    """The page and its plots beside the JSON `file`; the groups."""
    measured = record.read(file)
    groups = [group for group, _ in measured]
    parts = [HEAD, goals(groups)]
    for group, machine in measured:
        parts += [table(group), *([table_1(group)] if group.name == "shaders" else [])]
        parts.append("Measured on: " + ", ".join(f"{k} {v}" for k, v in machine.items()) + ".\n")
        plotted = group.series and "kind" not in machine  # another kind has the same curves
        for image in plot(group, folder / "images") if plotted else ():
            parts.append(f"![{group.title}, {image.stem}](images/{image.name})\n")
    parts.append(NOTES.read_text(encoding="utf-8"))
    (folder / "performance.md").write_text("\n".join(parts), encoding="utf-8")
    return groups
