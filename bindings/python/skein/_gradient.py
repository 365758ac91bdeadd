"""Gradients of a run: World.gradient(), by skein_gradient() of include/skein/gradient.h.

It takes the library in double precision: SKEIN_PRECISION=double before skein is imported.
"""
import ctypes as c

import numpy as np

from . import _library as L
from ._errors import of
from ._library import lib


class Gradient:
    """What World.gradient() found: the measure, and its derivatives by what the run begins with."""

    __slots__ = ("value", "by_positions", "by_velocities", "by_field")

    def __init__(self, value, by_positions, by_velocities, by_field):
        self.value, self.by_positions, self.by_velocities, self.by_field = value, by_positions, by_velocities, by_field

    def __repr__(self):
        return f"<Gradient of {self.value:.6g}, by {len(self.by_positions)} particles and {list(self.by_field)}>"


def _numbers(array, count):
    """An array of C as one of NumPy, n x 3, without a copy."""
    return np.ctypeslib.as_array(array, (count, 3)) if count else np.empty((0, 3))


def _called(measure, raised):
    """The measure as C calls it; what it raises is kept, for it cannot go through C."""

    def call(_, at):
        state = at.contents
        try:
            if raised:
                return np.nan
            arrays = [_numbers(array, state.particle_count) for array in (state.positions, state.velocities)]
            for array in arrays:
                array.flags.writeable = False
            answer = measure(state.step, *arrays)
            if answer is None:
                return 0.0
            value, *by = answer
            for to, given in zip((state.by_positions, state.by_velocities), by):
                if given is not None:
                    _numbers(to, state.particle_count)[:] = given
            if len(by) > 2:
                raise ValueError("a measure returns a value, and its derivatives by positions and by velocities")
            return float(value)
        except BaseException as error:  # pylint: disable=broad-except
            raised.append(error)
            return np.nan

    return L.MEASURE(call)


def gradient(world, steps, measure, fields, dt, most_bytes):
    """See World.gradient()."""
    raised, count = [], len(world)
    paths = [fields] if isinstance(fields, str) else list(fields)
    numbers = []
    for path in paths:
        value = L.Value()
        world._call(lib.skein_get_path, path.encode(), c.byref(value))
        numbers.append(value.count)
    callback = _called(measure, raised)
    names = (c.c_char_p * (len(paths) + 1))(*[path.encode() for path in paths], None)
    desc = L.GradientDesc(dt, steps, callback, None, c.cast(names, c.POINTER(c.c_char_p)), most_bytes)
    by = [np.zeros((count, 3)), np.zeros((count, 3)), np.zeros(sum(numbers) + 1)]
    result = L.GradientResult(0, *[array.ctypes.data for array in by])
    with world._lock:
        pointer = world._pointer
        failed = lib.skein_gradient(pointer, c.byref(desc), c.byref(result))
        if raised:
            raise raised[0]
        if failed:
            raise of(lib.skein_world_error(pointer).contents)
    by_field, at = {}, 0
    for path, width in zip(paths, numbers):
        by_field[path] = float(by[2][at]) if width == 1 else by[2][at:at + width].copy()
        at += width
    return Gradient(result.value, by[0], by[1], by_field)
