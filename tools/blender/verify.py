# Checks in Blender that what skein writes lies where it was simulated: PC2, MDD, GLB, and the add-on.
# Run by tools/blender/verify: blender -b --factory-startup -P verify.py -- SKEIN FOLDER
#
# The truth is the CSV of the same run, text of another writer: every particle of every frame, y up, in metres. A Blender
# object has to be there to six digits: nowhere farther off than a millionth of the scene's size.

import csv
import json
import os
import random
import subprocess
import sys

import bpy
import numpy
from mathutils import Euler, Matrix, Vector

here = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, here)
import skein_addon  # noqa: E402

skein, folder = sys.argv[sys.argv.index("--") + 1:][:2]
FRAMES, FPS = 12, 24
if not hasattr(numpy, "bool"):
    numpy.bool = bool  # the glTF importer of Debian's Blender 3.4 asks for it; its numpy has it no more
faults = []


def run(*arguments):
    done = subprocess.run([skein, "run", *arguments, "--quiet"], capture_output=True, text=True)
    if done.returncode:
        raise SystemExit(f"skein run {' '.join(arguments)}: {done.stderr}")


def truth_of(path):
    """For each sample the places of its particles, in Blender's axes."""
    samples, last = [], None
    with open(path, newline="") as file:
        rows = csv.reader(line for line in file if not line.startswith("#"))
        for row in rows:
            try:
                time, x, y, z = row[0], float(row[2]), float(row[3]), float(row[4])
            except ValueError:
                continue  # the header
            if time != last:
                samples.append([])
                last = time
            samples[-1].append(Vector((x, -z, y)))
    return samples


def places_of(object_, frame):
    """Where Blender has the vertices at a frame, in the world."""
    scene = bpy.context.scene
    scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    mesh_object = object_.evaluated_get(graph)
    mesh = mesh_object.to_mesh()
    out = [mesh_object.matrix_world @ v.co for v in mesh.vertices]
    mesh_object.to_mesh_clear()
    return out


def compare(what, object_, truth, first=0, unit=1.0):
    worst, size, moved = 0.0, 0.0, 0.0
    for frame, ought in enumerate(truth):
        at = places_of(object_, first + frame)
        if len(at) != len(ought):
            faults.append(what)
            print(f"{what}: {len(at)} vertices, {len(ought)} in the run")
            return
        for a, b, start in zip(at, ought, truth[0]):
            worst = max(worst, (a * unit - b).length)
            size = max(size, b.length)
            moved = max(moved, (b - start).length)
    good = worst <= 1e-6 * max(size, 1) and len(truth) == FRAMES + 1 and moved > 0.05
    print(f"{what}: {len(truth)} frames, moved by up to {moved:.3f} m; farthest off {worst:.2e} m of {size:.2f} m"
          f"{'' if good else ': TOO FAR'}")
    if not good:
        faults.append(what)


def clear():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = FPS
    bpy.context.scene.frame_start, bpy.context.scene.frame_end = 0, FRAMES


def read_obj(path):
    """An object by the file's own numbers, as a modeller with z up would have it."""
    vertices, faces = [], []
    with open(path) as file:
        for line in file:
            words = line.split()
            if words[:1] == ["v"]:
                vertices.append([float(w) for w in words[1:4]])
            elif words[:1] == ["f"]:
                faces.append([int(w.split("/")[0]) - 1 for w in words[1:]])
    mesh = bpy.data.meshes.new("own")
    mesh.from_pydata(vertices, [], faces)
    object_ = bpy.data.objects.new("own", mesh)
    bpy.context.scene.collection.objects.link(object_)
    return object_


def lay(object_, path, kind):
    """The modifier as it comes, with nothing but the file's name and the first frame."""
    modifier = object_.modifiers.new("cache", "MESH_CACHE")
    modifier.cache_format, modifier.filepath, modifier.frame_start = kind, path, 0


def check_caches():
    out = os.path.join(folder, "caches")
    outputs = 'output=["pc2", "mdd", "obj", "csv"]'
    common = ("flag", "--frames", str(FRAMES), "--fps", str(FPS), "--set", outputs)
    run(*common, "--up", "z", "--out", out)
    truth = truth_of(os.path.join(out, "flag.csv"))
    for kind in ("PC2", "MDD"):
        clear()
        object_ = read_obj(os.path.join(out, "flag.obj"))
        lay(object_, os.path.join(out, "flag." + kind.lower()), kind)
        compare(f"{kind} with --up z, on an own object, all defaults", object_, truth)
    # y up, on what Blender's importer makes of the OBJ beside it
    out = os.path.join(folder, "y")
    run(*common, "--out", out)
    clear()
    bpy.ops.wm.obj_import(filepath=os.path.join(out, "flag.obj"))
    object_ = bpy.context.selected_objects[0]
    lay(object_, os.path.join(out, "flag.pc2"), "PC2")
    compare("PC2 with y up, on the OBJ as it is imported, all defaults", object_, truth)
    # half the size
    out = os.path.join(folder, "half")
    run(*common, "--up", "z", "--scale", "0.5", "--out", out)
    clear()
    object_ = read_obj(os.path.join(out, "flag.obj"))
    lay(object_, os.path.join(out, "flag.pc2"), "PC2")
    compare("PC2 with --up z --scale 0.5", object_, truth, unit=2.0)
    # glTF
    run("flag", "--frames", str(FRAMES), "--fps", str(FPS), "--out", os.path.join(folder, "flag.glb"))
    clear()
    bpy.ops.import_scene.gltf(filepath=os.path.join(folder, "flag.glb"))
    object_ = next(o for o in bpy.context.scene.objects if o.type == "MESH")
    compare("GLB, as it is imported", object_, truth)


