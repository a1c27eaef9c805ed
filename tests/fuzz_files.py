"""Malformed files and command lines by mutation of good ones: what does the command line answer?

    python tests/fuzz_files.py --count 4000 --seed 0

Every case runs in this process. It must end with status 0 or 2 within the time limit, on status 2
with one line on standard error; no file that was there may change; what it wrote must be whole.
The simulator is one that costs nothing: what is tried is what stands around it.
"""

import argparse
import collections
import contextlib
import io
import json
import os
import random
import re
import shutil
import signal
import sys
import tempfile
import time
import traceback
from pathlib import Path

import numpy as np
import xarray as xr
from stand_in import stand_in


HERE = Path(__file__).resolve().parent
LIMIT = 30  # s
CAMPAIGN = """
schema = "skyfit/campaign/1"
title = "small"
[planet]
radius_m = 6.371e6
top_altitude_m = 60e3
[sun]
spectrum = "astm_g173"
[ground]
albedo = { csv = "a.csv", column = "green_grass" }
[[constituents]]
name = "air"
kind = "air"
[[constituents]]
name = "haze"
kind = "angstrom_aerosol"
optical_depth = 0.2
angstrom_exponent = 1.3
asymmetry = 0.7
profile = { kind = "exponential", scale_height_m = 1200.0 }
[sweep]
key = "constituents.haze.optical_depth"
values = [0.1, 0.2]
[sampling]
sun_zenith_deg = { first = 0, last = 60, count = 3 }
view_zenith_deg = [30, 60, 80]
relative_azimuth_deg = { first = 0.0, last = 180.0, step = 60.0 }
wavelengths_nm = [450.0, 550.0, 650.0]
[simulation]
orders = 2
quality = "draft"
"""
CSV = "wavelength_nm,green_grass\n400,0.05\n550,0.1\n700,0.2\n800,0.5\n"
NASTY = [
    "nan", "inf", "-inf", "1e400", "1e308", "-1", "0", "-0.0", "1e-320", "999999999", "9" * 5000,
    "true", '""', '"x"', "[]", "{}", "null", "[[1]]", "7", "1e30", "3.39", '"/dev/zero"', "0x7f",
    "1979-05-27", '"\\u0000"', '"../../x"', "[nan]", "{first=0,last=1,count=9}",
    "{first = 0, last = 90, count = 999999999}", "{first = 0, last = 180, step = 1e-9}",
]  # fmt: skip
VALUES = [
    float("nan"), float("inf"), -1, 0, 1e308, -1e308, 1e400, 10**400, True, None, "", "x", [], {},
    [1], [[1, 2]], {"a": 1}, 7, 1e30, -5.5, "sun_zenith", '"""', "*/", "\u0000", 2**63, [None],
]  # fmt: skip
WORDS = [
    "nan", "inf", "-1", "0", "1e400", "", "x", "9" * 22, "--", "-", "é", "--json", "--overwrite",
    "45", "1e-320", "[/]", ".", "/", "~nobody/x", "/dev/zero", "2",
]  # fmt: skip
NUMBER = re.compile(rb"(?<![\w.])-?\d[\d.e+-]*")


def mutated_bytes(rng: random.Random, data: bytes) -> bytes:
    """A text or any bytes with one to three faults."""
    for _ in range(rng.choice((1, 1, 2, 3))):
        kind = rng.randrange(7)
        at = rng.randrange(len(data) + 1)
        lines = data.split(b"\n")
        line = rng.randrange(len(lines))
        if kind == 0:
            data = data[:at]
        elif kind == 1:
            data = data[:at] + rng.randbytes(rng.choice((1, 1, 4, 40))) + data[at + 1 :]
        elif kind == 2:
            data = b"\n".join(lines[:line] + lines[line + 1 :])
        elif kind == 3:
            data = b"\n".join([*lines[: line + 1], *lines[line:]])
        elif kind == 4 and b"=" in lines[line]:
            head = lines[line].split(b"=")[0]
            lines[line] = head + b"= " + rng.choice(NASTY).encode()
            data = b"\n".join(lines)
        else:
            found = list(NUMBER.finditer(data))
            if found:
                one = rng.choice(found)
                data = data[: one.start()] + rng.choice(NASTY).encode() + data[one.end() :]
    return data


