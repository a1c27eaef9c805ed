"""An animation that was interrupted goes on from its finished frames, and only from its own."""

import json
import math
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

import skyfit
from skyfit import cli
from skyfit.render import (
    Fisheye,
    ModelSource,
    animate,
    animation,
    load_source,
)
from skyfit.render.frames import FrameStore, animation_record, frames_directory


CAMERA = Fisheye(12)
SUNS = [(1.2, 2.0), (0.8, math.pi), (1.2, 4.0), (1.5, 4.5)]


@pytest.fixture
def source():
    return load_source(None, 3.0)


@pytest.fixture
def rendered(monkeypatch):
    """Zenith angles of the suns that were rendered."""
    suns, render = [], animation.render

    def counted(source, camera, zenith, azimuth, **options):
        suns.append(zenith)
        return render(source, camera, zenith, azimuth, **options)

    monkeypatch.setattr(animation, "render", counted)
    return suns


def stop_after(count):
    def progress(stage, done, total):
        if done == count:
            raise KeyboardInterrupt

    return progress


@pytest.fixture
def begun(source, rendered, tmp_path):
    """An animation that was stopped after two of its frames."""
    path = tmp_path / "day.apng"
    with pytest.raises(KeyboardInterrupt):
        animate(path, source, CAMERA, SUNS, progress=stop_after(2))
    assert [file.name for file in tmp_path.iterdir()] == ["day.apng.frames"]
    assert len(rendered) == 2
    rendered.clear()
    return path


def contents(directory):
    return {file.name: file.read_bytes() for file in directory.iterdir()}


@pytest.mark.slow
@pytest.mark.parametrize("name", ["day.gif", "day.apng"])
def test_what_was_interrupted_ends_as_if_it_had_not_been(source, rendered, tmp_path, name):
    whole, path = tmp_path / f"whole-{name}", tmp_path / name
    record = animate(whole, source, CAMERA, SUNS)
    rendered.clear()
    seen = []
    for stop in (1, 3):
        with pytest.raises(KeyboardInterrupt):
            animate(path, source, CAMERA, SUNS, progress=stop_after(stop))
    assert not path.exists()
    again = animate(path, source, CAMERA, SUNS, progress=lambda *at: seen.append(at))
    # Each sun once, whatever was stopped where.
    assert rendered == [zenith for zenith, _ in SUNS]
    assert seen == [("frames", done, 4) for done in range(1, 5)]
    assert path.read_bytes() == whole.read_bytes()
    assert again == record | {"out": str(path)}
    assert sorted(tmp_path.iterdir()) == sorted([path, whole])


def test_exposure_and_tone_may_be_others_when_it_goes_on(begun, source, rendered, tmp_path):
    look = {"ev": 13.0, "tone": "reinhard", "gamut": "clip", "seconds": 1.0}
    animate(begun, source, CAMERA, SUNS, **look)
    assert len(rendered) == 2
    animate(tmp_path / "whole.apng", source, CAMERA, SUNS, **look)
    assert begun.read_bytes() == (tmp_path / "whole.apng").read_bytes()


def test_a_picture_that_cannot_be_written_keeps_its_frames(begun, source, rendered, monkeypatch):
    def full(*arguments, **options):
        raise OSError("no space left")

    with monkeypatch.context() as patch:
        patch.setattr(Image.Image, "save", full)
        with pytest.raises(OSError, match="no space left"):
            animate(begun, source, CAMERA, SUNS)
    assert len(rendered) == 2
    assert [file.name for file in begun.parent.iterdir()] == ["day.apng.frames"]
    animate(begun, source, CAMERA, SUNS)
    assert len(rendered) == 2


def test_a_file_that_appears_meanwhile_is_not_replaced(begun, source):
    def appear(stage, done, total):
        begun.write_text("precious")

    with pytest.raises(ValueError, match="exists already"):
        animate(begun, source, CAMERA, SUNS, progress=appear)
    assert begun.read_text() == "precious"
    assert len(contents(frames_directory(begun))) == 1 + len(SUNS)


