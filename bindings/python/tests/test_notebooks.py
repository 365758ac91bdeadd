"""The notebooks run from their first cell to their last, and what they find is what they say."""
import contextlib
import io
import os
import sys
import tempfile
import unittest

import numpy as np

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import run_notebook

FOLDER = os.path.join(os.environ.get("SKEIN_SOURCE_DIR", "."), "bindings", "python", "notebooks")


class Notebooks(unittest.TestCase):
    def run_in_scratch(self, name, shown):
        path, before = os.path.abspath(os.path.join(FOLDER, name)), os.getcwd()
        with tempfile.TemporaryDirectory() as scratch, contextlib.redirect_stdout(io.StringIO()):
            os.chdir(scratch)
            try:
                found, count = run_notebook.run(path)
            finally:
                os.chdir(before)
        self.assertEqual(count, shown)
        return found

    def test_first_cloth(self):
        found = self.run_in_scratch("first_cloth.ipynb", 7)
        self.assertLess(found["lowest"][-1], -0.1)
        self.assertLess(found["rest"].max_stretch, 0.01)
        self.assertGreater(found["soft"].max_stretch, 0.1)
        self.assertEqual(found["before"], found["world"].hash())
        self.assertAlmostEqual(found["fit"].found["bodies.sheet.stretch.stiffness"], 100, delta=1)

    def test_nine_methods(self):
        found = self.run_in_scratch("nine_methods.ipynb", 1)
        want = {"explicit_euler": 1, "symplectic_euler": 1, "lookahead_euler": 1, "midpoint": 2, "leapfrog": 2, "rk4": 4,
                "backward_euler": 1, "xpbd": 1, "pbd": 1}
        self.assertEqual(set(found["errors"]), set(want))
        for method, order in want.items():
            self.assertAlmostEqual(found["order"](method), order, delta=0.1, msg=method)
        self.assertGreater(found["shares"]["explicit_euler"], 10)
        self.assertAlmostEqual(found["shares"]["leapfrog"], 1, delta=0.01)

    def test_flock_phases(self):
        found = self.run_in_scratch("flock_phases.ipynb", 4)
        phases = found["polarization"]
        self.assertLess(phases[0].max(), 0.3)  # nobody flies along: no order
        self.assertGreater(phases[-1, 2:].min(), 0.9)  # all do
        self.assertTrue((np.diff(phases.mean(axis=1)) > 0).mean() >= 0.6)
        self.assertEqual(found["diagram"].shape, (144, 144, 3))


if __name__ == "__main__":
    unittest.main()
