"""What docs/python.md shows runs, block after block; and the stubs know what the package has."""
import ast
import contextlib
import io
import os
import re
import sys
import tempfile
import unittest

import skein
from skein import _objects

ROOT = os.environ.get("SKEIN_SOURCE_DIR", ".")
sys.path.insert(0, f"{ROOT}/bindings/python")


class Documents(unittest.TestCase):
    def test_blocks_run(self):
        with open(f"{ROOT}/docs/python.md", encoding="utf-8") as file:
            text = file.read()
        blocks = list(re.finditer(r"^```python\n(.*?)^```", text, re.S | re.M))
        self.assertGreater(len(blocks), 10)
        namespace, before, printed = {"__name__": "document"}, os.getcwd(), io.StringIO()
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            try:
                for block in blocks:
                    line = text[:block.start()].count("\n") + 1
                    with contextlib.redirect_stdout(printed):
                        exec(compile("\n" * line + block[1], "docs/python.md", "exec"), namespace)
                self.assertEqual(sorted(os.listdir()), ["film.png", "picture.png"])
            finally:
                os.chdir(before)
        # what a comment says is printed is
        said = re.search(r"print\(error\) +# (.*)", text)[1]
        self.assertIn(said, printed.getvalue())
        self.assertIn("(64, 10, 3)", printed.getvalue())

    def test_stubs_know_all(self):
        import make_stubs
        tree = ast.parse(make_stubs.main())
        classes = {node.name: {part.name for part in node.body if isinstance(part, ast.FunctionDef)} | {
            part.target.id for part in node.body if isinstance(part, ast.AnnAssign)}
            for node in tree.body if isinstance(node, ast.ClassDef)}
        functions = {node.name for node in tree.body if isinstance(node, ast.FunctionDef)}
        names = set(classes) | functions | {node.target.id for node in tree.body if isinstance(node, ast.AnnAssign)}
        self.assertEqual(set(skein.__all__) - names - {"functions", "kinds"}, set())
        for cls in _objects.CLASSES.values():
            for full in cls._table.fields:
                group, _, last = full.rpartition(".")
                if last == "*":
                    self.assertIn(group, classes[cls.__name__])
                    continue
                where = classes[cls.__name__] if not group else classes[f"{group.capitalize()}Of{cls.__name__}"]
                self.assertIn({"from": "from_"}.get(last, last), where, (cls.__name__, full))
        kinds, functions = map(ast.parse, make_stubs.kinds_and_functions())
        self.assertEqual([node.names[0].asname for node in kinds.body], skein.kinds.__all__)
        self.assertEqual({node.name for node in functions.body if isinstance(node, ast.FunctionDef)} | {"pi"},
                         set(skein.functions.__all__))
        world = skein.World()
        for name in dir(world):
            if not name.startswith("_"):
                self.assertIn(name, classes["World"])
        self.assertLessEqual(set(dir(world.forces)) - {"add", "kinds"}, classes["Forces"])


if __name__ == "__main__":
    unittest.main()
