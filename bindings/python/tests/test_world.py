"""Worlds against closed forms, against the command, and what views and errors promise."""
import copy
import gc
import json
import math
import multiprocessing
import os
import pickle
import re
import subprocess
import tempfile
import threading
import unittest
import weakref

import numpy as np

import skein
from skein import _library as L

COMMAND = os.environ.get("SKEIN_COMMAND", "skein")
ROOT = os.environ.get("SKEIN_SOURCE_DIR", ".")


def command(*arguments):
    return subprocess.run([COMMAND, *arguments], cwd=ROOT, check=True, capture_output=True, text=True).stdout


class ClosedForms(unittest.TestCase):
    def test_free_fall(self):
        world = skein.World(threads=1)
        world.set_method("leapfrog", substeps=1)
        world.forces.gravity(acceleration=(0, -9.81, 0))
        world.add_particles([[0, 10, 0]], [[1, 0, 0]], masses=2)
        world.step(0.01, 100)
        self.assertAlmostEqual(world.time, 1.0, places=12)
        np.testing.assert_allclose(world.positions[0], [1, 10 - 9.81 / 2, 0], atol=2e-5)  # exact but for rounding
        np.testing.assert_allclose(world.velocities[0], [1, -9.81, 0], atol=2e-5)
        self.assertAlmostEqual(world.statistics().kinetic_energy, (1 + 9.81**2), delta=1e-3)

    def test_what_is_cut_off_falls(self):
        """The lower half of a cloth that is cut across goes as a stone does; mended, it hangs again."""
        world, g = skein.World(threads=1), 9.81
        world.set_method("xpbd", substeps=4)
        world.forces.gravity(acceleration=(0, -g, 0))
        cloth = world.bodies.cloth(grid=(12, 12), size=(1, 1), rotation=(90, 0, 0), pins="top edge")
        before = cloth.positions
        height = (before[:, 1].min() + before[:, 1].max()) / 2
        count = cloth.cut([[-9, height, -9], [9, height, -9], [0, height, 9]])
        self.assertEqual(count, 11)
        self.assertEqual((cloth.cuts.sum(), len(cloth.cuts)), (11, 121))
        loose = before[:, 1] < height
        self.assertEqual(loose.sum(), 72)
        world.step(1 / 60, 18)
        fallen = (before[loose, 1] - cloth.positions[loose, 1]).mean()
        self.assertAlmostEqual(fallen, g * 0.3 * (0.3 + 1 / 240) / 2, delta=2e-3)  # symplectic, by substeps
        whole = world.snapshot()
        cloth.mend()
        self.assertFalse(cloth.cuts.any())
        world.restore(whole)
        self.assertEqual(cloth.cuts.sum(), 11)
        world.reset()
        cloth.cut_faces([0, 5])
        self.assertEqual(np.flatnonzero(cloth.cuts).tolist(), [0, 5])
        with self.assertRaises(skein.ValueFault):
            cloth.cut_faces([121])
        with self.assertRaises(skein.ValueFault):
            cloth.cut([[math.nan] * 3] * 3)

    def test_pendulum(self):
        """The period of a rigid pendulum of 1 m that swings by 30 degrees, by the arithmetic-geometric mean."""
        world, angle, g, dt = skein.World(threads=1), math.radians(30), 9.81, 1 / 240
        world.set_method("xpbd", substeps=10)
        world.forces.gravity(acceleration=(0, -g, 0))
        world.add_particles([[0, 0, 0], [math.sin(angle), -math.cos(angle), 0]], masses=[0, 1])
        world.constraints.distance(particles=[[0, 1]], stiffness=math.inf)
        crossings, before = [], world.positions[1, 0]
        while len(crossings) < 5:
            world.step(dt)
            x = world.positions[1, 0]
            if before * x < 0:
                crossings.append(world.time - dt * x / (x - before))
            before = x
        a, b = 1.0, math.cos(angle / 2)
        while a - b > 1e-15:
            a, b = (a + b) / 2, math.sqrt(a * b)
        period = 2 * math.pi / a * math.sqrt(1 / g)
        self.assertAlmostEqual((crossings[4] - crossings[0]) / 2, period, delta=2e-3 * period)

    def test_formula_spring_is_the_built_in_one(self):
        """A traced spring swings as k/m says."""
        world, k, mass = skein.World(threads=1), 40.0, 0.5
        world.set_method("leapfrog", substeps=4)
        world.add_particles([[0, 0, 0], [1.1, 0, 0]], masses=[0, mass])
        length = skein.functions.length
        spring = world.constraints.formula(constraint=lambda p0, p1, L=1.0: length(p0 - p1) - L, particles=[0, 1], stiffness=k)
        self.assertEqual(spring.constraint, "length(p0 - p1) - L")
        self.assertEqual(spring.parameters.L, 1)
        world.step(1e-3, 1000)
        self.assertAlmostEqual(world.positions[1, 0], 1 + 0.1 * math.cos(math.sqrt(k / mass) * world.time), delta=1e-4)


