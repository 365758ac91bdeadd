"""Fields: the library's tables become classes whose attributes are the fields, each with its unit, range and help.

    cloth.stretch.stiffness = 2e4        # a field of a group of fields
    help(type(cloth))                    # all of them

A class for each kind is made when the package is imported, from what skein_kind_at() lists; no kind is named here. Names
that are words of Python get an underscore (`rope.from_`); any name goes in brackets (`rope["from"]`,
`cloth["stretch.stiffness"]`).
"""
import ctypes
import keyword
import math
import numbers

from . import _library as L
from ._errors import fault
from ._formula import Formula, formula

COUNTS = {L.BOOL: 1, L.INT: 1, L.INT2: 2, L.INT3: 3, L.REAL: 1, L.REAL2: 2, L.VEC3: 3, L.CHOICE: 1, L.TEXT: 0}
TYPES = {L.BOOL: "bool", L.INT: "int", L.INT2: "two ints", L.INT3: "three ints", L.REAL: "number", L.REAL2: "two numbers",
         L.VEC3: "three numbers", L.CHOICE: "word", L.TEXT: "text"}


class Field:
    """One parameter of a kind, as its table describes it."""

    def __init__(self, raw):
        self.name, self.type, self.unit = raw.name.decode(), raw.type, raw.unit.decode()
        self.least, self.most = raw.least, raw.most
        self.choices = raw.choices.decode().split("|") if raw.choices else []
        self.help = raw.help.decode()
        self.count = COUNTS[self.type]
        value = L.Value(self.count, raw.initial, raw.text)
        self.default = None if self.name.endswith("*") else self.read(value)

    def __repr__(self):
        return f"Field({self.name!r}: {self.words()})"

    def words(self):
        """What it takes: type, unit, range, default."""
        kind = " or ".join(map(repr, self.choices)) if self.choices else TYPES[self.type]
        words = [kind + (f" in {self.unit}" if self.unit else "")]
        if self.count and self.type not in (L.BOOL, L.CHOICE):
            low, high = (f"{x:g}" if abs(x) < 1e15 else None for x in (self.least, self.most))
            if low and high:
                words.append(f"{low} to {high}")
            elif low:
                words.append(f"at least {low}" + (", or math.inf" if math.isinf(self.most) else ""))
        if self.default is not None:
            words.append(f"default {self.default!r}")
        return "; ".join(words)

    def read(self, value):
        """A skein_value as Python has it."""
        if self.type == L.TEXT:
            return value.text.decode() if value.text else ""
        if self.type == L.CHOICE:
            return self.choices[int(value.number[0])]
        if self.type == L.BOOL:
            return bool(value.number[0])
        whole = self.type in (L.INT, L.INT2, L.INT3)
        number = [int(value.number[i]) if whole else value.number[i] for i in range(self.count)]
        return number[0] if self.count == 1 else tuple(number)

    def write(self, given, where=""):
        """What Python has as a skein_value; the library checks its range."""
        if self.type in (L.TEXT, L.CHOICE):
            if callable(given) and not isinstance(given, str):
                given = formula(given)
            if isinstance(given, (list, tuple)) or hasattr(given, "tolist"):
                given = join([self._name_of(one, where) for one in given])
            given = self._name_of(given, where)
            if not isinstance(given, str):
                raise self._refuse(given, where)
            return L.Value(0, (0, 0, 0), given.encode())
        if isinstance(given, str):
            if given != "infinite" or not math.isinf(self.most):
                raise self._refuse(given, where)
            given = math.inf
        numbers_ = [given] if isinstance(given, (numbers.Number, bool)) or getattr(given, "ndim", None) == 0 else given
        try:
            found = [float(x) for x in numbers_]
        except (TypeError, ValueError):
            raise self._refuse(given, where) from None
        if len(found) != self.count:
            raise self._refuse(given, where)
        return L.Value(self.count, (ctypes.c_double * 3)(*found), None)

    def _name_of(self, given, where):
        """Of an object its name, by which fields refer to it: `on=cloth`."""
        if not hasattr(given, "_handle"):
            return given
        if not given.name:
            raise fault(L.ERROR_VALUE, where or self.name, f"this {given.kind} has no name: make it with name=\"...\" to refer to it")
        return given.name

    def _refuse(self, given, where):
        return fault(L.ERROR_VALUE, where or self.name, f"expected {self.words()}, not {given!r}")


def join(rows):
    """A list as the text that pins, keys and names take: numbers by blanks, rows and words by commas."""
    rows = rows.tolist() if hasattr(rows, "tolist") else rows
    if any(isinstance(row, (list, tuple)) for row in rows):
        return ", ".join(" ".join(f"{x:.17g}" for x in row) for row in rows)
    if any(isinstance(row, str) for row in rows):
        return ", ".join(map(str, rows))
    return " ".join(f"{x:.17g}" if isinstance(x, numbers.Number) else str(x) for x in rows)


class KindTable:
    """A kind: its name, its help and its fields by name."""

    def __init__(self, raw):
        self.name, self.help, self.category = raw.name.decode(), raw.help.decode(), raw.category
        count = ctypes.c_size_t()
        common = L.lib.skein_common_fields(raw.category, ctypes.byref(count))
        rows = [raw.fields[i] for i in range(raw.field_count)]
        rows += [common[i] for i in range(count.value) if L.lib.skein_kind_takes(ctypes.byref(raw), common[i].name)]
        self.fields = {field.name: field for field in map(Field, rows)}
        self.has_parameters = "parameters.*" in self.fields

    def __repr__(self):
        return f"<{L.CATEGORIES[self.category]} {self.name}: {self.help}>"


