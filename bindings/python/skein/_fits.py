"""Fits: fields of a scene are varied until its run is like a target, by the command's own module (docs/gradients.md).

The module skein_fit.so lies beside the library: it is the library in double precision once more, with liblbfgs, and takes
structs, those of fit/fit.h. The scene is opened here first, in the library's own precision, for its faults and its particles.
"""
import concurrent.futures
import ctypes as c
import json
import math
import os

import numpy as np

from . import _library as L
from ._errors import FileFault, NameFault, ValueFault, of
from ._library import lib

ENDS = ["converged", "iterations", "stuck", "interrupted"]
MOST_ITERATIONS = 1000000


class _Field(c.Structure):
    _fields_ = [("path", c.c_char_p), ("least", c.c_double), ("most", c.c_double)]


class _Number(c.Structure):
    _fields_ = [("field", c.c_size_t), ("component", c.c_int), ("began", c.c_double), ("found", c.c_double)]


class _State(c.Structure):
    _fields_ = [("iterations", c.c_int), ("evaluations", c.c_int), ("moved", c.c_bool), ("misfit", c.c_double),
                ("numbers", c.POINTER(_Number)), ("count", c.c_size_t)]


_GO_ON = c.CFUNCTYPE(c.c_bool, c.c_void_p, c.POINTER(_State))


class _Request(c.Structure):
    _fields_ = [("scene", c.c_char_p), ("path", c.c_char_p), ("dt", c.c_double), ("particles", c.c_void_p),
                ("particle_count", c.c_size_t), ("steps", c.c_void_p), ("places", c.c_void_p), ("sample_count", c.c_size_t),
                ("fields", c.POINTER(_Field)), ("field_count", c.c_size_t), ("most_iterations", c.c_int),
                ("go_on", _GO_ON), ("user", c.c_void_p)]


class _Outcome(c.Structure):
    _fields_ = [("numbers", c.POINTER(_Number)), ("count", c.c_size_t), ("iterations", c.c_int), ("evaluations", c.c_int),
                ("began", c.c_double), ("misfit", c.c_double), ("end", c.c_int)]


class _Content(c.Structure):
    _fields_ = [("run", c.CFUNCTYPE(c.c_bool, c.POINTER(_Request), c.POINTER(_Outcome), c.POINTER(L.Error))),
                ("release", c.CFUNCTYPE(None, c.POINTER(_Outcome)))]


class _Module(c.Structure):
    _fields_ = [("version", c.c_char_p), ("real_size", c.c_size_t), ("content", c.POINTER(_Content))]


_STRUCTS = {"module": _Module, "content": _Content, "field": _Field, "number": _Number, "state": _State,
            "request": _Request, "outcome": _Outcome}


class Fit:
    """What skein.fit() found: `found` and `began`, dicts of the varied paths' values; `misfit` and `began_misfit`, the root
    of the mean squared distance from the target, m; `iterations` of L-BFGS and `runs`, each with its gradient; `scene`, a dict
    with what was found in it; and `end`: "converged", "iterations" (more would go on), "stuck" (no step gets nearer) or
    "interrupted" (by `progress`)."""

    __slots__ = ("found", "began", "misfit", "began_misfit", "iterations", "runs", "end", "scene")

    def __init__(self, **members):
        for name, value in members.items():
            setattr(self, name, value)

    def __repr__(self):
        found = ", ".join(f"{path} = {value:.6g}" if isinstance(value, float) else f"{path} = {value}"
                          for path, value in self.found.items())
        return f"<Fit, {self.end}: misfit {self.misfit:.4g} m after {self.iterations} iterations, {found}>"


# ---- the module ----


def _content():
    """What the module does; it stays loaded."""
    looked = [L.folder, os.path.dirname(L.folder)] if os.path.basename(L.folder) == "double" else [L.folder]
    path = next((path for path in (os.path.join(folder, "skein_fit.so") for folder in looked) if os.path.exists(path)), None)
    if path is None:
        raise FileFault([("no fit", "skein_fit.so", f"skein.fit() takes this module, which is not in {' or '.join(looked)}: the "
                          "package was built where liblbfgs was missing. 'apt install liblbfgs-dev', then build it again "
                          "('make wheel'); or let the command fit: skein fit SCENE --target CACHE.pc2 --vary PATH")])
    try:
        module = _Module.in_dll(c.CDLL(path), "skein_module")
    except (OSError, ValueError) as wrong:
        raise FileFault([("no fit", path, f"it cannot be loaded, install what is missing: {wrong}")]) from None
    if module.version != lib.py_version() or any(
            lib.py_fit_struct_size(name.encode()) != c.sizeof(struct) for name, struct in _STRUCTS.items()):
        raise FileFault([("no fit", path, "it is of another version of Skein: install the package anew")])
    return module.content.contents


# ---- what varies ----