class Scenes(unittest.TestCase):
    def test_hashes_are_the_command_s(self):
        for name, frames in ("hanging", 30), ("birds", 20), ("jelly_ball", 10), ("torus", 20), ("breathing_rope", 60):
            with self.subTest(name):
                report = json.loads(command("run", f"scenes/{name}.json", "--frames", str(frames), "--quiet", "--json"))
                world = skein.World.from_scene(f"{ROOT}/scenes/{name}.json")
                world.frame(frames)
                self.assertEqual(world.hash(), report["state_hash"])
                self.assertEqual(world.statistics().state_hash, report["state_hash"])

    def test_changes_before_and_while_it_lives(self):
        path = f"{ROOT}/scenes/flag.json"
        before = skein.World.from_scene(path, {"forces.1.velocity": [2, 0, 3], "method.substeps": 5})
        live = skein.World.from_scene(path)
        live.set("forces.1.velocity", (2, 0, 3))
        live.method.substeps = 5
        self.assertEqual(live.get("forces.1.velocity"), (2, 0, 3))
        other = skein.World.from_scene(before.scene() | {"output": ["film"]})
        for world in before, live, other:
            world.frame(20)
        self.assertEqual(before.hash(), live.hash())
        self.assertEqual(before.hash(), other.hash())
        self.assertEqual(before.scene()["method"]["substeps"], 5)
        live.bodies[0].stretch.limit = math.inf
        live.colliders.add  # looking at it adds nothing
        again = skein.World.from_scene(live.scene() | {"output": []})  # what was set while it lived is in it
        live.reset()
        for world in live, again:
            world.set_method("pbd", substeps=7)
            world.frame(5)
        self.assertEqual(again.hash(), live.hash())
        self.assertEqual(again.get("forces.1.velocity"), (2, 0, 3))
        self.assertEqual(live.scene()["bodies"][0]["stretch"]["limit"], "infinite")
        self.assertEqual((live.scene()["method"]["type"], live.scene()["method"]["substeps"]), ("pbd", 7))
        live.method.iterations = 2
        self.assertEqual(live.scene()["method"]["iterations"], 2)
        live.forces[1].remove()
        self.assertRaisesRegex(skein.ValueFault, "added or removed", live.scene)
        self.assertIsNone(skein.World().scene())
        self.assertRaisesRegex(TypeError, "snapshot", copy.deepcopy, live)
        plain = skein.World.from_scene(path)
        plain.frame(20)
        self.assertNotEqual(plain.hash(), live.hash())

    def test_by_hand_is_by_scene(self):
        scene = skein.World.from_scene({"bodies": [{"type": "cloth", "grid": [9, 12], "pins": "corners"}],
                                        "forces": [{"type": "gravity"}, {"type": "drag", "rate": 0.5}]})
        hand = skein.World()
        hand.bodies.cloth(grid=(9, 12), pins="corners")
        hand.forces.gravity()
        hand.forces.drag(rate=0.5)
        scene.step(1 / 60, 30)
        hand.step(1 / 60, 30)
        self.assertEqual(scene.hash(), hand.hash())

    def test_meshes_by_file_and_from_arrays(self):
        world = skein.World.from_scene(f"{ROOT}/meshes/ball.obj", {"method.substeps": 3})
        world.frame(5)
        report = json.loads(command("run", "meshes/ball.obj", "--frames", "5", "--set", "method.substeps=3", "--quiet", "--json"))
        self.assertEqual(world.hash(), report["state_hash"])
        triangle = skein.World()
        body = triangle.bodies.cloth(vertices=[[0, 0, 0], [1, 0, 0], [0, 0, 1], [1, 0, 1]], faces=[[0, 1, 2], [1, 3, 2]])
        self.assertEqual(len(body.particles), 4)
        self.assertEqual([list(face) for face in body.faces], [[0, 1, 2], [1, 3, 2]])
        self.assertEqual(body.elements("triangles").shape, (2, 3))
        np.testing.assert_array_equal(body.vertices, body.positions.astype(np.float32))


