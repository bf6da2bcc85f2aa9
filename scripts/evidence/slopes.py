"""How the number of splats grows as the bound narrows."""

import math

import clouds
import inputs
from runs import say
from tables import table

# Percent of the diagonal; each half of the one before.
BOUNDS = ("0.2", "0.1", "0.05", "0.025")

# Where the count goes as a power of the bound: a plane leaves a surface by the square of its size, so area by
# the bound; a quadric leaves a smooth surface by the cube of its size; on a sphere a paraboloid by the fourth
# power.
FLAT = "-1"
EXPECTED = {"fertility-smooth": "-2/3", "igea": "-2/3", "sphere": "-1/2"}


def slope(pairs):
    """The exponent of a power law, by least squares of the logarithms."""
    xs, ys = zip(*((math.log(x), math.log(y)) for x, y in pairs))
    x, y = sum(xs) / len(xs), sum(ys) / len(ys)
    return sum((a - x) * (b - y) for a, b in zip(xs, ys)) / sum((a - x) ** 2 for a in xs)


def section(runs, fixtures, names, quick):
    """The section's lines."""
    wanted = ["sphere"] if quick else list(EXPECTED)
    wanted = [name for name in wanted if not names or name in names]
    bounds = BOUNDS[:2] if quick else BOUNDS
    cells = []
    for name in wanted:
        say(f"slopes: {name}")
        try:
            if name == "sphere":
                path = fixtures / "sphere.ply"
            else:
                path, _ = inputs.find(next(model for model in inputs.MODELS if model.name == name), runs)
        except clouds.Missing:
            continue  # said where it was to be baked first
        for shapes, expected in (("all", EXPECTED[name]), ("flat", FLAT)):
            counts = []
            for bound in bounds:
                bake = runs.bake(path, ["--max-error", f"{bound}%", "--holes", "leave", "--shapes", shapes])
                counts.append(bake.report and bake.report["counts"]["splats"])
            found = "–" if None in counts else f"{slope([(float(b), n) for b, n in zip(bounds, counts)]):.2f}"
            cells.append([name, "quadric" if shapes == "all" else "flat",
                          *("failed" if count is None else f"{count:,}" for count in counts), found, expected])
    if not cells:
        return []
    return [
        "## Splats against the bound\n",
        "Splats at bounds in percent of the diagonal, with `--holes leave`: of all kinds (*quadric*), and with "
        "`--shapes flat`. *Slope* is the exponent of the power of the bound that fits best; *expected* is that of "
        "a generic smooth surface (-2/3 by quadrics, -1 by planes) and of a sphere (-1/2 by quadrics), beside which "
        "a scan's roughness and a mesh's facets, where the bound comes near them, take more.\n",
        *table(["model", "splats", *(f"{bound} %" for bound in bounds), "slope", "expected"], cells),
    ]
