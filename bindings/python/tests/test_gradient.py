"""Gradients of a run, in double precision: against a closed form and central differences; and what float says."""
import os
import subprocess
import sys
import unittest

if os.environ.get("SKEIN_PRECISION") != "double":
    # once more in a process of its own, for the library is chosen when skein is imported
    sys.exit(subprocess.run([sys.executable, *(["-B"] if sys.dont_write_bytecode else []), __file__, *sys.argv[1:]],
                            env={**os.environ, "SKEIN_PRECISION": "double"}).returncode)

import numpy as np

import skein

CLOTH = {"skein": 1, "method": {"type": "symplectic_euler", "substeps": 10},
         "bodies": [{"type": "cloth", "grid": [6, 6], "pins": "top edge", "rotation": [60, 0, 0],
                     "stretch": {"stiffness": 40, "tether": "infinite"}, "shear": {"stiffness": 10}}],
         "forces": [{"type": "gravity"}, {"type": "drag", "rate": 1}]}
FIELDS = ["bodies.0.stretch.stiffness", "forces.0.acceleration"]


def weigh(positions, velocities):
    return 0.5 * (positions ** 2).sum() + 0.1 * velocities.sum(), positions, np.full_like(velocities, 0.1)


class Gradients(unittest.TestCase):
    def test_agrees_with_differences(self):
        for method in "symplectic_euler", "xpbd":
            with self.subTest(method):
                self.agrees_with_differences(method)

    def agrees_with_differences(self, method):
        world = skein.World.from_scene(CLOTH, {"method.type": method})
        steps, rng = 12, np.random.default_rng(21)
        self.assertEqual(skein.precision, "double")
        asked = []

        def measure(step, positions, velocities):
            asked.append(step)
            self.assertFalse(positions.flags.writeable)
            return weigh(positions, velocities) if step == steps else None

        begun, before = world.positions, world.hash()
        found = world.gradient(steps, measure, FIELDS)
        self.assertEqual((asked, world.hash()), (list(range(steps, -1, -1)), before))
        dx, dv = rng.normal(size=(2, *begun.shape)) * [[[0.01]], [[0.1]]]
        df = {FIELDS[0]: 30.0, FIELDS[1]: np.array([1.0, 2.0, -1.0])}
        ought = (dx * found.by_positions).sum() + (dv * found.by_velocities).sum() + sum(
            np.dot(df[path], found.by_field[path]) for path in FIELDS)

        def value(e):
            world.reset()
            world.bodies[0].stretch.stiffness = 40 + e * df[FIELDS[0]]
            world.forces[0].acceleration = np.array([0, -9.81, 0]) + e * df[FIELDS[1]]
            world.positions, world.velocities = begun + e * dx, e * dv
            world.step(count=steps)
            return weigh(world.positions, world.velocities)[0]

        e = 1e-4
        slope = (8 * (value(e) - value(-e)) - (value(2 * e) - value(-2 * e))) / (12 * e)
        self.assertLess(abs(slope / ought - 1), 1e-7)
        self.assertLess(abs(found.value / value(0) - 1), 1e-12)

    def test_faults(self):
        world = skein.World.from_scene(CLOTH)
        with self.assertRaisesRegex(KeyError, "mine"):  # what a measure raises comes through
            world.gradient(3, lambda *_: {}["mine"])
        with self.assertRaisesRegex(skein.SkeinError, "stifness"):
            world.gradient(3, lambda *_: None, "bodies.0.stretch.stifness")
        with self.assertRaises(ValueError):
            world.gradient(3, lambda *_: (1, 0, 0, 0))
        world.colliders.plane()
        with self.assertRaisesRegex(skein.ValueFault, "has no gradient yet"):
            world.gradient(3, lambda *_: None)

    def test_float_says_so(self):
        code = ("import skein; w = skein.World(); w.bodies.cloth(grid=(3, 3))\n"
                "try: w.gradient(1, lambda *_: None)\nexcept skein.ValueFault as e: print(skein.precision, e)")
        said = subprocess.run([sys.executable, "-B", "-c", code], env={**os.environ, "SKEIN_PRECISION": ""}, check=True,
                              capture_output=True, text=True).stdout
        self.assertRegex(said, "float.*double precision")
        wrong = subprocess.run([sys.executable, "-B", "-c", "import skein"], env={**os.environ, "SKEIN_PRECISION": "half"},
                               capture_output=True, text=True)
        self.assertIn("SKEIN_PRECISION=half: expected float or double", wrong.stderr)


if __name__ == "__main__":
    unittest.main()
