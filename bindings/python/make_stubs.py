"""Makes the types that editors and checkers read (__init__.pyi, kinds.pyi, functions.pyi) from the package and its tables:

    make_stubs.py FOLDER      (PYTHONPATH and SKEIN_LIBRARY lead to the package and its library)

Public classes are those of skein.__all__, with their signatures and the first lines of their words; kinds have their fields
as attributes, with types, units and help. tools/wheel makes them, so that they are the tables' of that day; a test asks whether anything is missing in them.
"""
import inspect
import math
import re
import sys

import skein
from skein import _fields, _formula, _library as L, _objects

TYPES = {L.BOOL: "bool", L.INT: "int", L.INT2: "tuple[int, int]", L.INT3: "tuple[int, int, int]", L.REAL: "float",
         L.REAL2: "tuple[float, float]", L.VEC3: "tuple[float, float, float]", L.TEXT: "str"}
RETURNS = {  # what no signature says; anything else is Any
    "positions": "Array", "velocities": "Array", "position_view": "Array", "velocity_view": "Array",
    "slot_of": "Array", "vertices": "Array", "faces": "list[Array]", "elements": "Array", "time": "float",
    "select": "Array", "nearest_triangles": "Array", "probe": "Any", "move_vertices": "None", "profile": "list[Any]",
    "record": "Recording", "replay": "Any", "data": "bytes",
    "cut": "int", "cut_faces": "None", "mend": "None", "cuts": "Array",
    "closed": "bool", "hash": "str", "render": "Image", "snapshot": "State", "particles": "range", "kind": "str", "valid": "bool",
    "remove": "None", "reset": "None", "step": "None", "frame": "None", "close": "None", "restore": "None", "pin": "None",
    "move_pins": "None", "add_particles": "range", "explain": "list[str]", "hashes": "list[str]", "method": "Method",
    "set_method": "Method", "save": "None", "contacts": "list[Any]", "surface_contacts": "list[Any]", "set": "None", "fields": "dict[str, Any]",
    "constraint_count": "int", "evaluate": "dict[str, Any]", "teleport": "None", "is_live": "bool", "kinds": "list[str]", "methods": "list[str]", "advice": "list[str]",
    "substeps_needed": "float",
    "scene": "dict[str, Any] | None", "from_scene": "World", "film": "Film", "formula": "Formula", "scenes": "list[str]",
    "study": "Array", "fit": "Fit",
}
OF_ENVIRONMENTS = {"reset": "tuple[Any, dict[str, Any]]", "step": "tuple[Any, Any, Any, Any, dict[str, Any]]",
                   "build": "World", "start": "None", "act": "None", "reward": "float", "terminated": "bool"}
LISTS = {"bodies": "Bodies", "constraints": "Constraints", "forces": "Forces", "colliders": "Colliders", "motions": "Motions"}
WRITTEN = {"method": "str", "time": "float"}  # anything else takes Any
OF_OPERATORS = {"__len__": "int", "__contains__": "bool", "__eq__": "bool", "__exit__": "None"}
OPERATORS = ["__len__", "__getitem__", "__iter__", "__enter__", "__exit__", "__contains__", "__eq__", "__hash__"]


def words(text, indent):
    first = (text or "").strip().split("\n\n")[0]
    line = re.sub(r"\s+", " ", first).replace("\\", "\\\\")
    line += " " * line.endswith('"')
    return f'{indent}"""{line}"""\n' if line else ""


def field_type(field, write=False):
    """Its type as it is read, or as what may be written: lists and arrays for vectors, functions and objects for texts."""
    if field.choices:
        return "Literal[" + ", ".join(f'"{word}"' for word in field.choices) + "]"
    kind = TYPES[field.type]
    if not write:
        return kind
    if field.type == L.TEXT:
        return "str | Object | Callable[..., Any] | Sequence[Any] | Array"
    if field.type == L.REAL and math.isinf(field.most):
        return 'float | Literal["infinite"]'
    return f"{kind} | Sequence[float] | Array" if kind.startswith("tuple") else kind


