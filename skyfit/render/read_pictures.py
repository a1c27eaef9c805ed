"""Reading pictures of high dynamic range: OpenEXR and Radiance HDR, as linear sRGB in cd m⁻²."""

from os import PathLike
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from ..errors import InputError, not_found
from .files import RADIANCE_EFFICACY


class Light(NamedTuple):
    """A picture's light.

    Attributes:
        rgb: Linear red, green and blue as the file has them.
        white: What (1, 1, 1) stands for by the file [cd m⁻²].
    """

    rgb: Float[np.ndarray, "row column 3"]
    white: float


def read_picture(path: str | PathLike[str]) -> Light:
    """The light of an .exr or .hdr file.

    A Radiance file is in W m⁻² sr⁻¹, of which it takes 179 lm each, divided by its EXPOSURE. An EXR
    says what 1 stands for by `whiteLuminance`; without that it is taken for cd m⁻².

    Raises:
        FileNotFoundError: There is no such file.
        InputError: Another ending, or a file that is not what its ending says.
    """
    path = Path(path)
    if path.suffix.lower() not in (".exr", ".hdr"):
        raise InputError(f"{path}: expected a picture ending in .exr or .hdr")
    if not path.exists():
        raise not_found(path)
    if path.suffix.lower() == ".exr":
        return _read_exr(path)
    try:
        return _read_hdr(path.read_bytes())
    except (ValueError, IndexError) as error:
        raise InputError(f"{path}: expected a Radiance picture; {error}") from None


def _read_exr(path: Path) -> Light:
    import OpenEXR

    try:
        with OpenEXR.File(str(path), separate_channels=True) as file:
            header = dict(file.header())
            channels = {name: np.array(c.pixels, float) for name, c in file.channels().items()}
    except (RuntimeError, ValueError, TypeError) as error:
        raise InputError(f"{path}: expected an OpenEXR picture; {error}") from None
    if not set("RGB") <= set(channels):
        raise InputError(f"{path}: expected channels R, G and B; there are {[*channels]}")
    planes = [channels[name] for name in "RGB"]
    return Light(np.stack(planes, axis=-1), float(header.get("whiteLuminance", 1.0)))


def _read_hdr(data: bytes) -> Light:
    head, _, rest = data.partition(b"\n\n")
    lines = head.decode("latin-1").splitlines()
    if not lines or not lines[0].startswith("#?"):
        raise InputError("it does not begin with #?")
    known = [line.split("=", 1) for line in lines if "=" in line and not line.startswith("#")]
    formats = [value.strip() for name, value in known if name.strip() == "FORMAT"]
    if formats and formats[-1] != "32-bit_rle_rgbe":
        raise InputError(f"its format is {formats[-1]}, not 32-bit_rle_rgbe")
    exposure = np.prod([float(value) for name, value in known if name.strip() == "EXPOSURE"])
    size, _, body = rest.partition(b"\n")
    words = size.decode("latin-1").split()
    if len(words) != 4 or (words[0], words[2]) != ("-Y", "+X"):
        raise InputError(f"its size is {size[:40]!r}, not like -Y 512 +X 512")
    rows, columns = int(words[1]), int(words[3])
    pixels = np.frombuffer(_unpacked(body, rows, columns), np.uint8)
    rgbe = pixels.reshape(rows, columns, 4).astype(float)
    lit = rgbe[..., 3:] > 0
    rgb = np.where(lit, (rgbe[..., :3] + 0.5) * 2.0 ** (rgbe[..., 3:] - 136), 0.0)
    return Light(rgb / exposure, RADIANCE_EFFICACY)


def _unpacked(body: bytes, rows: int, columns: int) -> bytes:
    """Four bytes for each pixel; scan lines are packed by runs, each of the four by itself."""
    flat = 4 * rows * columns
    if columns < 8 or columns > 32767 or body[:2] != b"\x02\x02":
        if len(body) < flat:
            raise InputError(f"it has {len(body)} bytes of {flat}")
        return body[:flat]
    found, at = bytearray(), 0
    for _ in range(rows):
        if body[at : at + 2] != b"\x02\x02":
            raise InputError("its scan lines are packed in an older way")
        at += 4
        line = bytearray()
        while len(line) < 4 * columns:
            count = body[at]
            if count > 128:
                line += body[at + 1 : at + 2] * (count - 128)
                at += 2
            else:
                line += body[at + 1 : at + 1 + count]
                at += 1 + count
        parts = np.frombuffer(bytes(line), np.uint8).reshape(4, columns)
        found += parts.T.tobytes()
    return bytes(found)
