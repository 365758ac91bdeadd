"""Pictures and films: the same drawing as the command's, into arrays, and shown where a notebook shows things.

libskein_draw.so is loaded by the first picture, for it wants OpenGL 4.5 (which Mesa has without a card or a display).
Films of live worlds are animated PNGs, made here; MP4, WebM and GIF are the command's, which is looked for.
"""
import base64
import ctypes
import json
import os
import shutil
import struct
import subprocess
import tempfile
import threading
import zlib

import numpy as np

from . import _library as L
from ._errors import FileFault, SkeinError, ValueFault, of
from ._library import lib

_here = threading.local()
_loaded = []


def _draw():
    if not _loaded:
        path = os.path.join(L.folder, "libskein_draw.so")
        try:
            loaded = ctypes.CDLL(path)
        except OSError as missing:
            raise SkeinError([("no pictures", "render", f"{missing}. Drawing needs OpenGL: apt install libepoxy0 libegl1 "
                               "libgl1-mesa-dri (Mesa draws without a card, too)")]) from None
        size, error = ctypes.POINTER(ctypes.c_int32 * 2), ctypes.POINTER(L.Error)
        loaded.py_draw.argtypes = [L.world, ctypes.c_void_p, size, ctypes.c_int, ctypes.c_void_p, error]
        loaded.py_studio_create.argtypes = [size, ctypes.c_int, ctypes.c_void_p, error]
        loaded.py_studio_create.restype = ctypes.c_void_p
        loaded.py_studio_draw.argtypes = [ctypes.c_void_p, L.world, ctypes.c_void_p, ctypes.c_size_t, error]
        loaded.py_studio_destroy.argtypes, loaded.py_studio_destroy.restype = [ctypes.c_void_p], None
        _loaded.append(loaded)
    return _loaded[0]


# ---- images ----


def _chunk(name, data):
    return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))


def _packed(frame):
    rows = np.concatenate([np.zeros((frame.shape[0], 1), np.uint8), frame.reshape(frame.shape[0], -1)], axis=1)
    return zlib.compress(rows.tobytes(), 6)


def _png(frames, fps=30):
    height, width, _ = frames[0].shape
    parts = [b"\x89PNG\r\n\x1a\n", _chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))]
    if len(frames) == 1:
        parts.append(_chunk(b"IDAT", _packed(frames[0])))
    else:  # animated: what does not know how shows the first
        parts.append(_chunk(b"acTL", struct.pack(">II", len(frames), 0)))
        number = 0
        for i, frame in enumerate(frames):
            control = struct.pack(">IIIIIHHBB", number, width, height, 0, 0, 1000, round(1000 * fps), 0, 0)
            parts.append(_chunk(b"fcTL", control))
            number += 1
            if i:
                parts.append(_chunk(b"fdAT", struct.pack(">I", number) + _packed(frame)))
                number += 1
            else:
                parts.append(_chunk(b"IDAT", _packed(frame)))
    return b"".join(parts + [_chunk(b"IEND", b"")])


class Image(np.ndarray):
    """A picture: height x width x 3 bytes (sRGB), rows from the top. A notebook shows it; save() writes a PNG."""

    def __new__(cls, pixels):
        return np.ascontiguousarray(pixels, np.uint8).view(cls)

    def _repr_png_(self):
        return _png([np.asarray(self)]) if self.ndim == 3 and self.shape[2] == 3 else None

    def save(self, path):
        if self.ndim != 3 or self.shape[2] != 3:
            raise ValueFault([("invalid value", "save", "a picture is height x width x 3")])
        with open(path, "wb") as file:
            file.write(_png([np.asarray(self)]))


class _View:
    """A world's view with changes: what draw.c takes, as long as this is held."""

    def __init__(self, world, fields):
        from ._scene import open_view
        self.opened = None
        if fields is None:
            self.pointer = lib.py_scene_view(world._owner.scene) if world._owner.scene else None
        else:
            scene = json.loads(L.take_text(lib.py_scene_text(world._owner.scene))) if world._owner.scene else {}
            self.opened = open_view({**(scene.get("view") or {}), **fields})
            self.pointer = lib.py_scene_view(self.opened)

    def __enter__(self):
        return self.pointer

    def __exit__(self, *_):
        if self.opened:
            lib.py_scene_free(self.opened)
            self.opened = None


def _size(size, samples):
    width, height = size
    if not (1 <= width <= 16384 and 1 <= height <= 16384 and 1 <= samples <= 64):
        raise ValueFault([("invalid value", "size", f"expected 1 to 16384 pixels each way and 1 to 64 samples, not {size}, "
                           f"{samples}")])
    if getattr(_here, "filming", False):
        raise RuntimeError("a film is being made on this thread: its pictures are its own")
    return (ctypes.c_int32 * 2)(int(width), int(height))


def render(world, size, samples, view):
    draw, pair, error = _draw(), _size(size, samples), L.Error()
    pixels = np.empty((pair[1], pair[0], 3), np.uint8)
    with world._lock, _View(world, view) as pointer:
        if draw.py_draw(world._pointer, pointer, pair, samples, pixels.ctypes.data, error):
            raise of(error, "render")
    return Image(pixels)


