"""Runs the cells of notebooks in order, each notebook in one namespace, as Jupyter would: run_notebook.py NOTEBOOK...

A cell's last line, if it is an expression, is shown as Jupyter shows it (its picture is made, too). A cell that fails ends
the run with its place. No Jupyter is needed.
"""
import ast
import json
import os
import sys
import tempfile


def show(value):
    """What Jupyter would ask it for; returns what there is to see."""
    for name in "_repr_mimebundle_", "_repr_png_":
        if hasattr(value, name):
            return getattr(value, name)() is not None
    return value is not None and print(repr(value)[:2000]) is None


def run(path):
    with open(path, encoding="utf-8") as file:
        notebook = json.load(file)
    if notebook["nbformat"] != 4:
        raise SystemExit(f"{path}: nbformat {notebook['nbformat']}, expected 4")
    namespace, shown = {"__name__": "__main__"}, 0
    for number, cell in enumerate(notebook["cells"]):
        if cell["cell_type"] != "code":
            continue
        place = f"{os.path.basename(path)}, cell {number}"
        tree = ast.parse("".join(cell["source"]), place)
        last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
        exec(compile(tree, place, "exec"), namespace)
        if last:
            shown += bool(show(eval(compile(ast.Expression(last.value), place, "eval"), namespace)))
    return namespace, shown


if __name__ == "__main__":
    if len(sys.argv) < 2:
        raise SystemExit(__doc__)
    for given in map(os.path.abspath, sys.argv[1:]):
        with tempfile.TemporaryDirectory() as scratch:
            os.chdir(scratch)
            print(f"{given}: {run(given)[1]} results shown")
            os.chdir("/")
