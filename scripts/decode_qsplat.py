#!/usr/bin/env python3
"""A second decoder of .qsplat version 3, written from format-spec.md alone.

It is slow and plain on purpose: where it and the Rust decoder disagree, one of them or the
specification is wrong. Prints all splats as JSON with every digit.

    decode_qsplat.py FILE.qsplat > FILE.json

Needs Python 3.8 and, for colours and clip partners, the module `compression.zstd` (Python 3.14) or
`zstandard`, or the command `zstd`.
"""

import json
import math
import struct
import subprocess
import sys
import zlib

BIAS = 1 << 27


class Bad(Exception):
    """The file breaks a rule of the specification."""


def require(condition, why):
    if not condition:
        raise Bad(why)


# Section 2: checksum and varints ---------------------------------------------------------------


class Fields:
    def __init__(self, data):
        self.data, self.at = data, 0

    def take(self, layout):
        size = struct.calcsize(layout)
        require(self.at + size <= len(self.data), "a field ends too early")
        values = struct.unpack_from(layout, self.data, self.at)
        self.at += size
        return list(values)

    def varint(self):
        value = 0
        for n in range(5):
            byte = self.take("<B")[0]
            value |= (byte & 127) << 7 * n
            if byte < 128:
                require(byte > 0 or n == 0, "a varint with idle bytes")
                return value
        raise Bad("a varint of more than five bytes")

    def signed(self):
        value = self.varint()
        return value // 2 if value % 2 == 0 else -(value + 1) // 2

    def word(self):
        value = self.varint()
        require(value < 1 << 32, "a number of more than 32 bits")
        return value

    def left(self):
        return len(self.data) - self.at


def unsealed(data):
    require(data[:4] == b"\x89QSP", "magic")
    require(data[4:5] == b"\x03", "version")
    require(len(data) >= 9 and data[-4:] == struct.pack("<I", zlib.crc32(data[:-4])), "checksum")
    return Fields(data[5:-4])


# Section 3: header and chunks ------------------------------------------------------------------

STEPS = {"cell": 40, "height": 2, "slide": 5, "tilt": 80, "bend": 180, "spin": 80, "clip": 68}
CHUNKS = ["SPLT", "COLR", "PART"]


def unzstd(frame):
    try:
        from compression import zstd

        return zstd.decompress(frame)
    except ImportError:
        pass
    try:
        import zstandard

        return zstandard.ZstdDecompressor().decompressobj().decompress(frame)
    except ImportError:
        pass
    return subprocess.run(["zstd", "-d", "-c", "-q"], input=frame, stdout=subprocess.PIPE, check=True).stdout


def read_header(fields):
    head = {"required": fields.word(), "optional": fields.word()}
    (form,) = fields.take("<B")
    require(form < 32 and head["required"] < 4, "an unknown form or required feature")
    head["guesses"] = form & 3
    for name in ["splats", "straight", "curved"]:
        head[name] = fields.word()
    head["steps"] = dict(zip(STEPS, fields.take("<7B"))) if form & 4 else STEPS
    head["exponent"] = fields.signed()
    require(abs(head["exponent"]) <= 1000, "exponent")
    if form & 8:
        head["origin"] = fields.take("<3d")
    else:
        head["origin"] = [fields.signed() * 2.0 ** (head["exponent"] - 10) for _ in range(3)]
    head["diagonal"], head["E"] = fields.take("<2d" if form & 16 else "<2f")
    head["fit"] = [fields.word() / 8192 * head["E"] for _ in range(3)]
    require(all(math.isfinite(x) for x in head["origin"]), "origin")
    require(2.0**-60 <= head["diagonal"] <= 2.0**60, "diagonal")
    require(2.0**-24 * head["diagonal"] <= head["E"] <= 16 * head["diagonal"], "max error")
    steps = head["steps"]
    require(all(steps[n] > 0 for n in ["cell", "tilt", "bend", "spin", "clip"]), "a step of zero")
    require(steps["height"] <= 12 and steps["slide"] <= 12, "steps")
    return head


def read_entry(fields):
    (tag,) = fields.take("<B")
    number = tag >> 2
    require(number <= len(CHUNKS), "a number that no chunk has")
    name = CHUNKS[number - 1] if number else fields.take("<4s")[0].decode("latin-1")
    require(number or name not in CHUNKS, "an id spelt out in place of its number")
    raw = fields.word() if tag & 2 else None
    return name, tag, raw, fields.word()


