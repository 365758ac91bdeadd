"""Errors as exceptions, with their place and their words.

Every exception that the library's faults become is a SkeinError. It is also what Python would raise for such a thing, so
that `except ValueError` catches a value out of range: see KINDS.
"""
from ._library import lib


class SkeinError(Exception):
    """Something failed. `where` is its place (a field's path, a file and line) or "", `status` the library's word for its
    sort; `faults` has all of (status, where, message) where a scene had several."""

    def __init__(self, faults):
        self.faults = faults
        self.status, self.where, _ = faults[0] if faults else ("out of memory", "", "")
        super().__init__("\n".join((f"{where}: " if where else "") + message for _, where, message in faults)
                         or "out of memory")


class MemoryFault(SkeinError, MemoryError):
    """There is no memory."""


class ValueFault(SkeinError, ValueError):
    """A value has the wrong type or is out of range."""


class NameFault(SkeinError, AttributeError, LookupError):
    """No kind, field or body of that name."""


class HandleFault(SkeinError, ReferenceError):
    """The object was removed, or is of another world."""


class MeshFault(SkeinError, ValueError):
    """The mesh cannot be what was asked of it."""


class FileFault(SkeinError, OSError):
    """A file cannot be read or written."""

    def __init__(self, faults):
        SkeinError.__init__(self, faults)

    def __str__(self):
        return Exception.__str__(self)


class SyntaxFault(SkeinError, ValueError):
    """A file or formula is malformed; the message shows the place."""


class LimitFault(SkeinError, OverflowError):
    """More than an index can count."""


KINDS = [SkeinError, MemoryFault, ValueFault, NameFault, HandleFault, MeshFault, FileFault, SyntaxFault, LimitFault]


def fault(status, where, message):
    """The exception for one fault."""
    return faults([(status, where, message)])


def faults(found):
    """The exception for some: of the sort of the first."""
    kind = KINDS[found[0][0]] if found else MemoryFault
    return kind([(lib.skein_status_text(status).decode(), where, message) for status, where, message in found])


def of(error, before=""):
    """The exception for a skein_error; `before` is the place of which `where` is a part."""
    where = error.where.decode(errors="replace")
    place = f"{before}.{where}" if before and where else before or where
    return fault(error.status, place, error.message.decode(errors="replace"))
