"""Readers of picture files, written from the formats' descriptions and sharing nothing with skyfit.

OpenEXR: "OpenEXR file layout" and "Technical introduction", openexr.com. Radiance: Ward (1991),
"Real pixels", Graphics Gems II, and the Radiance reference manual's page on picture files.
"""

import struct
import zlib

import numpy as np


def read_exr(path):
    """Channels by name [row, column], and the header's attributes as raw bytes."""
    data = path.read_bytes()
    magic, version = struct.unpack_from("<II", data)
    assert magic == 20000630
    assert version == 2  # one part, scan lines
    at, header = 8, {}
    while data[at]:
        name, at = _text(data, at)
        kind, at = _text(data, at)
        (size,) = struct.unpack_from("<I", data, at)
        header[name] = (kind, data[at + 4 : at + 4 + size])
        at += 4 + size
    at += 1
    x0, y0, x1, y1 = struct.unpack("<4i", header["dataWindow"][1])
    columns, rows = x1 - x0 + 1, y1 - y0 + 1
    assert header["compression"][1] == b"\x03"  # ZIP, 16 lines at a time
    names, types = _channels(header["channels"][1])
    found = {name: np.empty((rows, columns), kind) for name, kind in zip(names, types, strict=True)}
    offsets = struct.unpack_from(f"<{-(-rows // 16)}Q", data, at)
    line = columns * sum(np.dtype(kind).itemsize for kind in types)
    for offset in offsets:
        first, size = struct.unpack_from("<iI", data, offset)
        lines = min(16, rows - (first - y0))
        block = data[offset + 8 : offset + 8 + size]
        if size < lines * line:
            block = _unzip(block)
        place = 0
        for row in range(first - y0, first - y0 + lines):
            for name, kind in zip(names, types, strict=True):
                found[name][row] = np.frombuffer(block, kind, columns, place)
                place += columns * np.dtype(kind).itemsize
    return found, header


def _text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def _channels(data):
    at, names, types = 0, [], []
    while data[at]:
        name, at = _text(data, at)
        names.append(name)
        types.append({1: "<f2", 2: "<f4"}[struct.unpack_from("<i", data, at)[0]])
        at += 16
    return names, types


def _unzip(block):
    """Differences of bytes, first those at even places and then those at odd ones."""
    steps = np.frombuffer(zlib.decompress(block), np.uint8).astype(int)
    steps[1:] -= 128
    whole = (np.cumsum(steps) % 256).astype(np.uint8)
    mixed = np.empty_like(whole)
    half = -(-whole.size // 2)
    mixed[0::2], mixed[1::2] = whole[:half], whole[half:]
    return mixed.tobytes()


def read_hdr(path):
    """Linear values [row, column, 3], and the header's lines; flat scan lines only."""
    head, _, rest = path.read_bytes().partition(b"\n\n")
    lines = head.decode().split("\n")
    assert lines[0] == "#?RADIANCE"
    assert "FORMAT=32-bit_rle_rgbe" in lines
    size, _, pixels = rest.partition(b"\n")
    down, rows, right, columns = size.decode().split()
    assert (down, right) == ("-Y", "+X")
    values = np.frombuffer(pixels, np.uint8).reshape(int(rows), int(columns), 4).astype(float)
    scale = np.where(values[..., 3:] > 0, 2.0 ** (values[..., 3:] - 136), 0.0)
    return (values[..., :3] + 0.5) * scale, lines