def read_chunks(fields):
    chunks, names = {}, []
    while fields.left() > 0:
        name, tag, raw, coded = read_entry(fields)
        require(name not in names and len(names) < 255, "a chunk twice, or too many")
        names.append(name)
        require(coded <= fields.left(), "a chunk's length")
        (body,) = fields.take(f"<{coded}s")
        if name not in CHUNKS:
            require(tag & 1 == 0, "an unknown required chunk")
            continue
        if tag & 2:
            require(name != "SPLT", "splats coded by zstd")
            body = unzstd(b"\x28\xb5\x2f\xfd" + body)
            require(len(body) == raw, "a chunk's decoded length")
        require(len(body) > 0, "an empty chunk")
        chunks[name] = body
    return chunks


# Section 4: symbols and extra bits -----------------------------------------------------------


class Tape:
    def __init__(self, data):
        self.data, self.at = data, 0
        self.above, self.range = 0, 2**32 - 1
        self.odds = {}
        for _ in range(4):
            self.shift()

    def shift(self):
        byte = self.data[self.at] if self.at < len(self.data) else 0
        self.above = (self.above << 8 | byte) & 0xFFFFFFFF
        self.at += 1

    def settle(self):
        while self.range < 1 << 24:
            self.shift()
            self.range <<= 8

    def symbol(self, field):
        node = 1
        for _ in range(8):
            zero, seen = self.odds.get((field, node), (1 << 15, 0))
            bound = (self.range >> 12) * min(max(zero >> 4, 1), 4095)
            if self.above < bound:
                bit, self.range = 0, bound
                zero += (65535 - zero) // (seen + 2)
            else:
                bit, self.range = 1, self.range - bound
                self.above -= bound
                zero -= zero // (seen + 2)
            self.odds[field, node] = zero, min(seen + 1, 62)
            self.settle()
            node = 2 * node + bit
        require(self.at <= len(self.data) + 3, "the splats end too early")
        return node - 256

    def bits(self, count):
        value = 0
        for _ in range(count):
            self.range >>= 1
            bit = int(self.above >= self.range)
            self.above -= bit * self.range
            self.settle()
            value = 2 * value + bit
        require(self.at <= len(self.data) + 3, "the splats end too early")
        return value

    def kind(self):
        return self.symbol("Kind")

    def number(self, field):
        symbol = self.symbol(field)
        if symbol < 8:
            return symbol
        extra = (symbol - 8) // 2 + 2
        require(extra + 2 <= 100, "a symbol that does not exist")
        return ((2 + symbol % 2) << extra) + self.bits(extra)

    def near(self, field, guess, most):
        z = self.number(field)
        require(z < 1 << 60, "a difference out of range")
        value = guess + (z // 2 if z % 2 == 0 else -(z + 1) // 2)
        require(abs(value) <= most, "a value out of range")
        return value

    def finish(self):
        require(self.at == len(self.data) + 3, "bytes are left over")


# Section 5: grids ----------------------------------------------------------------------------


def sin_cos(n, count):
    octant, rest = divmod(8 * n, count)
    x = (rest if octant % 2 == 0 else count - rest) / count * 0.7853981633974483
    y, s, c = x * x, 1.0, 1.0
    for k in [210.0, 156.0, 110.0, 72.0, 42.0, 20.0, 6.0]:
        s = 1.0 - y * s / k
    for k in [240.0, 182.0, 132.0, 90.0, 56.0, 30.0, 12.0, 2.0]:
        c = 1.0 - y * c / k
    s = x * s
    return [(s, c), (c, s), (c, -s), (s, -c), (-s, -c), (-c, -s), (-c, s), (-s, c)][octant]


def radius(size):
    return (32 + size % 32) * 2.0 ** (size // 32 - 9)


def sign(x):
    return -1.0 if x < 0 else 1.0


def normal_of(lattice, n):
    x, y, n = float(lattice[0]), float(lattice[1]), float(n)
    z = n - abs(x) - abs(y)
    if z < 0:
        x, y = (n - abs(y)) * sign(x), (n - abs(x)) * sign(y)
    length = math.sqrt(x * x + y * y + z * z)
    return [x / length, y / length, z / length]


def lattice_near(v, n):
    n = float(n)
    total = abs(v[0]) + abs(v[1]) + abs(v[2])
    x, y = v[0] / total * n, v[1] / total * n
    if v[2] < 0:
        x, y = (n - abs(y)) * sign(x), (n - abs(x)) * sign(y)
    return [math.floor(x + 0.5), math.floor(y + 0.5)]


def basis(k):
    x, y, z = k
    s = sign(z)
    a = -1.0 / (s + z)
    b = x * y * a
    return [1.0 + s * (x * x * a), s * b, -(s * x)], [b, s + y * y * a, -y]


def dot(a, b):
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


class Grids:
    def __init__(self, head):
        self.E, self.steps, self.guesses = head["E"], head["steps"], head["guesses"]
        self.cell = self.E * (self.steps["cell"] / 16.0)
        self.clip = self.E * (self.steps["clip"] / 1024.0)

    def height_bits(self, f):
        return self.steps["height"] + f

    def slide_bits(self, small, f):
        return min(max(self.steps["slide"] - (small // 32 - 4) + f, 0), self.height_bits(f))

    def normal_steps(self, large, f):
        return max(math.ceil(radius(large) * 256.0 * 2.0**f / self.steps["tilt"]), 2)

    def bend(self, f):
        return self.steps["bend"] / 256.0 * 2.0**-f

    def spin_bits(self, sizes, bend, f):
        if sizes[0] == sizes[1] and bend[0] == bend[1]:
            return 0
        ratio, step = radius(sizes[0]) / radius(sizes[1]), self.bend(f)
        twist = abs(bend[0] * step / ratio - bend[1] * step * ratio)
        by_height, by_shape = twist * 256.0 / self.steps["spin"], (ratio - 1.0 / ratio) * 32.0
        wanted = 1.5707964 * max(by_height, by_shape) * 2.0**f
        return next((bits for bits in range(1, 41) if 2.0**bits >= wanted), 40)

    def border_steps(self, large):
        finest = radius(large) * 4.442883 * 1024.0 / self.steps["clip"]
        return max(math.ceil(finest / 16.0), 1) * 16

    def border(self, n, sizes):
        s, c = sin_cos(n, self.border_steps(sizes[0]))
        return [radius(sizes[0]) * self.E * c, radius(sizes[1]) * self.E * s]

    def coordinate(self, cell, low, bits):
        return ((cell - BIAS) + low * 2.0**-bits) * self.cell


# Section 6: records --------------------------------------------------------------------------


def nearest(done, place):
    best, least = None, math.inf
    for other in reversed(done[-32:]):
        d = [a - b for a, b in zip(other["center"], place)]
        square = dot(d, d)
        if square < least:
            best, least = other, square
    return best


def normal_guess(near, place, steps):
    d = [a - b for a, b in zip(place, near["center"])]
    slopes = []
    for axis, r, c in zip([near["i"], near["j"]], near["radii"], near["curvature"]):
        slopes.append(2.0 * c * min(max(dot(d, axis), -2.0 * r), 2.0 * r))
    v = [k - slopes[0] * i - slopes[1] * j for i, j, k in zip(near["i"], near["j"], near["k"])]
    return lattice_near(v, steps)


def bend_guess(near, radii, step):
    guess = [math.floor(c * (r * r) / step + 0.5) for c, r in zip(near["curvature"], radii)]
    return [min(max(g, -(1 << 40)), 1 << 40) for g in guess]


def spin_guess(near, k, bits):
    i0, j0 = basis(k)
    x, y = dot(near["i"], i0), dot(near["i"], j0)
    if y < 0:
        x, y = -x, -y
    low, high = 0, 1 << bits
    while high - low > 1:
        middle = (low + high) // 2
        s, c = sin_cos(middle, 2 << bits)
        low, high = (middle, high) if c * y - s * x >= 0 else (low, middle)
    return low


# Section 6.5: clip curves ---------------------------------------------------------------------


def chord_frame(p1, p3):
    chord = [p3[0] - p1[0], p3[1] - p1[1]]
    length = math.sqrt(chord[0] * chord[0] + chord[1] * chord[1])
    along = [chord[0] / length, chord[1] / length]
    return along, [-along[1], along[0]]


def moved_right(arms, by):
    sides = []
    for p, q in zip(arms, arms[1:]):
        d = [q[0] - p[0], q[1] - p[1]]
        length = math.sqrt(d[0] * d[0] + d[1] * d[1])
        if not length > 0.0:
            return None
        sides.append([d[1] / length, -(d[0] / length)])
    one, three = sides
    share = 1.0 + (one[0] * three[0] + one[1] * three[1])
    if not share > 0.05:
        return None
    mitre = by / share
    p1, p2, p3 = arms
    return [
        [p1[n] + by * one[n] for n in range(2)],
        [p2[n] + mitre * (one[n] + three[n]) for n in range(2)],
        [p3[n] + by * three[n] for n in range(2)],
    ]


def lifted(splat, arms):
    (a, b), p2 = splat["curvature"], arms[1]

    def height(p):
        return a * p[0] * p[0] + b * p[1] * p[1]

    def tangent(p):
        return height(p) + 2.0 * a * p[0] * (p2[0] - p[0]) + 2.0 * b * p[1] * (p2[1] - p[1])

    heights = [height(arms[0]), 0.5 * (tangent(arms[0]) + tangent(arms[2])), height(arms[2])]
    axes = list(zip(splat["center"], splat["i"], splat["j"], splat["k"]))
    return [[c + p[0] * i + p[1] * j + w * k for c, i, j, k in axes] for p, w in zip(arms, heights)]


def lead_of(splat, conic, budget):
    arms = conic[:3]
    line = moved_right(arms, -(0.5 * budget))
    rho = 0.5 if conic[3] == 0.0 else conic[3]
    return {"own": lifted(splat, arms), "line": lifted(splat, line) if line else None, "rho": rho}


def distance(lead, place):
    chord = [q - p for p, q in zip(lead["own"][0], lead["own"][2])]
    off = [q - p for p, q in zip(lead["own"][0], place)]
    length, along = dot(chord, chord), dot(off, chord)
    share = min(along / length, 1.0) if along > 0.0 and length > 0.0 else 0.0
    d = [o - share * c for o, c in zip(off, chord)]
    return dot(d, d)


def crossings(a, b, radii):
    p, d = [a[n] / radii[n] for n in range(2)], [(b[n] - a[n]) / radii[n] for n in range(2)]
    square, half = d[0] * d[0] + d[1] * d[1], p[0] * d[0] + p[1] * d[1]
    rest = p[0] * p[0] + p[1] * p[1] - 1.0
    root = half * half - square * rest
    if not (root > 0.0 and square > 0.0):
        return None
    return (-half - math.sqrt(root)) / square, (-half + math.sqrt(root)) / square


def blossom(curve, s, t):
    a, b, c = (1.0 - s) * (1.0 - t), s * (1.0 - t) + t * (1.0 - s), s * t
    return [a * p + b * q + c * r for p, q, r in zip(*curve)]


def reach(curve, t, radii):
    point = blossom(curve, t, t)
    if not point[2] > 0.0:
        return math.inf
    x, y = point[0] / point[2] / radii[0], point[1] / point[2] / radii[1]
    return x * x + y * y


def span_inside(curve, radii):
    places = [-1.0 + 3.0 * n / 24.0 for n in range(25)]
    reaches = [reach(curve, t, radii) for t in places]
    inmost = min(range(25), key=lambda n: (reaches[n], n))
    before = next((n for n in range(inmost - 1, -1, -1) if reaches[n] > 1.0), None)
    after = next((n for n in range(inmost + 1, 25) if reaches[n] > 1.0), None)
    if reaches[inmost] > 1.0 or before is None or after is None:
        return None
    found = []
    for inside, outside in [(places[before + 1], places[before]), (places[after - 1], places[after])]:
        for _ in range(24):
            middle = 0.5 * (inside + outside)
            inside, outside = (inside, middle) if reach(curve, middle, radii) > 1.0 else (middle, outside)
        found.append(inside)
    return found


def crossing(lead, splat, form, across, budget):
    """The curve P1, P2, P3, rho that a lead is in the plane of a splat, from border to border."""
    arms, radii = lead["line"] if across else lead["own"], splat["radii"]
    if arms is None:
        return None
    arms = [[dot([a - b for a, b in zip(p, splat["center"])], splat[axis]) for axis in "ij"] for p in arms]
    if form == "straight":
        arms[1] = [0.5 * (p + q) for p, q in zip(arms[0], arms[2])]
    if across:
        arms = moved_right(arms[::-1], 0.5 * budget)
        if arms is None:
            return None
    p1, p2, p3 = arms

    def on(p, q, t):
        return [a + t * (b - a) for a, b in zip(p, q)]

    if form == "straight":
        t = crossings(p1, p3, radii)
        if t is None:
            return None
        p1, p3 = on(p1, p3, t[0]), on(p1, p3, t[1])
        return [p1, [0.5 * (a + b) for a, b in zip(p1, p3)], p3, 0.0]
    if form == "corner":
        ways = [crossings(p2, p1, radii), crossings(p2, p3, radii)]
        if lead["rho"] < 1.0 or any(t is None or not t[0] < 0.0 for t in ways):
            return None
        return [on(p2, p1, ways[0][1]), p2, on(p2, p3, ways[1][1]), 1.0]
    if not lead["rho"] < 1.0:
        return None
    weights = [1.0 - lead["rho"], lead["rho"], 1.0 - lead["rho"]]
    curve = [[p[0] * w, p[1] * w, w] for p, w in zip(arms, weights)]
    span = span_inside(curve, radii)
    if span is None:
        return None
    a, b, c = blossom(curve, span[0], span[0]), blossom(curve, *span), blossom(curve, span[1], span[1])
    if not (a[2] > 0.0 and b[2] > 0.0 and c[2] > 0.0):
        return None
    weight = b[2] / math.sqrt(a[2] * c[2])
    return [[p[0] / p[2], p[1] / p[2]] for p in [a, b, c]] + [weight / (1.0 + weight)]


def border_step(point, grids, sizes):
    count = grids.border_steps(sizes[0])
    x, y = point[0] / (radius(sizes[0]) * grids.E), point[1] / (radius(sizes[1]) * grids.E)
    x, y, first = (-x, -y, count // 2) if y < 0.0 else (x, y, 0)

    def passed(n, count):
        s, c = sin_cos(n, count)
        return c * y - s * x >= 0.0

    low, high = 0, count // 2
    while high - low > 1:
        middle = (low + high) // 2
        low, high = (middle, high) if passed(middle, count) else (low, middle)
    return (first + low + passed(2 * low + 1, 2 * count)) % count


def read_clip(tape, grids, splat, curved, leads):
    form = "straight"
    if curved:
        corner = tape.number("Corner")
        require(corner <= 1, "a form that does not exist")
        form = "corner" if corner else "curved"
    side = tape.number("Lead")
    require(side <= 2, "a side that does not exist")
    guess = None
    if side:
        rank = tape.number("Rank")
        found = (crossing(lead, splat, form, side == 2, grids.E) for lead in leads)
        guess = next((c for n, c in enumerate(c for c in found if c is not None) if n == rank), None)
        require(guess is not None, "a rank beyond the curves that cross")
    grain = tape.number("Grain")
    require(grain <= 4, "grain")
    unit, sizes = 2 ** (4 - grain), splat["sizes"]
    count = grids.border_steps(sizes[0])
    near, rho_near = [0, 0], None
    if side:
        steps = [border_step(p, grids, sizes) for p in [guess[0], guess[2]]]
        start, end = [(n + unit * tape.near("Off", 0, 1 << 50)) % count for n in steps]
        along, across = chord_frame(guess[0], guess[2])
        arm = [p - 0.5 * (a + b) for a, p, b in zip(*guess[:3])]
        near = [(arm[0] * v[0] + arm[1] * v[1]) / grids.clip + 0.5 for v in [along, across]]
        require(all(map(math.isfinite, near)) and guess[3] <= 1.0, "a guess out of range")
        near = [math.floor(n) for n in near]
        require(max(map(abs, near)) <= 1 << 40, "a guess out of range")
    else:
        start, sweep = unit * tape.number("Ends"), unit * (tape.number("Ends") + 1)
        require(start < count and sweep < count, "an end beyond a whole turn")
        end = (start + sweep) % count
    require(start != end, "a curve that spans nothing")
    p1, p3 = grids.border(start, sizes), grids.border(end, sizes)
    middle = [0.5 * (a + b) for a, b in zip(p1, p3)]
    if form == "straight":
        return [p1, middle, p3, 0.0]
    field = "Off" if side else "Ctrl"
    control = [n + unit * tape.near(field, 0, 1 << 50) for n in near]
    steps = abs(control[0]) + abs(control[1])
    require(steps > 0 and max(map(abs, control)) <= 1 << 40, "a control point on the chord, or out of range")
    along, across = chord_frame(p1, p3)
    x, y = float(control[0]), float(control[1])
    p2 = [m + (x * a + y * b) * grids.clip for m, a, b in zip(middle, along, across)]
    if form == "corner":
        return [p1, p2, p3, 1.0]
    if side:
        rho = guess[3]
    else:
        chord = [b - a for a, b in zip(p1, p3)]
        half, height = 0.5 * math.sqrt(chord[0] * chord[0] + chord[1] * chord[1]), y * grids.clip
        weight = half / math.sqrt(half * half + height * height)
        rho = weight / (1.0 + weight)
    rho = math.floor(rho * float(steps) + 0.5) + unit * tape.near("Off" if side else "Rho", 0, 1 << 50)
    require(0 < rho < steps, "rho")
    return [p1, p2, p3, rho / steps]


def told(conic):
    """A clip curve as it is printed."""
    p1, p2, p3, rho = conic
    p2 = p2 if rho > 0.0 else [0.0, 0.0]
    return {"alpha1": central(p1), "alpha3": central(p3), "p2": p2, "rho": rho}


def central(p):
    angle = math.atan2(p[1], p[0])
    angle = angle + 2 * math.pi if angle < 0 else angle
    return angle if angle < 2 * math.pi else 0.0


def read_splat(tape, grids, last, done, leads):
    kind = tape.kind()
    fineness, turn = kind >> 4 & 3, kind >> 6
    if fineness == 3:
        more = tape.number("More")
        require(more <= 13, "fineness")
        fineness += more
    require(turn < 3, "turn")
    morton = last + tape.number("Cell")
    require(morton < 1 << 84, "Morton code")
    cell = [sum((morton >> (3 * n + axis) & 1) << n for n in range(28)) for axis in range(3)]
    near = nearest(done, [grids.coordinate(c, 0, 0) for c in cell])
    large = tape.near("Size", near["sizes"][0] if near else 0, 1023)
    require(large >= 0, "radius code")
    small = large
    if kind & 2:
        small = large - 1 - tape.number("Shape")
        require(small >= 0, "radius code")
    sizes, radii = [large, small], [radius(large) * grids.E, radius(small) * grids.E]
    slide, height = grids.slide_bits(small, fineness), grids.height_bits(fineness)
    low = [tape.bits(slide) for _ in range(3)]
    rise = tape.bits(height - slide)
    coarse = [grids.coordinate(c, l, slide) for c, l in zip(cell, low)]
    steps = grids.normal_steps(large, fineness)
    guess = normal_guess(near, coarse, steps) if near else [0, 0]
    k = normal_of([tape.near("Norm", g, steps) for g in guess], steps)
    step = grids.bend(fineness) * grids.E
    bend = [0, 0]
    if kind & 1:
        guess = bend_guess(near, radii, step) if near and grids.guesses & 1 else [0, 0]
        bend = [tape.near("Bend", g, 1 << 40) for g in guess]
        require(bend != [0, 0], "a quadric without curvature")
    bits, spin = grids.spin_bits(sizes, bend, fineness), 0
    if bits:
        off, half = tape.near("Spin", 0, 1 << (bits - 1)), 1 << (bits - 1)
        require(off < half, "turn")
        spin = ((spin_guess(near, k, bits) if near and grids.guesses & 2 else 0) + off) % (1 << bits)
    sort = kind >> 2 & 3
    counts = [[0, 0], [1, 0], [0, 1]][sort] if sort < 3 else [tape.number("More"), tape.number("More")]
    require(max(counts) <= 1 << 16 and (sort < 3 or sum(counts) >= 2), "clip counts")
    axis = (max(range(3), key=lambda n: (abs(k[n]), -n)) + turn) % 3
    center = list(coarse)
    center[axis] = grids.coordinate(cell[axis], low[axis] << (height - slide) | rise, height)
    i0, j0 = basis(k)
    s, c = sin_cos(spin, 2 << bits)
    splat = {
        "center": center,
        "i": [c * a + s * b for a, b in zip(i0, j0)],
        "j": [c * b - s * a for a, b in zip(i0, j0)],
        "k": k,
        "radii": radii,
        "curvature": [b * step / (r * r) for b, r in zip(bend, radii)],
        "color": [255, 255, 255],
        "sizes": sizes,
    }
    recent = leads[-512:][::-1]
    ranked = sorted(range(len(recent)), key=lambda n: (distance(recent[n], center), n)) if sum(counts) else []
    nearby = [recent[n] for n in ranked[:64]]
    clips = [read_clip(tape, grids, splat, n >= counts[0], nearby) for n in range(sum(counts))]
    leads.extend(lead_of(splat, clip, grids.E) for clip in clips)
    splat["clips"] = [told(clip) for clip in clips]
    return morton, splat, counts


def paint(splats, planes):
    count = len(splats)
    require(len(planes) == 3 * count, "colours")
    last = [0, 0, 0]
    for n, splat in enumerate(splats):
        last = [(value + planes[p * count + n]) % 256 for p, value in enumerate(last)]
        splat["color"] = [(last[1] + last[0]) % 256, last[0], (last[2] + last[0]) % 256]


# Section 8.2: clip partners --------------------------------------------------------------------


def link(splats, data):
    numbers = Fields(data)
    require(numbers.varint() == 1, "the version of the clip partners")
    partners = [{} for _ in splats]
    for i in range(len(splats)):
        j = i
        for _ in range(numbers.varint()):
            number = numbers.varint()
            j += (number >> 2) + 1
            require(j < len(splats), "a partner beyond the last splat")
            partners[i][j], partners[j][i] = number & 1, number >> 1 & 1
    for splat, own in zip(splats, partners):
        if not own:
            continue
        way, groups = numbers.varint(), []
        require(way in (0, 2) or way == 1 and len(own) > 1, "how partners cut")
        for n, j in enumerate(sorted(own)):
            group = [n + 1, 1][way] if way < 2 else numbers.varint()
            require(group <= len(groups) + 1, "a group out of turn")
            if group > len(groups):
                groups.append([])
            if group > 0:
                groups[group - 1].append({"splat": j, "sees": own[j] == 1})
        splat["partners"] = groups
    require(numbers.left() == 0, "clip partners are left over")


def decode(data):
    fields = unsealed(data)
    head = read_header(fields)
    chunks = read_chunks(fields)
    require(head["splats"] <= 4 * len(chunks.get("SPLT", b"")), "too few bytes for the splats")
    require(head["splats"] > 0 or "SPLT" not in chunks, "a chunk without splats")
    tape, grids = Tape(chunks.get("SPLT", b"")), Grids(head)
    morton, splats, clips, quadric, leads = 0, [], [0, 0], False, []
    for _ in range(head["splats"]):
        morton, splat, counts = read_splat(tape, grids, morton, splats, leads)
        clips = [a + b for a, b in zip(clips, counts)]
        quadric |= splat["curvature"] != [0.0, 0.0]
        splats.append(splat)
    if splats:
        tape.finish()
    require(clips == [head["straight"], head["curved"]], "clip counts")
    require(head["required"] == quadric * 1 + (sum(clips) > 0) * 2, "required features")
    colors = head["optional"] & 1 != 0
    require(colors and head["splats"] > 0 or "COLR" not in chunks, "colours that are not announced")
    if colors:
        paint(splats, chunks.get("COLR", b""))
    for splat in splats:
        del splat["sizes"]
        splat["partners"] = []
    require((head["optional"] & 2 != 0) == ("PART" in chunks), "partners that are not announced")
    if "PART" in chunks:
        link(splats, chunks["PART"])
    return {
        "version": 3,
        "frame": {"origin": head["origin"], "exponent": head["exponent"]},
        "diagonal": head["diagonal"],
        "max_error": head["E"],
        "fit": dict(zip(["rms", "p99", "max"], head["fit"])),
        "has_colors": colors,
        "splats": splats,
    }


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    with open(sys.argv[1], "rb") as file:
        data = file.read()
    try:
        asset = decode(data)
    except Bad as fault:
        sys.exit(f"{sys.argv[1]}: not a sound .qsplat: {fault}")
    json.dump(asset, sys.stdout)
    print()


if __name__ == "__main__":
    main()
