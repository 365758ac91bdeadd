#!/bin/sh
# The wheel as a user has it: wheel.sh ROOT PYTHON WHEEL COMMAND. In a clean virtual environment, offline (NumPy is the system's),
# far from the sources and without the variables that lead to a build:
#   1  it is installed, and is no pure package; the libraries that it asks for beyond its own are the C library's
#   2  a scene that comes along has the command's hash; stubs, scenes and their meshes are there; a picture is drawn
#   3  the notebooks run
#   4  the source distribution has what it is built from, and no binary
# Prints each fault, and fails if there is one. 77: a tool is missing.
set -u
cd "$1" || exit 2
root=$PWD python=$2 wheel=$(realpath "$3") command=$(realpath "$4")
"$python" -c 'import venv, ensurepip, numpy' 2>/dev/null || { echo "wheel: no venv or NumPy"; exit 77; }
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
faults=0
fault() {
    echo "wheel: $1"
    faults=$((faults + 1))
}
unset SKEIN_LIBRARY PYTHONPATH SKEIN_SCENES
case $wheel in *-py3-none-linux_*.whl) ;; *) fault "a name of another sort: $wheel" ;; esac

"$python" -m venv --system-site-packages "$work/env" || exit 2
PIP_NO_INDEX=1 "$work/env/bin/pip" install -q --no-index --disable-pip-version-check "$wheel" || fault "pip cannot install it"
cd "$work" || exit 2
here=$("$work/env/bin/python" -c 'import os, skein; print(os.path.dirname(skein.__file__))') || fault "it cannot be imported"
case $here in "$work"/env/*) ;; *) fault "another package was imported: $here" ;; esac
for library in $(ldd "$here/libskein.so" "$here/skein_fit.so" | awk '/=>/ && $3 ~ "^/" { print $3 }'); do
    case $library in
    "$here"/* | */libc.so* | */libm.so* | */libdl.so* | */libpthread.so*) ;;
    *) fault "it asks for $library" ;;
    esac
done
cat >use.py <<'PYTHON'
import json, os, subprocess, sys
import skein

assert "drape" in skein.scenes() and "elephant" not in skein.scenes(), skein.scenes()
folder = os.path.dirname(skein.__file__)
for name in ("__init__.pyi", "py.typed", "libjansson.so.4", "libjansson.copyright", "skein_fit.so", "liblbfgs.copyright"):
    assert os.path.exists(os.path.join(folder, name)), name
for name in skein.scenes():
    skein.World.from_scene(name).close()
world = skein.World.from_scene("drape")
world.frame(20)
run = [sys.argv[1], "run", os.path.join(folder, "scenes", "drape.json"), "--frames", "20", "--quiet", "--json"]
want = json.loads(subprocess.run(run, capture_output=True, check=True).stdout)["state_hash"]
assert world.hash() == want, (world.hash(), want)
if os.path.exists(os.path.join(folder, "libskein_draw.so")):
    assert len(set(world.render(size=(64, 36), samples=1).reshape(-1).tolist())) > 10
PYTHON
"$work/env/bin/python" -W error use.py "$command" || fault "use.py"
for notebook in "$root"/bindings/python/notebooks/*.ipynb; do
    "$work/env/bin/python" "$root/bindings/python/tests/run_notebook.py" "$notebook" >said 2>&1 || {
        cat said
        fault "$(basename "$notebook")"
    }
done

source=$(echo "$wheel" | sed 's/-py3-none.*/.tar.gz/')
tar -tzf "$source" >list || fault "no source distribution"
for file in setup.py skein/__init__.py source/CMakeLists.txt source/src/catalogue.c source/bindings/python/exports.c source/bindings/python/fit.map source/fit/fit.c; do
    grep -q "^skein-[^/]*/$file\$" list || fault "the source distribution lacks $file"
done
! grep '[.]so' list || fault "the source distribution has binaries"
echo "wheel: $(wc -c <"$wheel") bytes, $(ls "$root"/bindings/python/notebooks/*.ipynb | wc -l) notebooks, $faults faults"
[ $faults -eq 0 ]
