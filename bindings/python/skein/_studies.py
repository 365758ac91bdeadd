"""Studies: a scene run many times with fields varied, by the command's own code (docs/studies.md), into one array."""
import concurrent.futures
import ctypes
import json
import os
import threading

import numpy as np

from . import _library as L
from ._errors import FileFault, faults
from ._library import lib
from ._scene import plain, scene_path

_WORDS = ("outcome", "state_hash", "scene_hash", "skein", "precision", "command", "said")
_COUNTS = ("frames", "steps")


def _hearing():
    found = []
    return found, L.REPORT(lambda _, status, where, message: found.append(
        (status, where.decode(errors="replace"), message.decode(errors="replace"))))


def _column(values):
    """A column of numbers where all are; whole ones where all are whole; else of words."""
    if all(isinstance(value, int) and not isinstance(value, bool) for value in values):
        return np.array(values, np.int64)
    if all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values):
        return np.array(values, float)
    return np.array([value if isinstance(value, str) else json.dumps(value) for value in values])


def _table(about, results):
    """A structured array of all rows, in their order."""
    results = [results[row] for row in sorted(results)]
    columns = {"row": np.array([result["row"] for result in results], np.int64)}
    for v, path in enumerate(about["varied"]):
        columns[path] = _column([result["values"][v] for result in results])
    for m, name in enumerate(about["measures"]):
        columns[name] = np.array([np.nan if result["measures"][m] is None else result["measures"][m]
                                  for result in results], float)
    for name in _COUNTS:
        columns[name] = np.array([result[name] for result in results], np.int64)
    columns["time"] = np.array([result["time"] for result in results], float)
    for name in _WORDS:
        columns[name] = np.array([result[name] for result in results], str)
    columns["seconds"] = np.array([result["seconds"] for result in results], float)
    table = np.empty(len(results), [(name, column.dtype) for name, column in columns.items()])
    for name, column in columns.items():
        table[name] = column
    return table


def study(study, out=None, *, jobs=None, threads=1, progress=None):
    """Runs a study and returns a structured array with a row for each run: what was varied and measured, by its path and
    name, and what it takes to do it again (command, state_hash, ...).

    study: a dict, JSON, or the path of a file (docs/studies.md). out: a folder that keeps rows and tables; a study that
    was broken off goes on from there, whoever began it: Python or `skein study`. jobs: how many rows run at once; None,
    one a processor. threads: of each row. progress: called as progress(done, rows) after each row.

    Ctrl-C ends it after what is under way has heard of it; with `out` what was done is kept."""
    if isinstance(study, dict):
        text, path = json.dumps(study, default=plain).encode(), "study.json"
    elif isinstance(study, str) and study.lstrip().startswith("{"):
        text, path = study.encode(), "study.json"
    else:
        path = os.fspath(study)
        if not os.path.isfile(path):
            raise FileFault([("file", path, "there is no such file")])
        with open(path, "rb") as file:
            text = file.read()
    text = _with_scene(text, path)
    found, report = _hearing()
    opened = lib.py_study_open(text, len(text), path.encode(), report, None)
    if not opened:
        raise faults(found)
    try:
        return _run(opened, out, jobs, threads, progress)
    finally:
        lib.py_study_free(opened)


def _with_scene(text, path):
    """The same with the whole path of a scene that came with the package: only Python knows where these are."""
    try:
        about = json.loads(text)
        name = about["scene"]
        if isinstance(name, str) and not os.path.exists(os.path.join(os.path.dirname(path), name)):
            found = scene_path(name)
            if found:
                return json.dumps(dict(about, scene=os.path.abspath(found))).encode()
    except (ValueError, KeyError, TypeError):
        pass  # the reader has words for that
    return text


def _run(opened, out, jobs, threads, progress):
    found, report = _hearing()
    about = json.loads(L.take_text(lib.py_study_describe(opened)))
    if out is not None and not lib.py_study_keep(opened, os.fspath(out).encode(), report, None):
        raise faults(found)
    results = {}
    if out is not None:
        for row in range(about["rows"]):
            there = lib.py_study_row(opened, row)
            if there:
                results[row] = json.loads(L.take_text(there))
    missing = iter([row for row in range(about["rows"]) if row not in results])
    lock = threading.Lock()
    stopping = []

    def work():
        while not stopping:
            with lock:
                row = next(missing, None)
            if row is None:
                return
            text = L.take_text(lib.py_study_run(opened, row, threads))
            result = json.loads(text)
            if result["outcome"] == "stopped":
                return
            with lock:
                if out is not None and not lib.py_study_add(opened, text if isinstance(text, bytes) else text.encode(),
                                                            report, None):
                    stopping.append(True)
                    return
                results[row] = result
                if progress:
                    progress(len(results), about["rows"])

    count = max(1, min(jobs or os.cpu_count() or 1, about["rows"] - len(results)))
    try:
        if count == 1:
            work()
        else:
            with concurrent.futures.ThreadPoolExecutor(count) as pool:
                tasks = [pool.submit(work) for _ in range(count)]
                try:
                    for task in tasks:
                        task.result()
                except BaseException:
                    stopping.append(True)
                    lib.py_study_stop(opened)
                    raise
    finally:
        if out is not None and results and not found:
            lib.py_study_tables(opened, report, None)
    if found:
        raise faults(found)
    return _table(about, results)
