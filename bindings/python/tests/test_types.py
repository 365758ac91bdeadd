"""The type stubs as a checker takes them: mypy --strict finds nothing in a program that runs, and what is wrong in one that does not."""
import os
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))

RIGHT = """
import numpy as np
import skein

with skein.World(threads=1) as world:
    cloth = world.bodies.cloth(name="sheet", grid=(3, 3), pins="top corners", stretch={"stiffness": 1e4})
    ball = world.colliders.sphere(radius=1, centre=[0, -2, 0])
    world.forces.drag(on=cloth, rate=0.5)
    swirl = world.forces.force_field(force=lambda p: (p.z, 0, -p.x))
    cloth.stretch.stiffness = 2e4
    cloth.stretch.stiffness = "infinite"
    cloth.stretch = {"stiffness": 3.0}
    stiffness: float = cloth.stretch.stiffness
    ball.centre = np.zeros(3)
    ball.centre = [0, -2, 0]
    x, y, z = ball.centre
    world.method = "rk4"
    world.set_method("xpbd", substeps=5)
    kind: str = world.method.kind
    world.positions = world.positions + [0, 1, 0]
    with world.record() as recording:
        world.step(1 / 60, count=3)
    size: int = len(recording.data)
    rows: int = swirl.probe([[0, 0, 1]]).shape[0]


class Reach(skein.Environment):
    def build(self) -> skein.World:
        return skein.World(threads=1)
"""

WRONG = [
    ("cloth.stretch.stifness = 3", 'maybe "stiffness"'),
    ("world.bodies.clth()", 'maybe "cloth"'),
    ("word: str = cloth.stretch.stiffness", "expression has type"),
    ('ball.centre = "left"', "expression has type"),
    ("world.method = 4", "expression has type"),
]


class Types(unittest.TestCase):
    def check(self, folder, text):
        path = os.path.join(folder, "program.py")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        ran = subprocess.run(["mypy", "--strict", "--no-error-summary", "--cache-dir", os.path.join(folder, "cache"), path],
                             env={**os.environ, "MYPYPATH": os.path.join(folder, "stubs")}, capture_output=True, text=True)
        return [line for line in ran.stdout.splitlines() if ": error:" in line]

    def test_a_checker_takes_what_runs_and_finds_what_does_not(self):
        if not any(os.path.exists(os.path.join(place, "mypy")) for place in os.environ["PATH"].split(os.pathsep)):
            self.skipTest("no mypy")
        with tempfile.TemporaryDirectory() as folder:
            os.makedirs(os.path.join(folder, "stubs", "skein"))
            subprocess.run([sys.executable, "-B", os.path.join(HERE, "..", "make_stubs.py"), os.path.join(folder, "stubs", "skein")],
                           check=True)
            exec(compile(RIGHT, "RIGHT", "exec"), {})  # it runs
            self.assertEqual(self.check(folder, RIGHT), [])
            inside = "".join(f"    {line}\n" for line, _ in WRONG)
            found = self.check(folder, RIGHT.replace("\n\nclass Reach", "\n" + inside + "\n\nclass Reach"))
            self.assertEqual(len(found), len(WRONG), found)
            for line, (_, words) in zip(found, WRONG):
                self.assertIn(words, line)


if __name__ == "__main__":
    unittest.main()
