# Skein in Blender: cloth of meshes, colliders, pins by vertex groups; the motion is laid on the objects themselves.
#
# Install it in Preferences > Add-ons > Install. Needs Blender 3.4 or later and the command skein; no graphics card. The
# panel is in the 3D view's sidebar (N), tab Skein.
#
# What it does: writes the meshes as they stand in the world at the scene's first frame (OBJ, metres, y up) and a scene
# (JSON) into a folder, runs `skein run`, and turns the point cache back into each object's own coordinates, frame by
# frame, whatever its place, turn and scale are. A Mesh Cache modifier, the first in the stack, plays it. Without Blender's
# own window (blender -b) the operator waits for the end; tools/blender/verify.py runs it so.
#
# Colliders stand still, as balls, boxes or planes. Pins stay where they are at the first frame.

bl_info = {
    "name": "Skein",
    "description": "Cloth by Skein: simulate meshes and lay the motion on them",
    "version": (0, 1, 0),
    "blender": (3, 4, 0),
    "location": "3D View > Sidebar > Skein",
    "category": "Physics",
}

import array
import json
import math
import os
import re
import shutil
import struct
import subprocess
import sys
import threading

import bpy
from mathutils import Matrix, Vector

# Blender's x, y, z are Skein's x, z, -y.
TO_SKEIN = Matrix(((1, 0, 0), (0, 0, 1), (0, -1, 0)))

# kg/m2, N/m along and across the threads, N m
FABRICS = {
    "COTTON": ("Cotton", 0.2, 20000.0, 2000.0, 1e-5),
    "SILK": ("Silk", 0.08, 8000.0, 300.0, 1e-6),
    "DENIM": ("Denim", 0.4, 40000.0, 8000.0, 5e-5),
    "LEATHER": ("Leather", 0.9, 60000.0, 30000.0, 5e-4),
    "RUBBER": ("Rubber", 0.5, 800.0, 400.0, 2e-5),
}


def use_fabric(settings, context):
    if settings.fabric in FABRICS:
        _, settings.density, settings.stretch, settings.shear, settings.bend = FABRICS[settings.fabric]


class SkeinObject(bpy.types.PropertyGroup):
    """What an object is to Skein."""

    role: bpy.props.EnumProperty(
        name="Role", items=[("NONE", "None", "Not simulated"), ("CLOTH", "Cloth", "Moves"),
                            ("COLLIDER", "Collider", "Cloth falls on it")])
    fabric: bpy.props.EnumProperty(
        name="Fabric", items=[(key, row[0], "") for key, row in FABRICS.items()], update=use_fabric)
    density: bpy.props.FloatProperty(name="Density", description="kg of a square metre", default=0.2, min=1e-4)
    stretch: bpy.props.FloatProperty(name="Stretch", description="N/m along the threads", default=20000, min=0)
    shear: bpy.props.FloatProperty(name="Shear", description="N/m across the threads", default=2000, min=0)
    bend: bpy.props.FloatProperty(name="Bend", description="rigidity in N m", default=1e-5, min=0, precision=7)
    pins: bpy.props.StringProperty(name="Pins", description="Vertices of this group are held")
    shape: bpy.props.EnumProperty(
        name="Shape", items=[("SPHERE", "Ball", "As wide as the object's largest side"),
                             ("BOX", "Box", "The object's bounding box"),
                             ("PLANE", "Plane", "All below the object's own x-y plane is solid")])
    friction: bpy.props.FloatProperty(name="Friction", default=0.3, min=0)
    thickness: bpy.props.FloatProperty(name="Thickness", description="cloth is kept so far off", default=0.002, min=0,
                                       unit="LENGTH", precision=4)


class SkeinScene(bpy.types.PropertyGroup):
    """How a scene is run."""

    program: bpy.props.StringProperty(name="Program", subtype="FILE_PATH", description="skein; empty: where PATH has it")
    folder: bpy.props.StringProperty(name="Folder", subtype="DIR_PATH", default="//skein",
                                     description="The scene, meshes and caches go there")
    substeps: bpy.props.IntProperty(name="Substeps", default=20, min=1, max=1000)
    air: bpy.props.FloatProperty(name="Air", description="drag of the air, 1/s", default=0.4, min=0)
    cache: bpy.props.EnumProperty(name="Cache", items=[("PC2", "PC2", ""), ("MDD", "MDD", "")])


