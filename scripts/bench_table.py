#!/usr/bin/env python3
"""Prints the table of benchmarks from what the harness kept: bench_table.py TARGET_FOLDER [README].

With a README, also renews the lines between its marks. Reads TARGET/criterion/STAGE/{stage,floor}/POINTS/new/estimates.json (times in nanoseconds) and
the notes that the benchmarks left in TARGET/tmp/bench-notes.json.
"""

import json
import math
import os
import pathlib
import sys

POINTS = [100_000, 1_000_000, 4_000_000]

# The README's lines between these are made here.
MARKS = ("<!-- scripts/bench -->\n", "<!-- scripts/bench ends -->\n")

# Stage, what it is, what its floor is.
PASS = "neighbour pass"
STAGES = [
    ("read", "binary PLY to cloud", "reading the bytes"),
    ("neighbours", "sort, merge, 16 nearest", PASS),
    ("normals", "planes and their orientation", PASS),
    ("fit", "a quadric for every point", PASS),
    ("clip fit", "conics to lines of 32 points", PASS),
    ("sample", "grow and choose splats", PASS),
    ("bake", "the program, file to file", PASS),
    ("encode", "asset to bytes", "copying the splats"),
    ("decode", "bytes to asset", "copying the splats"),
    ("cpu frame", "512 x 512 by the reference", "the same, flat"),
    ("wgpu frame", "512 x 512 and back to memory", "the same, flat"),
]


def median(folder, stage, which, points):
    path = folder / "criterion" / stage / which / str(points) / "new" / "estimates.json"
    if not path.exists():
        return None
    return json.loads(path.read_text())["median"]["point_estimate"] * 1e-9


def seconds(value):
    for unit, size in [("s", 1.0), ("ms", 1e-3)]:
        if value >= size:
            return f"{value / size:.3g} {unit}"
    return f"{value * 1e6:.3g} µs"


def ratio(stage, floor):
    times = stage / floor
    return f"{times:.3g}" if times < 1000 else f"{times:,.0f}"


def cell(times):
    stage, floor = times
    if stage is None or floor is None:
        return "–"
    return f"{seconds(stage)}, **{ratio(stage, floor)}**"


def growth(times):
    """Exponent of the time between the smallest and the largest input measured."""
    found = [(points, stage) for points, (stage, _) in zip(POINTS, times) if stage is not None]
    if len(found) < 2:
        return "–"
    (few, first), (many, last) = found[0], found[-1]
    return f"{math.log(last / first) / math.log(many / few):.2f}"


def measured(folder, stage):
    """Seconds of a stage and of its floor, for each number of points."""
    return [tuple(median(folder, stage, which, points) for which in ("stage", "floor")) for points in POINTS]


def ratios(folder):
    """The table without seconds."""
    lines = [
        "| time over that of the floor | floor | 100 thousand points | 1 million | 4 million |",
        "|---|---|---|---|---|",
    ]
    for stage, what, floor in STAGES:
        pairs = [pair if None not in pair else None for pair in measured(folder, stage)]
        cells = " | ".join("–" if pair is None else ratio(*pair) for pair in pairs)
        lines.append(f"| {stage}: {what} | {floor} | {cells} |")
    return "".join(line + "\n" for line in lines)


def renew(readme, table):
    """Puts a table between a README's marks."""
    before, rest = readme.read_text().split(MARKS[0])
    after = rest.split(MARKS[1])[1]
    readme.write_text(before + MARKS[0] + "\n" + table + "\n" + MARKS[1] + after)


def each(notes, stage, say):
    facts = sorted(((int(points), fact) for points, fact in notes.get(stage, {}).items()))
    return "; ".join(f"{points:,} points: {say(points, fact)}" for points, fact in facts)


def main():
    folder = pathlib.Path(sys.argv[1])
    notes = json.loads((folder / "tmp" / "bench-notes.json").read_text())
    machine = notes.get("machine", {})
    print("# Benchmarks\n")
    print(
        f"Made by `scripts/bench`: medians of ten runs on {machine.get('threads', '?')} threads, the "
        "stage's time and, in bold, that over its floor, measured right after it in the same process. "
        "Times alone mean little on a shared machine; ratios mean more. The input is a generated "
        "head-like surface without an edge, scanned evenly; settings are the program's defaults (0.1 % "
        "of the diagonal, effort 5). *Growth* is the exponent of the time between the smallest and the "
        "largest input: 1 is linear; – was not measured. Over the quarter of an hour before this was "
        f"written, {os.getloadavg()[2]:.1f} threads on the machine wanted its {os.cpu_count()} processors.\n"
    )
    print("| stage | floor | 100 thousand | 1 million | 4 million | growth |")
    print("|---|---|---|---|---|---|")
    for stage, what, floor in STAGES:
        times = measured(folder, stage)
        cells = " | ".join(cell(pair) for pair in times)
        print(f"| **{stage}**: {what} | {floor} | {cells} | {growth(times)} |")
    print(
        "\nThe *neighbour pass* sorts the points along the Morton curve, builds a k-d tree (kiddo), and "
        "asks for the 16 nearest of every point, on the same threads.\n"
    )
    mebibyte = 1 << 20
    facts = [
        ("bake", "Memory and cores of the bake", lambda points, fact: (
            f"{fact['peak_bytes'] / points:.0f} bytes a point at the peak "
            f"({fact['peak_bytes'] / mebibyte:.0f} MiB), {fact['cores']:.2f} cores busy")),
        ("sample", "Splats chosen", lambda points, fact: f"{fact['splats']:,}"),
        ("clip fit", "Clip curves", lambda points, fact: f"{fact['fitted']:,} of {fact['lines']:,} lines fitted"),
        ("encode", "Files coded", lambda points, fact: (
            f"{fact['splats']:,} splats (one for 40 points) in {fact['bytes']:,} bytes")),
    ]
    for stage, title, say in facts:
        if stage in notes:
            print(f"- {title}: {each(notes, stage, say)}.")
    if "adapter" in machine:
        print(f"- Graphics adapter: {machine['adapter']}.")
    for readme in sys.argv[2:]:
        renew(pathlib.Path(readme), ratios(folder))


if __name__ == "__main__":
    main()
