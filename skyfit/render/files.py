"""Pictures as files: OpenEXR, Radiance HDR, PNG."""

import math
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from .._files import refuse_target, whole
from ..colour import D65_WHITE, SRGB_PRIMARIES
from ..errors import InputError


PRECISIONS = ("half", "float")
SUFFIXES = (".exr", ".hdr", ".png", ".gif", ".apng")
RADIANCE_EFFICACY = 179.0  # lm/W: Radiance's own luminous efficacy of white, WHTEFFICACY
_HALF_MAX = 65504.0


def check_target(path: str | PathLike[str], overwrite: bool) -> str:
    """The kind of file a name stands for, by its ending. Its folder is made if need be.

    Raises:
        InputError: Another ending; something is there that must not be replaced; nothing can be
            written there.
    """
    path = Path(path)
    if path.suffix not in SUFFIXES:
        raise InputError(f"{path}: expected a name ending in {', '.join(SUFFIXES)}")
    refuse_target(path, overwrite=overwrite)
    return path.suffix


def write_exr(
    path: str | PathLike[str],
    rgb: Float[np.ndarray, "row column 3"],
    comments: str = "",
    precision: str = "half",
    environment: bool = False,
) -> float:
    """Write linear sRGB as OpenEXR, with its primaries and its scale in the header.

    Args:
        path: Ends in .exr.
        rgb: (1, 1, 1) being white of 1 cd m⁻².
        comments: Text for the header.
        precision: "half" holds 65504 at most: the values are divided by a power of two that makes
            room for the brightest pixel. "float" needs no scale.
        environment: Say in the header that this is an equirectangular panorama.

    Returns:
        The standard attribute `whiteLuminance`: what a value of 1 stands for [cd m⁻²].
    """
    import OpenEXR

    if precision not in PRECISIONS:
        raise InputError(f"write_exr(precision=...): expected half or float; got {precision!r}")
    white = 1.0
    if precision == "half":
        brightest = float(np.max(np.abs(rgb), initial=0.0))
        white = 2.0 ** max(0, math.ceil(math.log2(max(brightest, 1.0) / _HALF_MAX)))
    dtype = np.float16 if precision == "half" else np.float32
    pixels = np.ascontiguousarray((rgb / rgb.dtype.type(white)).astype(dtype))
    xy = [number for pair in (*SRGB_PRIMARIES, D65_WHITE) for number in pair]
    header: dict[str, Any] = {
        "compression": OpenEXR.ZIP_COMPRESSION,
        "type": OpenEXR.scanlineimage,
        "chromaticities": tuple(xy),
        "whiteLuminance": white,
        "comments": comments,
    }
    if environment:
        header["envmap"] = OpenEXR.ENVMAP_LATLONG
    with OpenEXR.File(header, {"RGB": pixels}) as file, whole(path) as begun:
        file.write(str(begun))
    return white


def write_hdr(
    path: str | PathLike[str], rgb: Float[np.ndarray, "row column 3"], comments: str = ""
) -> float:
    """Write linear sRGB in the format of Radiance (RGBE), in its unit W m⁻² sr⁻¹.

    Radiance takes 179 lm/W for white, so (1, 1, 1) in the file is 179 cd m⁻². Negative channels
    become 0. Values keep 8 bits of the brightest channel: 0.4 %.

    Returns:
        What a value of 1 stands for [cd m⁻²].
    """
    rows, columns, _ = rgb.shape
    xy = " ".join(f"{number:.4f}" for pair in (*SRGB_PRIMARIES, D65_WHITE) for number in pair)
    notes = "".join(f"# {line}\n" for line in comments.splitlines())
    header = (
        f"#?RADIANCE\n{notes}FORMAT=32-bit_rle_rgbe\nPRIMARIES= {xy}\n\n-Y {rows} +X {columns}\n"
    )
    pixels = to_rgbe(np.asarray(rgb, float) / RADIANCE_EFFICACY)
    with whole(path) as begun:
        begun.write_bytes(header.encode("utf-8") + pixels.tobytes())
    return RADIANCE_EFFICACY


def to_rgbe(rgb: Float[np.ndarray, "*shape 3"]) -> np.ndarray:
    """Bytes red, green, blue and exponent: value = (byte + 1/2) 2^(exponent - 136).

    Source: Ward (1991), "Real pixels", Graphics Gems II.
    """
    positive = np.maximum(rgb, 0.0)
    most = positive.max(axis=-1)
    _, exponent = np.frexp(most)
    lit = most > 1e-38
    scaled = np.ldexp(positive, (8 - exponent)[..., None])
    mantissa = np.clip(np.floor(scaled), 0, 255)
    biased = np.clip(exponent + 128, 0, 255)
    whole = np.concatenate([mantissa, biased[..., None]], axis=-1)
    return np.where(lit[..., None], whole, 0).astype(np.uint8)


def write_png(path: str | PathLike[str], pixels: np.ndarray, notes: dict[str, str]) -> None:
    """Write 8-bit sRGB [row, column, 3] as PNG, with notes as text chunks."""
    from PIL import Image
    from PIL.PngImagePlugin import PngInfo

    information = PngInfo()
    for key, text in notes.items():
        information.add_itxt(key, text)
    with whole(path) as begun:
        Image.fromarray(pixels).save(begun, format="PNG", pnginfo=information)