class Fault(Exception):
    """What the user has to mend."""


# ---- Out to Skein -----------------------------------------------------------------------------------------

def numbers(vector):
    return [float(x) for x in vector]


def write_obj(path, mesh, to_skein):
    """All vertices, in their order, and all polygons."""
    with open(path, "w", encoding="ascii") as file:
        for vertex in mesh.vertices:
            file.write("v %.9g %.9g %.9g\n" % tuple(to_skein @ vertex.co))
        for polygon in mesh.polygons:
            file.write("f " + " ".join(str(v + 1) for v in polygon.vertices) + "\n")


def pins_of(object_):
    settings = object_.skein
    if not settings.pins:
        return []
    group = object_.vertex_groups.get(settings.pins)
    if group is None:
        raise Fault(f"{object_.name} has no vertex group '{settings.pins}': choose another one under Pins")
    return [v.index for v in object_.data.vertices if any(g.group == group.index and g.weight > 0 for g in v.groups)]


def describe_cloth(object_, name, to_skein, folder):
    if object_.type != "MESH" or not object_.data.polygons:
        raise Fault(f"{object_.name} is no mesh with faces: a cloth has to be one")
    write_obj(os.path.join(folder, name + ".obj"), object_.data, to_skein)
    s = object_.skein
    body = {"type": "cloth", "name": name, "mesh": name + ".obj", "density": s.density,
            "stretch": {"stiffness": s.stretch}, "shear": {"stiffness": s.shear}, "bend": {"rigidity": s.bend}}
    pins = pins_of(object_)
    if pins:
        body["pins"] = pins
    return body


def describe_collider(object_, matrix, unit):
    """`matrix`: the object's, to Skein's axes in metres."""
    s = object_.skein
    base = {"name": object_.name, "friction": s.friction, "thickness": s.thickness * unit}
    corners = [Vector(c) for c in object_.bound_box]
    middle = matrix @ (sum(corners, Vector()) / 8)
    place, turn, scale = matrix.decompose()
    if s.shape == "PLANE":
        normal = turn @ Vector((0, 0, 1))
        return dict(base, type="plane", normal=numbers(normal), offset=float(normal.dot(place)))
    sides = [abs(scale[k]) * (max(c[k] for c in corners) - min(c[k] for c in corners)) for k in range(3)]
    if s.shape == "SPHERE":
        return dict(base, type="sphere", centre=numbers(middle), radius=max(sides) / 2)
    angles = turn.to_euler("XYZ")
    return dict(base, type="box", centre=numbers(middle), size=[max(x, 1e-6) for x in sides],
                rotation=[math.degrees(a) for a in angles])


def safe_name(name, place):
    return f"{place}_" + re.sub(r"[^A-Za-z0-9_-]", "_", name)


