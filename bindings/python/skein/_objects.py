"""Bodies, constraints, forces, colliders, motions and methods as objects of Python, and the lists that a world has of them.

An object is a world and a handle; what it is lies in the world. Its class has its kind's fields as attributes
(_fields.py). A handle that outlived its object is an error, never a crash.
"""
import ctypes

import numpy as np

from . import _fields, _library as L
from ._adding import indices, numbers_of
from ._errors import fault
from ._library import lib


class Object(_fields.Fields):
    """A thing of a world. Its fields are its attributes: dir() lists them, help() has their units."""

    __slots__ = ("_world", "_handle")
    _table = None
    _category = None

    def __init__(self, world, handle):
        object.__setattr__(self, "_world", world)
        object.__setattr__(self, "_handle", handle)

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        raise self._no_field(name)

    def _no_field(self, name):
        return _fields.no_field(self._table, name, self._place())

    def _place(self):
        return f"{L.LISTS[self._category]}: {self._table.name}"

    def _field(self, full):
        if full.startswith("parameters.") and self._table.has_parameters:
            return self._table.fields["parameters.*"]
        field = self._table.fields.get(full)
        if not field:
            raise self._no_field(full)
        return field

    def _get(self, full):
        value, field = L.Value(), self._field(full)
        self._world._call(lib.skein_get, self._handle, full.encode(), ctypes.byref(value), place=self._place())
        return field.read(value)

    def _set(self, full, given):
        self._world._change(self, full)
        value = self._field(full).write(given, f"{self._place()}: {full}")
        self._world._call(lib.skein_set, self._handle, full.encode(), value, place=self._place())
        key = self._handle.key()
        self._world._noted[key, full] = self._category, key, full

    def __getitem__(self, full):
        return self._get(full)

    def __setitem__(self, full, value):
        self._set(full, value)

    def set(self, **given):
        """Sets several fields; groups are dicts: `cloth.set(stretch={"stiffness": 2e4}, density=0.1)`."""
        for full, value in _fields.flatten(self._table, given, self._place()).items():
            self._set(full, value)

    def fields(self):
        """All fields by name, with their present values."""
        return {name: self._get(name) for name in self._names()}

    def _names(self):
        names = [name for name in self._table.fields if not name.endswith("*")]
        return names + ["parameters." + name for name in self._parameter_names()]

    def _parameter_names(self):
        kind = lib.skein_object_kind(self._world._pointer, self._handle)
        if not kind or not self._table.has_parameters:
            return []
        names = [kind.contents.fields[i].name.decode() for i in range(kind.contents.field_count)]
        return [name[len("parameters."):] for name in names if name.startswith("parameters.") and name[-1] != "*"]

    def is_live(self, full):
        """Whether a field can be set now: it shapes nothing that is already built."""
        return lib.skein_field_is_live(self._world._pointer, self._handle, full.encode())

    @property
    def kind(self):
        """The kind's name: "cloth"."""
        return self._table.name

    @property
    def valid(self):
        """Whether it is still there."""
        return not self._world.closed and lib.skein_handle_valid(self._world._pointer, self._handle)

    def remove(self):
        """Takes it out of its world, a body with all that it has."""
        if self._category == L.BODY:
            self._world._resize()
        self._world._as_opened = False
        self._world._call(lib.skein_remove, self._handle, place=self._place())

    def __eq__(self, other):
        return isinstance(other, Object) and self._handle.key() == other._handle.key()

    def __hash__(self):
        return hash(self._handle.key())

    def __repr__(self):
        if not self.valid:
            return f"<{type(self).__name__}, gone>"
        values = self.fields()
        changed = (f"{name}={value!r}" for name, value in values.items()
                   if name not in self._table.fields or value != self._table.fields[name].default)
        return f"<{type(self).__name__} {', '.join(changed)}>".replace(" >", ">")


