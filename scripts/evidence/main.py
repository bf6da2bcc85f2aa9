#!/usr/bin/env python3
"""Writes the page of evidence: called by scripts/models, which builds the program first."""

import argparse
import os
import pathlib
import shlex
import shutil
import sys
import tempfile

import efforts
import inputs
import peers
import pictures
import rows as table_rows
import slopes
import tables
from runs import Runs, say

ROOT = pathlib.Path(__file__).resolve().parents[2]


def arguments():
    parser = argparse.ArgumentParser(prog="scripts/models", description="Bakes and measures every model, and "
                                     "writes docs/models.md, docs/models.csv and docs/models.png.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="only these models")
    parser.add_argument("--quick", action="store_true", help="three small models at two bounds")
    parser.add_argument("--work", type=pathlib.Path, help="keeps finished rows in this folder, and goes on from them")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "docs", help="where the page goes, by default docs")
    parser.add_argument("--program", type=pathlib.Path, required=True, help=argparse.SUPPRESS)
    given = parser.parse_args()
    known = {name for model in inputs.MODELS for name in model.names()} | set(slopes.EXPECTED)
    for name in given.names:
        if name not in known:
            parser.error(f"no model is called {name}; there are {', '.join(sorted(known))}")
    return given


def top(given):
    """The page's first lines."""
    command = " ".join(["scripts/models", *(["--quick"] if given.quick else []), *map(shlex.quote, given.names)])
    lines = [
        "# The models\n",
        f"Made by `{command}`. Times are of a shared machine, of one run each: they tell orders of magnitude. "
        f"Over the quarter of an hour before this was written, {os.getloadavg()[2]:.1f} threads on the machine "
        f"wanted its {os.cpu_count()} processors.",
    ]
    if given.quick or given.names:
        lines[-1] += " This is a part of the page alone."
    return lines


ABOUT = [
    "All at defaults (effort 5) but for what a row names. The *bound* is a percentage of the diagonal of the bounding "
    "box. At defaults one coarser than a pixel of the views is narrowed to that, but for a noisy cloud, so that "
    "several bounds give one file; `--holes leave` keeps them. *Flat*, *cylinder* and *quadric* splats make all; "
    "*clipped* are those of any kind that are cut. *Bytes* are those of the file, colours included where the input has "
    "any. *Seconds* are on the clock, *processor* those of all threads. Distances are in bounds: *fit* of the input's "
    "points along the splats' normals, *forward* from the input to the splats, *backward* from the splats to the input, "
    "*edge* between feature lines and cuts, both ways. *Normals* are the angles between theirs. *Missing*, *extra* and *through* "
    "count pixels of 26 views; *overlap* is the splats' area over the surface's; *outliers* are points of a cloud that "
    "belong to no surface and are left out ([measure-schema.md](measure-schema.md)). [models.csv](models.csv) has the "
    "same rows, and more of each.",
    "A row is bold where it breaks a promise: fit and edge within one bound, forward of a mesh too, backward within "
    "two, no point uncovered, no pixel missing or extra (but with `--holes leave`, which promises none of the pixels). "
    "*Falls short* names what.",
]
NOISE = (
    "Sampled points are spread at random and evenly over the area of the mesh, always the same. A *spacing* is the "
    "side of the square that each has of the area; noise is normal, with that standard deviation along each axis. A "
    "bound too near the noise is refused, with one that is not."
)


def page(runs, given):
    """The lines of the page; writes its picture and its CSV beside it."""
    models = inputs.chosen(given.names, given.quick)
    rows, left_out = table_rows.all_rows(runs, models, given.quick)
    lines = [*top(given), *(f"\n{text}" for text in ABOUT)]
    for title, kind in (("Meshes", "mesh"), ("Clouds", "cloud")):
        mine = [row for row in rows if row.model.kind == kind]
        if mine:
            lines += [f"\n## {title}\n", *([NOISE, ""] if kind == "cloud" else []), *tables.of_rows(mine)]
    if left_out:
        lines += ["\nLeft out:\n", *(f"- {text}." for text in left_out)]
    beside, missed = peers.section(rows, ROOT / "docs" / "peers.csv")
    short = tables.falls_short(rows) + missed
    lines += ["\n## Falls short\n", *(short or ["Nothing does."])]
    for part in (
        slopes.section(runs, ROOT / "fixtures", given.names, given.quick),
        beside,
        efforts.section(runs, given.names, given.quick),
        pictures.section(runs, rows, given.out),
    ):
        lines += ["", *part] if part else []
    (given.out / "models.csv").write_text(tables.as_csv(rows))
    return lines


def main():
    given = arguments()
    work = given.work or pathlib.Path(tempfile.mkdtemp(prefix="qsplat-models-"))
    given.out.mkdir(parents=True, exist_ok=True)
    try:
        lines = page(Runs(given.program, work), given)
    except BaseException:
        say(f"finished rows stay in {work}: --work {work} goes on from them")
        raise
    (given.out / "models.md").write_text("\n".join(lines) + "\n")
    say(f"written: {given.out / 'models.md'}")
    if given.work is None:
        shutil.rmtree(work)


if __name__ == "__main__":
    sys.exit(main())
