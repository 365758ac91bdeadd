"""Fields and formulas: the classes against the command's tables, errors with their places, functions as formulas."""
import json
import math
import os
import pydoc
import re
import subprocess
import unittest

import skein
from skein import _library as L, _objects
from skein.functions import *  # noqa: F403

COMMAND = os.environ.get("SKEIN_COMMAND", "skein")
ROOT = os.environ.get("SKEIN_SOURCE_DIR", ".")


class Tables(unittest.TestCase):
    def test_all_that_skein_list_has(self):
        listed = json.loads(subprocess.run([COMMAND, "list", "--json"], check=True, capture_output=True).stdout)
        lists = ["bodies", "constraints", "forces", "colliders", "motions", "methods"]
        seen = 0
        for category, name in enumerate(lists):
            kinds = listed[name]
            self.assertEqual([kind["name"] for kind in kinds], [kind for at, kind in _objects.CLASSES if at == category])
            for kind in kinds:
                table = _objects.CLASSES[category, kind["name"]]._table
                self.assertEqual(table.help, kind["help"])
                self.assertEqual([field["name"] for field in kind["fields"]], list(table.fields))
                for field in kind["fields"]:
                    seen += 1
                    mine = table.fields[field["name"]]
                    self.assertEqual((mine.unit, mine.help), (field["unit"], field["help"]))
                    want = field["default"]
                    want = math.inf if want == "infinite" else tuple(want) if isinstance(want, list) else want
                    if field["type"] == "choice" or not isinstance(want, (float, tuple)):
                        self.assertEqual(mine.default, want)
                    elif want is not None:
                        flat = (lambda x: x if isinstance(x, tuple) else (x,))
                        for a, b in zip(flat(mine.default), flat(want)):
                            self.assertTrue(math.isclose(a, b, rel_tol=1e-12), (kind["name"], field["name"]))
        self.assertGreater(seen, 300)

    def test_structs_are_the_header_s(self):
        """The members of the structs that the header shows, by their names and in their order."""
        header = ""
        for name in ("skein", "gradient", "cut", "record"):
            with open(f"{ROOT}/include/skein/{name}.h", encoding="utf-8") as file:
                header += re.sub(r"/\*.*?\*/", "", file.read(), flags=re.S)
        mine = {name: [field[0] for field in struct._fields_] for name, struct in L.STRUCTS.items()}
        mine["statistics"] = [member[0] for member in L.statistics_members]  # a new one goes into exports.c
        for name in mine:
            if name == "handle":  # its members are the library's own
                continue
            body = re.search(rf"typedef struct skein_{name} \{{(.*?)\}} skein_{name};", header, re.S)[1]
            members = []
            for line in body.split(";"):
                if "(*" in line:
                    members.append(re.search(r"\(\*(\w+)\)", line)[1])
                elif line.strip():
                    declared = re.sub(r"\[[^\]]*\]", "", line).split(",")
                    members += [re.findall(r"\w+", part)[-1] for part in declared]
            self.assertEqual(members, mine[name], name)

    def test_words(self):
        doc = skein.kinds.ClothBody.stretch.fget(None).__class__.stiffness.__doc__
        self.assertIn("N/m", doc)
        self.assertIn("default 20000", doc)
        self.assertIn("kg/m2", pydoc.render_doc(skein.kinds.ClothBody))
        world = skein.World()
        cloth = world.bodies.cloth(grid=(3, 3))
        self.assertLessEqual({"stretch", "density", "name", "positions", "set"}, set(dir(cloth)))
        self.assertEqual(dir(cloth.stretch), ["damping", "limit", "stiffness", "tear", "tether"])
        self.assertIn("gravity", dir(world.forces))
        self.assertIn("m/s2", world.forces.gravity.__doc__)