class Views(unittest.TestCase):
    def setUp(self):
        self.world = skein.World(threads=1)
        self.cloth = self.world.bodies.cloth(grid=(20, 33), pins="top edge")
        self.world.forces.gravity()

    def test_they_show_the_step_with_no_copy(self):
        positions, velocities, slot_of = self.world.position_view, self.world.velocity_view, self.world.slot_of
        first = positions.copy()
        for count in 1, 7:
            self.world.step(1 / 60, count)
            np.testing.assert_array_equal(positions[slot_of][:, :3], self.world.positions)
            np.testing.assert_array_equal(velocities[slot_of][:, :3], self.world.velocities)
        self.assertFalse(np.array_equal(first, positions))
        view = L.position_view(self.world._pointer)
        self.assertEqual(positions.ctypes.data, view.xyzw)  # it is the world's memory itself
        self.assertEqual(slot_of.ctypes.data, view.slot_of)
        self.assertFalse(positions.flags.writeable)
        self.assertEqual((positions[slot_of][:, 3] == 0).sum(), self.world.statistics().pinned_particles)
        np.testing.assert_allclose(velocities[slot_of][:, 3].sum(), 0.2, rtol=1e-5)  # kg: 0.2 kg/m2, and 1 m2

    def test_nothing_takes_their_memory_away(self):
        view = self.world.position_view
        part = view[3:, 1]
        del view
        for act in (self.world.close, lambda: self.world.bodies.rope(), self.cloth.remove,
                    lambda: setattr(self.cloth, "enabled", False), lambda: self.world.add_particles([[0, 0, 0]])):
            self.assertRaisesRegex(BufferError, "still held", act)
        self.world.step()
        self.world.method = "pbd"  # what moves nothing is allowed
        self.world.step(1 / 30)
        self.assertTrue(np.isfinite(part).all())
        del part
        self.cloth.enabled = False
        self.world.bodies.rope()
        self.world.close()
        self.assertRaisesRegex(ValueError, "closed", self.world.step)
        self.assertRaisesRegex(ValueError, "closed", lambda: self.world.positions)

    def test_a_view_keeps_its_world(self):
        owner = weakref.ref(self.world._owner)
        self.world.step()
        view, slot_of, want = self.world.position_view, self.world.slot_of, self.world.positions
        gc.disable()  # nothing here waits for the collector of cycles: a world goes with its last name
        try:
            self.world = self.cloth = None
            self.assertIsNotNone(owner())
            np.testing.assert_array_equal(view[slot_of][:, :3], want)
            del view, slot_of
            self.assertIsNone(owner())
        finally:
            gc.enable()

    def test_rows_that_move_in_large_flocks(self):
        world = skein.World()
        world.set_method("symplectic_euler", substeps=1)
        world.bodies.flock(count=40000, spread=(40, 40, 40), speed=2)
        world.forces.flocking(separation=1, alignment=1, cohesion=1)
        view, slot_of = world.position_view, world.slot_of
        before = slot_of.copy()
        world.step(0.1, 2)
        self.assertFalse(np.array_equal(before, slot_of))  # or this test shows nothing
        np.testing.assert_array_equal(view[slot_of][:, :3], world.positions)

    def test_an_empty_world_has_empty_views(self):
        world = skein.World()
        self.assertEqual(world.position_view.shape, (0, 4))
        self.assertEqual(world.positions.shape, (0, 3))
        world.bodies.rope()


