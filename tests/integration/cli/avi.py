"""Writes uncompressed videos: what a run sees of them is known to the byte."""

import struct


def avi(width, height, frames):
    """An AVI file of frames (rows of grey, from the top) as 24-bit pixels."""
    stored = [stored_frame(width, height, frame) for frame in frames]
    size = len(stored[0]) if stored else 0
    main = struct.pack("<14I", 40000, 0, 0, 0x10, len(stored), 0, 1, size, width, height, 0, 0, 0, 0)
    stream = b"vidsDIB " + struct.pack("<IHH8I4H", 0, 0, 0, 0, 1, 25, 0, len(stored), size, 0xFFFFFFFF, 0, 0, 0, width, height)
    form = struct.pack("<IiiHHIIiiII", 40, width, height, 1, 24, 0, size, 0, 0, 0, 0)
    movie = b"movi"
    index = b""
    for data in stored:
        index += b"00db" + struct.pack("<III", 0x10, len(movie), len(data))
        movie += chunk(b"00db", data)
    header = chunk(b"LIST", b"hdrl" + chunk(b"avih", main) + chunk(b"LIST", b"strl" + chunk(b"strh", stream) + chunk(b"strf", form)))
    body = b"AVI " + header + chunk(b"LIST", movie) + chunk(b"idx1", index)
    return chunk(b"RIFF", body)


def chunk(name, data):
    return name + struct.pack("<I", len(data)) + data + b"\0" * (len(data) % 2)


def stored_frame(width, height, pixels):
    """Rows from the bottom, each filled up to four bytes."""
    rows = [pixels[y * width : (y + 1) * width] for y in range(height)]
    fill = b"\0" * (-3 * width % 4)
    return b"".join(bytes(value for pixel in row for value in (pixel,) * 3) + fill for row in reversed(rows))