class Run:
    """One simulation: files, process, and what comes back."""

    def __init__(self, context):
        scene, settings = context.scene, context.scene.skein
        self.scene = scene
        self.unit = scene.unit_settings.scale_length or 1.0
        self.frames = scene.frame_end - scene.frame_start
        self.first = scene.frame_start
        self.done = 0
        self.said = []
        self.process = None
        self.folder = self.find_folder(settings.folder)
        self.program = self.find_program(settings.program)
        scene.frame_set(self.first)
        self.cloths = {}
        self.write_scene(context)

    @staticmethod
    def find_folder(given):
        if given.startswith("//") and not bpy.data.filepath:
            raise Fault("save the file first, or give a folder that does not begin with //")
        folder = bpy.path.abspath(given)
        os.makedirs(folder, exist_ok=True)
        return folder

    @staticmethod
    def find_program(given):
        program = bpy.path.abspath(given) if given else shutil.which("skein")
        if not program or not os.access(program, os.X_OK):
            raise Fault(f"there is no program {given or 'skein on the PATH'}: name it in the panel, under Program")
        return program

    def write_scene(self, context):
        settings = context.scene.skein
        to_metres = TO_SKEIN.to_4x4() @ Matrix.Scale(self.unit, 4)
        bodies, colliders = [], []
        for object_ in context.scene.objects:
            matrix = to_metres @ object_.matrix_world
            if object_.skein.role == "CLOTH":
                name = safe_name(object_.name, len(bodies))
                bodies.append(describe_cloth(object_, name, matrix, self.folder))
                self.cloths[name] = object_
            elif object_.skein.role == "COLLIDER":
                colliders.append(describe_collider(object_, matrix, self.unit))
        if not bodies:
            raise Fault("no object is a cloth: choose one, and set its role in the panel")
        if self.frames < 1:
            raise Fault("the scene has one frame only: set its last frame")
        forces = []
        if context.scene.use_gravity:
            forces.append({"type": "gravity", "acceleration": numbers(TO_SKEIN @ context.scene.gravity * self.unit)})
        if settings.air > 0:
            forces.append({"type": "drag", "rate": settings.air})
        render = context.scene.render
        scene = {"skein": 1, "name": "blender", "frames": self.frames, "fps": render.fps / render.fps_base,
                 "method": {"type": "xpbd", "substeps": settings.substeps}, "bodies": bodies, "forces": forces,
                 "colliders": colliders, "output": ["pc2"]}
        self.path = os.path.join(self.folder, "scene.json")
        with open(self.path, "w", encoding="utf-8") as file:
            json.dump(scene, file, indent=2)

    # ---- The process ----

    def start(self):
        command = [self.program, "run", self.path, "--out", os.path.join(self.folder, "out"), "--up", "z", "--scale",
                   repr(1 / self.unit)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                        encoding="utf-8", errors="replace")
        self.reader = threading.Thread(target=self.listen, daemon=True)
        self.reader.start()

    def listen(self):
        for line in self.process.stdout:
            for part in line.replace("\r", "\n").splitlines():
                progress = re.search(r"frame (\d+) of \d+", part)
                if progress:
                    self.done = int(progress.group(1))
                elif part.strip():
                    self.said.append(part.strip())

    def finish(self):
        status = self.process.wait()
        self.reader.join()
        if status != 0:
            raise Fault("skein: " + (" / ".join(self.said[-3:]) or f"it ended with {status}"))
        for name, object_ in self.cloths.items():
            self.lay(name, object_)

    # ---- Back on the objects ----

    def matrices(self, object_):
        """For each frame from the world to the object."""
        moves = any(o.animation_data or o.constraints for o in self.line_of(object_))
        out = []
        for frame in range(self.frames + 1):
            if moves or not out:
                self.scene.frame_set(self.first + frame)
                out.append(object_.matrix_world.inverted())
            else:
                out.append(out[0])
        self.scene.frame_set(self.first)
        return out

    @staticmethod
    def line_of(object_):
        while object_:
            yield object_
            object_ = object_.parent

    def lay(self, name, object_):
        points, samples = read_pc2(os.path.join(self.folder, "out", name + ".pc2"))
        if points != len(object_.data.vertices):
            raise Fault(f"{object_.name} has {len(object_.data.vertices)} vertices, its motion {points}: run it again")
        own = [turn(sample, matrix) for sample, matrix in zip(samples, self.matrices(object_))]
        kind = self.scene.skein.cache
        path = os.path.join(self.folder, name + "." + kind.lower())
        render = self.scene.render
        (write_pc2 if kind == "PC2" else write_mdd)(path, points, own, render.fps / render.fps_base)
        modifier = object_.modifiers.get("Skein") or object_.modifiers.new("Skein", "MESH_CACHE")
        modifier.cache_format = kind
        modifier.filepath = path
        modifier.frame_start = self.first
        modifier.forward_axis, modifier.up_axis = "POS_Y", "POS_Z"  # as they come: nothing is turned
        modifier.interpolation, modifier.deform_mode = "LINEAR", "OVERWRITE"
        modifier.time_mode, modifier.play_mode = "FRAME", "SCENE"
        with bpy.context.temp_override(object=object_, active_object=object_):
            bpy.ops.object.modifier_move_to_index(modifier=modifier.name, index=0)


def floats(data, big=False):
    out = array.array("f", data)
    if (sys.byteorder == "little") == big:
        out.byteswap()
    return out


def read_pc2(path):
    with open(path, "rb") as file:
        head = file.read(32)
        if head[:12] != b"POINTCACHE2\0":
            raise Fault(f"{path} is no PC2 file")
        points, samples = struct.unpack("<i8xi", head[16:32])
        return points, [floats(file.read(12 * points)) for _ in range(samples)]


def turn(sample, matrix):
    """Points by a matrix."""
    rows = [tuple(row) for row in matrix]
    out = array.array("f", bytes(4 * len(sample)))
    for i in range(0, len(sample), 3):
        x, y, z = sample[i:i + 3]
        for k in range(3):
            a, b, c, d = rows[k]
            out[i + k] = a * x + b * y + c * z + d
    return out