class State(unittest.TestCase):
    def test_snapshots_are_exact(self):
        world = skein.World.from_scene(f"{ROOT}/scenes/drape.json")
        world.frame(20)
        state, start = world.snapshot(), world.hash()
        world.frame(20)
        end = world.hash()
        self.assertNotEqual(start, end)
        world.colliders[0].friction = 0.9
        view = world.position_view  # which no snapshot of the same bodies moves
        world.restore(state)
        self.assertEqual(world.hash(), start)
        self.assertNotEqual(world.colliders[0].friction, 0.9)
        np.testing.assert_array_equal(view[world.slot_of][:, :3], world.positions)
        self.assertRaisesRegex(BufferError, "still held", world.restore, bytes(state))
        del view
        world.frame(20)
        self.assertEqual(world.hash(), end)
        twin = skein.World.from_scene(f"{ROOT}/scenes/drape.json")
        twin.restore(pickle.loads(pickle.dumps(state)))
        twin.frame(20)
        self.assertEqual(twin.hash(), end)
        self.assertRaises(skein.SyntaxFault, twin.restore, b"nothing of the kind")
        self.assertRaises(skein.SkeinError, skein.World().restore, state)
        self.assertEqual(twin.hash(), end)
        world.reset()
        world.frame(40)
        self.assertEqual(world.hash(), end)

    def test_snapshots_and_bodies_that_come_and_go(self):
        world = skein.World()
        cloth, _ = world.bodies.cloth(grid=(5, 5)), world.bodies.rope()
        world.step()
        state = world.snapshot()
        cloth.enabled = False
        view = world.position_view
        self.assertRaisesRegex(BufferError, "still held", world.restore, state)
        del view
        world.restore(state)
        self.assertTrue(cloth.enabled)

    def test_writing_holding_leading(self):
        world = skein.World(threads=1)
        rope = world.bodies.rope(count=5, from_=(0, 0, 0), to=(1, 0, 0), pins="first")
        world.forces.gravity()
        rope.positions = rope.positions + [0, 2, 0]
        rope.velocities = [0, 0, 1]
        np.testing.assert_allclose(world.positions[:, 1], 2)
        np.testing.assert_allclose(world.velocities[1:], [[0, 0, 1]] * 4)
        rope.velocities = 0
        world.pin(4)
        world.move_pins([0, 4], [[0, 3, 0], [1, 3, 0]])
        world.step()
        np.testing.assert_allclose(world.positions[[0, 4]], [[0, 3, 0], [1, 3, 0]])
        self.assertRaisesRegex(skein.ValueFault, "count of steps", world.step, count=-1)
        world.pin(4, False)
        world.step(count=20)
        self.assertLess(world.positions[4, 1], 2.9)
        self.assertRaisesRegex(skein.SkeinError, "0 to 4", world.pin, 5)
        self.assertRaises(skein.ValueFault, setattr, world, "positions", np.nan)
        self.assertRaises(ValueError, setattr, world, "positions", np.zeros((4, 3)))

    def test_measures(self):
        world = skein.World.from_scene(f"{ROOT}/scenes/birds.json")
        order = world.order(world.bodies["birds"])
        self.assertEqual(order.count, 1024)
        self.assertAlmostEqual(order.farthest, np.linalg.norm(world.positions, axis=1).max(), places=3)
        ball = skein.World()
        sphere = ball.colliders.sphere(radius=0.5, name="ball")
        ball.add_particles([[0, 0.4, 0], [0, 3, 0]])
        (contact,) = ball.contacts()
        self.assertEqual((contact.particle, contact.collider), (0, sphere))
        np.testing.assert_allclose(contact.normal, [0, 1, 0], atol=1e-6)
        hit = ball.ray_cast([0, 5, 0], [0, -2, 0], of="collider")
        self.assertAlmostEqual(hit.t, 4.5, places=5)
        self.assertEqual(hit.object, sphere)
        self.assertIsNone(ball.ray_cast([0, 5, 0], [0, 1, 0], of="collider"))
        np.testing.assert_allclose(sphere.probe([[2, 0, 0], [0, 0, 0.25]])[0], [1.5, -0.25], atol=1e-6)
        self.assertTrue(len(world.explain()) > 3)


