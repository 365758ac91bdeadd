"""Recordings: what is done to a world and what comes of it, as bytes, to be done again and compared (skein/record.h)."""
import ctypes
import types

from . import _library as L
from ._library import lib


class Recording:
    """A recording that is being made: World.record(). `data` has its bytes, whole once the `with` block has ended."""

    __slots__ = ("_world", "_parts", "_note")

    def __init__(self, world, note):
        self._world, self._parts, self._note = world, [], note.encode()

    @property
    def data(self):
        """The bytes so far: what skein run --record writes, and skein verify reads, of a world of a scene with its note."""
        return b"".join(self._parts)

    def __enter__(self):
        world, parts = self._world, self._parts

        def put(_, data, size):
            parts.append(ctypes.string_at(data, size))
            return True

        write = L.PUT(put)
        recorder = L.Recorder(write, None, self._note)
        with world._lock:
            world._call(lib.skein_record_begin, ctypes.byref(recorder), place="record")
            world._owner.recorder = write
        return self

    def __exit__(self, kind, *_):
        world = self._world
        if world.closed:  # which has ended it
            return
        with world._lock:
            failed = lib.skein_record_end(world._pointer)
            world._owner.recorder = None
            if failed and not kind:
                from ._errors import of
                raise of(lib.skein_world_error(world._pointer).contents, "record")

    def __repr__(self):
        return f"<Recording of {len(self.data)} bytes>"


def replay(world, data):
    """See World.replay()."""
    world._owner.check_process()
    world._resize()  # bodies may come and go
    found = L.Difference()
    world._call(lib.skein_replay, data, len(data), ctypes.byref(found), place="replay")
    names = ("steps", "found", "exact", "position", "velocity", "particle", "blocks", "is_whole")
    body = world._object(L.BODY, L.Handle(*found.body.key())) if lib.skein_handle_valid(world._pointer, found.body) else None
    return types.SimpleNamespace(**{name: getattr(found, name) for name in names}, body=body,
                                 stopped=found.stopped.decode(errors="replace"))