def mutated_tree(rng: random.Random, tree):
    """A JSON document with one node replaced, removed, repeated or renamed."""
    here, key = None, None
    node = tree
    while isinstance(node, dict | list) and node and (here is None or rng.random() < 0.85):
        here, key = node, rng.choice(list(node) if isinstance(node, dict) else range(len(node)))
        node = node[key]
    kind = rng.randrange(5)
    if here is None:
        return rng.choice(VALUES)
    if kind == 0:
        del here[key]
    elif kind == 1 and isinstance(here, list):
        here.insert(key, node)
    elif kind == 1:
        here[str(key) + rng.choice(('"""', "x", "*/", ""))] = here.pop(key)
    elif kind == 2 and isinstance(node, list):
        here[key] = node[::-1]
    elif kind == 3 and isinstance(node, int | float):
        here[key] = node * rng.choice((-1, 1e6, 1e200, 1e-200))
    else:
        here[key] = rng.choice(VALUES)
    return tree


def mutated_dataset(rng: random.Random, data: xr.Dataset) -> xr.Dataset:
    """A dataset with one variable, coordinate or attribute changed."""
    data = data.copy(deep=True)
    name = rng.choice(list(map(str, data.variables)))
    kind = rng.randrange(6)
    if kind == 0:
        return data.drop_vars(name)
    if kind == 1:
        values = np.asarray(data[name].values, float).copy()
        values.flat[rng.randrange(values.size)] = rng.choice((np.nan, np.inf, -1, 1e30, 7, 0))
        return data.assign({name: (data[name].dims, values)})
    if kind == 2:
        return data.assign({name: (data[name].dims, data[name].values.astype(str))})
    if kind == 3:
        key = rng.choice(list(data.attrs))
        value = rng.choice(("", "{}", "[]", "x", 7, "null", '{"a": 1}', '{"atmosphere": {}}'))
        return data.assign_attrs({key: value})
    if kind == 4:
        return data.isel({rng.choice(list(map(str, data.dims))): slice(0, rng.choice((0, 1)))})
    return data.rename({name: rng.choice(("x2", "lambda", "radiance2", "time"))})


