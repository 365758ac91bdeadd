"""World: particles under rules, and a method that turns rules into motion.

What it owns: the C world (an Owner, which views hold, too), the document of its scene if it has one, and the lock that
lets one thread in at a time. Units are SI, y is up.
"""
import ctypes
import json
import logging
import os
import struct
import threading
import types

import numpy as np

from . import _library as L, _objects
from ._adding import indices, numbers_of
from ._errors import fault, of
from ._fields import settings
from ._library import lib
from ._views import Views

DEFAULT_STEP = 1 / 90  # s, SKEIN_DEFAULT_STEP
_AT_ONCE = 16  # steps in one call of C
_log = logging.getLogger("skein")
_after_fork = [0]  # how many forks this process is away from the first one
os.register_at_fork(after_in_child=lambda: _after_fork.__setitem__(0, _after_fork[0] + 1))


class Owner:
    """The C world, destroyed when nobody holds it."""

    __slots__ = ("pointer", "scene", "log", "forks", "recorder", "__weakref__")

    def __init__(self, pointer, scene, log):
        self.pointer, self.scene, self.log, self.forks = pointer, scene, log, _after_fork[0]
        self.recorder = None  # what C calls while it records, which must live as long

    def check_process(self):
        """Fails in a child of fork() that this world was made before."""
        if self.forks != _after_fork[0]:
            raise RuntimeError("this world was made before fork(): its threads are not in this process. Make worlds after "
                               "the fork")

    def destroy(self):
        pointer, self.pointer = self.pointer, None
        scene, self.scene = self.scene, None
        if pointer and self.forks == _after_fork[0]:  # a child of fork() has not the threads that this would wait for
            lib.skein_world_destroy(pointer)
        if scene:
            lib.py_scene_free(scene)

    def __del__(self):
        self.destroy()


def described(threads, log):
    """A world's description, and the callback that must live as long as the world."""

    def hear(_, level, message):
        words = message.decode(errors="replace")
        if log:
            log(words)
        else:
            _log.log(logging.WARNING if level else logging.INFO, "%s", words)

    desc = lib.skein_default_world_desc()
    callback = desc.log = L.LOG(hear)
    desc.thread_count = threads
    return desc, callback


def refuse_step(dt, count):
    """What is wrong with a step of `dt` seconds, or so many of them, that are no such numbers."""
    return fault(L.ERROR_VALUE, "step", f"expected seconds and a count of steps, not dt={dt!r}, count={count!r}")


class State(bytes):
    """A world's state as bytes, in memory or in a file: World.restore() goes on from it with the same bits.

    `enabled` says which bodies took part; bytes that come from a file have no such note."""

    enabled = None

    def __new__(cls, data, enabled=None):
        made = super().__new__(cls, data)
        made.enabled = enabled
        return made

    def __repr__(self):
        return f"<State of {len(self)} bytes>"


