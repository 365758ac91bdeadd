"""Many worlds on threads, and environments: the same bits as one after the other."""
import os
import signal
import unittest

import numpy as np

import skein

ROOT = os.environ.get("SKEIN_SOURCE_DIR", ".")


def cloth(i):
    world = skein.World(threads=1)
    world.bodies.cloth(grid=(6, 7 + i % 3), pins="corners", density=0.1 + 0.01 * i)
    world.forces.gravity()
    return world


class Together(unittest.TestCase):
    def test_64_on_threads_are_64_alone(self):
        with skein.Worlds(64, cloth, threads=4) as worlds:
            worlds.step(1 / 60, 5)
            worlds.step(1 / 60)
            for i in (0, 1, 31, 62, 63):
                alone = cloth(i)
                alone.step(1 / 60, 6)
                self.assertEqual(worlds[i].hash(), alone.hash())
            self.assertEqual(len(set(worlds.hashes())), 64)
            self.assertEqual({world.statistics().steps for world in worlds}, {6})
            worlds.reset()
            worlds.step(1 / 60, 6)
            self.assertAlmostEqual(worlds[31].time, 6 / 60)
        self.assertTrue(all(world.closed for world in worlds))

    def test_scenes_and_stacks(self):
        worlds = skein.Worlds(3, f"{ROOT}/scenes/rope.json", threads=2)
        worlds[1].forces[0].enabled = False
        worlds.frame(3)
        positions = worlds.positions()
        self.assertEqual(positions.shape, (3, len(worlds[0]), 3))
        np.testing.assert_array_equal(positions[0], positions[2])
        self.assertFalse(np.array_equal(positions[0], positions[1]))
        self.assertEqual(worlds.velocities().shape, positions.shape)

    def test_a_fault_names_the_world(self):
        worlds = skein.Worlds(8, cloth, threads=2)
        worlds[5].forces.gravity(on="nobody")
        self.assertRaisesRegex(skein.NameFault, r"worlds\.5.*nobody", worlds.step)
        self.assertEqual(worlds[7].statistics().steps, 1)  # the others went on
        self.assertRaisesRegex(skein.ValueFault, r"worlds\.", worlds.step, -1)
        self.assertRaisesRegex(skein.ValueFault, "count of steps", worlds.step, count=-1)
        self.assertRaisesRegex(skein.ValueFault, "dt='x'", worlds.step, "x")
        self.assertRaisesRegex(skein.ValueFault, "count=2.5", worlds.step, count=2.5)

    def test_a_child_of_fork_is_told_and_does_not_wait_for_threads_that_it_has_not(self):
        worlds = skein.Worlds(4, cloth, threads=2)
        worlds.step(1 / 60)  # the threads are there
        child = os.fork()
        if not child:
            signal.alarm(20)
            try:
                worlds.step(1 / 60)
            except RuntimeError as error:
                os._exit(0 if "fork()" in str(error) else 1)
            os._exit(2)
        self.assertEqual(os.waitpid(child, 0)[1], 0)


class Push(skein.Environment):
    """A particle on a line: pushed by an action; it is over beyond 1 m."""

    limit = 30

    def build(self):
        world = skein.World(threads=1, dt=0.1)
        world.set_method("symplectic_euler", substeps=1)
        world.add_particles([[0, 0, 0]])
        self.wind = world.forces.wind(force=(0, 0, 0))
        return world

    def start(self, world, rng):
        world.positions = [[rng.uniform(-0.1, 0.1), 0, 0]]

    def act(self, world, action):
        self.wind.force = (float(action), 0, 0)

    def observe(self, world):
        return np.array([world.positions[0, 0], world.velocities[0, 0]])

    def reward(self, world, action):
        return -abs(world.positions[0, 0])

    def terminated(self, world):
        return abs(world.positions[0, 0]) > 1


class Learning(unittest.TestCase):
    def test_one(self):
        env = Push()
        first, info = env.reset(seed=7)
        again, _ = env.reset(seed=7)
        np.testing.assert_array_equal(first, again)
        self.assertEqual(info, {})
        other, _ = env.reset()
        self.assertNotEqual(first[0], other[0])
        env.reset(seed=7)
        observation, reward, terminated, truncated, _ = env.step(1.0)  # v = a dt, x = x0 + v dt
        np.testing.assert_allclose(observation, [first[0] + 0.01, 0.1], atol=1e-6)
        self.assertAlmostEqual(reward, -abs(observation[0]))
        self.assertEqual((terminated, truncated), (False, False))
        taken = 1
        while not terminated:
            observation, _, terminated, truncated, _ = env.step(1.0)
            taken += 1
        self.assertLess(taken, 20)
        self.assertGreater(observation[0], 1)
        env.reset(seed=1)
        for _ in range(30):
            _, _, terminated, truncated, _ = env.step(0)
        self.assertEqual((terminated, truncated), (False, True))
        env.close()
        self.assertTrue(env.world.closed)

    def test_many(self):
        envs, one = skein.Environments(Push, 5, threads=2), Push()
        observations, _ = envs.reset(seed=3)
        self.assertEqual(observations.shape, (5, 2))
        first, _ = one.reset(seed=5)
        np.testing.assert_array_equal(observations[2], first)
        actions = np.array([0, 0, 1.0, 0, -1.0])
        for _ in range(40):
            observations, rewards, over, cut, infos = envs.step(actions)
            self.assertEqual((observations.shape, rewards.shape, over.dtype), ((5, 2), (5,), np.bool_))
            if over[2]:
                break
            np.testing.assert_array_equal(observations[2], one.step(1.0)[0])
        self.assertTrue(over[2])
        self.assertGreater(infos["final_observation"][2][0], 1)  # and the row is a new start
        self.assertLess(abs(observations[2, 0]), 0.2)
        self.assertIsNone(infos["final_observation"][0])
        envs.close()


if __name__ == "__main__":
    unittest.main()