def nearly(source):
    return ModelSource(skyfit.preetham_sky(np.nextafter(3.0, 4.0)), 3.0, source.name)


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"source": nearly(load_source(None, 3.0))}, "of another sky"),
        ({"source": load_source(None, 4.0)}, "of another sky"),
        ({"camera": Fisheye(13)}, "through another camera"),
        ({"camera": Fisheye(12, top=1e-12)}, "through another camera"),
        ({"suns": [*SUNS[:-1], (1.5, np.nextafter(4.5, 5.0))]}, "under other suns"),
        ({"suns": SUNS[:-1]}, "under other suns"),
        ({"sun_disc": False}, "with other options"),
        ({"ground_albedo": 0.5}, "with other options"),
    ],
)
def test_frames_of_another_animation_are_refused(begun, source, rendered, changed, message):
    before = contents(frames_directory(begun))
    given = {"source": source, "camera": CAMERA, "suns": SUNS, "overwrite": True} | changed
    with pytest.raises(ValueError, match=rf"day\.apng\.frames: holds frames {message}; give"):
        animate(begun, **given)
    assert contents(frames_directory(begun)) == before
    assert rendered == []


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("skyfit", "0.0.1", "by another version"),
        ("schema", "skyfit/frames/0", "by another version"),
        ("precision", "float32", "in another precision"),
    ],
)
def test_frames_of_another_program_are_refused(begun, source, key, value, message):
    file = frames_directory(begun) / "record.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | {key: value}))
    with pytest.raises(ValueError, match=message):
        animate(begun, source, CAMERA, SUNS)


@pytest.mark.parametrize("content", [None, "no record", "[]"])
def test_a_directory_of_something_else_is_left_alone(source, rendered, tmp_path, content):
    path = tmp_path / "day.gif"
    frames_directory(path).mkdir()
    (frames_directory(path) / "precious.txt").write_text("precious")
    if content is not None:
        (frames_directory(path) / "record.json").write_text(content)
    before = contents(frames_directory(path))
    with pytest.raises(ValueError, match=r"expected frames of an animation; found something else"):
        animate(path, source, CAMERA, SUNS)
    assert contents(frames_directory(path)) == before
    assert rendered == []


@pytest.mark.parametrize("left", ["record.json", "record.json.77.part"])
def test_a_record_cut_short_does_not_stop_the_animation(source, rendered, tmp_path, left):
    path = tmp_path / "day.gif"
    frames_directory(path).mkdir()
    (frames_directory(path) / left).write_bytes(b"")
    with pytest.raises(KeyboardInterrupt):
        animate(path, source, CAMERA, SUNS, progress=stop_after(2))
    animate(path, source, CAMERA, SUNS)
    assert len(rendered) == len(SUNS)
    assert [file.name for file in tmp_path.iterdir()] == ["day.gif"]


def test_only_its_own_files_are_removed(begun, source):
    foreign = frames_directory(begun) / "notes.txt"
    foreign.write_text("precious")
    animate(begun, source, CAMERA, SUNS)
    assert contents(frames_directory(begun)) == {"notes.txt": b"precious"}


def cut(file, other):
    file.write_bytes(file.read_bytes()[:-1])


def empty(file, other):
    file.write_bytes(b"")


