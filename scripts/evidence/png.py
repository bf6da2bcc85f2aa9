"""PNG by the standard library alone: reading what `qsplat render` writes, and writing few colours."""

import struct
import zlib

SIGNATURE = b"\x89PNG\r\n\x1a\n"
CHANNELS = {2: 3, 6: 4}  # by colour type: RGB, RGBA
PALETTE = 256  # one byte a pixel


def paeth(a, b, c):
    """The PNG specification's predictor, section 9.4."""
    p = a + b - c
    pa, pb, pc = abs(p - a), abs(p - b), abs(p - c)
    return a if pa <= pb and pa <= pc else b if pb <= pc else c


def read(path):
    """Rows of RGB triples; what is transparent is laid on white."""
    data = path.read_bytes()
    at, packed = len(SIGNATURE), b""
    while at < len(data):
        length, name = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if name == b"IHDR":
            width, height, depth, color, _, _, interlaced = struct.unpack(">IIBBBBB", body)
        packed += body if name == b"IDAT" else b""
        at += 12 + length
    if depth != 8 or color not in CHANNELS or interlaced:
        raise ValueError(f"{path}: is no plain PNG of RGB or RGBA")
    step, raw = CHANNELS[color], zlib.decompress(packed)
    rows, before = [], bytes(width * step)
    for y in range(height):
        start = y * (width * step + 1)
        line, how = bytearray(raw[start + 1:start + 1 + width * step]), raw[start]
        for n in range(len(line) if how else 0):
            left = line[n - step] if n >= step else 0
            corner = before[n - step] if n >= step else 0
            guess = (0, left, before[n], (left + before[n]) // 2, paeth(left, before[n], corner))[how]
            line[n] = (line[n] + guess) & 255
        rows.append([on_white(line[n:n + step]) for n in range(0, len(line), step)])
        before = line
    return rows


def on_white(pixel):
    if len(pixel) == 3 or pixel[3] == 255:
        return tuple(pixel[:3])
    return tuple(255 + (value - 255) * pixel[3] // 255 for value in pixel[:3])


def palette(rows):
    """At most 256 colours, and the number of the one that stands for each: the median cut (Heckbert 1982)."""
    counts = {}
    for row in rows:
        for pixel in row:
            counts[pixel] = counts.get(pixel, 0) + 1

    def widest(colors):
        return max((max(c[axis] for c in colors) - min(c[axis] for c in colors), axis) for axis in range(3))

    boxes = [(widest(list(counts)), list(counts))]
    while len(boxes) < PALETTE:
        # The box that errs most: its extent, weighed by the root of the pixels in it.
        at = max(range(len(boxes)), key=lambda n: boxes[n][0][0] * sum(counts[c] for c in boxes[n][1]) ** 0.5)
        (extent, axis), colors = boxes[at]
        if extent == 0:
            break
        colors = sorted(colors, key=lambda c: c[axis])
        half, passed, cut = sum(counts[c] for c in colors) / 2, 0, 1
        for cut in range(1, len(colors)):
            passed += counts[colors[cut - 1]]
            if passed >= half:
                break
        boxes[at:at + 1] = [(widest(part), part) for part in (colors[:cut], colors[cut:])]
    means, numbers = [], {}
    for number, (_, colors) in enumerate(boxes):
        all_pixels = sum(counts[c] for c in colors)
        means.append(tuple(round(sum(counts[c] * c[axis] for c in colors) / all_pixels) for axis in range(3)))
        numbers |= {c: number for c in colors}
    return means, numbers


def indexed(rows):
    """The bytes of a PNG of at most 256 colours."""
    colors, numbers = palette(rows)

    def chunk(name, body):
        return struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body))

    head = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 3, 0, 0, 0)
    # Indices are no amounts: rows stay unfiltered.
    raw = b"".join(b"\0" + bytes(numbers[pixel] for pixel in row) for row in rows)
    return (SIGNATURE + chunk(b"IHDR", head) + chunk(b"PLTE", bytes(v for color in colors for v in color))
            + chunk(b"IDAT", zlib.compress(raw, 9)) + chunk(b"IEND", b""))
