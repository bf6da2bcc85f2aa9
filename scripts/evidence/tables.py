"""The table of models, as lines of Markdown and as CSV."""

import csv
import io

from rows import LIMITS, above

HEADS = ["model", "triangles or points", "bound, %", "flat", "cylinder", "quadric", "clipped", "bytes",
         "seconds", "processor", "fit max", "forward max", "backward max", "backward rms", "edge max",
         "normals rms, °", "missing", "extra", "through", "overlap", "outliers"]
LIMIT = {name: limit for name, _, limit in LIMITS}


def table(heads, cells):
    """A table of Markdown."""
    lines = ["| " + " | ".join(heads) + " |", "|" + "---|" * len(heads)]
    return lines + ["| " + " | ".join(row) + " |" for row in cells]


def bold(cells):
    return [f"**{cell}**" for cell in cells]


def size(row):
    """Triangles of a mesh, points of a cloud."""
    if row.bake.report is None:
        return "–"
    found = row.bake.report["input"]
    return f"{found['triangles' if row.model.kind == 'mesh' else 'points']:,}"


def distance(row, of, which="max"):
    value = row.in_bounds(of, which)
    return "–" if value is None else above(value, LIMIT[of] if which == "max" else 0.0)


def cells(row):
    """A row's cells."""
    first = [row.model.title(), size(row), row.bound()]
    if row.measure is None:
        word = "refused" if row.bake.refused else "failed"
        return first + [word] + ["–"] * (len(HEADS) - len(first) - 1)
    report, measure = row.bake.report, row.measure
    counts, holes, cost = report["counts"], measure["holes"], measure["cost"]
    return first + [
        *(f"{counts[kind]:,}" for kind in ("flat", "cylinder", "quadric", "clipped")),
        f"{report['file']['bytes']:,}",
        f"{report['run']['wall_seconds']:.1f}",
        f"{report['run']['cpu_seconds']:.1f}",
        distance(row, "fit"),
        distance(row, "forward"),
        distance(row, "backward"),
        distance(row, "backward", "rms"),
        distance(row, "edge"),
        f"{measure['normal']['rms_deg']:.2f}",
        *(f"{holes[which]:,}" for which in ("missing", "extra", "through")),
        "–" if cost["overlap"] is None else f"{cost['overlap']:.2f}",
        f"{measure['outliers']:,}",
    ]


def of_rows(rows):
    """The table of some rows, and below it what refusals advise."""
    lines = table(HEADS, [bold(cells(row)) if row.broken() else cells(row) for row in rows])
    refusals = [row for row in rows if row.bake.refused]
    if refusals:
        lines += ["", *(f"- {row.model.title()}, {row.bound()} %: {row.advice()}." for row in refusals)]
    return lines


def falls_short(rows):
    """A line for each row that breaks a promise."""
    return [f"- {row.model.title()}, bound {row.bound()}: {'; '.join(row.broken())}." for row in rows if row.broken()]


FIELDS = ["model", "input", "kind", "options", "bound_percent", "budget_percent", "holes", "refused", "failed",
          "input_size", "splats", "flat", "cylinder", "quadric", "clipped", "bytes", "color_bytes",
          "wall_seconds", "cpu_seconds", "peak_bytes", "threads", "fit_rms", "fit_max", "forward_rms",
          "forward_max", "backward_rms", "backward_max", "edge_rms", "edge_max", "normal_rms_deg",
          "normal_p99_deg", "missing", "extra", "through", "pixels", "uncovered", "overlap", "outliers",
          "flip_mean", "broken"]


def record(row, bound):
    """All that is known of a row, distances as fractions of the diagonal."""
    options = [str(option) for option in row.model.options] + (["--edges", row.model.lines] if row.model.lines else [])
    known = {
        "model": row.model.title(), "input": row.model.source, "kind": row.model.kind, "options": " ".join(options),
        "bound_percent": bound, "holes": "leave" if row.leave else "close", "refused": row.bake.refused,
        "failed": row.failed, "broken": "; ".join(row.broken()),
    }
    if row.measure is None:
        return known
    report, measure = row.bake.report, row.measure
    known |= {"budget_percent": f"{100 * row.budget():.6g}", "input_size": size(row).replace(",", ""),
              "bytes": report["file"]["bytes"], **report["counts"], **report["run"], **measure["holes"]}
    known["color_bytes"] = sum(chunk["coded_bytes"] for chunk in report["file"]["chunks"] if chunk["name"] == "COLR")
    for which in ("wall_seconds", "cpu_seconds"):
        known[which] = f"{known[which]:.2f}"
    for of in ("fit", "forward", "backward", "edge"):
        for which in ("rms", "max"):
            known[f"{of}_{which}"] = measure[of] and f"{measure[of][which]:.4g}"
    known |= {"normal_rms_deg": f"{measure['normal']['rms_deg']:.4g}",
              "normal_p99_deg": f"{measure['normal']['p99_deg']:.4g}",
              "uncovered": measure["uncovered"], "outliers": measure["outliers"],
              "overlap": measure["cost"]["overlap"] and f"{measure['cost']['overlap']:.4g}",
              "flip_mean": f"{measure['image']['flip_mean']:.4g}"}
    return known


def as_csv(rows):
    """All rows, one for each bound that was asked for."""
    text = io.StringIO()
    writer = csv.DictWriter(text, FIELDS, extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    for row in rows:
        for bound in row.bounds:
            writer.writerow(record(row, bound))
    return text.getvalue()
