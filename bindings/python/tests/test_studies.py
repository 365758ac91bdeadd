"""Studies: the rows of the command, from threads of Python, in an array."""
import contextlib
import csv
import io
import json
import os
import re
import subprocess
import tempfile
import unittest

import numpy as np

import skein

ROOT = os.environ.get("SKEIN_SOURCE_DIR", ".")
COMMAND = os.environ.get("SKEIN_COMMAND")

STUDY = {
    "study": 1, "scene": "rope", "set": {"frames": 8}, "seed": 3, "repeat": 2,
    "vary": {"method.substeps": [2, 4], "method.type": ["xpbd", "no_such"],
             "bodies.slack.stretch.stiffness": {"random": [100, 1000]}},
    "measure": ["lowest", {"measure": "kinetic_energy", "over": "mean", "name": "k"}],
}


class Studies(unittest.TestCase):
    def test_rows_are_those_of_worlds(self):
        seen = []
        table = skein.study(STUDY, jobs=3, progress=lambda done, rows: seen.append((done, rows)))
        self.assertEqual(seen, [(i + 1, 8) for i in range(8)])
        np.testing.assert_array_equal(table["row"], range(8))
        np.testing.assert_array_equal(table["method.substeps"], [2] * 4 + [4] * 4)
        self.assertEqual(list(table["outcome"]), (["good"] * 2 + ["refused"] * 2) * 2)
        self.assertTrue(np.isnan(table["lowest"][2]) and "no_such" in table["said"][2])
        self.assertEqual(len(set(table["bodies.slack.stretch.stiffness"])), 8)
        row = table[5]
        world = skein.World.from_scene("rope", {
            "method.substeps": 4, "bodies.slack.stretch.stiffness": float(row["bodies.slack.stretch.stiffness"])})
        energies = [world.statistics().kinetic_energy]
        for _ in range(8):
            world.frame()
            energies.append(world.statistics().kinetic_energy)
        self.assertEqual(world.hash(), row["state_hash"])
        self.assertAlmostEqual(np.mean(energies), row["k"], places=12)
        self.assertEqual(world.positions[:, 1].min(), row["lowest"])

    def test_a_folder_goes_on_with_the_command(self):
        with tempfile.TemporaryDirectory() as folder:
            study, out = f"{folder}/s.json", f"{folder}/out"
            with open(study, "w", encoding="utf-8") as file:
                json.dump(dict(STUDY, scene=os.path.abspath(f"{ROOT}/scenes/rope.json")), file)
            whole = skein.study(study)

            def stop(done, rows):
                if done == 3:
                    raise KeyboardInterrupt

            self.assertRaises(KeyboardInterrupt, skein.study, study, out, jobs=1, progress=stop)
            with open(f"{out}/table.csv", encoding="utf-8") as file:
                self.assertEqual(len(list(csv.DictReader(file))), 3)
            again = skein.study(study, out)
            names = [name for name in whole.dtype.names if name != "seconds"]
            for name in names:
                np.testing.assert_array_equal(whole[name], again[name])
            self.assertRaisesRegex(skein.SkeinError, "another study", skein.study, dict(STUDY, seed=4), out)
            if COMMAND:  # nothing is left for it to do, and it says that two rows of each four were refused
                done = subprocess.run([COMMAND, "study", study, "--out", out, "--no-progress"], capture_output=True, text=True)
                self.assertEqual(done.returncode, 1)
                self.assertIn("4 rows refused", done.stderr)
                with open(f"{out}/table.csv", encoding="utf-8") as file:
                    rows = list(csv.DictReader(file))
                self.assertEqual([row["state_hash"] for row in rows], list(whole["state_hash"]))

    def test_the_document_s_block_runs(self):
        with open(f"{ROOT}/docs/studies.md", encoding="utf-8") as file:
            block = re.search(r"^```python\n(.*?)^```", file.read(), re.S | re.M)[1]
        printed = io.StringIO()
        with contextlib.redirect_stdout(printed):
            exec(block, {})
        self.assertIn("[ 5 10 20]", printed.getvalue())

    def test_faults(self):
        self.assertRaisesRegex(skein.SkeinError, "no such file", skein.study, "none.json")
        self.assertRaisesRegex(skein.NameFault, r"measure\.0.*did you mean 'lowest'", skein.study,
                               dict(STUDY, measure=["lowset"]))
        self.assertRaisesRegex(skein.SkeinError, "vary", skein.study, "{}")


if __name__ == "__main__":
    unittest.main()
