"""Pictures and videos, written and read byte by byte: what a run sees of them is known exactly."""

import itertools
import pathlib
import random
import struct
import subprocess
import zlib

PYTHON = "/usr/bin/python3"  # Debian's, which has matplotlib


def pgm(width, height, pixels):
    return b"P5\n%d %d\n255\n" % (width, height) + bytes(pixels)


def ppm(width, height, pixels):
    return b"P6\n%d %d\n255\n" % (width, height) + bytes(pixels)


def noise(width, height, seed):
    return random.Random(seed).randbytes(width * height)


def png_chunks(data):
    at = 8
    while at < len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        yield data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        at += 12 + length


def read_png(path, bits=8):
    """(width, height, channels, rows of bytes) of a PNG that is not interlaced."""
    chunks = list(png_chunks(pathlib.Path(path).read_bytes()))
    width, height, depth, kind, _, _, interlaced = struct.unpack(">IIBBBBB", chunks[0][1])
    assert depth == bits and interlaced == 0 and kind in (0, 2, 6)
    channels = {0: 1, 2: 3, 6: 4}[kind]
    raw = zlib.decompress(b"".join(data for name, data in chunks if name == b"IDAT"))
    bytes_per_pixel = channels * bits // 8
    stride = width * bytes_per_pixel
    rows = []
    for start in range(0, height * (stride + 1), stride + 1):
        row = bytearray(raw[start + 1 : start + 1 + stride])
        unfilter(raw[start], row, bytes_per_pixel)
        rows.append(bytes(row))
    return width, height, channels, rows


def unfilter(method, row, bytes_per_pixel):
    """Turns one row of a PNG, in place, from differences to the left, as OpenCV writes them, into pixels."""
    assert method in (0, 1)
    for channel in range(bytes_per_pixel if method == 1 else 0):
        part = row[channel::bytes_per_pixel]
        values = itertools.accumulate(part, lambda left, more: (left + more) & 0xFF)
        row[channel::bytes_per_pixel] = bytes(values)


def read_png_16(path):
    """The rows of a 16-bit grey PNG."""
    width, _, channels, rows = read_png(path, 16)
    assert channels == 1
    return [struct.unpack(f">{width}H", row) for row in rows]


def read_pfm(path):
    """(width, height, rows of floats from the top)."""
    kind, size, scale, data = pathlib.Path(path).read_bytes().split(b"\n", 3)
    assert kind == b"Pf" and float(scale) == -1.0
    width, height = map(int, size.split())
    values = struct.unpack(f"<{width * height}f", data)
    rows = [list(values[y * width : (y + 1) * width]) for y in range(height)]
    return width, height, rows[::-1]


def drawn(*paths):
    """Of each figure (width, height, white part of the area, number of colours)."""
    script = """
import sys
import numpy
from matplotlib import image
for path in sys.argv[1:]:
    pixels = (image.imread(path)[:, :, :3] * 255).round().astype(int) @ [65536, 256, 1]
    print(pixels.shape[1], pixels.shape[0], numpy.mean(pixels == 0xFFFFFF), len(numpy.unique(pixels)))
"""
    command = [PYTHON, "-c", script, *map(str, paths)]
    process = subprocess.run(command, capture_output=True, text=True, timeout=300, check=True)
    for line in process.stdout.splitlines():
        width, height, white, colors = line.split()
        yield int(width), int(height), float(white), int(colors)


def avi(width, height, frames):
    """An uncompressed AVI file of frames (rows of grey, from the top) as 24-bit pixels."""
    stored = [stored_frame(width, height, frame) for frame in frames]
    size = len(stored[0]) if stored else 0
    main = struct.pack("<14I", 40000, 0, 0, 0x10, len(stored), 0, 1, size, width, height, 0, 0, 0, 0)
    times = (0, 0, 0, 0, 1, 25, 0, len(stored), size, 0xFFFFFFFF, 0)
    stream = b"vidsDIB " + struct.pack("<IHH8I4H", *times, 0, 0, width, height)
    form = struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, size, 0, 0, 0, 0)
    movie = b"movi"
    index = b""
    for data in stored:
        index += b"00db" + struct.pack("<III", 0x10, len(movie), len(data))
        movie += chunk(b"00db", data)
    streams = chunk(b"LIST", b"strl" + chunk(b"strh", stream) + chunk(b"strf", form))
    header = chunk(b"LIST", b"hdrl" + chunk(b"avih", main) + streams)
    return chunk(b"RIFF", b"AVI " + header + chunk(b"LIST", movie) + chunk(b"idx1", index))


def chunk(name, data):
    return name + struct.pack("<I", len(data)) + data + b"\0" * (len(data) % 2)


def stored_frame(width, height, pixels):
    """Rows from the bottom, each filled up to four bytes."""
    rows = [pixels[y * width : (y + 1) * width] for y in range(height)]
    fill = b"\0" * (-3 * width % 4)
    return b"".join(bytes(value for pixel in row for value in (pixel,) * 3) + fill for row in reversed(rows))
