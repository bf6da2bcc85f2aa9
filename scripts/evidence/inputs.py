"""Which models there are, and at which bounds they are baked."""

import os
import pathlib
from dataclasses import dataclass, field
from typing import Callable

import clouds

# Percent of the diagonal: from where a pixel shows to a tenth of the detail of the scans.
BOUNDS = ("1", "0.3", "0.1", "0.03")

# For what is smooth and exact enough to be worth it.
FINER = (*BOUNDS, "0.01")

# Of a quick run: one that is narrowed for a mesh, and the default.
QUICK_BOUNDS = ("0.3", "0.1")
QUICK = ("fandisk", "teapot", "fandisk-points")

# Feature lines of a cloud that are those found on the mesh whose points it is.
OF_MESH = "of the mesh"


@dataclass
class Model:
    """An input of the table."""

    name: str
    source: str  # a file among the models
    kind: str = "mesh"
    bounds: tuple = BOUNDS
    options: list = field(default_factory=list)  # of bake and measure alike
    lines: str | None = None  # a file of feature lines among the models, or OF_MESH
    made: Callable | None = None  # makes the input from the source
    what: str = ""  # beside the name

    def names(self):
        """What it is called by on the command line."""
        return {self.name, pathlib.Path(self.source).stem}

    def title(self):
        return f"{pathlib.Path(self.source).stem}{', ' if self.what else ''}{self.what}"


def sampled(name, source, many, noise, lines=None):
    what = f"{many:,} points" + (f", noise of {noise:g} spacings" if noise else "") + (", lines given" if lines else "")
    return Model(name, source, "cloud", lines=lines, what=what,
                 made=lambda mesh, made: clouds.sample(mesh, many, noise, made))


ABC = "abc-00000049"
MODELS = [
    Model("fandisk", "fandisk.obj", bounds=FINER),
    Model("teapot", "teapot.obj", bounds=FINER),
    Model("bumpy-cube", "bumpy-cube.obj", bounds=FINER),
    Model("fertility-smooth", "fertility-smooth.ply"),
    Model("fertility", "fertility.off"),
    Model(f"{ABC}-given", f"{ABC}.obj", lines=f"{ABC}.features.obj", what="lines given"),
    Model(f"{ABC}-found", f"{ABC}.obj", what="lines found"),
    Model("suzanne", "suzanne.obj"),
    Model("cesium-milk-truck", "cesium-milk-truck.glb"),
    Model("stanford-bunny", "stanford-bunny.obj"),
    Model("igea", "igea.ply"),
    Model("armadillo", "armadillo.ply"),
    Model("xyzrgb-dragon", "xyzrgb-dragon.ply"),
    Model("dragon-dense", "dragon-dense.ply"),
    sampled("fertility-smooth-points", "fertility-smooth.ply", 1_000_000, 0.0),
    sampled("fertility-smooth-noisy-points", "fertility-smooth.ply", 1_000_000, 0.5),
    sampled("fandisk-points", "fandisk.obj", 200_000, 0.0),
    sampled("fandisk-points-given", "fandisk.obj", 200_000, 0.0, OF_MESH),
    sampled(f"{ABC}-points", f"{ABC}.obj", 500_000, 0.0),
    sampled(f"{ABC}-points-given", f"{ABC}.obj", 500_000, 0.0, f"{ABC}.features.obj"),
    sampled(f"{ABC}-noisy-points", f"{ABC}.obj", 500_000, 0.5),
    Model("dragon-scans", "dragon-scans.ply", "cloud", options=["--denoise"], what="--denoise"),
    Model("topography", "topography.laz", "cloud", made=clouds.from_laz),
    Model("vol-total", "vol-total.laz", "cloud", made=clouds.from_laz),
]


def folder():
    """Where the models are."""
    return pathlib.Path(os.environ.get("QSPLAT_MODELS", "../shared/models"))


def chosen(names, quick):
    """The models that are asked for."""
    wanted = [model for model in MODELS if not quick or model.name in QUICK]
    # A model's own name stands for it alone, that of a file for all that is made of it.
    files = set(names) - {model.name for model in MODELS}
    return [model for model in wanted if not names or model.name in names or model.names() & files]


def among_models(name):
    """A file of the models; raises `clouds.Missing` where it is not."""
    path = folder() / name
    if not path.exists():
        raise clouds.Missing(f"no {path.name} among the models")
    return path


def find(model, runs):
    """The input's path, made where it must be, and the options that go with it.

    Raises `clouds.Missing` with the reason why it is not there.
    """
    source, options = among_models(model.source), list(model.options)
    if model.lines:
        options += ["--edges", runs.lines(source) if model.lines == OF_MESH else among_models(model.lines)]
    if model.made is None:
        return source, options
    made = runs.work / "inputs" / f"{model.name}.ply"
    if not made.exists():
        model.made(source, made)
    return made, options