class Body(Object):
    """A builder that laid down particles and rules."""

    __slots__ = ()
    _category = L.BODY

    @property
    def asleep(self):
        """Whether it has come to rest, and sleeps, as its field `sleep` says. Setting any field wakes it."""
        return bool(lib.skein_body_asleep(self._world._pointer, self._handle))

    def _surface(self):
        surface = L.Surface()
        self._world._call(lib.skein_body_surface, self._handle, ctypes.byref(surface), place=self._place())
        return surface

    @property
    def particles(self):
        """Its particles' indices in the world, as a range."""
        surface = self._surface()
        return range(surface.first_particle, surface.first_particle + surface.particle_count)

    @property
    def positions(self):
        """A copy of its particles' positions, n x 3, m; what is assigned is written."""
        return self._world._copy(lib.skein_positions_copy_to, self.particles)

    @positions.setter
    def positions(self, xyz):
        self._world._write(lib.skein_positions_set, xyz, self.particles)

    @property
    def velocities(self):
        """A copy of their velocities, n x 3, m/s; what is assigned is written."""
        return self._world._copy(lib.skein_velocities_copy_to, self.particles)

    @velocities.setter
    def velocities(self, xyz):
        self._world._write(lib.skein_velocities_set, xyz, self.particles)

    @property
    def vertices(self):
        """Where the surface's vertices are now (after welding several may be one particle), n x 3, m."""
        count = self._surface().vertex_count
        out = np.empty((count, 3), np.float32)
        to, none = L.Buffer(out.ctypes.data, 0, 0), L.Buffer(None, 0, 0)
        self._world._call(lib.skein_body_vertices_copy, self._handle, 1.0, to, none, place=self._place())
        return out

    @property
    def faces(self):
        """The surface's faces as they came: a list of arrays of vertices."""
        surface = self._surface()
        sizes = np.ctypeslib.as_array(surface.face_sizes, (surface.face_count,)) if surface.face_count else np.empty(0, int)
        if not len(sizes):
            return []
        corners = np.ctypeslib.as_array(surface.face_vertices, (surface.face_vertex_count,)).copy()
        return np.split(corners, np.cumsum(sizes)[:-1])

    def teleport(self, shift=(0, 0, 0), turn=None):
        """It is elsewhere at once: particles go from x to turn x + shift, velocities turn, and nothing is flung."""
        shift = numbers_of(shift, (3,), self._place() + ".shift")
        turn = None if turn is None else numbers_of(turn, (3, 3), self._place() + ".turn")
        self._world._call(lib.skein_body_teleport, self._handle, turn.ctypes.data if turn is not None else None,
                          shift.ctypes.data, place=self._place())

    def cut(self, blade):
        """Takes away the faces of a cloth that a blade meets, a triangle (3 x 3, m), with all that held across them; returns
        how many there were."""
        blade, count = numbers_of(blade, (3, 3), self._place() + ".blade"), ctypes.c_size_t()
        self._world._call(lib.skein_cut, self._handle, blade.ctypes.data, ctypes.byref(count), place=self._place())
        return count.value

    def cut_faces(self, faces):
        """The same by the numbers that faces have in `faces`."""
        faces = indices(faces, self._place(), "faces").ravel()
        self._world._call(lib.skein_cut_faces, self._handle, faces.ctypes.data, len(faces), place=self._place())

    def mend(self):
        """Puts back all faces that were cut."""
        self._world._call(lib.skein_cut_mend, self._handle, place=self._place())

    @property
    def cuts(self):
        """Of each of its faces, whether it is cut."""
        cuts, count = L.Cuts(), self._surface().face_count
        self._world._call(lib.skein_body_cuts, self._handle, ctypes.byref(cuts), place=self._place())
        return np.ctypeslib.as_array(cuts.face, (count,)).astype(bool) if cuts.face else np.zeros(count, bool)

    def select(self, text):
        """The particles that a text names, as pins are named ("top edge", "box x y z x y z", "sphere x y z radius"), by where
        they were built: an array of indices in the world."""
        count = ctypes.c_size_t()
        self._world._call(lib.skein_body_select, self._handle, str(text).encode(), None, 0, ctypes.byref(count),
                          place=self._place())
        out = np.empty(count.value, np.uint32)
        self._world._call(lib.skein_body_select, self._handle, str(text).encode(), out.ctypes.data, count.value,
                          ctypes.byref(count), place=self._place())
        return out

    def nearest_triangles(self, particles):
        """Of other bodies' particles the triangles of this one that are nearest now, as constraints of the kind "attachment"
        take them: a row of the particle and three corners for each."""
        particles = indices(particles, self._place(), "particles").ravel()
        out = np.empty((len(particles), 4), np.uint32)
        self._world._call(lib.skein_attachments_find, particles.ctypes.data, len(particles), self._handle, out.ctypes.data,
                          place=self._place())
        return out

    def elements(self, what="edges"):
        """Sets of its particles that constraints can be made on: "edges", "triangles", "hinges" or "tetrahedra"."""
        words = {"edges": 2, "triangles": 3, "hinges": 4, "tetrahedra": 4}
        if what not in words:
            raise fault(L.ERROR_VALUE, "elements", f"expected one of {', '.join(words)}, not {what!r}")
        count, code = ctypes.c_size_t(), list(words).index(what)
        self._world._call(lib.skein_body_elements, self._handle, code, None, 0, ctypes.byref(count), place=self._place())
        out = np.empty((count.value, words[what]), np.uint32)
        self._world._call(lib.skein_body_elements, self._handle, code, out.ctypes.data, count.value, ctypes.byref(count),
                          place=self._place())
        return out


