"""Many worlds at once, and worlds as environments of reinforcement learning.

Worlds are stepped on threads, each thread in one call of C for many of them, with the interpreter's lock free. An
Environment has reset() and step() as gymnasium has them, without needing it; Environments has many.
"""
import concurrent.futures
import contextlib
import ctypes
import operator
import os

import numpy as np

from ._errors import fault, of
from ._library import ERROR_VALUE, lib, world as world_pointer
from ._world import World, refuse_step


class Worlds:
    """Some worlds that are stepped together: Worlds(64, build), where build(i) makes the i-th (with threads=1), or is a
    scene that all of them begin as. Worlds(list) takes those that there are.

    threads: how many step at once; None, one a processor."""

    def __init__(self, count, build=None, *, threads=None):
        if not callable(build):
            scene = build

            def build(_):
                return World.from_scene(scene, threads=1)

        self._worlds = [build(i) for i in range(count)] if isinstance(count, int) else list(count)
        self._threads = max(1, min(threads or os.cpu_count() or 1, len(self._worlds)))
        self._pool = concurrent.futures.ThreadPoolExecutor(self._threads) if self._threads > 1 else None

    def __len__(self):
        return len(self._worlds)

    def __getitem__(self, index):
        return self._worlds[index]

    def __iter__(self):
        return iter(self._worlds)

    def _step_some(self, first, worlds, dt, count):
        with contextlib.ExitStack() as locks:
            for world in worlds:
                locks.enter_context(world._lock)
            pointers = (world_pointer * len(worlds))(*(world._pointer for world in worlds))
            done = lib.py_steps_of_all(pointers, len(worlds), dt, count)
            for world in worlds[:done]:
                world._settled = True
            if done < len(worlds):
                raise of(lib.skein_world_error(pointers[done]).contents, f"worlds.{first + done}")

    def step(self, dt=None, count=1):
        """Each goes on by `count` steps of dt seconds (the first one's World.dt). The first fault is raised, once all
        that could be done is done."""
        if not self._worlds:
            return
        dt = self._worlds[0].dt if dt is None else dt
        for world in self._worlds:
            world._owner.check_process()  # the pool's threads are not in a child, and would be waited for
        try:
            dt, count = float(dt), operator.index(count)
        except (TypeError, ValueError):
            raise refuse_step(dt, count) from None
        if count < 0:
            raise fault(ERROR_VALUE, "step", f"expected a count of steps, not {count}")
        if not self._pool:
            self._step_some(0, self._worlds, dt, count)
            return
        share = max(1, len(self._worlds) // (4 * self._threads))  # several a thread: some worlds take longer
        tasks = [self._pool.submit(self._step_some, i, self._worlds[i:i + share], dt, count)
                 for i in range(0, len(self._worlds), share)]
        concurrent.futures.wait(tasks)
        for task in tasks:
            task.result()

    def frame(self, count=1):
        """Each goes on by `count` frames of the first one's scene."""
        self.step(count=count * self._worlds[0].steps_per_frame if self._worlds else 0)

    def reset(self):
        for world in self._worlds:
            world.reset()

    def positions(self):
        """All positions, worlds x particles x 3; all have as many particles."""
        return np.stack([world.positions for world in self._worlds])

    def velocities(self):
        return np.stack([world.velocities for world in self._worlds])

    def hashes(self):
        return [world.hash() for world in self._worlds]

    def close(self):
        if self._pool:
            self._pool.shutdown()
            self._pool = None
        for world in self._worlds:
            world.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def __repr__(self):
        return f"<{len(self)} worlds on {self._threads} threads>"


class Environment:
    """A world as reinforcement learning expects one. A subclass says what it is:

        class Balance(skein.Environment):
            limit = 500                                # actions, then an episode is truncated; None: never
            def build(self): ...                       # the world, made once, with threads=1
            def start(self, world, rng): ...           # after a reset: what is random
            def act(self, world, action): ...          # before the steps
            def observe(self, world): ...              # an array
            def reward(self, world, action): ...
            def terminated(self, world): ...

    reset(seed) gives (observation, info), step(action) (observation, reward, terminated, truncated, info)."""

    limit = None
    steps = 1  # of World.dt for each action

    def __init__(self):
        self.world, self.rng, self.actions = self.build(), np.random.default_rng(), 0

    def build(self):
        raise NotImplementedError("build() makes the world")

    def start(self, world, rng):
        """What is random at the start; nothing is."""

    def act(self, world, action):
        raise NotImplementedError("act() does the action")

    def observe(self, world):
        return world.positions

    def reward(self, world, action):
        return 0.0

    def terminated(self, world):
        return False

    def reset(self, *, seed=None, options=None):
        if seed is not None:
            self.rng = np.random.default_rng(seed)
        self.world.reset()
        self.actions = 0
        self.start(self.world, self.rng)
        return self.observe(self.world), {}

    def step(self, action):
        self.act(self.world, action)
        self.world.step(count=self.steps)
        return self._outcome(action)

    def _outcome(self, action):
        self.actions += 1
        truncated = self.limit is not None and self.actions >= self.limit
        return (self.observe(self.world), float(self.reward(self.world, action)), bool(self.terminated(self.world)),
                truncated, {})

    def render(self, **options):
        return self.world.render(**options)

    def close(self):
        self.world.close()


class Environments:
    """Many environments that are stepped together: Environments(Balance, 64). Arrays have a row for each.

    One that ended is reset in the same step: its row of the observations is the new start, and infos["final_observation"]
    has the last one (None in all other rows)."""

    def __init__(self, make, count, *, threads=None):
        self.members = [make() for _ in range(count)]
        self.worlds = Worlds([member.world for member in self.members], threads=threads)

    def __len__(self):
        return len(self.members)

    def reset(self, *, seed=None, options=None):
        seeds = [None if seed is None else seed + i for i in range(len(self))]
        return np.stack([member.reset(seed=s)[0] for member, s in zip(self.members, seeds)]), {}

    def step(self, actions):
        if len(actions) != len(self):
            raise fault(ERROR_VALUE, "step", f"expected an action for each of {len(self)} environments, not {len(actions)}")
        for member, action in zip(self.members, actions):
            member.act(member.world, action)
        self.worlds.step(count=self.members[0].steps)
        rows = [member._outcome(action) for member, action in zip(self.members, actions)]
        observations, last = [row[0] for row in rows], [None] * len(rows)
        for i, (observation, _, terminated, truncated, _) in enumerate(rows):
            if terminated or truncated:
                last[i] = observation
                observations[i] = self.members[i].reset()[0]
        rewards, terminations, truncations = (np.array([row[k] for row in rows]) for k in (1, 2, 3))
        return np.stack(observations), rewards, terminations, truncations, {"final_observation": last}

    def close(self):
        self.worlds.close()