def _bounds(path, pair):
    if pair is None:
        return -math.inf, math.inf
    try:
        least, most = pair
        least, most = -math.inf if least is None else float(least), math.inf if most is None else float(most)
        good = least < most
    except (TypeError, ValueError):
        good = False
    if not good:
        raise ValueFault([("invalid value", path, f"its bounds are {pair!r}: expected (least, most), the least below the most; "
                           "None is no bound")])
    return least, most


def _fields(vary, bounds):
    """As C has them, and their paths."""
    paths = [vary] if isinstance(vary, str) else list(vary)
    of_each = {**(vary if isinstance(vary, dict) else {}), **(bounds or {})}
    if not paths or not all(isinstance(path, str) for path in paths):
        raise ValueFault([("invalid value", "vary", "which fields are to be found? [\"bodies.0.stretch.stiffness\"], say")])
    for path in paths:
        if paths.count(path) > 1:
            raise ValueFault([("invalid value", path, "it is named twice")])
    for path in of_each:
        if path not in paths:
            raise NameFault([("no such name", path, "it has bounds, but is not one of those that vary: " + ", ".join(paths))])
    return (_Field * len(paths))(*[(path.encode(), *_bounds(path, of_each.get(path))) for path in paths]), paths


# ---- the target ----


def _body(world, body):
    """The body that is meant by a name or an index, or the only one."""
    if body is None:
        if len(world.bodies) != 1:
            raise ValueFault([("invalid value", "body", f"the scene has {len(world.bodies)} bodies: name the one that the target "
                               "shows")])
        body = 0
    return world.bodies[body]


def _particles(body, points, where):
    """The particle of each point, and which points count: of vertices that were joined only the first."""
    surface, all_points = body._surface(), np.arange(points)
    if points == surface.vertex_count:
        particles, first = np.unique(np.ctypeslib.as_array(surface.particle_of_vertex, (points,)), return_index=True)
        return particles.astype(np.uint32), first
    if points == surface.particle_count:
        return (surface.first_particle + all_points).astype(np.uint32), all_points
    raise ValueFault([("invalid value", where, f"it has {points} points: expected as many as the body has vertices "
                       f"({surface.vertex_count}) or particles ({surface.particle_count})")])


def _read_cache(path):
    """A PC2 file: its places, the frame of the first and the frames from one to the next."""
    count, timing, error = (c.c_uint32 * 2)(), (c.c_double * 2)(), L.Error()
    reader = lib.py_cache_open(os.fsencode(path), count, timing, c.byref(error))
    if not reader:
        raise of(error)
    try:
        places = np.empty((count[1], count[0], 3))
        for sample in range(count[1]):
            if lib.py_cache_read(reader, sample, places[sample].ctypes.data, c.byref(error)):
                raise of(error)
    finally:
        lib.py_cache_close(reader)
    return places, timing[0], timing[1]


def _samples(target, start):
    """Where points are, samples x points x 3; the frame of each sample; and what messages call it."""
    if isinstance(target, (str, bytes, os.PathLike)):
        places, first, rate = _read_cache(target)
        return places, (first if start is None else start) + rate * np.arange(len(places)), os.fsdecode(target)
    try:
        places = np.asarray(target, float)
    except (TypeError, ValueError):
        places = np.empty(0)
    if places.ndim != 3 or places.shape[2] != 3:
        raise ValueFault([("invalid value", "target", f"its shape is {places.shape}: expected frames x particles x 3, or the path "
                           "of a PC2 file")])
    return places, (start or 0) + np.arange(len(places)), "target"


def _axes(places, up, scale):
    """Back from the target's axes and unit."""
    if up not in ("y", "z"):
        raise ValueFault([("invalid value", "up", f"{up!r}: expected 'y' or 'z'")])
    if not 1e-6 <= scale <= 1e6:
        raise ValueFault([("invalid value", "scale", f"{scale!r}: expected a number, 1e-6 to 1e6")])
    return (places[..., [0, 2, 1]] * [1, 1, -1] if up == "z" else places) / scale


def _steps(frames, last, steps_per_frame, where):
    """After how many steps each sample is that is neither at the start, which is given, nor past the last; and which those are."""
    steps = frames * steps_per_frame
    early = frames <= (math.inf if last is None else last) + 1e-6
    if (steps <= -0.5).any():
        raise ValueFault([("invalid value", where, f"its first sample is at frame {frames[0]:g}, before the run begins")])
    within = early & (np.abs(steps - np.round(steps)) > 1e-3)
    if within.any():
        sample = int(np.argmax(within))
        raise ValueFault([("invalid value", where, f"sample {sample} is at frame {frames[sample]:g}, which is no end of a step: "
                           "change the scene's step")])
    kept = early & (steps > 0.5)
    if not kept.any():
        raise ValueFault([("invalid value", where, "it has no sample after the start" + (
            f" and up to frame {last}" if last is not None else ""))])
    return np.round(steps[kept]).astype(np.uintp), kept


# ---- the search ----


def _values(paths, numbers, count, member):
    """The numbers of each path: one, or an array of those that it has."""
    found = {path: [] for path in paths}
    for number in numbers[:count]:
        found[paths[number.field]].append(getattr(number, member))
    return {path: values[0] if len(values) == 1 else np.array(values) for path, values in found.items() if values}


