"""Scenes: the files of the command, read by the same code, so that faults have the same words."""
import ctypes
import json
import math
import os

from . import _library as L
from ._errors import FileFault, faults
from ._library import lib


def _folders():
    """Where scenes lie: what SKEIN_SCENES names, and no other; else ./scenes, and those that came with the package."""
    given = os.environ.get("SKEIN_SCENES")
    here = os.path.dirname(os.path.abspath(__file__))
    return [given] if given else ["scenes", os.path.join(here, "scenes")]


def scenes():
    """The names of the scenes that come along."""
    found = set()
    for folder in _folders():
        if os.path.isdir(folder):
            found |= {name[:-5] for name in os.listdir(folder) if name.endswith(".json")}
    return sorted(found)


def scene_path(word):
    """The file that a word means: a path, or the name of a scene; None where it means neither."""
    word = os.fspath(word)
    if os.path.isfile(word):
        return word
    if os.path.basename(word) == word:
        for folder in _folders():
            path = os.path.join(folder, word if word.endswith(".json") else word + ".json")
            if os.path.isfile(path):
                return path
    return None


def plain(value):
    """Arrays and numbers of NumPy, of which JSON knows nothing, as lists and numbers."""
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"a scene has numbers, words, lists and dicts, and no {type(value).__name__}: {value!r}")


def _text(scene):
    """A scene's JSON and the path that its files lie beside; None for a mesh."""
    if isinstance(scene, dict):
        return json.dumps(scene, default=plain).encode(), "scene.json"
    if isinstance(scene, str) and scene.lstrip().startswith("{"):
        return scene.encode(), "scene.json"
    if not isinstance(scene, (str, os.PathLike)):
        raise TypeError(f"a scene is a dict, JSON, a path or a name, not {type(scene).__name__}")
    path = scene_path(scene)
    if path is None:
        raise FileFault([("file", os.fspath(scene), "there is no such file, and no scene of that name; there are: "
                          + ", ".join(scenes()))])
    if lib.py_path_is_mesh(path.encode()):
        return None, path
    with open(path, "rb") as file:
        return file.read(), path


def _sets(sets, text):
    """As --set has them, a C list that ends with NULL. What a scene wants to be written is left out: a film, say."""
    if isinstance(sets, dict):
        sets = [f"{path}={value if isinstance(value, str) else json.dumps(value, default=plain)}" for path, value in sets.items()]
    elif isinstance(sets, str):
        sets = [sets]
    all_sets = [s.encode() for s in (["output=[]"] if text and b'"output"' in text else []) + list(sets)]
    return (ctypes.c_char_p * (len(all_sets) + 1))(*all_sets, None)


def open_scene(scene, sets, threads, log):
    """Reads and builds: the owner of the world, and what the scene says of itself."""
    from ._world import Owner, described
    text, path = _text(scene)
    found = []
    report = L.REPORT(lambda _, status, where, message: found.append(
        (status, where.decode(errors="replace"), message.decode(errors="replace"))))
    opened = lib.py_scene_open(text, len(text or b""), path.encode(), _sets(sets, text), report, None)
    if not opened:
        raise faults(found)
    desc, callback = described(threads, log)
    world = lib.py_scene_build(opened, ctypes.byref(desc), report, None)
    owner = Owner(world, opened, callback)
    if not world or found:
        raise faults(found)
    return owner, json.loads(L.take_text(lib.py_scene_settings(opened)))


def note(opened, sets):
    """Notes in a scene's document what was set in its world."""
    found = []
    report = L.REPORT(lambda _, status, where, message: found.append(
        (status, where.decode(errors="replace"), message.decode(errors="replace"))))
    for path, value in sets:
        text = json.dumps(_finite(value))
        if not lib.py_scene_note(opened, f"{path}={text}".encode(), report, None):
            raise faults(found)


def _finite(value):
    """As JSON has it: groups of dots are objects."""
    if isinstance(value, dict):
        tree = {}
        for full, inner in value.items():
            *prefix, last = full.split(".")
            at = tree
            for part in prefix:
                at = at.setdefault(part, {})
            at[last] = _finite(inner)
        return tree
    return "infinite" if isinstance(value, float) and math.isinf(value) else value


def open_view(fields):
    """A scene that is nothing but a view, for its view; to be freed."""
    text, found = json.dumps({"view": fields}, default=plain).encode(), []
    report = L.REPORT(lambda _, status, where, message: found.append(
        (status, where.decode(errors="replace"), message.decode(errors="replace"))))
    opened = lib.py_scene_open(text, len(text), b"view", _sets((), text), report, None)
    if not opened or found:
        if opened:
            lib.py_scene_free(opened)
        raise faults(found)
    return opened
