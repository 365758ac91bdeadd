"""How objects get into a world: what a kind takes besides its fields, as C takes it."""
import ctypes

import numpy as np

from . import _library as L
from ._errors import fault
from ._fields import settings
from ._library import lib


def indices(rows, place, member):
    """Numbers of particles, vertices or faces, as C takes them."""
    array = np.asarray(rows)
    if array.size and (array.dtype.kind not in "iu" or array.min() < 0 or array.max() >= 2**32 - 1):
        raise fault(L.ERROR_VALUE, f"{place}.{member}", "expected whole numbers from 0 on")
    return np.ascontiguousarray(array, np.uint32)


def numbers_of(given, shape, place, spread=False):
    """So many numbers, as C takes them. With `spread` one, or a row of them, stands for all."""
    try:
        array = np.asarray(given, np.float64)
        return np.ascontiguousarray(np.broadcast_to(array, shape) if spread else array.reshape(shape))
    except (TypeError, ValueError):
        words = " x ".join(map(str, shape))
        of = " x ".join(map(str, given.shape)) if hasattr(given, "shape") else repr(given)[:60]
        raise fault(L.ERROR_VALUE, place, f"expected {words} numbers, not {of}") from None


def _mesh(vertices, faces, place):
    positions = np.ascontiguousarray(np.asarray(vertices, np.float64).reshape(-1, 3))
    sizes = np.array([len(face) for face in faces], np.uint32)
    corners = indices(np.concatenate([np.asarray(face) for face in faces]) if len(faces) else [], place, "faces")

    def numbers(array, kind):
        return array.ctypes.data_as(ctypes.POINTER(kind))

    mesh = L.Mesh(numbers(positions, ctypes.c_double), len(positions), numbers(sizes, ctypes.c_uint32), len(sizes),
                  numbers(corners, ctypes.c_uint32), corners.size)
    mesh.kept = positions, sizes, corners
    return mesh


def _given_mesh(fields, place):
    """What `vertices` and `faces` make, which are taken out; None without them."""
    vertices, faces = fields.pop("vertices", None), fields.pop("faces", None)
    if (vertices is None) != (faces is None):
        raise fault(L.ERROR_VALUE, place, "a mesh has both: vertices (n x 3) and faces (lists of vertices)")
    return ctypes.byref(_mesh(vertices, faces, place)) if vertices is not None else None


def _body(world, kind, table, fields, place, handle):
    world._resize()
    mesh = _given_mesh(fields, place)
    world._call(lib.skein_body_add, kind, mesh, settings(table, fields, place), handle, place=place)


def _collider(world, kind, table, fields, place, handle):
    mesh = _given_mesh(fields, place)
    world._call(lib.skein_collider_add_mesh, kind, mesh, settings(table, fields, place), handle, place=place)


def _constraint(world, kind, table, fields, place, handle):
    if "particles" not in fields:
        raise fault(L.ERROR_VALUE, f"{place}.particles", "it is missing: a row of indices for each constraint, such as "
                                                         "cloth.elements(\"edges\")")
    particles = indices(fields.pop("particles"), place, "particles").reshape(-1)
    given, arity = settings(table, fields, place), ctypes.c_size_t()
    world._call(lib.skein_constraint_arity, kind, given, ctypes.byref(arity), place=place)
    count = len(particles) // arity.value if arity.value else 1
    if count * arity.value != len(particles):
        raise fault(L.ERROR_VALUE, f"{place}.particles", f"each constraint takes {arity.value} particles, and "
                                                         f"{len(particles)} are no multiple of that")
    world._call(lib.skein_constraint_add, kind, particles.ctypes.data, count, given, handle, place=place)


def _motion(world, kind, table, fields, place, handle):
    track = None
    if "places" in fields:
        places = np.ascontiguousarray(fields.pop("places"), np.float64)
        particles = indices(fields.pop("particles", []), place, "particles")
        if places.ndim != 3 or places.shape[1:] != (len(particles), 3):
            raise fault(L.ERROR_VALUE, f"{place}.places", f"expected times x {len(particles)} particles x 3, not "
                                                          f"{' x '.join(map(str, places.shape))}")
        made = L.Track(particles.ctypes.data_as(ctypes.POINTER(ctypes.c_uint32)),
                       places.ctypes.data_as(ctypes.POINTER(ctypes.c_double)), len(particles), len(places),
                       fields.pop("interval", world.dt))
        track = ctypes.byref(made)
    world._call(lib.skein_motion_add, kind, track, settings(table, fields, place), handle, place=place)


def _plain(function):
    def add(world, kind, table, fields, place, handle):
        world._call(function, kind, settings(table, fields, place), handle, place=place)

    return add


WAYS = {L.BODY: _body, L.CONSTRAINT: _constraint, L.MOTION: _motion, L.FORCE: _plain(lib.skein_force_add),
        L.COLLIDER: _collider}


def add(world, category, kind, table, fields, place):
    """Adds one; returns its handle."""
    handle = L.Handle()
    WAYS[category](world, kind.encode(), table, dict(fields), place, ctypes.byref(handle))
    return handle
