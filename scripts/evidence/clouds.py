"""Clouds that are made: points sampled from a mesh, and LAZ as PLY.

Needs numpy to sample, laspy and lazrs to read LAZ; without them `Missing` says which.
"""

import pathlib

# Seed of the places and of the noise.
SEED = 1

LITTLE = {"char": "i1", "uchar": "u1", "short": "<i2", "ushort": "<u2", "int": "<i4", "uint": "<u4",
          "float": "<f4", "double": "<f8"}


class Missing(Exception):
    """A Python package is not there."""


def numpy():
    try:
        import numpy
    except ImportError:
        raise Missing("Python's numpy is missing")
    return numpy


def obj(path):
    """Corners and triangles of an OBJ; polygons are cut into fans."""
    np = numpy()
    places, faces = [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            places.append([float(word) for word in words[1:4]])
        elif words[:1] == ["f"]:
            corners = [int(word.split("/")[0]) - 1 for word in words[1:]]
            faces += [[corners[0], b, c] for b, c in zip(corners[1:], corners[2:])]
    return np.array(places), np.array(faces)


def ply(path):
    """Corners and triangles of a binary little-endian PLY of triangles."""
    np = numpy()
    data = path.read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    counts, fields = {}, []
    for words in (line.split() for line in data[:end].decode().splitlines()):
        if words[0] == "element":
            counts[words[1]] = int(words[2])
        elif words[0] == "property" and words[1] != "list":
            fields.append((words[2], LITTLE[words[1]]))
    corners = np.frombuffer(data, np.dtype(fields), counts["vertex"], end)
    places = np.stack([corners[axis].astype(float) for axis in "xyz"], axis=1)
    faces = np.frombuffer(data, np.dtype([("n", "u1"), ("of", "<i4", 3)]), counts["face"], end + corners.nbytes)
    if (faces["n"] != 3).any():
        raise ValueError(f"{path}: has faces of other than three corners")
    return places, faces["of"]


def write_ply(path, columns):
    """Writes points to a binary PLY; columns are names, PLY types and values."""
    np = numpy()
    points = np.empty(len(columns[0][2]), np.dtype([(name, LITTLE[kind]) for name, kind, _ in columns]))
    for name, _, values in columns:
        points[name] = values
    head = ["ply", "format binary_little_endian 1.0", f"element vertex {len(points)}"]
    head += [f"property {kind} {name}" for name, kind, _ in columns]
    new = path.with_name(path.name + ".new")
    new.write_bytes(("\n".join(head) + "\nend_header\n").encode() + points.tobytes())
    new.rename(path)


def sample(mesh, many, noise, made):
    """Points spread at random and evenly over a mesh's area, without normals.

    `noise` is the standard deviation of each coordinate, in spacings: the side of the square that a point
    has of the area.
    """
    np = numpy()
    places, faces = ply(mesh) if mesh.suffix == ".ply" else obj(mesh)
    a, b, c = (places[faces[:, corner]] for corner in range(3))
    ends = np.cumsum(0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1))
    random = np.random.default_rng(SEED)
    at = np.minimum(np.searchsorted(ends, random.random(many) * ends[-1], side="right"), len(ends) - 1)
    # Osada et al. 2002, section 3: even over a triangle.
    root, along = np.sqrt(random.random(many))[:, None], random.random(many)[:, None]
    points = (1 - root) * a[at] + root * (1 - along) * b[at] + root * along * c[at]
    points += noise * np.sqrt(ends[-1] / many) * random.standard_normal((many, 3))
    write_ply(made, [(axis, "float", points[:, n]) for n, axis in enumerate("xyz")])


def from_laz(laz, made):
    """The points of a LAZ, with their colours if it has any."""
    try:
        import laspy
        import lazrs  # noqa: F401  laspy calls it
    except ImportError as fault:
        raise Missing(f"Python's {pathlib.Path(fault.name or 'laspy').name} is missing")
    read = laspy.read(laz)
    columns = [(axis, "double", getattr(read, axis)) for axis in "xyz"]
    if "red" in read.point_format.dimension_names:
        # 16 bits a channel, of which PLY keeps the upper 8.
        columns += [(color, "uchar", getattr(read, color) >> 8) for color in ("red", "green", "blue")]
    write_ply(made, columns)