def add_grid(n, placed, amplitude):
    """A sheet of n x n with a wave in it, its edge of least y in a vertex group."""
    vertices = [(x / (n - 1) - 0.5, y / (n - 1) - 0.5, amplitude * random.random()) for y in range(n) for x in range(n)]
    faces = [(y * n + x, y * n + x + 1, (y + 1) * n + x + 1, (y + 1) * n + x) for y in range(n - 1) for x in range(n - 1)]
    mesh = bpy.data.meshes.new("sheet")
    mesh.from_pydata(vertices, [], faces)
    object_ = bpy.data.objects.new("my sheet", mesh)
    bpy.context.scene.collection.objects.link(object_)
    object_.matrix_world = placed
    object_.vertex_groups.new(name="held").add(list(range(n)), 1.0, "REPLACE")
    return object_


def check_addon(cache, unit, moving):
    clear()
    scene, out = bpy.context.scene, os.path.join(folder, f"addon-{cache}-{unit}-{moving}")
    scene.frame_start, scene.frame_end = 5, 5 + FRAMES
    scene.unit_settings.scale_length = unit
    skein_addon.register()
    placed = Matrix.LocRotScale(Vector((0.3, -1.2, 2.0)), Euler((0.4, -0.3, 1.1)), Vector((1.5, 0.8, 1.2)))
    sheet = add_grid(12, placed, 0.02)
    sheet.modifiers.new("Smooth", "SUBSURF").show_viewport = False
    sheet.skein.role, sheet.skein.fabric, sheet.skein.pins = "CLOTH", "SILK", "held"
    if moving:  # the object itself is moved by keys: the cloth stays where it was simulated
        for frame, x in ((5, 0.3), (5 + FRAMES, 2.3)):
            sheet.location.x = x
            sheet.keyframe_insert("location", frame=frame)
    for name, shape, at in (("ball", "SPHERE", (0.3, -1.2, 1.2)), ("block", "BOX", (0.6, -1.5, 1.6))):
        bpy.ops.mesh.primitive_cube_add(size=0.5, location=at, rotation=(0.2, 0.5, 0.1))
        bpy.context.object.name = name
        bpy.context.object.skein.role, bpy.context.object.skein.shape = "COLLIDER", shape
    scene.skein.program, scene.skein.folder, scene.skein.cache, scene.skein.substeps = skein, out, cache, 30
    if bpy.ops.skein.simulate() != {"FINISHED"}:
        faults.append("the add-on")
    if sheet.modifiers[0].name != "Skein":
        faults.append("the modifier's place")
    # its own scene, run again, with the truth as text
    with open(os.path.join(out, "scene.json")) as file:
        written = json.load(file)
    assert len(written["bodies"][0]["pins"]) == 12 and written["fps"] == FPS and written["frames"] == FRAMES
    run(os.path.join(out, "scene.json"), "--set", 'output=["csv"]', "--out", os.path.join(out, "truth"))
    truth = truth_of(os.path.join(out, "truth", written["bodies"][0]["name"] + ".csv"))
    compare(f"add-on, {cache}, {unit} m a unit{', object moved by keys' if moving else ''}", sheet, truth, 5, unit)
    # pins are where the object had them, and the box in the scene is Blender's
    before = [placed @ v.co for v in sheet.data.vertices][:12]
    after = places_of(sheet, 5 + FRAMES)[:12]
    if max((a - b).length for a, b in zip(before, after)) > 1e-5:
        faults.append("pins")
        print("add-on: pins have moved")
    block = bpy.data.objects["block"]
    box = next(c for c in written["colliders"] if c["type"] == "box")
    axes = Euler([a * 3.141592653589793 / 180 for a in box["rotation"]], "XYZ").to_matrix()
    for corner in block.bound_box:
        own = skein_addon.TO_SKEIN @ (block.matrix_world @ Vector(corner)) * unit
        local = axes.transposed() @ (own - Vector(box["centre"]))
        if max(abs(abs(local[k]) - box["size"][k] / 2) for k in range(3)) > 1e-5:
            faults.append("the box")
            print("add-on: the box is not Blender's")
            break
    skein_addon.unregister()


random.seed(1)
check_caches()
check_addon("PC2", 1.0, False)
check_addon("MDD", 0.5, False)
check_addon("PC2", 1.0, True)
print("verify-blender: " + ("FAILED: " + ", ".join(faults) if faults else "all as simulated"))