def tables():
    """All kinds there are, in the library's order."""
    found = []
    for category in range(len(L.CATEGORIES)):
        index = 0
        while raw := L.lib.skein_kind_at(category, index):
            found.append(KindTable(raw.contents))
            index += 1
    return found


def attribute(name):
    """A field's name as an attribute."""
    return name + "_" if keyword.iskeyword(name) else name


def plain(name):
    return name[:-1] if name.endswith("_") and keyword.iskeyword(name[:-1]) else name


class Fields:
    """What has fields: `_get` and `_set` by their full names are its owner's."""

    __slots__ = ()

    def __setattr__(self, name, value):
        if not name.startswith("_") and not hasattr(type(self), name):
            raise self._no_field(name)
        object.__setattr__(self, name, value)

    def __dir__(self):
        return [name for name in object.__dir__(self) if not name.startswith("_")]


class Group(Fields):
    """Some of an object's fields, as `stretch` of a cloth."""

    __slots__ = ("_object", "_prefix")

    def __init__(self, owner, prefix):
        object.__setattr__(self, "_object", owner)
        object.__setattr__(self, "_prefix", prefix)

    def __getattr__(self, name):
        raise self._no_field(name)

    def _no_field(self, name):
        return self._object._no_field(self._prefix + plain(name))

    def __repr__(self):
        inside = ", ".join(f"{name}={getattr(self, name)!r}" for name in dir(self))
        return f"{self._prefix[:-1]}({inside})"


class Parameters(Fields):
    """The numbers that an object's formulas name: `ring.parameters.R = 0.5`."""

    __slots__ = ("_object",)

    def __init__(self, owner):
        object.__setattr__(self, "_object", owner)

    def __getattr__(self, name):
        if name.startswith("__"):
            raise AttributeError(name)
        return self._object._get("parameters." + name)

    def __setattr__(self, name, value):
        self._object._set("parameters." + name, value)

    __getitem__ = __getattr__
    __setitem__ = __setattr__

    def __dir__(self):
        return self._object._parameter_names()

    def __iter__(self):
        return iter(dir(self))

    def __repr__(self):
        return "parameters(" + ", ".join(f"{name}={self[name]!r}" for name in self) + ")"


def _property(full, field):
    def get(self):
        return (self._object if isinstance(self, Group) else self)._get(full)

    def put(self, value):
        (self._object if isinstance(self, Group) else self)._set(full, value)

    return property(get, put, doc=f"{field.help} ({field.words()})")


def camel(name):
    return "".join(part.capitalize() for part in name.split("_"))


def class_of(table, base):
    """The class of a kind's objects: ClothBody, GravityForce ..."""
    name = camel(table.name) + base.__name__
    members, groups = {"_table": table, "__slots__": ()}, {}
    for full, field in table.fields.items():
        *prefix, last = full.split(".")
        if last == "*":
            members["parameters"] = property(Parameters, doc=field.help)
        elif prefix:
            groups.setdefault(prefix[0], {})[attribute(last)] = _property(full, field)
        else:
            members[attribute(last)] = _property(full, field)
    for group, inside in groups.items():
        kind = type(camel(group) + "Of" + name, (Group,), {"__slots__": (), "__doc__": f"{group} of {table.name}", **inside})
        members[attribute(group)] = property(
            lambda self, kind=kind, group=group: kind(self, group + "."),
            lambda self, value, group=group: self.set(**{group: value}), doc=f"the fields of {group}, {', '.join(inside)}")
        members.setdefault("_groups", {})[attribute(group)] = kind
    members["__doc__"] = table.help + "\n\n" + "\n".join(
        f"    {full}: {field.help} ({field.words()})" for full, field in table.fields.items())
    members["__module__"] = "skein.kinds"
    return type(name, (base,), members)


def flatten(table, given, where=""):
    """Keywords as a list of (field, value): groups are dicts, `from_` is from, a formula brings its parameters."""
    found = {}

    def take(prefix, members):
        for name, value in members.items():
            full = prefix + plain(name)
            if isinstance(value, dict) and full not in table.fields:
                take(full + ".", value)
                continue
            if callable(value) and not isinstance(value, str):
                value = formula(value)
            if isinstance(value, Formula) and table.has_parameters:
                for parameter, number in value.parameters.items():
                    if number is not None:
                        found.setdefault("parameters." + parameter, number)
            found[full] = value

    take("", given)
    return found


def settings(table, given, where=""):
    """A C array of settings, and what must live as long."""
    found = flatten(table, given, where)
    array = (L.Setting * (len(found) + 1))()
    for i, (full, value) in enumerate(found.items()):
        field = table.fields.get(full)
        if not field and full.startswith("parameters.") and table.has_parameters:
            field = table.fields["parameters.*"]
        if not field:
            raise no_field(table, full, where)
        array[i] = L.Setting(full.encode(), field.write(value, f"{where}.{full}" if where else full))
    return array


def no_field(table, full, where=""):
    error = L.Error()
    kind = L.lib.skein_kind_find(table.category, table.name.encode(), ctypes.byref(error))
    common = L.lib.skein_field_find(kind, full.encode(), ctypes.byref(error))  # others of the category have it
    words = f"{table.name} takes no '{full}'" if common else error.message.decode()
    return fault(L.ERROR_NAME, f"{where}.{full}" if where else full, words)
