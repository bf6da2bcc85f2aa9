#!/usr/bin/env python3
"""Checks `qsplat measure` against an independent implementation.

usage: check_measure.py EXPORTED.ply INPUT MEASURED.json

EXPORTED.ply is what `qsplat export FILE --tolerance 0.01 -o EXPORTED.ply` wrote, INPUT the mesh that FILE was baked
from, MEASURED.json what `qsplat measure` printed with --json. Both surfaces are sampled densely and
at random, by area and at their vertices, and each sample is compared with the other surface by
point-cloud-utils (Embree's exact closest points). Prints rms and max, forward and backward, as
fractions of the diagonal beside those of MEASURED.json, with their ratio. Exits with 1 if any
differs by more than 5 %; with 2 if the arguments are wrong, or the export strays by more than a
hundredth of the error budget from the splats, which could pass for such a difference.

Needs: pip install numpy trimesh point-cloud-utils
"""

import json
import re
import sys

import numpy as np
import point_cloud_utils as pcu
import trimesh

SAMPLES = 1_000_000  # each way: rms within a few thousandths
MOST_OFF = 0.05
MOST_STRAY = 0.01  # of the error budget; rms is about a fifth of it
FACES, CLOSELY = 1000, 300  # faces looked at again, places on each
BATCH = 200_000


def load(path):
    mesh = trimesh.load(path, process=False, force="mesh")
    return np.asarray(mesh.vertices, np.float64), np.asarray(mesh.faces, np.int64)


def stray(path):
    """The share of the error budget that the export's header says its triangles keep."""
    with open(path, "rb") as file:
        head = file.read(1000).split(b"end_header")[0].decode()
    return float(re.search(r"triangles within (\S+) of the error budget", head).group(1))


def samples(vertices, faces, seed):
    """Random places by area; each face's corners."""
    rng = np.random.default_rng(seed)
    a, b, c = (vertices[faces[:, n]] for n in range(3))
    areas = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    which = rng.choice(len(faces), SAMPLES, p=areas / areas.sum())
    u, v = rng.random((2, SAMPLES, 1))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    inner = a[which] + u * (b - a)[which] + v * (c - a)[which]
    return inner, vertices[np.unique(faces)], which


def again(vertices, faces, worst, seed):
    """Random places of a few faces only: where the largest distance is looked for more closely."""
    rng = np.random.default_rng(seed)
    a, b, c = (np.repeat(vertices[faces[worst, n]], CLOSELY, axis=0) for n in range(3))
    u, v = rng.random((2, len(a), 1))
    u, v = np.where(u + v > 1, 1 - u, u), np.where(u + v > 1, 1 - v, v)
    return a + u * (b - a) + v * (c - a)


def distances(points, vertices, faces):
    found = []
    for start in range(0, len(points), BATCH):
        # 32 bits are what Embree searches in: the closest point is taken again in 64.
        part = points[start : start + BATCH]
        _, face, weights = pcu.closest_points_on_mesh(
            part.astype(np.float32), vertices.astype(np.float32), faces.astype(np.int32)
        )
        corners = vertices[faces[face]]
        found.append(trimesh.triangles.closest_point(corners, part) - part)
    return np.linalg.norm(np.concatenate(found), axis=1)


def greatest(points, found, vertices, faces):
    """The greatest distance; each that comes into question is taken again without a search.

    Now and then the 32-bit search returns a face ten times as far as the nearest.
    """
    corners = vertices[faces]
    middles = corners.mean(axis=1)
    radii = np.linalg.norm(corners - middles[:, None], axis=2).max(axis=1)
    most = 0.0
    for n in np.argsort(-found):
        if found[n] <= most:
            return most
        point = points[n]
        near = corners[np.linalg.norm(middles - point, axis=1) - radii <= found[n] * 1.001]
        exact = trimesh.triangles.closest_point(near, np.broadcast_to(point, (len(near), 3)))
        most = max(most, np.nanmin(np.linalg.norm(exact - point, axis=1)))
    return most


def one_way(source, target, seed):
    inner, corners, which = samples(*source, seed)
    along, ends = distances(inner, *target), distances(corners, *target)
    _, first = np.unique(which[np.argsort(-along)], return_index=True)
    worst = which[np.argsort(-along)][np.sort(first)[:FACES]]
    closer = again(*source, worst, seed + 1)
    pairs = [(inner, along), (corners, ends), (closer, distances(closer, *target))]
    most = max(greatest(points, found, *target) for points, found in pairs)
    return {"rms": float(np.sqrt(np.mean(along**2))), "max": float(most)}


def main():
    if len(sys.argv) != 4:
        print(__doc__, file=sys.stderr)
        return 2
    if not stray(sys.argv[1]) <= MOST_STRAY:
        print(f"{sys.argv[1]}: export again with --tolerance {MOST_STRAY}", file=sys.stderr)
        return 2
    exported, given = load(sys.argv[1]), load(sys.argv[2])
    with open(sys.argv[3], encoding="utf-8") as file:
        measured = json.load(file)
    used = given[0][np.unique(given[1])]
    origin = (used.max(axis=0) + used.min(axis=0)) / 2
    diagonal = np.linalg.norm(given[0].max(axis=0) - given[0].min(axis=0))
    # Around the origin and of size 1, so that 32 bits go as far as they can.
    exported, given = [((v - origin) / diagonal, f) for v, f in (exported, given)]
    found = {"forward": one_way(given, exported, 1), "backward": one_way(exported, given, 2)}
    failed = False
    print(f"{'':14}{'measured':>14}{'here':>14}{'ratio':>10}")
    for way, numbers in found.items():
        for name, here in numbers.items():
            there = measured[way][name]
            off = abs(there - here) > MOST_OFF * here
            failed |= off
            ratio = there / here if here > 0 else float("nan")
            print(f"{way + ' ' + name:14}{there:14.4e}{here:14.4e}{ratio:10.4f}{'  OFF' if off else ''}")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main())