def write_whole(path, parts):
    """Under its name only when all is there."""
    with open(path + ".part", "wb") as file:
        for part in parts:
            file.write(part)
    os.replace(path + ".part", path)


def in_order(sample, big):
    if (sys.byteorder == "little") == big:
        sample = array.array("f", sample)
        sample.byteswap()
    return sample.tobytes()


def write_pc2(path, points, samples, fps):
    head = struct.pack("<12siiffi", b"POINTCACHE2\0", 1, points, 0.0, 1.0, len(samples))
    write_whole(path, [head] + [in_order(s, False) for s in samples])


def write_mdd(path, points, samples, fps):
    times = struct.pack(f">{len(samples)}f", *(i / fps for i in range(len(samples))))
    write_whole(path, [struct.pack(">ii", len(samples), points), times] + [in_order(s, True) for s in samples])


# ---- Operators and the panel ---------------------------------------------------------------------------------

class SKEIN_OT_simulate(bpy.types.Operator):
    """Simulate all cloth of the scene, from its first frame to its last, and lay the motion on it (Esc ends it)"""

    bl_idname = "skein.simulate"
    bl_label = "Simulate"
    bl_options = {"REGISTER", "UNDO"}

    def begin(self, context):
        try:
            self.run = Run(context)
            self.run.start()
            return True
        except (Fault, OSError) as fault:
            self.report({"ERROR"}, str(fault))
            return False

    def end(self):
        try:
            self.run.finish()
        except (Fault, OSError) as fault:
            self.report({"ERROR"}, str(fault))
            return {"CANCELLED"}
        self.report({"INFO"}, f"{self.run.frames} frames of {len(self.run.cloths)} cloth in {self.run.folder}")
        return {"FINISHED"}

    def execute(self, context):
        return self.end() if self.begin(context) else {"CANCELLED"}

    def invoke(self, context, event):
        if not self.begin(context):
            return {"CANCELLED"}
        self.timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.progress_begin(0, self.run.frames)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        manager = context.window_manager
        ended = self.run.process.poll() is not None
        if event.type == "ESC":
            self.run.process.terminate()
            self.run.process.wait()
            self.report({"WARNING"}, "ended by Esc: nothing is laid on the objects")
        if event.type == "TIMER" and not ended:
            manager.progress_update(self.run.done)
            context.workspace.status_text_set(f"Skein: frame {self.run.done} of {self.run.frames}; Esc ends it")
        if event.type != "ESC" and not ended:
            return {"PASS_THROUGH"}
        manager.event_timer_remove(self.timer)
        manager.progress_end()
        context.workspace.status_text_set(None)
        return {"CANCELLED"} if event.type == "ESC" else self.end()


class SKEIN_PT_panel(bpy.types.Panel):
    bl_label = "Skein"
    bl_space_type = "VIEW_3D"
    bl_region_type = "UI"
    bl_category = "Skein"

    def draw(self, context):
        layout, object_ = self.layout, context.object
        layout.use_property_split = True
        if object_ and object_.type == "MESH":
            s = object_.skein
            layout.label(text=object_.name, icon="OBJECT_DATA")
            layout.prop(s, "role")
            if s.role == "CLOTH":
                for name in ("fabric", "density", "stretch", "shear", "bend"):
                    layout.prop(s, name)
                layout.prop_search(s, "pins", object_, "vertex_groups")
            elif s.role == "COLLIDER":
                for name in ("shape", "friction", "thickness"):
                    layout.prop(s, name)
            layout.separator()
        for name in ("program", "folder", "substeps", "air", "cache"):
            layout.prop(context.scene.skein, name)
        layout.operator("skein.simulate", icon="PLAY")


classes = (SkeinObject, SkeinScene, SKEIN_OT_simulate, SKEIN_PT_panel)


def register():
    for class_ in classes:
        bpy.utils.register_class(class_)
    bpy.types.Object.skein = bpy.props.PointerProperty(type=SkeinObject)
    bpy.types.Scene.skein = bpy.props.PointerProperty(type=SkeinScene)


def unregister():
    del bpy.types.Object.skein
    del bpy.types.Scene.skein
    for class_ in reversed(classes):
        bpy.utils.unregister_class(class_)


if __name__ == "__main__":
    register()