class Setting(unittest.TestCase):
    def setUp(self):
        self.world = skein.World(threads=1)
        self.cloth = self.world.bodies.cloth(grid=(4, 5), name="sheet", stretch={"stiffness": 1e4})

    def test_values(self):
        self.cloth.stretch.stiffness = 2e4
        self.assertEqual(self.cloth.stretch.stiffness, 2e4)
        self.assertEqual(self.cloth["stretch.stiffness"], 2e4)
        self.cloth["stretch.tether"] = "infinite"
        self.assertEqual(self.cloth.stretch.tether, math.inf)
        self.cloth.stretch = {"tether": 0.5, "damping": 1}
        self.assertEqual((self.cloth.stretch.tether, self.cloth.stretch.damping), (0.5, 1))
        self.assertEqual(self.cloth.grid, (4, 5))
        self.assertEqual(self.cloth.look, "cloth")
        self.cloth.look = "jelly"
        self.assertEqual(self.world.bodies["sheet"].look, "jelly")
        self.assertIs(self.cloth.visible, True)
        self.assertEqual(self.world.get("bodies.sheet.stretch.damping"), 1)
        self.assertFalse(self.cloth.is_live("grid"))
        self.assertEqual(self.cloth.fields()["shear.stiffness"], 2000)
        self.assertIn("stretch.tether=0.5", repr(self.cloth))
        rope = self.world.bodies.rope(from_=(0, 1, 0), to=(0, 0, 0), pins=[0, 3])
        self.assertEqual(rope.from_, (0, 1, 0))
        self.assertEqual((self.world.statistics().pinned_particles, rope.pins), (2, "0 3"))

    def test_lists(self):
        gravity, drag = self.world.forces.gravity(), self.world.forces.add("drag", rate=0.3)
        self.assertEqual(self.world.forces[:], [gravity, drag])
        self.assertEqual(self.world.forces[-1], drag)
        self.assertEqual(len(self.world.forces), 2)
        gravity.remove()
        self.assertEqual(list(self.world.forces), [drag])
        self.assertFalse(gravity.valid)
        self.assertRaises(ReferenceError, getattr, gravity, "acceleration")
        self.assertRaises(IndexError, lambda: self.world.forces[1])
        self.assertRaisesRegex(skein.NameFault, "'sheet'", lambda: self.world.bodies["shet"])
        method = self.world.method
        self.world.method = "rk4"
        self.assertEqual(self.world.method.kind, "rk4")
        self.world.set_method("xpbd", substeps=20)
        self.assertEqual((self.world.method.substeps, method), (20, self.world.method))

    def test_faults_name_place_and_words(self):
        cases = [
            (skein.NameFault, r"cloth\.densty: .*did you mean 'density'", lambda: setattr(self.cloth, "densty", 1)),
            (AttributeError, r"'stretch\.stiffness'", lambda: self.cloth.stretch.stifness),
            (ValueError, r"cloth\.density: .*already built", lambda: setattr(self.cloth, "density", 1)),
            (skein.ValueFault, r"stretch\.stiffness", lambda: setattr(self.cloth.stretch, "stiffness", -1)),
            (skein.ValueFault, r"expected number in N/m.*not 'soft'", lambda: setattr(self.cloth.stretch, "stiffness", "soft")),
            (skein.ValueFault, r"three numbers", lambda: self.world.forces.gravity(acceleration=(1, 2))),
            (skein.NameFault, r"gravity", lambda: self.world.forces.graviti()),
            (skein.NameFault, r"attach\.jump: attach takes no 'jump'", lambda: self.world.motions.attach(jump=1)),
            (skein.NameFault, r"xpbd", lambda: setattr(self.world, "method", "xpdb")),
            (skein.ValueFault, r"particles: it is missing", lambda: self.world.constraints.distance()),
            (skein.ValueFault, r"takes 2 particles", lambda: self.world.constraints.distance(particles=[0, 1, 2])),
            (skein.SyntaxFault, r"\n *\^", lambda: self.world.colliders.formula(surface="length(p) - * 2")),
            (skein.SkeinError, r"bodies\.0\.densty", lambda: skein.World.from_scene({"bodies": [{"type": "cloth", "densty": 1}]})),
            (ValueError, r"scene\.json:2:", lambda: skein.World.from_scene('{"skein": 1,\n "bodies": }')),
            (OSError, r"there are: .*hanging", lambda: skein.World.from_scene("hangng")),
            (skein.NameFault, r"at its beginning", lambda: self.world.get("colours.0")),
        ]
        for kind, words, act in cases:
            with self.subTest(words):
                self.assertRaisesRegex(kind, words, act)
        try:
            skein.World.from_scene({"bodies": [{"type": "cloth", "grid": [3, 3], "densty": 1, "sizes": 2}]})
        except skein.SkeinError as error:
            self.assertEqual([where.split(": ")[1] for _, where, _ in error.faults], ["bodies.0.densty", "bodies.0.sizes"])
        self.assertEqual(len(self.world.constraints), 0)