def flip(file, other):
    content = bytearray(file.read_bytes())
    content[len(content) // 2] ^= 1
    file.write_bytes(content)


def exchange(file, other):
    file.write_bytes(other.read_bytes())


@pytest.mark.parametrize("damage", [cut, empty, flip, exchange])
def test_a_damaged_frame_is_rendered_again(begun, source, rendered, tmp_path, damage):
    first, second = (frames_directory(begun) / f"frame-000{k}.light" for k in (1, 2))
    damage(second, first)
    animate(begun, source, CAMERA, SUNS)
    assert rendered == [SUNS[1][0], SUNS[2][0], SUNS[3][0]]
    animate(tmp_path / "whole.apng", source, CAMERA, SUNS)
    assert begun.read_bytes() == (tmp_path / "whole.apng").read_bytes()


def test_half_a_file_never_has_a_frames_name(begun, source, monkeypatch):
    """The disk is full in the middle of the third frame."""
    write = Path.write_bytes

    def half(path, content):
        write(path, content[: len(content) // 2])
        raise OSError("no space left")

    before = contents(frames_directory(begun))
    with monkeypatch.context() as patch:
        patch.setattr(Path, "write_bytes", half)
        with pytest.raises(OSError, match="no space left"):
            animate(begun, source, CAMERA, SUNS)
    assert contents(frames_directory(begun)) == before


def test_frames_of_the_same_shape_from_elsewhere_do_not_count(begun, source):
    """Files copied from another animation into this one's directory."""
    there = animation_record(source, Fisheye(12, top=1.0), np.array(SUNS), {})
    record = frames_directory(begun) / "record.json"
    record.write_text(json.dumps(there))
    store = FrameStore(frames_directory(begun), there, CAMERA.shape)
    assert store.load(0) is None
    assert store.load(1) is None


class Tinted(ModelSource):
    def xyz(self, direction, sun_zenith, sun_azimuth):
        return 2 * super().xyz(direction, sun_zenith, sun_azimuth)


class Named(Tinted):
    def identity(self):
        return "twice", self.turbidity


class WideFisheye(Fisheye):
    pass


def test_what_skyfit_cannot_know_is_not_kept(source, rendered, tmp_path):
    path, own = tmp_path / "day.apng", (source.model, 3.0, "own")
    for sky, camera in ((Tinted(*own), CAMERA), (source, WideFisheye(12))):
        with pytest.raises(KeyboardInterrupt):
            animate(path, sky, camera, SUNS, progress=stop_after(2))
        assert list(tmp_path.iterdir()) == []
    # Its author can tell it apart.
    with pytest.raises(KeyboardInterrupt):
        animate(path, Named(*own), CAMERA, SUNS, progress=stop_after(2))
    with pytest.raises(ValueError, match="of another sky"):
        animate(path, source, CAMERA, SUNS)
    rendered.clear()
    animate(path, Named(*own), CAMERA, SUNS)
    assert len(rendered) == 2


def test_the_command_says_how_to_go_on_and_does(tmp_path, monkeypatch, capsys, rendered):
    monkeypatch.chdir(tmp_path)
    words = ["render", "--turbidity", "3", "--to-sun-zenith-deg", "90", "--frames", "3",
             "--height", "12", "--out"]  # fmt: skip
    assert cli.run([*words, "whole.gif"]) == 0
    capsys.readouterr()
    whole, counted = (tmp_path / "whole.gif").read_bytes(), animation.render

    def stopped(source, camera, zenith, azimuth, **options):
        if len(rendered) == 2:
            raise KeyboardInterrupt
        return counted(source, camera, zenith, azimuth, **options)

    rendered.clear()
    with monkeypatch.context() as patch:
        patch.setattr(animation, "render", stopped)
        assert cli.run([*words, "day.gif"]) == 130
    error = capsys.readouterr().err
    assert error == (
        "skyfit: interrupted: 2 of 3 frames are in day.gif.frames; the same command continues\n"
    )
    assert cli.run([*words, "day.gif", "--height", "13"]) == 2
    error = capsys.readouterr().err
    assert "day.gif.frames: holds frames through another camera" in error
    assert error.count("\n") == 1
    assert cli.run([*words, "day.gif"]) == 0
    assert len(rendered) == 3
    assert (tmp_path / "day.gif").read_bytes() == whole
    assert sorted(file.name for file in tmp_path.iterdir()) == ["day.gif", "whole.gif"]
