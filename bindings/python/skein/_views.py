"""Views of the state: NumPy arrays on the world's own memory, with no copy.

A view shows each step's result as soon as the step is done. It holds its world: as long as there is one, the world does not
go by itself, and what would move its memory (closing it, adding or removing a body) raises BufferError, as a bytearray
does. A view is read-only; positions and velocities are written by assignment to World.positions and World.velocities.
"""
import weakref

import numpy as np


class Memory:
    """What NumPy asks for where an array lies; an array keeps it, and it keeps the world."""

    __slots__ = ("owner", "__array_interface__", "__weakref__")

    def __init__(self, owner, address, shape, kind):
        self.owner = owner
        self.__array_interface__ = {"version": 3, "shape": shape, "typestr": np.dtype(kind).str, "data": (address, True)}


class Views:
    """The views that are held of one world."""

    __slots__ = ("held",)

    def __init__(self):
        self.held = weakref.WeakSet()

    def give(self, owner, address, shape, kind):
        if not address or 0 in shape:
            return np.empty(shape, kind)
        memory = Memory(owner, address, shape, kind)
        self.held.add(memory)
        return np.asarray(memory)

    def refuse(self, what):
        if self.held:
            count = len(self.held)
            raise BufferError(f"{count} view{'s' * (count > 1)} of the state {'are' if count > 1 else 'is'} still held: "
                              f"{what} would take {'their' if count > 1 else 'its'} memory away. Let go of what "
                              "position_view, velocity_view and slot_of gave (del), or take copies")