class Workshop:
    """Good files to begin with, and a folder in which each case is tried."""

    def __init__(self, home: Path):
        import jax

        import skyfit
        from skyfit.dataset import runner, save_dataset

        jax.config.update("jax_enable_x64", True)  # as the command line has it
        runner.simulate = lambda orders, **more: stand_in(orders=orders or 3, **more)
        self.home = home
        self.campaigns = [(HERE.parent / "sims" / f"{name}.toml").read_bytes() for name in
                          ("mars", "desert_dust", "preetham1999")]  # fmt: skip
        self.campaigns += [CAMPAIGN.encode()] * 3
        (home / "a.csv").write_text(CSV)
        (home / "c.toml").write_text(CAMPAIGN)
        self.fits = [json.loads(file.read_text()) for file in (HERE / "files").glob("*.json")]
        for number, fit in enumerate([*self.fits]):
            (home / "f.json").write_text(json.dumps(fit))
            skyfit.load_fit(home / "f.json").save(home / f"g{number}.json")
            self.fits.append(json.loads((home / f"g{number}.json").read_text()))
        self.skies = skyfit.run_campaign(skyfit.load_campaign(home / "c.toml"))
        save_dataset(self.skies, home / "s.nc")
        save_dataset(self.skies, home / "s.zarr")
        (home / "precious.json").write_text("precious")

    def toml(self, rng: random.Random) -> list[str]:
        """A campaign file."""
        (self.home / "m.toml").write_bytes(mutated_bytes(rng, rng.choice(self.campaigns)))
        return ["simulate", "m.toml", "--out", rng.choice(("o.nc", "o.zarr"))]

    def csv(self, rng: random.Random) -> list[str]:
        """A table that a campaign names."""
        (self.home / "m.csv").write_bytes(mutated_bytes(rng, CSV.encode()))
        text = CAMPAIGN.replace("a.csv", rng.choice(("m.csv",) * 20 + ("/dev/zero", "..", "", "."))
                                )  # fmt: skip
        (self.home / "m.toml").write_text(text)
        return ["simulate", "m.toml", "--out", "o.nc"]

    def json(self, rng: random.Random) -> list[str]:
        """A fit."""
        fit = rng.choice(self.fits)
        if rng.random() < 0.8:
            text = json.dumps(mutated_tree(rng, json.loads(json.dumps(fit)))).encode()
        else:
            text = mutated_bytes(rng, json.dumps(fit, indent=1).encode())
        (self.home / "m.json").write_bytes(text)
        if rng.random() < 0.15:
            return ["render", "m.json", "--turbidity", "3", "--height", "6", "--out", "o.png"]
        language = rng.choice(("c", "glsl", "hlsl", "js", "python", "json"))
        return ["export", "m.json", "--format", language, "--out", "o.txt"]

    def zarr(self, rng: random.Random) -> list[str]:
        """A store, by its files or by its arrays."""
        store = self.home / "m.zarr"
        if rng.random() < 0.3:
            mutated_dataset(rng, self.skies).to_zarr(store, mode="w", consolidated=False)
        else:
            shutil.copytree(self.home / "s.zarr", store)
            file = rng.choice([path for path in sorted(store.rglob("*")) if path.is_file()])
            if rng.random() < 0.15:
                file.unlink()
            elif file.suffix == ".json" and rng.random() < 0.8:
                file.write_text(json.dumps(mutated_tree(rng, json.loads(file.read_text()))))
            else:
                file.write_bytes(mutated_bytes(rng, file.read_bytes()))
        return self._of_skies(rng, "m.zarr")

    def netcdf(self, rng: random.Random) -> list[str]:
        """A file, by its bytes or by its arrays."""
        if rng.random() < 0.7:
            mutated_dataset(rng, self.skies).to_netcdf(self.home / "m.nc", engine="netcdf4")
        else:
            data = bytearray((self.home / "s.nc").read_bytes())
            for _ in range(rng.choice((1, 5, 50))):
                data[rng.randrange(len(data))] = rng.randrange(256)
            end = len(data) if rng.random() < 0.8 else rng.randrange(len(data))
            (self.home / "m.nc").write_bytes(data[:end])
        return self._of_skies(rng, "m.nc")

    def _of_skies(self, rng: random.Random, name: str) -> list[str]:
        return rng.choice((
            ["render", name, "--turbidity", "0.1", "--sun-zenith-deg", "60", "--height", "6",
             "--no-sun", "--out", "o.png"],
            ["fit", name, "--out", "o.json"],
            ["simulate", "c.toml", "--out", name],
        ))  # fmt: skip

    def words(self, rng: random.Random) -> list[str]:
        """A command line."""
        good = [
            ["simulate", "c.toml", "--out", "o.nc", "--workers", "1", "--estimate-error", "none"],
            ["export", "published", "--format", "c", "--out", "o.txt", "--name", "sky"],
            ["render", "--turbidity", "3", "--height", "6", "--out", "o.png", "--ev", "14"],
            ["render", "--height", "6", "--out", "o.png", "--view", "perspective", "--width", "5",
             "--terrain", "sample", "--samples", "1", "--field-of-view-deg", "60"],
            ["render", "--height", "6", "--frames", "2", "--seconds", "1", "--latitude-deg", "40",
             "--day-of-year", "100", "--out", "o.gif"],
            ["fit", "s.nc", "--out", "o.json", "--distribution", "perez", "--channels", "Yxy"],
        ]  # fmt: skip
        words = list(rng.choice(good))
        at = rng.randrange(1, len(words))
        kind = rng.randrange(4)
        if kind == 0:
            del words[at]
        elif kind == 1:
            words.insert(at, rng.choice(WORDS))
        else:
            words[at] = rng.choice([*WORDS, "precious.json", "s.nc", "new/o.png", "o.txt"])
        return words


KINDS = ("toml", "csv", "json", "zarr", "netcdf", "words")