def _constraint_count(self):
    count = ctypes.c_size_t()
    self._world._call(lib.skein_constraint_count, self._handle, ctypes.byref(count), place=self._place())
    return count.value


def _evaluate(self, index=0):
    value, most = L.ConstraintValue(), 8
    particles, gradient = np.zeros(most, np.uint32), np.zeros((most, 3))
    self._world._call(lib.skein_constraint_evaluate, self._handle, index, ctypes.byref(value), particles.ctypes.data,
                      gradient.ctypes.data, most, place=self._place())
    count = min(value.particle_count, most)
    return {"value": value.value, "stiffness": value.stiffness, "energy": value.is_energy, "one_sided": value.one_sided,
            "label": value.label.decode(), "text": value.text.decode(), "particles": particles[:count],
            "gradient": gradient[:count]}


Body.constraint_count = property(_constraint_count, doc="how many constraints it has in all its parts")
Body.evaluate = _evaluate
_evaluate.__name__ = "evaluate"
_evaluate.__doc__ = "One of its constraints as the state stands: value, particles and gradient, by automatic derivatives."


class Constraint(Object):
    """A function of a few particles that wants to be zero, or constraints of one kind that share their settings."""

    __slots__ = ()
    _category = L.CONSTRAINT

    def __len__(self):
        return _constraint_count(self)

    def __bool__(self):
        return True

    evaluate = _evaluate


class Force(Object):
    """What pushes particles, or bounds their speed."""

    __slots__ = ()
    _category = L.FORCE

    def probe(self, points):
        """What a force field or a potential does now to a particle that rests at each of points (n x 3): n x 3, m/s2 where
        its formula is per mass, else N."""
        points = np.ascontiguousarray(points, np.float64).reshape(-1, 3)
        forces = np.empty((len(points), 3))
        self._world._call(lib.skein_force_probe, self._handle, len(points), points.ctypes.data, forces.ctypes.data,
                          place=self._place())
        return forces


class Collider(Object):
    """A solid that particles may not enter. One whose place is set travels there through the next step."""

    __slots__ = ()
    _category = L.COLLIDER

    @property
    def pose(self):
        """Where it stands now: position (m) and a rotation matrix."""
        pose = L.Pose()
        self._world._call(lib.skein_collider_pose, self._handle, ctypes.byref(pose), place=self._place())
        return np.array(pose.position), np.array(pose.rotation).reshape(3, 3)

    def teleport(self):
        """What was set since the last step is no way, but where it stands from now on."""
        self._world._call(lib.skein_collider_teleport, self._handle, place=self._place())

    def _triangles(self):
        found = L.Triangles()
        self._world._call(lib.skein_collider_triangles, self._handle, ctypes.byref(found), place=self._place())
        return found

    @property
    def triangles(self):
        """The triangles of a "mesh" collider: three numbers of its `vertices` each; none of other kinds."""
        found = self._triangles()
        if not found.count:
            return np.empty((0, 3), np.uint32)
        return np.ctypeslib.as_array(found.vertices, (found.count, 3)).copy()

    @property
    def vertices(self):
        """Where the vertices of a "mesh" collider are now, n x 3, m, in the world; those that were given at one place are one."""
        out = np.empty((self._triangles().vertex_count, 3), np.float32)
        if len(out):
            self._world._call(lib.skein_collider_vertices_copy, self._handle, L.Buffer(out.ctypes.data, 0, 0), place=self._place())
        return out

    def move_vertices(self, vertices):
        """Where the vertices of a "mesh" collider are from the next step on (n x 3, m, in the mesh's own coordinates): set
        before each step, it deforms in any way, and its surface has a velocity."""
        vertices = np.ascontiguousarray(vertices, np.float64).reshape(-1, 3)
        self._world._call(lib.skein_collider_vertices_set, self._handle, vertices.ctypes.data, len(vertices),
                          place=self._place())

    def probe(self, points):
        """How far points (n x 3) are from its surface, negative inside, and the normals there."""
        points = np.ascontiguousarray(points, np.float64).reshape(-1, 3)
        distances, normals = np.empty(len(points)), np.empty((len(points), 3))
        self._world._call(lib.skein_collider_probe, self._handle, len(points), points.ctypes.data, distances.ctypes.data,
                          normals.ctypes.data, place=self._place())
        return distances, normals


