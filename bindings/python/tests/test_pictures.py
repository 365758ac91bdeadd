"""Pictures: pixels where things are, the same as the command's, PNGs that can be read, films."""
import os
import struct
import subprocess
import tempfile
import unittest
import zlib

import numpy as np

import skein

COMMAND = os.environ.get("SKEIN_COMMAND", "skein")
ROOT = os.environ.get("SKEIN_SOURCE_DIR", ".")


def read_png(data):
    """The pictures of a PNG of eight-bit colours without an own reader's help: unfilters all filters there are."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed, sizes = 8, [], None
    while at < len(data):
        length, name = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        assert struct.unpack(">I", data[at + 8 + length:at + 12 + length])[0] == zlib.crc32(name + body)
        if name == b"IHDR":
            sizes = struct.unpack(">IIBB", body[:10])
        elif name == b"fcTL":
            packed.append(b"")
        elif name in (b"IDAT", b"fdAT"):
            packed = packed or [b""]
            packed[-1] += body[4:] if name == b"fdAT" else body
        at += 12 + length
    width, height, depth, colours = sizes
    assert (depth, colours) == (8, 2)
    return [_unfilter(zlib.decompress(one), width, height) for one in packed]


def _unfilter(raw, width, height):
    rows = np.frombuffer(raw, np.uint8).reshape(height, 1 + 3 * width)
    out = np.zeros((height, 3 * width), np.int64)
    for y, row in enumerate(rows):
        kind, line = row[0], row[1:].astype(np.int64)
        above = out[y - 1] if y else np.zeros(3 * width, np.int64)
        for x in range(3 * width) if kind in (1, 3, 4) else ():
            a, b, c = out[y, x - 3] if x >= 3 else 0, above[x], above[x - 3] if x >= 3 else 0
            if kind == 4:
                p = a + b - c
                a = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            out[y, x] = (line[x] + (a if kind in (1, 4) else (a + b) // 2)) % 256
        if kind in (0, 2):
            out[y] = (line + (above if kind == 2 else 0)) % 256
    return out.reshape(height, width, 3).astype(np.uint8)


class Pictures(unittest.TestCase):
    def test_the_command_s_picture(self):
        world = skein.World.from_scene(f"{ROOT}/scenes/drape.json")
        world.frame(5)
        mine = world.render(size=(160, 90), samples=1)
        with tempfile.TemporaryDirectory() as folder:
            path = f"{folder}/drape.png"
            subprocess.run([COMMAND, "render", "scenes/drape.json", "-o", path, "--frame", "5", "--size", "160x90",
                            "--samples", "1", "--quiet"], cwd=ROOT, check=True)
            with open(path, "rb") as file:
                (theirs,) = read_png(file.read())
            mine.save(path)
            with open(path, "rb") as file:
                np.testing.assert_array_equal(read_png(file.read())[0], mine)
        self.assertEqual((mine.shape, mine.dtype), ((90, 160, 3), np.uint8))
        np.testing.assert_array_equal(mine, theirs)
        self.assertEqual(read_png(mine._repr_png_())[0].shape, (90, 160, 3))

    def test_a_view_s_fields(self):
        world = skein.World()
        world.bodies.cloth(grid=(9, 9))
        plain, none = (world.render(size=(80, 45), samples=1, view=view) for view in (None, {"surface": False}))
        self.assertFalse(np.array_equal(plain, none))
        self.assertRaisesRegex(skein.NameFault, "surfac", world.render, view={"surfac": False})
        self.assertRaisesRegex(skein.ValueFault, "16384", world.render, size=(0, 10))
        world.close()
        self.assertRaisesRegex(ValueError, "closed", world.render, size=(8, 8))


class Films(unittest.TestCase):
    def test_of_a_live_world(self):
        world, seen = skein.World.from_scene(f"{ROOT}/scenes/rope.json"), []
        film = skein.film(world, frames=4, size=(64, 36), samples=1, each=lambda w, i: seen.append((w is world, i)))
        self.assertEqual((len(film), world.statistics().steps, seen), (4, 3 * world.steps_per_frame, [(True, i) for i in (1, 2, 3)]))
        with tempfile.TemporaryDirectory() as folder:
            film.save(f"{folder}/rope.png")
            with open(f"{folder}/rope.png", "rb") as file:
                pictures = read_png(file.read())
        np.testing.assert_array_equal(pictures, film.frames)
        self.assertFalse(np.array_equal(pictures[0], pictures[3]))
        self.assertIn("image/png", film._repr_mimebundle_())
        self.assertRaisesRegex(skein.ValueFault, "animated", skein.film, world, "rope.mp4")
        world.render(size=(8, 8), samples=1)  # the thread is free again

    def test_of_a_scene_by_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            film = skein.film({"bodies": [{"type": "rope", "count": 4}]}, f"{folder}/rope.gif", frames=3, size=(64, 36),
                              samples=1)
            with open(film.path, "rb") as file:
                self.assertEqual(file.read(4), b"GIF8")
            self.assertIn("text/html", film._repr_mimebundle_())
            self.assertRaisesRegex(skein.SkeinError, "densty", skein.film, {"bodies": [{"type": "cloth", "densty": 1}]},
                                   f"{folder}/x.gif")
        before = os.environ.get("SKEIN_COMMAND")
        os.environ["SKEIN_COMMAND"] = "/nowhere/skein"
        try:
            self.assertRaisesRegex(OSError, "make install", skein.film, "rope", "rope.mp4")
        finally:
            os.environ["SKEIN_COMMAND"] = before or "skein"


if __name__ == "__main__":
    unittest.main()