class World:
    """A world, empty and under XPBD, or of a scene: World.from_scene().

    threads: the most threads of its own; 0, as many as there are processors. log: hears warnings, a line each, instead of
    logging.getLogger("skein")."""

    def __init__(self, threads=0, *, dt=DEFAULT_STEP, log=None):
        error = L.Error()
        desc, callback = described(threads, log)
        pointer = L.world_create(ctypes.byref(desc), ctypes.byref(error))
        if not pointer:
            raise of(error)
        self._begin(Owner(pointer, None, callback), dt)

    def _begin(self, owner, dt):
        self._owner, self._lock, self._views, self._noted = owner, threading.RLock(), Views(), {}
        self._settled, self._as_opened = False, True
        self.dt = dt  # s, of a step
        self.steps_per_frame = 1
        self.fps = 1 / dt
        self.name = self.description = ""
        self.frames = 0

    @classmethod
    def from_scene(cls, scene, sets=(), *, threads=0, log=None):
        """Opens a scene: a dict, JSON text, a file's path, a mesh's, or the name of one that comes along
        (skein.scenes()). `sets` are changes before it is built, as --set has them: {"method.substeps": 20}."""
        from ._scene import open_scene
        world = cls.__new__(cls)
        owner, facts = open_scene(scene, sets, threads, log)
        world._begin(owner, facts["dt"])
        world.steps_per_frame, world.fps, world.frames = facts["steps_per_frame"], facts["fps"], facts["frames"]
        world.name, world.description = facts["name"], facts["description"]
        return world

    # ---- the world's life ----

    @property
    def closed(self):
        return self._owner.pointer is None

    @property
    def _pointer(self):
        pointer = self._owner.pointer
        if pointer is None:
            raise ValueError("the world is closed")
        return pointer

    def close(self):
        """Gives the memory back. BufferError while views of the state are held."""
        with self._lock:
            self._views.refuse("closing the world")
            self._owner.destroy()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _call(self, function, *arguments, place=""):
        with self._lock:
            pointer = self._pointer
            if function(pointer, *arguments):
                raise of(lib.skein_world_error(pointer).contents, place)

    def _resize(self):
        """Before the state's memory may move."""
        self._views.refuse("adding, removing or disabling a body or particles")
        self._settled = False

    def _change(self, thing, full):
        """Before a field is set."""
        if full == "enabled" and thing._category == L.BODY:
            self._resize()

    # ---- objects ----

    bodies = property(lambda self: _objects.ObjectList(self, L.BODY), doc="its bodies: world.bodies.cloth(...), world.bodies[0]")
    constraints = property(lambda self: _objects.ObjectList(self, L.CONSTRAINT), doc="constraints added by themselves")
    forces = property(lambda self: _objects.ObjectList(self, L.FORCE), doc="its forces: world.forces.gravity()")
    colliders = property(lambda self: _objects.ObjectList(self, L.COLLIDER), doc="its colliders: world.colliders.sphere(radius=0.3)")
    motions = property(lambda self: _objects.ObjectList(self, L.MOTION), doc="what leads pins")

    @property
    def method(self):
        """The method, with its fields: world.method.substeps = 20; or another: world.method = "rk4"."""
        return self._object(L.METHOD, lib.skein_object_at(self._pointer, L.METHOD, 0))

    @method.setter
    def method(self, kind):
        self.set_method(kind)

    def set_method(self, kind, **fields):
        """Another method; what the former one was set to is gone."""
        place = "method"
        found = _objects.CLASSES.get((L.METHOD, kind))
        if not found:
            raise _objects.ObjectList(self, L.METHOD)._no_kind(kind)
        self._call(lib.skein_method_set, kind.encode(), settings(found._table, fields, place), place=place)
        self._noted = {key: thing for key, thing in self._noted.items() if thing[0] != L.METHOD}
        self._noted["method"] = L.METHOD, None, None
        return self.method

    @staticmethod
    def methods():
        """The names of all methods."""
        return [name for category, name in _objects.CLASSES if category == L.METHOD]

    def _object(self, category, handle):
        kind = lib.skein_object_kind(self._pointer, handle)
        if not kind:
            raise fault(L.ERROR_HANDLE, L.LISTS[category], "there is no such object any more")
        return _objects.CLASSES[category, kind.contents.name.decode()](self, handle)

    def _add(self, category, kind, fields):
        from . import _adding
        place = f"{L.LISTS[category]}: {kind}"
        self._as_opened = False
        handle = _adding.add(self, category, kind, _objects.CLASSES[category, kind]._table, fields, place)
        return self._object(category, handle)

    def _at_path(self, path):
        first, *rest = path.split(".")
        if first == "method":
            return self.method, ".".join(rest)
        if first not in L.LISTS or len(rest) < 2:
            raise fault(L.ERROR_NAME, path, f"expected one of {', '.join(L.LISTS)} at its beginning, then a number or a "
                                            "name, then a field")
        key = int(rest[0]) if rest[0].isdigit() else rest[0]
        return getattr(self, first)[key], ".".join(rest[1:])

    def get(self, path):
        """A field by its path: world.get("colliders.ball.radius")."""
        thing, full = self._at_path(path)
        return thing[full]

    def set(self, path, value):
        """Sets a field by its path, as --set has it."""
        thing, full = self._at_path(path)
        thing[full] = value

    # ---- stepping ----

    def step(self, dt=None, count=1):
        """Goes on by `count` steps of dt seconds (World.dt if it is left out). Other threads of Python run meanwhile."""
        owner = self._owner
        if owner.forks != _after_fork[0]:
            owner.check_process()
        with self._lock:
            pointer = owner.pointer
            if pointer is None:
                raise ValueError("the world is closed")
            dt = self.dt if dt is None else dt
            try:
                if count < 0:
                    raise fault(L.ERROR_VALUE, "step", f"expected a count of steps, not {count}")
                while count > _AT_ONCE:  # Ctrl-C is heard in between
                    if lib.py_steps(pointer, dt, _AT_ONCE):
                        raise of(lib.skein_world_error(pointer).contents)
                    count -= _AT_ONCE
                if lib.py_steps(pointer, dt, count):
                    raise of(lib.skein_world_error(pointer).contents)
            except (ctypes.ArgumentError, TypeError):
                raise refuse_step(dt, count) from None
            self._settled = True

    def frame(self, count=1):
        """Goes on by `count` frames of its scene."""
        self.step(count=count * self.steps_per_frame)

    def gradient(self, steps, measure, fields=(), *, dt=None, most_bytes=0):
        """The derivatives of a number that a run of so many steps from here would have, by where particles begin, how fast,
        and by fields (paths: "bodies.0.stretch.stiffness"); the world stays as it is. At the cost of some four runs.

        measure(step, positions, velocities) is asked for each state, from the last (step == steps) to the first (0), and
        returns None, or what that state adds to the number and its derivatives: value, by_positions[, by_velocities],
        n x 3. It must not step or change this world. Needs double precision: SKEIN_PRECISION=double before skein is
        imported; docs/gradients.md has what can be differentiated. most_bytes: for states on the way; 0, 256 MB."""
        from ._gradient import gradient
        return gradient(self, steps, measure, fields, self.dt if dt is None else dt, most_bytes)

    def reset(self):
        """Positions as they were built; velocities, time and counters zero. Fields stay as they are now."""
        self._call(lib.skein_world_reset)

    @property
    def time(self):
        """Simulated time, s. Setting it sets the clock alone."""
        return lib.skein_world_time(self._pointer)

    @time.setter
    def time(self, seconds):
        self._call(lib.skein_world_time_set, seconds)

    def snapshot(self):
        """All that steps and calls have changed since the world was built, as bytes (a State)."""
        with self._lock:
            size, written = lib.skein_snapshot_size(self._pointer), ctypes.c_size_t()
            out = ctypes.create_string_buffer(size)
            self._call(lib.skein_snapshot_write, out, size, ctypes.byref(written))
            return State(out.raw[:written.value], self._enabled())

    def restore(self, state):
        """Goes back to a snapshot of this world, or of one that was built by the same calls: positions, velocities, time,
        pins and live fields. Fails, changing nothing, for what does not fit."""
        with self._lock:
            if getattr(state, "enabled", None) != self._enabled():
                self._resize()
            self._call(lib.skein_snapshot_read, bytes(state), len(state))

    def _enabled(self):
        return tuple(body.enabled for body in self.bodies)

    # ---- the state ----

    def __len__(self):
        """How many particles there are."""
        return lib.skein_particle_count(self._pointer)

    def __bool__(self):
        return True

    def __reduce_ex__(self, _):
        raise TypeError("a world is not copied or pickled: take snapshot(), and restore() in one that was built alike")

    def _copy(self, function, particles):
        out = np.empty((len(particles), 3), L.real)
        self._call(function, particles.start, len(particles), L.Buffer(out.ctypes.data, 0, int(L.real.itemsize == 8)))
        return out

    def _write(self, function, xyz, particles):
        xyz = numbers_of(xyz, (len(particles), 3), "", spread=True)
        self._call(function, particles.start, len(particles), xyz.ctypes.data)

    @property
    def positions(self):
        """A copy in the order of particles, n x 3, m; what is assigned is written. position_view copies nothing."""
        return self._copy(lib.skein_positions_copy_to, range(len(self)))

    @positions.setter
    def positions(self, xyz):
        self._write(lib.skein_positions_set, xyz, range(len(self)))

    @property
    def velocities(self):
        """A copy in the order of particles, n x 3, m/s; what is assigned is written."""
        return self._copy(lib.skein_velocities_copy_to, range(len(self)))

    @velocities.setter
    def velocities(self, xyz):
        self._write(lib.skein_velocities_set, xyz, range(len(self)))

    def _view(self, function):
        with self._lock:
            if not self._settled:  # particles get their slots now, and not in a step that would move them under a view
                self._call(lib.skein_world_explain, self.dt, L.WRITE(), None)
                self._settled = True
            view = function(self._pointer)
            slot_of = self._views.give(self._owner, view.slot_of, (view.count,), np.uint32)
            return view, slot_of

    def _slots(self, function):
        view, slot_of = self._view(function)
        slots = int(slot_of.max()) + 1 if view.count else 0
        return self._views.give(self._owner, view.xyzw, (slots, 4), L.real)

    @property
    def position_view(self):
        """The state itself, no copy: x, y, z (m) and the inverse mass (1/kg) of each slot. Read-only. It shows every
        step's result; particle i is in row slot_of[i]: position_view[slot_of] is a copy in the order of particles."""
        return self._slots(L.position_view)

    @property
    def velocity_view(self):
        """The same of velocities: x, y, z (m/s) and the mass (kg) of each slot."""
        return self._slots(L.velocity_view)

    @property
    def slot_of(self):
        """The row of each particle in position_view and velocity_view, no copy. Steps of large flocks change it."""
        return self._view(L.position_view)[1]

    def add_particles(self, positions, velocities=None, masses=1.0):
        """Adds loose particles; masses in kg, 0 holds one where it is. Returns their indices as a range."""
        self._resize()
        self._as_opened = False
        positions = np.ascontiguousarray(np.asarray(positions, np.float64).reshape(-1, 3))
        count, first = len(positions), ctypes.c_uint32()
        if velocities is not None:
            velocities = np.ascontiguousarray(np.broadcast_to(np.asarray(velocities, np.float64), (count, 3)))
        masses = np.ascontiguousarray(np.broadcast_to(np.asarray(masses, np.float64), (count,)))
        self._call(lib.skein_particles_add, count, positions.ctypes.data, L.pointer_to(velocities), masses.ctypes.data,
                   ctypes.byref(first))
        return range(first.value, first.value + count)

    def pin(self, particle, pinned=True):
        """Pins a particle where it is, or lets it go."""
        self._call(lib.skein_particle_pin, self._index(particle), bool(pinned))

    def _index(self, particle):
        if not hasattr(particle, "__index__") or not 0 <= particle < len(self):
            raise fault(L.ERROR_VALUE, "particle", f"expected 0 to {len(self) - 1}, not {particle!r}")
        return particle.__index__()

    def move_pins(self, particles, places):
        """Says where pinned particles are at the end of the next step: they go there in straight lines."""
        particles = indices(np.atleast_1d(particles), "move_pins", "particles")
        places = numbers_of(places, (len(particles), 3), "move_pins: places", spread=True)
        self._call(lib.skein_pins_move, particles.ctypes.data, len(particles), places.ctypes.data)

    # ---- measures ----

    def hash(self):
        """The state's fingerprint, 16 hexadecimal digits: what `skein run` prints of the same scene."""
        with self._lock:
            return f"{lib.skein_world_hash(self._pointer):016x}"

    def statistics(self):
        """Measures the present state: energies, stretch, contacts ...; costs about a step."""
        data, values = ctypes.create_string_buffer(L.statistics_size), {}
        self._call(lib.skein_world_statistics, data)
        for name, offset, count, sort in L.statistics_members:
            numbers = struct.unpack_from(f"={count}{sort}", data, offset)
            values[name] = numbers[0] if count == 1 else np.array(numbers)
        values["state_hash"] = f"{values['state_hash']:016x}"
        return types.SimpleNamespace(**values)

    def order(self, body=None, centre=(0, 0, 0), group_distance=0.0):
        """How particles fly together (polarization, milling, nearest ...): of a body, or of all."""
        particles = body.particles if body is not None else range(len(self))
        found, centre = L.Order(), np.array(centre, np.float64)
        self._call(lib.skein_order_measure, particles.start, len(particles), centre.ctypes.data, group_distance,
                   ctypes.byref(found))
        return types.SimpleNamespace(**{name: getattr(found, name) for name, _ in L.Order._fields_})

    def contacts(self):
        """The particles within a collider's thickness: a list with particle, collider, normal and gap (m)."""
        count = ctypes.c_size_t()
        with self._lock:
            self._call(lib.skein_contacts_copy, None, 0, ctypes.byref(count))
            array = (L.Contact * max(count.value, 1))()
            self._call(lib.skein_contacts_copy, array, count.value, ctypes.byref(count))
        return [types.SimpleNamespace(particle=x.particle, collider=self._object(L.COLLIDER, L.Handle(*x.collider.key())),
                                      normal=np.array(x.normal), gap=x.gap) for x in array[:count.value]]

    def surface_contacts(self):
        """The pairs of features of surfaces that touch: a list with rule, edges (or a vertex and a triangle), particles, weights,
        normal, gap and thickness (m)."""
        count = ctypes.c_size_t()
        with self._lock:
            self._call(lib.skein_surface_contacts_copy, None, 0, ctypes.byref(count))
            array = (L.SurfaceContact * max(count.value, 1))()
            self._call(lib.skein_surface_contacts_copy, array, count.value, ctypes.byref(count))
        return [types.SimpleNamespace(rule=self._object(L.FORCE, L.Handle(*x.rule.key())), edges=bool(x.edges),
                                      particles=np.array(x.particle, np.uint32), weights=np.array(x.weight),
                                      normal=np.array(x.normal), gap=x.gap, thickness=x.thickness)
                for x in array[:count.value]]

    def ray_cast(self, origin, direction, of="body"):
        """What a ray meets first among "body" or "collider": object, t (m), point, normal; None where it meets nothing."""
        if of not in ("body", "collider"):
            raise fault(L.ERROR_VALUE, "ray_cast", f"expected of=\"body\" or \"collider\", not {of!r}")
        hit, category = L.Hit(), L.CATEGORIES.index(of)
        origin, direction = numbers_of(origin, (3,), "ray_cast: origin"), numbers_of(direction, (3,), "ray_cast: direction")
        self._call(lib.skein_ray_cast, origin.ctypes.data, direction.ctypes.data, category, ctypes.byref(hit))
        if not np.isfinite(hit.t):
            return None
        return types.SimpleNamespace(t=hit.t, point=np.array(hit.point), normal=np.array(hit.normal), face=hit.face,
                                     particle=hit.particle, object=self._object(category, L.Handle(*hit.object.key())))

    def explain(self, dt=None):
        """The plan of a step, as lines."""
        lines = []
        self._call(lib.skein_world_explain, self.dt if dt is None else dt,
                   L.WRITE(lambda _, line: lines.append(line.decode())), None)
        self._settled = True
        return lines

    def advice(self, dt=None):
        """What steps of dt will suffer from, in the words of `skein check`: a list of lines, empty where all is well. Costs
        as much as some steps."""
        lines = []
        with self._lock:
            lib.py_advise(self._pointer, self.dt if dt is None else dt,
                          L.WRITE(lambda _, line: lines.append(line.decode(errors="replace"))), None)
        return lines

    def substeps_needed(self, dt=None):
        """How many substeps a step of dt takes to be stable under the method: inf where none is enough."""
        with self._lock:
            return lib.py_advise(self._pointer, self.dt if dt is None else dt, L.WRITE(lambda *_: None), None)

    def profile(self, dt=None):
        """Takes a step, with the same bits, op after op, and measures each: a list with kind, label and seconds."""
        self._owner.check_process()
        dt, most, count = self.dt if dt is None else dt, 4096, ctypes.c_size_t()
        passes = (L.Pass * most)()
        self._call(lib.skein_world_profile, dt, passes, most, ctypes.byref(count))
        self._settled = True
        return [types.SimpleNamespace(kind=one.kind.decode(), label=one.label.decode(), seconds=one.seconds)
                for one in passes[:min(count.value, most)]]

    # ---- recordings ----

    def record(self, note=""):
        """Records all that is done to the world and what comes of it, until the `with` block ends:

            with world.record() as recording:
                world.step(count=100)
            twin.replay(recording.data)          # a world that was built by the same calls

        Adding or removing objects or particles ends it, and replay() says so."""
        from ._recording import Recording
        return Recording(self, note)

    def replay(self, data):
        """Does again what was recorded, in a world that was built as that one was, and compares each step, bit for bit.
        Returns steps (that came out the same), found (whether one did not) and then particle, position, velocity, exact, blocks
        and body; is_whole and stopped are about the recording."""
        from ._recording import replay
        return replay(self, bytes(data))

    # ---- scenes and pictures ----

    def scene(self):
        """The scene that it was opened from, with all fields that were set since, as a dict: opened again, it gives the
        same world. None if the world was made by hand; fails where objects were added or removed since."""
        from ._scene import note
        if not self._owner.scene:
            self._pointer
            return None
        if not self._as_opened:
            raise fault(L.ERROR_VALUE, "scene", "objects were added or removed since it was opened: no scene says so")
        note(self._owner.scene, self._noted_sets())
        return json.loads(L.take_text(lib.py_scene_text(self._owner.scene)))

    def _noted_sets(self):
        """What was set since it was opened, as --set has it."""
        for category, key, full in self._noted.values():
            if full is None:
                method = self.method
                yield "method", {"type": method.kind, **method.fields()}
            else:
                path, thing = L.LISTS[category], self.method
                if category != L.METHOD:
                    things = getattr(self, path)[:]
                    at = [one._handle.key() for one in things].index(key)
                    path, thing = f"{path}.{at}", things[at]
                yield f"{path}.{full}", thing[full]

    def render(self, size=(640, 360), samples=4, view=None):
        """A picture as it stands: an array of height x width x 3 bytes (sRGB). `view` are fields of a scene's "view"."""
        from ._pictures import render
        return render(self, size, samples, view)

    def __repr__(self):
        if self.closed:
            return "<World, closed>"
        title = f" {self.name!r}" if self.name else ""
        return (f"<World{title}: {len(self)} particles, {len(self.bodies)} bodies, {len(self.forces)} forces, "
                f"{len(self.colliders)} colliders, {self.method.kind}, {self.time:g} s>")
