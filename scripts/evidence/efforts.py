"""What an effort costs, and what it brings."""

import clouds
import inputs
from runs import say
from tables import table

EFFORTS = ("1", "3", "5", "7", "9")
QUICK_EFFORTS = ("1", "5")
MODELS = ("fandisk", "stanford-bunny")
BOUND = "0.1%"


def section(runs, names, quick):
    """The section's lines."""
    wanted = [name for name in (MODELS[:1] if quick else MODELS) if not names or name in names]
    cells = []
    for name in wanted:
        say(f"efforts: {name}")
        try:
            path, _ = inputs.find(next(model for model in inputs.MODELS if model.name == name), runs)
        except clouds.Missing:
            continue  # said where it was to be baked first
        for effort in QUICK_EFFORTS if quick else EFFORTS:
            report = runs.bake(path, ["--max-error", BOUND, "--effort", effort, "--lower-bound"]).report
            if report is None:
                cells.append([name, effort, "failed", *["–"] * 7])
                continue
            run, least = report["run"], report["choice"]["lower_bound"]
            cells.append([name, effort, f"{report['file']['bytes']:,}", f"{report['counts']['splats']:,}",
                          f"{run['wall_seconds']:.1f}", f"{run['cpu_seconds']:.1f}",
                          f"{report['choice']['candidates']:,}", f"{least['cost']:,.0f}",
                          f"{least['lagrangian']:,.0f}", f"{100 * (least['cost'] / least['lagrangian'] - 1):.1f} %"])
    if not cells:
        return []
    return [
        "## Effort\n",
        f"At a bound of {BOUND[:-1]} %. *Cost* is what the choice of splats weighs, bytes by a model; *at least* is "
        "the Lagrangian bound: no cover by the same candidates costs less, so the choice is within *beyond* of the "
        "cheapest ([report-schema.md](report-schema.md)). A greater effort grows more candidates, so that bounds of "
        "different efforts bound different covers.\n",
        *table(["model", "effort", "bytes", "splats", "seconds", "processor", "candidates", "cost", "at least",
                "beyond"], cells),
    ]