class _Hearing:
    """What the module calls after each run, on a thread of its own."""

    def __init__(self, paths, progress):
        self.stopped, self.raised = False, None
        self.paths, self.progress = paths, progress

    def __call__(self, _, at):
        state = at.contents
        try:
            if self.progress and state.moved and not self.stopped:
                found = _values(self.paths, state.numbers, state.count, "found")
                self.stopped = self.progress(state.iterations, state.misfit, found) is False or self.stopped
        except BaseException as error:  # pylint: disable=broad-except
            self.stopped, self.raised = True, error
        return not self.stopped


def _search(content, request, hearing):
    """Runs the module on another thread, so that Ctrl-C is heard here: it ends after the run that is under way."""
    outcome, error = _Outcome(), L.Error()
    try:
        with concurrent.futures.ThreadPoolExecutor(1) as pool:
            task = pool.submit(content.run, c.byref(request), c.byref(outcome), c.byref(error))
            try:
                good = task.result()
            except BaseException:
                hearing.stopped = True
                raise
        if hearing.raised:
            raise hearing.raised
        if not good:
            raise of(error)
        return {"found": _values(hearing.paths, outcome.numbers, outcome.count, "found"),
                "began": _values(hearing.paths, outcome.numbers, outcome.count, "began"),
                "misfit": outcome.misfit, "began_misfit": outcome.began, "iterations": outcome.iterations,
                "runs": outcome.evaluations, "end": ENDS[outcome.end]}
    finally:
        content.release(c.byref(outcome))


def _scene_with(world, given, found):
    """The world's scene as a dict with what was found in it; what it wants written is as it was."""
    from ._scene import note
    note(world._owner.scene, [(path, value if isinstance(value, float) else value.tolist()) for path, value in found.items()])
    scene = json.loads(L.take_text(lib.py_scene_text_anywhere(world._owner.scene)))
    if given and "output" in given:
        scene["output"] = given["output"]
    return scene


def fit(scene, target, vary, bounds=None, iterations=50, *, body=None, frames=None, start=None, up="y", scale=1.0, sets=None,
        threads=0, progress=None):
    """Finds fields with which a scene moves like a target: stiffness, damping, gravity, wind or drag. Returns a Fit.

    scene: a dict, JSON, a path or a name. target: where a body's particles (or vertices) ought to be, an array of frames x
    particles x 3 whose first is frame `start` (0, the start of the run, if not given), or the path of a PC2 point cache,
    which says itself when it begins. vary: paths of fields, or a dict of path: (least, most), where None is no bound;
    bounds: such a dict for some of them. iterations: of L-BFGS, at most. body: the name of the one that the target shows, where
    there are several. frames: the last frame that counts; None, the target's last. up, scale: the target's axis that
    points up, "y" or "z", and its length of a metre. sets: changes of the scene, {"fps": 25}. progress: called
    as progress(iterations, misfit, found) after each iteration; False ends it with the best so far.

    It begins with the scene's own numbers and makes the mean squared distance from the target as small as it can, by the
    gradient of the run in double precision (docs/gradients.md: not every method and rule has one). Ctrl-C ends it."""
    from ._scene import _text, plain
    from ._world import World
    if isinstance(iterations, bool) or not isinstance(iterations, (int, np.integer)) or not 1 <= iterations <= MOST_ITERATIONS:
        raise ValueFault([("invalid value", "iterations", f"{iterations!r}: expected a whole number, 1 to {MOST_ITERATIONS}")])
    fields, paths = _fields(vary, bounds)
    content = _content()
    text, path = _text(scene)
    with World.from_scene(scene, sets or (), threads=threads) as world:
        places, at, where = _samples(target, start)
        particles, points = _particles(_body(world, body), places.shape[1], where)
        steps, kept = _steps(at, frames, world.steps_per_frame, where)
        places = np.ascontiguousarray(_axes(places[kept][:, points], up, scale))
        if not np.isfinite(places).all():
            sample, point = np.argwhere(~np.isfinite(places))[0][:2]
            raise ValueFault([("invalid value", where, f"sample {np.flatnonzero(kept)[sample]}, point {points[point]}: its place is "
                               "not finite")])
        document = json.loads(L.take_text(lib.py_scene_text_anywhere(world._owner.scene)))
        document = {name: value for name, value in document.items() if name not in ("view", "output")}
        if threads:
            document["threads"] = threads
        hearing = _Hearing(paths, progress)
        go_on = _GO_ON(hearing)
        request = _Request(json.dumps(document, default=plain).encode(), path.encode(), world.dt, particles.ctypes.data, len(particles),
                           steps.ctypes.data, places.ctypes.data, len(steps), fields, len(paths), int(iterations), go_on, None)
        found = _search(content, request, hearing)
        return Fit(**found, scene=_scene_with(world, json.loads(text) if text else None, found["found"]))