class Solids(unittest.TestCase):
    """Meshes as solids, from arrays, which deform; what is fastened to another body; fields that are asked."""

    corners = np.array([[-1, 0, -1], [1, 0, -1], [0, 0, 1], [0, 0.5, 0]], float)
    faces = [[0, 3, 1], [1, 3, 2], [2, 3, 0], [0, 1, 2]]

    def test_a_mesh_that_deforms_pushes(self):
        world = skein.World(threads=1)
        world.add_particles([[0, 0.6, 0]])
        ground = world.colliders.mesh(vertices=self.corners, faces=self.faces)
        np.testing.assert_allclose(ground.probe([[0, 1.5, 0]])[0], [1], atol=1e-6)
        for i in range(60):  # its tip rises by half a metre in a second
            ground.move_vertices(np.vstack([self.corners[:3], [[0, 0.5 + (i + 1) / 120, 0]]]))
            world.step(1 / 60)
        np.testing.assert_allclose(ground.probe([[0, 2, 0]])[0], [1], atol=1e-6)
        np.testing.assert_allclose(ground.vertices, np.vstack([self.corners[:3], [[0, 1, 0]]]), atol=1e-6)
        self.assertEqual(sorted(sorted(t) for t in ground.triangles), sorted(sorted(t) for t in self.faces))
        self.assertEqual((len(world.colliders.plane().vertices), len(world.colliders.plane().triangles)), (0, 0))
        self.assertGreater(world.positions[0, 1], 0.99)
        self.assertRaisesRegex(skein.ValueFault, "2 places for 4 vertices", ground.move_vertices, self.corners[:2])
        self.assertRaisesRegex(skein.ValueFault, "no vertices", world.colliders.plane().move_vertices, self.corners)
        self.assertRaisesRegex(skein.ValueFault, "a mesh has both", world.colliders.mesh, vertices=self.corners)
        self.assertRaisesRegex(skein.MeshFault, "without a mesh", world.colliders.plane, vertices=self.corners, faces=self.faces)
        field = world.colliders.field(vertices=self.corners, faces=self.faces)
        np.testing.assert_allclose(field.probe([[0, 1.5, 0]])[0], [1], atol=0.05)

    def test_what_is_fastened_to_a_body_goes_with_it(self):
        world = skein.World(threads=1)
        sheet = world.bodies.cloth(name="sheet", grid=(5, 5), pins="all")
        patch = world.bodies.cloth(name="patch", grid=(3, 3), size=(0.2, 0.2), position=(0, 0.1, 0))
        corners = patch.select("corners")
        self.assertEqual(sorted(corners - patch.particles.start), [0, 2, 6, 8])
        rows = sheet.nearest_triangles(corners)
        self.assertEqual(rows.shape, (4, 4))
        self.assertTrue(set(rows[:, 1:].ravel()) <= set(sheet.particles))
        world.constraints.attachment(particles=rows, stiffness=2000)
        world.forces.gravity(on=patch)
        world.step(1 / 60, count=60)
        self.assertLess(np.abs(patch.positions[:, 1] - 0.1).max(), 0.02)
        self.assertRaisesRegex(skein.NameFault, "top edge", sheet.select, "tip edge")
        self.assertRaisesRegex(skein.ValueFault, "'sheet' itself", sheet.nearest_triangles, [0])

    def test_objects_and_lists_of_names(self):
        world = skein.World(threads=1)
        a, b = (world.bodies.cloth(name=name, grid=(3, 3)) for name in "ab")
        nobody = world.bodies.rope()
        self.assertEqual(world.forces.drag(on=[a, b], rate=1).on, "a, b")
        self.assertEqual(world.forces.drag(on=["a", "b"], rate=1).on, "a, b")
        self.assertEqual(world.forces.drag(on=b, rate=1).on, "b")
        world.step()  # such bodies are there
        self.assertRaisesRegex(skein.ValueFault, "this rope has no name", world.forces.drag, on=nobody)

    def test_a_field_is_asked(self):
        world = skein.World(threads=1)
        swirl = world.forces.force_field(force=lambda p: (p.z, 0, -p.x))
        np.testing.assert_allclose(swirl.probe([[1, 2, 3], [0, 0, 1]]), [[3, 0, -1], [1, 0, 0]], atol=1e-6)
        self.assertRaisesRegex(skein.ValueFault, "no field", world.forces.gravity().probe, [[0, 0, 0]])