def answer_to(home: Path, words: list[str]) -> tuple[str, str | None]:
    """The answer to a command line, and what is wrong with it; None if nothing is."""
    from skyfit import cli

    before = _state(home)
    out, err = io.StringIO(), io.StringIO()
    signal.signal(signal.SIGALRM, _too_long)
    signal.alarm(LIMIT)
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            status = cli.run(words)
    except BaseException as error:
        return "fault", f"traceback: {''.join(traceback.format_exception(error))[-1500:]}"
    finally:
        signal.alarm(0)
    said = err.getvalue()
    last = [line for line in said.splitlines() if not line.startswith("skyfit: warning: ")]
    if status not in (0, 2) or "Traceback" in said:
        return "fault", f"status {status}: {said}"
    if status == 2 and len(last) != 1:
        return "fault", f"not one line: {said}"
    target = words[words.index("--out") + 1] if "--out" in words[:-1] else ""
    changed = [name for name in before if _state(home).get(name) != before[name]]
    own = words[0] == "simulate" and all(name.startswith("m.zarr") for name in changed)
    if changed and not own and "--overwrite" not in words:
        return "fault", f"changed {changed}: {said}"
    left = [name for name in _state(home) if Path(name).name.startswith(".")]
    if left:
        return "fault", f"left behind: {left}"
    if status == 0 and target.endswith((".txt", ".json", ".png", ".gif")):
        written = Path(home, target).expanduser()
        if not written.exists() or not written.stat().st_size:
            return "fault", f"lost: {out.getvalue()}"
        if target == "o.txt" and re.search(r"(?<![\w.])-?(nan|inf|NaN|Infinity)\b(?!\()",
                                           _without_comments(written.read_text())):  # fmt: skip
            return "fault", "a number of the export is none"
    return "refused" if status else "taken", None


def _without_comments(code: str) -> str:
    return re.sub(
        r'^\s*(//|\*|/\*|#).*$|"""(.|\n)*?"""|^ "?(provenance|formula).*$', "", code, flags=re.M
    )


def _too_long(*_):
    raise TimeoutError(f"took more than {LIMIT} s")


def _state(home: Path) -> dict[str, tuple[int, int]]:
    return {
        str(path.relative_to(home)): (path.stat().st_mtime_ns, path.stat().st_size)
        for path in home.rglob("*")
        if path.is_file()
    }


def run(numbers, seed: int, kinds=KINDS, show=print):
    """Try the cases of these numbers; return the answers by kind and command, and the faults."""
    counts: collections.Counter = collections.Counter()
    faults = []
    before = os.getcwd()
    with tempfile.TemporaryDirectory() as folder:
        home = Path(folder)
        os.chdir(home)
        try:
            workshop = Workshop(home)
            kept = set(home.rglob("*"))
            for number in numbers:
                rng = random.Random(f"{seed} {number}")
                kind = kinds[number % len(kinds)]
                words = getattr(workshop, kind)(rng)
                begun = time.monotonic()
                answer, fault = answer_to(home, words)
                counts[kind, words[0], answer] += 1
                if fault:
                    faults.append((number, kind, words, fault))
                    show(f"--- {seed} {number} {kind} {' '.join(words)!r:.150}\n{fault}")
                elif time.monotonic() - begun > 10:
                    show(f"--- slow: {number} {kind} {words} {time.monotonic() - begun:.0f} s")
                for path in set(home.iterdir()) - kept:
                    shutil.rmtree(path) if path.is_dir() else path.unlink()
        finally:
            os.chdir(before)
    return counts, faults


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=4000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", type=int, help="number of one case")
    parser.add_argument("--kind", choices=KINDS, action="append")
    given = parser.parse_args()
    sys.path.insert(0, str(HERE.parent))
    found, bad = run(
        range(given.count) if given.only is None else [given.only],
        given.seed,
        tuple(given.kind or KINDS),
    )
    for (kind, command, answer), number in sorted(found.items()):
        sys.stdout.write(f"{kind:<8} {command:<10} {answer:<8} {number}\n")
    sys.stdout.write(f"{sum(found.values())} cases, {len(bad)} faults\n")
    sys.exit(bool(bad))
