"""Bytes of the files beside those of meshes at equal error."""

import csv
import math
import pathlib

from tables import table

# Our bytes over the mesh's, at most: by what is measured, for smooth models and parts, and for scans.
TARGETS = {"max": (1 / 4, 1 / 2), "normals": (1 / 4, 1 / 2), "rms": (1 / 2, 3 / 4)}
SMOOTH = ("fandisk", "teapot", "fertility-smooth")
SCANS = ("stanford-bunny", "armadillo", "igea")

# Beyond the errors that a mesh was measured at, its bytes are told up to this many times farther.
BEYOND = 3.0


def read(path):
    """Points of each model and measure: pairs of error and bytes, in order."""
    lines = [line for line in pathlib.Path(path).read_text().splitlines() if not line.startswith("#")]
    points = {}
    for row in csv.DictReader(lines):
        points.setdefault((row["model"], row["measure"]), []).append((float(row["error"]), float(row["bytes"])))
    return {key: sorted(found) for key, found in points.items()}


def bytes_at(points, error):
    """The mesh's bytes at an error, along straight lines between logarithms; and whether that is beyond
    what was measured. None where it is too far beyond."""
    least, most = points[0][0], points[-1][0]
    if not least / BEYOND <= error <= most * BEYOND:
        return None
    after = next((n for n, point in enumerate(points) if error <= point[0]), len(points) - 1)
    (x0, y0), (x1, y1) = points[max(after, 1) - 1], points[max(after, 1)]
    share = math.log(error / x0) / math.log(x1 / x0)
    return y0 * (y1 / y0) ** share, not least <= error <= most


def errors(measure):
    """The two-sided errors that files and meshes are compared by."""
    both = {which: max(measure["forward"][which], measure["backward"][which]) for which in ("max", "rms")}
    return both | {"normals": measure["normal"]["rms_deg"]}


def of_class(rows, points, which, tally):
    """The table of one class of models; counts ratios and those that meet their target."""
    heads = ["model", "bound, %", "bytes"]
    for what, targets in TARGETS.items():
        heads += [f"{what}{', °' if what == 'normals' else ' / D'}", "mesh bytes", f"ratio (target {targets[which]:.2f})"]
    lines = []
    for row in rows:
        ours = row.bake.report["file"]["bytes"]
        line = [row.model.title(), row.bound(), f"{ours:,}"]
        ours_at = errors(row.measure)
        for what in TARGETS:
            error = ours_at[what]
            found = bytes_at(points[row.model.name, what], error)
            line.append(f"{error:.2f}" if what == "normals" else f"{error:.1e}".replace("e-0", "e-"))
            if found is None:
                line += ["–", "–"]
                continue
            theirs, beyond = found
            ratio, target = ours / theirs, TARGETS[what][which]
            text = f"{ratio:.2f}"
            line += [("~" if beyond else "") + f"{theirs:,.0f}", text if ratio <= target else f"**{text}**"]
            tally.setdefault(what, []).append(ratio <= target)
        lines.append(line)
    return table(heads, lines)


def section(rows, path):
    """The section's lines, and a line on what misses its target."""
    points = read(path)
    lines = [
        "## Beside meshes at equal error\n",
        "*Mesh bytes* are those that a mesh takes at the error of our file: the smaller of quadric-error decimation "
        "with Draco and gltfpack with simplification, each the smallest file of a sweep "
        "([peers.csv](peers.csv)), between the errors it was measured at along straight lines of the logarithms; "
        f"with ~ beyond these, by a factor of {BEYOND:g} at most. *max* and *rms* are the greater of forward and "
        "backward, fractions of the diagonal `D`; *ratio* is our bytes over the mesh's, bold where it is above its "
        "target. Only these models have been measured as meshes. With `--holes leave` a bound is not narrowed.",
    ]
    tally = {}
    for title, names, which in (("Smooth models and parts", SMOOTH, 0), ("Scans", SCANS, 1)):
        mine = [row for row in rows if row.model.name in names and row.measure]
        if mine:
            lines += [f"\n### {title}\n", *of_class(mine, points, which, tally)]
    if not tally:
        return [], []
    short = [f"- Beside meshes, {sum(met)} of {len(met)} ratios at equal {what} meet their target."
             for what, met in tally.items() if not all(met)]
    return lines, short