class Formulas(unittest.TestCase):
    def test_texts(self):
        def torus(p, R=0.4, r=0.1):
            q = vec3(length(vec3(p.x, 0, p.z)) - R, p.y, 0)  # noqa: F405
            return length(q) - r  # noqa: F405

        text = skein.formula(torus)
        self.assertEqual(text, "length(vec3(length(vec3(p.x, 0, p.z)) - R, p.y, 0)) - r")
        self.assertEqual(text.parameters, {"R": 0.4, "r": 0.1})
        self.assertEqual(skein.formula(lambda p: p.x - (p.y - p.z) * -2), "p.x - (p.y - p.z) * -2")
        self.assertEqual(skein.formula(lambda p, k: -(p.x**2) / (2 * k)), "-p.x^2 / (2 * k)")
        self.assertEqual(skein.formula(lambda p: (p.x < 0) & ~(p.y >= 1)), "p.x < 0 && !(p.y >= 1)")

        def twice(p0, p1, t):
            d = length(p0 - p1)  # noqa: F405
            return d * d - sin(t)  # noqa: F405

        self.assertEqual(skein.formula(twice), "let part1 = length(p0 - p1);\npart1 * part1 - sin(t)")

    def test_values_are_python_s(self):
        """What is traced means what it says: the library's value of the text against Python's of the function."""
        world, (x, y, z) = skein.World(), (0.3, -0.7, 1.9)
        cases = [
            lambda x, y, z: x - (y - z) - -x * -y / (z / x) ** 2 ** 0.5,
            lambda x, y, z: -(x - y) * z - (x**2) + (-x) ** 2 * 3 - (x - y) / (y + z) - 2 / (z - x) * y,
            lambda x, y, z: abs(y) ** x + (x + y) ** 2 - (x * y) ** 2 / -z + min(x, y) * max(y, z) - atan2(y, x),  # noqa: F405
            lambda x, y, z: 1e-3 * x + 1.5e7 * y - 0.1 * z + exp(sin(x) * cos(y)) * sqrt(z),  # noqa: F405
        ]
        first = world.add_particles([[x, y, z], [0, 0, 0]]).start
        for i, function in enumerate(cases):
            made = world.constraints.formula(constraint=lambda p0, p1: function(p0.x, p0.y, p0[2]) + 0 * p1.x,
                                             particles=[[first, first + 1]])
            stored = map(float, world.positions[0])
            self.assertTrue(math.isclose(made.evaluate()["value"], function(*stored), rel_tol=1e-9), (i, made.constraint))

    def test_what_cannot_be_traced(self):
        for function, words in [(lambda p: 1 if p.x > 0 else 2, "select"), (lambda p: math.sqrt(p.x), "skein.functions"),
                                (lambda p: sum(p), "components"), (lambda p: p.w, "no .w"), (lambda p: None, "nothing"),
                                (lambda *p: p[0], "one by one"), (lambda p: length(p, p), "1 argument, not 2")]:  # noqa: F405
            with self.subTest(words):
                self.assertRaisesRegex((TypeError, AttributeError), re.escape(words), skein.formula, function)


if __name__ == "__main__":
    unittest.main()
