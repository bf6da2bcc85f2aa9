"""One picture of several models: each splat in a colour of its own, and shaded beside it."""

import png
from runs import say

# Model, view, and what to look at.
PICTURES = [
    ("fandisk", "120,20", "splats end at the creases, sharply; a flat face takes few, however large, and a round one "
                          "long ones along the way it is straight."),
    ("abc-00000049-given", "120,20", "head and shank take a few; most lie on the thread, along its turns."),
    ("teapot", "30,20", "the belly takes large splats of two curvatures; they become small at knob, handle and spout."),
    ("fertility-smooth", "30,20", "sizes follow the curvature, and splats stretch along the way it bends least: long "
                                  "on the arms, small at hands and where limbs meet."),
    ("stanford-bunny", "30,20", "a scan: the bumps of the coat take most of the splats, the smoother ears, back and "
                                "tail few."),
    ("igea", "30,20", "cheeks and forehead take larger splats than hair and eyes; shaded, no border between two shows."),
]
BOUND = "0.1"  # percent, the program's default

# Pixels of one picture, two pictures a model and two models a line: six models take some 220 kB.
SIDE = 360
MODELS_A_LINE = 2

# Share of a picture that a model spans; the rest is margin.
FILLED = 0.94
WHITE = (255, 255, 255)

# All pictures together, so that the repository stays small. Larger, they are drawn smaller.
MOST_BYTES = 400_000
SMALLER = 0.85


def drawn(runs, row, view, show, size):
    """One picture's rows of pixels."""
    picture = runs.work / "picture.png"
    done = runs.call("render", row.bake.path, "-o", picture, "--show", show, "--view", view, "--size",
                     f"{size}x{size}", "--device", "cpu", "--quiet")
    if done.returncode != 0:
        raise RuntimeError(f"{row.model.name}: {done.stderr.strip()}")
    return png.read(picture)


def box(rows):
    """Where a picture is not white: the least and the greatest row and column."""
    high = [y for y, row in enumerate(rows) if any(pixel != WHITE for pixel in row)]
    wide = [x for x in range(len(rows[0])) if any(row[x] != WHITE for row in rows)]
    return high[0], high[-1], wide[0], wide[-1]


def draw(runs, row, view, side):
    """The rows of pixels of a model's two pictures, side by side, each filled by the model."""
    top, bottom, left, right = box(drawn(runs, row, view, "shaded", side))
    # A view leaves room for the model's ball: drawn so large that the model alone fills the square.
    size = int(side * FILLED * side / max(bottom - top + 1, right - left + 1))
    halves = []
    for show in ("splats", "shaded"):
        rows = drawn(runs, row, view, show, size)
        top, bottom, left, right = box(rows)
        y, x = (top + bottom - side) // 2, (left + right - side) // 2
        halves.append([[rows[b][a] if 0 <= b < size and 0 <= a < size else WHITE for a in range(x, x + side)]
                       for b in range(y, y + side)])
    return [left + right for left, right in zip(*halves)]


def sheet(runs, found, side):
    """All models as one PNG."""
    pairs = [draw(runs, row, view, side) for row, view, _ in found]
    lines = [pairs[n:n + MODELS_A_LINE] for n in range(0, len(pairs), MODELS_A_LINE)]
    bare = [[WHITE] * (2 * side)] * side
    wide = len(lines[0])
    rows = []
    for line in lines:
        line = line + [bare] * (wide - len(line))
        rows += [[pixel for part in across for pixel in part] for across in zip(*line)]
    return png.indexed(rows)


def section(runs, rows, out):
    """Writes models.png; the section's lines."""
    by_name = {row.model.name: row for row in rows if BOUND in row.bounds and not row.leave and row.bake.report}
    found = [(by_name[name], view, look) for name, view, look in PICTURES if name in by_name]
    if not found:
        return []
    say("pictures")
    side = SIDE
    while len(data := sheet(runs, found, side)) > MOST_BYTES:
        side = int(side * SMALLER)
    (out / "models.png").write_bytes(data)
    titles = ", ".join(row.model.title() for row, _, _ in found)
    return [
        "## Pictures\n",
        f"![{titles}: each splat in a colour of its own, and shaded](models.png)\n",
        f"At {BOUND} %, each splat in a colour of its own and shaded beside it, in this order:\n",
        *(f"- {row.model.title()}, {row.bake.report['counts']['splats']:,} splats: {look}" for row, _, look in found),
    ]