class Recordings(unittest.TestCase):
    def build(self, threads=1):
        world = skein.World(threads=threads)
        world.bodies.cloth(grid=(9, 9), pins="top corners")
        world.forces.gravity()
        return world

    def test_a_run_is_done_again_and_compared(self):
        world = self.build()
        with world.record("nine by nine") as recording:
            world.step(count=10)
            world.forces[0].acceleration = (0, -5, 0)
            world.step(count=20)
        twin = self.build(threads=2)
        found = twin.replay(recording.data)
        self.assertEqual((found.steps, found.found, found.is_whole, found.stopped), (30, False, True, ""))
        self.assertEqual(twin.hash(), world.hash())
        other = self.build()
        other.bodies[0].bend.rigidity = 1  # a snapshot takes it back: only what was not recorded differs
        self.assertFalse(other.replay(recording.data).found)
        damaged = bytearray(recording.data)
        damaged[len(damaged) // 2] ^= 4
        self.assertRaisesRegex(skein.SyntaxFault, "damaged", self.build().replay, damaged)
        self.assertRaisesRegex(skein.ValueFault, "built in the same way", skein.World().replay, recording.data)

    def test_what_ends_one(self):
        world = self.build()
        with world.record() as recording:
            self.assertRaisesRegex(skein.ValueFault, "being recorded", world.record().__enter__)
            world.step()
            world.bodies.rope()
        self.assertIn("added", self.build().replay(recording.data).stopped)
        with world.record() as recording:
            world.step()
            world.close()
        self.assertGreater(len(recording.data), 1000)

    def test_a_profile_is_a_step(self):
        world, twin = self.build(), self.build()
        passes = world.profile(1 / 60)
        twin.step(1 / 60)
        self.assertEqual(world.hash(), twin.hash())
        self.assertIn("project", {one.kind for one in passes})
        self.assertTrue(all(one.seconds >= 0 for one in passes))


class Words(unittest.TestCase):
    def test_what_is_no_number_is_named(self):
        world = skein.World(threads=1)
        sheet = world.bodies.cloth(grid=(3, 3), pins="corners")
        for words, call in [("dt='x'", lambda: world.step("x")), ("count=2.5", lambda: world.step(count=2.5)),
                            ("expected 0 to 8, not 1.5", lambda: world.pin(1.5)), ("from 0 on", lambda: world.move_pins([-3], [0, 0, 0])),
                            ("1 x 3 numbers", lambda: world.move_pins([0], [0, 0])), ("from 0 on", lambda: sheet.cut_faces([-1])),
                            ("expected 9 x 3 numbers, not 4 x 3", lambda: setattr(world, "positions", np.zeros((4, 3)))),
                            ("blade: expected 3 x 3", lambda: sheet.cut([[0, 0, 0], [1, 1, 1]])),
                            ("shift: expected 3", lambda: sheet.teleport((0, 1))),
                            ("not 'roof'", lambda: world.ray_cast((0, 0, 0), (0, 0, 1), of="roof")),
                            ("origin: expected 3", lambda: world.ray_cast((0, 0), (0, 0, 1)))]:
            with self.subTest(words):
                self.assertRaisesRegex(skein.ValueFault, re.escape(words), call)
        self.assertRaisesRegex(TypeError, "not list", skein.World.from_scene, [1])
        self.assertRaisesRegex(TypeError, "no object", skein.World.from_scene, {"bodies": [object()]})
        made = skein.World.from_scene({"bodies": [{"type": "cloth", "grid": np.array([4, 4]), "density": np.float32(0.25)}]},
                                      {"bodies.0.position": np.array([0, 1, 0])})
        self.assertEqual((len(made), made.bodies[0].density, made.bodies[0].position), (16, 0.25, (0, 1, 0)))

    def test_advice(self):
        world = skein.World.from_scene(f"{ROOT}/scenes/hanging.json")
        self.assertEqual(world.advice(), [])
        world.set_method("symplectic_euler", substeps=10)
        (line,) = world.advice()
        needed = world.substeps_needed()
        self.assertIn(f"{needed:.0f}", line)
        world.method.substeps = int(needed)
        self.assertEqual(world.advice(), [])
        spring = skein.World()  # 2/omega, omega^2 = k (1/m + 1/m)
        spring.set_method("symplectic_euler", substeps=1)
        spring.constraints.distance(particles=[spring.add_particles([[0, 0, 0], [1, 0, 0]])], stiffness=5e5)
        least = 0.1 / (2 / 1e3)
        self.assertTrue(least <= spring.substeps_needed(0.1) <= 1.25 * least)  # there is some room in it

    def test_warnings_are_heard(self):
        with tempfile.TemporaryDirectory() as folder:
            with open(f"{folder}/odd.obj", "w", encoding="utf-8") as file:
                file.write("v 0 0 0\nv 1 0 0\nv 0 0 1\nodd 1\nf 1 2 3\n")
            scene, heard = {"bodies": [{"type": "cloth", "mesh": f"{folder}/odd.obj"}]}, []
            skein.World.from_scene(scene, log=heard.append)
            self.assertRegex(heard[0], r"odd\.obj:4: .*passed over")
            with self.assertLogs("skein", "WARNING") as logged:
                skein.World.from_scene(scene)
            self.assertIn(heard[0], logged.output[0])


class Threads(unittest.TestCase):
    def test_others_run_while_a_step_does(self):
        """The interpreter's lock is free during steps: a counter goes on."""
        world = skein.World.from_scene(f"{ROOT}/scenes/hanging.json", threads=1)
        counted, stop = [0], threading.Event()

        def count():
            while not stop.is_set():
                counted[0] += 1

        thread = threading.Thread(target=count)
        thread.start()
        try:
            before = counted[0]
            world.step(count=200)  # one call
            during = counted[0] - before
        finally:
            stop.set()
            thread.join()
        self.assertGreater(during, 100)

    def test_one_world_is_for_one_thread_at_a_time(self):
        world = skein.World.from_scene(f"{ROOT}/scenes/hanging.json")
        threads = [threading.Thread(target=lambda: [world.step() or world.positions for _ in range(20)]) for _ in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        alone = skein.World.from_scene(f"{ROOT}/scenes/hanging.json")
        alone.step(count=80)
        self.assertEqual(world.hash(), alone.hash())

    def test_after_fork(self):
        world = skein.World.from_scene(f"{ROOT}/scenes/hanging.json")
        world.step(count=3)
        child = multiprocessing.get_context("fork").Process(target=_in_child, args=(world,))
        child.start()
        child.join(120)
        self.assertEqual(child.exitcode, 0)


def _in_child(world):
    try:
        world.step()
        os._exit(1)
    except RuntimeError:
        del world
        gc.collect()
        made = skein.World.from_scene(f"{ROOT}/scenes/hanging.json")
        made.step()
        os._exit(0)


if __name__ == "__main__":
    unittest.main()
