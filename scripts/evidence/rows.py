"""Rows of the table of models: what is baked, what was measured, and which promises are broken."""

import re
from dataclasses import dataclass

import clouds
import inputs
from runs import say

# A budget is stored in 32 bits: nearer than this it is the bound that was asked for.
ROUNDED = 1e-6

# What distances may come to, in bounds: names, keys of the measures, limits. `forward` is promised for
# meshes alone.
LIMITS = [("fit", "fit", 1.0), ("forward", "forward", 1.0), ("backward", "backward", 2.0), ("edge", "edge", 1.0)]


@dataclass
class Row:
    """One file, or why there is none."""

    model: inputs.Model
    bounds: list  # asked for, percent
    leave: bool  # with --holes leave
    bake: object
    measure: dict | None
    failed: str | None

    def budget(self):
        """The bound that the file keeps to, a fraction of the diagonal."""
        return self.bake.report["error"]["budget"]

    def narrowed(self):
        return self.bake.report is not None and self.budget() < (1 - ROUNDED) * min(map(float, self.bounds)) / 100

    def bound(self):
        """The bounds as the tables name them."""
        text = ", ".join(self.bounds)
        if self.narrowed():
            text += f" (narrowed to {100 * self.budget():.3g})"
        return text + (", `--holes leave`" if self.leave else "")

    def in_bounds(self, of, which="max"):
        """A distance in bounds, or None."""
        found = self.measure[of]
        return None if found is None else found[which] / self.measure["budget"]

    def broken(self):
        """The promises that it breaks, in words."""
        if self.failed:
            return [self.failed]
        if self.measure is None:
            return []
        words = []
        for name, key, limit in LIMITS:
            value = self.in_bounds(key)
            promised = key != "forward" or self.model.kind == "mesh"
            if promised and value is not None and not value <= limit:
                words.append(f"{name} max {above(value, limit)}")
        if self.measure["uncovered"] > 0:
            words.append(f"{self.measure['uncovered']:,} points uncovered")
        # What `--holes leave` shows is what it was asked to leave.
        words += [f"{self.measure['holes'][which]:,} pixels {which}" for which in ("missing", "extra")
                  if not self.leave and self.measure["holes"][which] > 0]
        return words

    def advice(self):
        """The program's refusal in brief, bounds in percent of the diagonal."""
        words = self.bake.refused
        found = re.search(r"an error bound of (\S+): give a --max-error of (\S+) or more", words)
        if not found:
            return f"refused: {words}"
        bound, least = (float(text.rstrip(",")) for text in found.groups())
        text = f"refused: the points scatter; advised is {float(self.bounds[0]) * least / bound:.4f} % or more"
        return text + (", or --denoise" if "or --denoise" in words else "")


def above(value, limit):
    """Two decimals, or as many as show that it is above the limit."""
    digits = 2
    while digits < 6 and value > limit and round(value, digits) <= limit:
        digits += 1
    return f"{value:.{digits}f}"


def row(runs, model, path, options, bound, leave):
    """Bakes at a bound, and measures."""
    baking = [*options, "--max-error", f"{bound}%", *(["--holes", "leave"] if leave else [])]
    bake = runs.bake(path, baking)
    measure, failed = None, bake.failed
    if bake.report is not None:
        measure, failed = runs.measure(bake, path, options)
    return Row(model, [bound], leave, bake, measure, failed)


def of_model(runs, model, bounds):
    """The rows of a model, from the coarsest bound on; bounds that make one file make one row."""
    path, options = inputs.find(model, runs)
    rows = []
    for bound in bounds:
        new = row(runs, model, path, options, bound, False)
        if rows and new.bake.file_hash and rows[-1].bake.file_hash == new.bake.file_hash:
            rows[-1].bounds.append(bound)
        else:
            rows.append(new)
    for narrowed in [each for each in rows if each.narrowed()]:
        at = rows.index(narrowed) + 1
        rows[at:at] = [row(runs, model, path, options, bound, True) for bound in narrowed.bounds]
    return rows


def all_rows(runs, models, quick):
    """The rows of all models, and what was left out, each with a reason."""
    rows, left_out = [], []
    for number, model in enumerate(models, 1):
        say(f"[{number}/{len(models)}] {model.title()}")
        try:
            rows += of_model(runs, model, inputs.QUICK_BOUNDS if quick else model.bounds)
        except clouds.Missing as reason:
            say(f"  left out: {reason}")
            left_out.append(f"{model.title()}: {reason}")
    return rows, left_out