# ---- films ----


class Film:
    """Pictures in a row, or a file of them. A notebook shows it; save() writes an animated PNG."""

    def __init__(self, frames=None, fps=30.0, path=None):
        self.frames, self.fps, self.path = frames, fps, path

    def __len__(self):
        return len(self.frames or [])

    def __getitem__(self, index):
        return Image(self.frames[index])

    def _repr_mimebundle_(self, include=None, exclude=None):
        if self.frames:
            return {"image/png": base64.b64encode(_png(self.frames, self.fps)).decode(), "text/plain": repr(self)}
        ending = os.path.splitext(self.path)[1][1:].lower()
        with open(self.path, "rb") as file:
            data = base64.b64encode(file.read()).decode()
        if ending in ("gif", "png"):
            return {f"image/{ending}": data, "text/html": f'<img src="data:image/{ending};base64,{data}">'}
        return {"text/html": f'<video controls loop src="data:video/{ending};base64,{data}"></video>',
                "text/plain": repr(self)}

    def save(self, path):
        """An animated PNG (.png), which browsers play."""
        if not os.fspath(path).lower().endswith(".png") or not self.frames:
            raise ValueFault([("invalid value", os.fspath(path), "a film of a live world is saved as an animated .png; "
                               "MP4, WebM and GIF are made of scenes: skein.film(scene, \"film.mp4\")")])
        with open(path, "wb") as file:
            file.write(_png(self.frames, self.fps))
        self.path = os.fspath(path)

    def __repr__(self):
        return f"<Film {self.path}>" if not self.frames else f"<Film of {len(self.frames)} pictures, {self.fps:g} a second>"


def command():
    """The command `skein`: SKEIN_COMMAND's, or the one on the PATH."""
    found = shutil.which(os.environ.get("SKEIN_COMMAND", "skein"))
    if not found:
        raise FileFault([("file", "film", "MP4, WebM and GIF are made by the command `skein render`, which is not on the "
                          "PATH: install Skein ('make install'), or let SKEIN_COMMAND name it. Without it "
                          "skein.film(world) makes an animated PNG")])
    return found


def _by_command(scene, path, frames, size, samples, fps, sets):
    from ._scene import scene_path
    arguments = ["-o", os.fspath(path), "--size", f"{size[0]}x{size[1]}", "--samples", str(samples), "--quiet"]
    if frames is not None:
        arguments += ["--frames", str(frames)]
    if fps is not None:
        arguments += ["--fps", f"{fps:g}"]
    for name, value in (sets or {}).items():
        arguments += ["--set", f"{name}={value if isinstance(value, str) else json.dumps(value)}"]
    with tempfile.TemporaryDirectory() as folder:
        if isinstance(scene, dict):
            file = os.path.join(folder, "scene.json")
            with open(file, "w", encoding="utf-8") as out:
                json.dump(scene, out)
        else:
            file = scene_path(scene) or os.fspath(scene)
        done = subprocess.run([command(), "render", file, *arguments], capture_output=True, text=True)
    if done.returncode:
        raise SkeinError([("no film", os.fspath(path), done.stderr.strip())])
    return Film(path=os.fspath(path))


def film(what, path=None, *, frames=None, size=(640, 360), samples=4, fps=None, view=None, sets=None, each=None):
    """A film: of a world as it goes on (animated PNG), or of a scene (MP4, WebM, GIF by the command).

    A World is stepped, frame by frame; each(world, frame) is called before every frame's steps. A scene (a dict, a path or
    a name) with a `path` that ends with .mp4, .webm or .gif is rendered by `skein render`."""
    from ._world import World
    ending = os.path.splitext(os.fspath(path))[1].lower() if path else ""
    if not isinstance(what, World):
        if ending and ending != ".png":
            return _by_command(what, path, frames, size, samples, fps, sets)
        what = World.from_scene(what, sets or ())
    elif ending and ending != ".png":
        raise ValueFault([("invalid value", os.fspath(path), "a film of a live world is an animated .png; MP4, WebM and "
                           "GIF are made of scenes: skein.film(scene, \"film.mp4\")")])
    made = Film(_frames(what, frames or what.frames or 60, size, samples, view, each), fps or min(what.fps, 60))
    if path:
        made.save(path)
    return made


def _frames(world, count, size, samples, view, each):
    draw, pair, error, found = _draw(), _size(size, samples), L.Error(), []
    with world._lock, _View(world, view) as pointer:
        studio = draw.py_studio_create(pair, samples, pointer, error)
        if not studio:
            raise of(error, "film")
        _here.filming = True
        try:
            for i in range(count):
                if i:
                    if each:
                        each(world, i)
                    world.frame()
                pixels = np.empty((pair[1], pair[0], 3), np.uint8)
                if draw.py_studio_draw(studio, world._pointer, pixels.ctypes.data, pair[0] * pair[1], error):
                    raise of(error, "film")
                found.append(pixels)
        finally:
            _here.filming = False
            draw.py_studio_destroy(studio)
    return found