class Motion(Object):
    """What leads pinned particles."""

    __slots__ = ()
    _category = L.MOTION


class Method(Object):
    """What turns rules into motion."""

    __slots__ = ()
    _category = L.METHOD


BASES = [Body, Constraint, Force, Collider, Motion, Method]
TABLES = _fields.tables()
CLASSES = {(table.category, table.name): _fields.class_of(table, BASES[table.category]) for table in TABLES}


class ObjectList:
    """A world's objects of one category: a sequence, with names as keys, and a call for each kind that adds one.

        world.bodies.cloth(grid=(33, 33), pins="top corners")
        world.bodies[0], world.bodies["flag"], len(world.bodies)
    """

    __slots__ = ("_world", "_category")

    def __init__(self, world, category):
        self._world, self._category = world, category

    def __len__(self):
        return lib.skein_object_count(self._world._pointer, self._category)

    def _at(self, index):
        return self._world._object(self._category, lib.skein_object_at(self._world._pointer, self._category, index))

    def __getitem__(self, key):
        if isinstance(key, slice):
            return [self._at(i) for i in range(*key.indices(len(self)))]
        if isinstance(key, str):
            for found in self:
                if found.name == key:
                    return found
            names = ", ".join(repr(found.name) for found in self if found.name) or "none has a name"
            raise fault(L.ERROR_NAME, L.LISTS[self._category], f"there is none of the name {key!r}; there are: {names}")
        index = key + len(self) if key < 0 else key
        if not 0 <= index < len(self):
            raise IndexError(f"{L.LISTS[self._category]}[{key}]: there are {len(self)}")
        return self._at(index)

    def __iter__(self):
        return (self._at(i) for i in range(len(self)))

    def __contains__(self, key):
        return any(found.name == key if isinstance(key, str) else found == key for found in self)

    def __repr__(self):
        return f"[{', '.join(map(repr, self))}]"

    def kinds(self):
        """The names of all kinds there are."""
        return [name for category, name in CLASSES if category == self._category]

    def __dir__(self):
        return [*self.kinds(), "add", "kinds"]

    def __getattr__(self, name):
        if (self._category, name) not in CLASSES:
            if name.startswith("_"):
                raise AttributeError(name)
            raise self._no_kind(name)

        def add(*arguments, **fields):
            return self.add(name, *arguments, **fields)

        add.__name__, add.__doc__ = name, CLASSES[self._category, name].__doc__
        return add

    def _no_kind(self, name):
        error = L.Error()
        lib.skein_kind_find(self._category, str(name).encode(), ctypes.byref(error))
        return fault(error.status, L.LISTS[self._category], error.message.decode())

    def add(self, kind, /, **fields):
        """Adds one of a kind, with fields by their names: groups as dicts, stretch={"stiffness": 2e4}.

        A body or collider of a mesh takes `vertices` (n x 3) and `faces` (lists of vertices); a constraint takes `particles`, a row
        of indices for each; the motion "cache" takes `places` (times x particles x 3), `particles` and `interval`."""
        if (self._category, kind) not in CLASSES:
            raise self._no_kind(kind)
        return self._world._add(self._category, kind, fields)