def property_of(name, read, write, text, indent=4):
    """What is read as one type and written as another: checkers take a property's setter for as strict as its getter, so
    where they differ it is a descriptor."""
    pad = " " * indent
    if write is None:
        return f"{pad}@property\n{pad}def {name}(self) -> {read}:\n{words(text, pad + '    ')}{pad}    ...\n"
    if read == write:
        setter = f"{pad}@{name}.setter\n{pad}def {name}(self, value: {write}) -> None: ...\n"
        return property_of(name, read, None, text, indent) + setter
    return f"{pad}{name}: _Settable[{read}, {write}]\n{words(text, pad)}"


def signature(function, drop_self=False):
    def plain(parameter):
        shown = parameter.name
        if parameter.kind == parameter.VAR_KEYWORD:
            return f"**{shown}: Any"
        if parameter.kind == parameter.VAR_POSITIONAL:
            return f"*{shown}: Any"
        if shown in ("self", "cls"):
            return shown
        return f"{shown}: Any" + ("" if parameter.default is parameter.empty else " = ...")

    parts, starred = [], False
    parameters = list(inspect.signature(function).parameters.values())
    for i, parameter in enumerate(parameters):
        if parameter.kind == parameter.KEYWORD_ONLY and not starred:
            parts.append("*")
            starred = True
        starred |= parameter.kind == parameter.VAR_POSITIONAL
        parts.append(plain(parameter))
        if parameter.kind == parameter.POSITIONAL_ONLY and (
                i + 1 == len(parameters) or parameters[i + 1].kind != parameter.POSITIONAL_ONLY):
            parts.append("/")
    return ", ".join(parts)


def member(name, value, out, returns):
    if isinstance(value, property):
        kind = LISTS.get(name, returns.get(name, "Any"))
        out.append(property_of(name, kind, WRITTEN.get(name, "Any") if value.fset else None, value.__doc__))
    elif isinstance(value, (classmethod, staticmethod)) or inspect.isfunction(value):
        function = value.__func__ if isinstance(value, (classmethod, staticmethod)) else value
        decorator = f"    @{type(value).__name__}\n" if not inspect.isfunction(value) else ""
        out.append(f"{decorator}    def {name}({signature(function)}) -> {returns.get(name, 'Any')}:\n"
                   f"{words(function.__doc__, ' ' * 8)}        ...\n")
    elif not callable(value):
        out.append(f"    {name}: Any\n")


def public_class(cls):
    bases = ", ".join(base.__name__ for base in cls.__bases__ if base is not object and not base.__name__.startswith("_"))
    bases = bases.replace("ndarray", "np.ndarray[Any, Any]").replace("Fields", "")
    out = [f"class {cls.__name__}{f'({bases})' if bases else ''}:\n{words(cls.__doc__, '    ')}"]
    slots = [slot for slot in cls.__dict__.get("__slots__", ()) if not slot.startswith("_")]
    for slot in slots:
        out.append(f"    {slot}: Any\n")
    if "__init__" in cls.__dict__:
        out.append(f"    def __init__({signature(cls.__init__)}) -> None: ...\n")
    for name, value in cls.__dict__.items():
        if name in slots or name.startswith("_") and name not in OPERATORS:
            continue
        if name == "__hash__":
            out.append("    def __hash__(self) -> int: ...\n")
        elif name in OPERATORS:
            kind = cls.__name__ if name == "__enter__" else OF_OPERATORS.get(name, "Any")
            out.append(f"    def {name}({signature(value)}) -> {kind}: ...\n")
        else:
            member(name, value, out, {**RETURNS, **OF_ENVIRONMENTS} if "Environment" in cls.__name__ else RETURNS)
    if cls is skein.World:
        out.append("    dt: float\n    fps: float\n    frames: int\n    steps_per_frame: int\n    name: str\n    description: str\n")
    return "".join(out + (["    ...\n"] if len(out) == 1 else []))


def attribute(name, field, indent):
    text = f"{field.help} ({field.words()})".replace('"""', "'''")
    return property_of(name, field_type(field), field_type(field, write=True), text, len(indent))


def kind_class(cls):
    table, groups, own = cls._table, {}, ""
    for full, field in table.fields.items():
        *prefix, last = full.split(".")
        if last == "*":
            own += "    @property\n    def parameters(self) -> Any: ...\n"
        elif prefix:
            groups.setdefault(prefix[0], []).append(attribute(_fields.attribute(last), field, "    "))
        else:
            own += attribute(_fields.attribute(last), field, "    ")
    text = ""
    for group, members in groups.items():
        name = f"{_fields.camel(group)}Of{cls.__name__}"
        text += f"class {name}:\n{''.join(members)}\n"
        own += f"    {group}: _Settable[{name}, dict[str, Any]]\n"
    return text + f"class {cls.__name__}({cls.__bases__[0].__name__}):\n{words(table.help, '    ')}{own or '    ...'}\n"


def adders(category, name, title):
    """The list of a category: a call for each kind, whose keywords are its fields and groups."""
    out = [f"class {name}(ObjectList):\n"]
    extra = {L.BODY: ["vertices: Any", "faces: Any"], L.COLLIDER: ["vertices: Any", "faces: Any"], L.CONSTRAINT: ["particles: Any"],
             L.MOTION: ["places: Any", "particles: Any", "interval: float"]}.get(category, [])
    for (at, kind), cls in _objects.CLASSES.items():
        if at != category:
            continue
        keywords, seen = [f"{part} = ..." for part in extra], set()
        for full, field in cls._table.fields.items():
            first = _fields.attribute(full.split(".")[0])
            if first in seen:
                continue
            seen.add(first)
            kind_of = "dict[str, Any]" if "." in full else f"{field_type(field, write=True)}"
            keywords.append(f"{first}: {kind_of} = ...")
        out.append(f"    def {kind}(self, *, {', '.join(keywords)}) -> {cls.__name__}:\n{words(cls._table.help, ' ' * 8)}"
                   "        ...\n")
    out.append(f"    def __getitem__(self, key: Any) -> {title}: ...\n    def __iter__(self) -> Iterator[{title}]: ...\n")
    return "".join(out) + "\n"


def main():
    text = ('# Made by bindings/python/make_stubs.py from the package and its tables of fields; do not edit.\n'
            "from collections.abc import Callable, Iterator, Sequence\nfrom typing import Any, Generic, Literal, TypeAlias, TypeVar\n\n"
            "import numpy as np\nfrom numpy.typing import NDArray\n\n"
            "from . import functions as functions, kinds as kinds\n\nArray: TypeAlias = NDArray[Any]\n"
            "_Read = TypeVar(\"_Read\")\n_Written = TypeVar(\"_Written\")\n\nclass _Settable(Generic[_Read, _Written]):\n"
            "    def __get__(self, owner: Any, kind: Any = ...) -> _Read: ...\n"
            "    def __set__(self, owner: Any, value: _Written) -> None: ...\n\n__version__: str\nprecision: str\nDEFAULT_STEP: float\n\n")
    classes = [getattr(skein, name) for name in skein.__all__ if inspect.isclass(getattr(skein, name))]
    classes.sort(key=lambda cls: len(cls.__mro__))
    for cls in classes:
        text += public_class(cls) + "\n"
    for name in skein.__all__:
        value = getattr(skein, name)
        if inspect.isfunction(value):
            text += f"def {name}({signature(value)}) -> {RETURNS.get(name, 'Any')}:\n{words(value.__doc__, '    ')}    ...\n\n"
    for cls in _objects.CLASSES.values():
        text += kind_class(cls)
    for category, (_, name) in enumerate(LISTS.items()):
        text += adders(category, name, _objects.BASES[category].__name__)
    return text


def kinds_and_functions():
    names = [cls.__name__ for cls in _objects.CLASSES.values()]
    kinds = "# Made by make_stubs.py.\n" + "".join(f"from . import {name} as {name}\n" for name in names)
    functions = "# Made by make_stubs.py.\nfrom typing import Any\n\npi: Any\n"
    for name, count in _formula.NAMES.items():
        functions += f"def {name}({', '.join(f'{letter}: Any' for letter in 'abcd'[:count])}, /) -> Any: ...\n"
    return kinds, functions


if __name__ == "__main__":
    for file_name, stub in zip(("__init__", "kinds", "functions"), (main(), *kinds_and_functions())):
        with open(f"{sys.argv[1]}/{file_name}.pyi", "w", encoding="utf-8") as file:
            file.write(stub)
