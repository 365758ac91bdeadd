"""The library by ctypes: where it is found, its structs and the calls of its header.

Each function has the types of include/skein/skein.h. ctypes lets go of the interpreter's lock during every call. The
library lies beside this file, and in the folder double another of its kind, which SKEIN_PRECISION=double asks for;
SKEIN_LIBRARY names another place (a folder or a file).
"""
import ctypes as c
import os

import numpy as np

# ---- structs ----


class Error(c.Structure):
    _fields_ = [("status", c.c_int), ("where", c.c_char * 256), ("message", c.c_char * 512)]


class Field(c.Structure):
    _fields_ = [("name", c.c_char_p), ("type", c.c_int), ("offset", c.c_size_t), ("unit", c.c_char_p),
                ("initial", c.c_double * 3), ("least", c.c_double), ("most", c.c_double), ("choices", c.c_char_p),
                ("text", c.c_char_p), ("help", c.c_char_p)]


class Kind(c.Structure):
    _fields_ = [("name", c.c_char_p), ("help", c.c_char_p), ("category", c.c_int), ("fields", c.POINTER(Field)),
                ("field_count", c.c_size_t), ("params_size", c.c_size_t)]


class Value(c.Structure):
    _fields_ = [("count", c.c_int), ("number", c.c_double * 3), ("text", c.c_char_p)]


class Setting(c.Structure):
    _fields_ = [("name", c.c_char_p), ("value", Value)]


class Handle(c.Structure):
    _fields_ = [("index", c.c_uint32), ("generation", c.c_uint32), ("world", c.c_uint64)]

    def key(self):
        return self.index, self.generation, self.world


LOG = c.CFUNCTYPE(None, c.c_void_p, c.c_int, c.c_char_p)
REPORT = c.CFUNCTYPE(None, c.c_void_p, c.c_int, c.c_char_p, c.c_char_p)
WRITE = c.CFUNCTYPE(None, c.c_void_p, c.c_char_p)
PUT = c.CFUNCTYPE(c.c_bool, c.c_void_p, c.c_void_p, c.c_size_t)


class WorldDesc(c.Structure):
    _fields_ = [("allocate", c.c_void_p), ("release", c.c_void_p), ("memory_user", c.c_void_p), ("log", LOG),
                ("log_user", c.c_void_p), ("run_tasks", c.c_void_p), ("tasks_user", c.c_void_p),
                ("thread_count", c.c_int), ("kinds", c.c_void_p)]


class Mesh(c.Structure):
    _fields_ = [("positions", c.POINTER(c.c_double)), ("vertex_count", c.c_size_t),
                ("face_sizes", c.POINTER(c.c_uint32)), ("face_count", c.c_size_t),
                ("face_vertices", c.POINTER(c.c_uint32)), ("face_vertex_count", c.c_size_t)]


class Track(c.Structure):
    _fields_ = [("particles", c.POINTER(c.c_uint32)), ("places", c.POINTER(c.c_double)), ("particle_count", c.c_size_t),
                ("sample_count", c.c_size_t), ("interval", c.c_double)]


class View(c.Structure):
    _fields_ = [("xyzw", c.c_void_p), ("slot_of", c.c_void_p), ("count", c.c_size_t)]


class Buffer(c.Structure):
    _fields_ = [("data", c.c_void_p), ("stride", c.c_size_t), ("type", c.c_int)]


class Surface(c.Structure):
    _fields_ = [("first_particle", c.c_uint32), ("particle_count", c.c_uint32),
                ("particle_of_vertex", c.POINTER(c.c_uint32)), ("vertex_count", c.c_size_t),
                ("face_sizes", c.POINTER(c.c_uint32)), ("face_count", c.c_size_t),
                ("face_vertices", c.POINTER(c.c_uint32)), ("face_vertex_count", c.c_size_t),
                ("grid_rows", c.c_uint32), ("grid_columns", c.c_uint32), ("corner_uv", c.POINTER(c.c_float))]


class Cuts(c.Structure):
    _fields_ = [("face", c.POINTER(c.c_uint8)), ("count", c.c_size_t), ("changes", c.c_uint64)]


class Recorder(c.Structure):
    _fields_ = [("write", PUT), ("user", c.c_void_p), ("note", c.c_char_p)]


class Difference(c.Structure):
    _fields_ = [("steps", c.c_uint64), ("found", c.c_bool), ("exact", c.c_bool), ("position", c.c_bool),
                ("velocity", c.c_bool), ("particle", c.c_uint32), ("blocks", c.c_uint32), ("body", Handle),
                ("is_whole", c.c_bool), ("stopped", c.c_char * 160)]


class Pass(c.Structure):
    _fields_ = [("kind", c.c_char_p), ("label", c.c_char * 64), ("seconds", c.c_double)]


class Pose(c.Structure):
    _fields_ = [("position", c.c_double * 3), ("rotation", c.c_double * 9)]


class Triangles(c.Structure):
    _fields_ = [("vertices", c.POINTER(c.c_uint32)), ("count", c.c_size_t), ("vertex_count", c.c_size_t)]


class Contact(c.Structure):
    _fields_ = [("particle", c.c_uint32), ("collider", Handle), ("normal", c.c_double * 3), ("gap", c.c_double)]


class SurfaceContact(c.Structure):
    _fields_ = [("rule", Handle), ("edges", c.c_bool), ("particle", c.c_uint32 * 4), ("weight", c.c_double * 4),
                ("normal", c.c_double * 3), ("gap", c.c_double), ("thickness", c.c_double)]


class Hit(c.Structure):
    _fields_ = [("t", c.c_double), ("point", c.c_double * 3), ("normal", c.c_double * 3), ("object", Handle),
                ("face", c.c_size_t), ("particle", c.c_uint32)]


class Order(c.Structure):
    _fields_ = [("count", c.c_size_t), ("polarization", c.c_double), ("milling", c.c_double), ("nearest", c.c_double),
                ("groups", c.c_size_t), ("radius", c.c_double), ("farthest", c.c_double), ("speed", c.c_double)]


class ConstraintValue(c.Structure):
    _fields_ = [("value", c.c_double), ("by_time", c.c_double), ("stiffness", c.c_double), ("is_energy", c.c_bool),
                ("one_sided", c.c_bool), ("guarded", c.c_bool), ("particle_count", c.c_size_t), ("label", c.c_char_p),
                ("text", c.c_char_p)]


class GradientState(c.Structure):
    _fields_ = [("step", c.c_size_t), ("time", c.c_double), ("particle_count", c.c_size_t),
                ("positions", c.POINTER(c.c_double)), ("velocities", c.POINTER(c.c_double)),
                ("by_positions", c.POINTER(c.c_double)), ("by_velocities", c.POINTER(c.c_double))]


MEASURE = c.CFUNCTYPE(c.c_double, c.c_void_p, c.POINTER(GradientState))


class GradientDesc(c.Structure):
    _fields_ = [("dt", c.c_double), ("steps", c.c_size_t), ("measure", MEASURE), ("user", c.c_void_p),
                ("fields", c.POINTER(c.c_char_p)), ("most_bytes", c.c_size_t)]


class GradientResult(c.Structure):
    _fields_ = [("value", c.c_double), ("by_positions", c.c_void_p), ("by_velocities", c.c_void_p),
                ("by_field", c.c_void_p)]


STRUCTS = {"error": Error, "field": Field, "kind": Kind, "value": Value, "setting": Setting, "handle": Handle,
           "world_desc": WorldDesc, "mesh": Mesh, "track": Track, "view": View, "buffer": Buffer, "surface": Surface, "cuts": Cuts,
           "recorder": Recorder, "difference": Difference, "pass": Pass,
           "pose": Pose, "contact": Contact, "hit": Hit, "order": Order,
           "constraint_value": ConstraintValue, "gradient_state": GradientState, "gradient_desc": GradientDesc,
           "gradient_result": GradientResult}

# ---- calls ----

world, size, text, status = c.c_void_p, c.c_size_t, c.c_char_p, c.c_int
array, error, settings, handle = c.c_void_p, c.POINTER(Error), c.POINTER(Setting), c.POINTER(Handle)

CALLS = {
    "skein_status_text": (text, [status]),
    "skein_version": (c.c_int, []),
    "skein_kind_at": (c.POINTER(Kind), [c.c_int, size]),
    "skein_kind_find": (c.POINTER(Kind), [c.c_int, text, error]),
    "skein_category_text": (text, [c.c_int]),
    "skein_common_fields": (c.POINTER(Field), [c.c_int, c.POINTER(size)]),
    "skein_kind_takes": (c.c_bool, [c.POINTER(Kind), text]),
    "skein_field_find": (c.POINTER(Field), [c.POINTER(Kind), text, error]),
    "skein_default_world_desc": (WorldDesc, []),
    "skein_world_destroy": (None, [world]),
    "skein_world_error": (c.POINTER(Error), [world]),
    "skein_particles_add": (status, [world, size, array, array, array, c.POINTER(c.c_uint32)]),
    "skein_body_add": (status, [world, text, c.POINTER(Mesh), settings, handle]),
    "skein_constraint_add": (status, [world, text, array, size, settings, handle]),
    "skein_constraint_arity": (status, [world, text, settings, c.POINTER(size)]),
    "skein_force_add": (status, [world, text, settings, handle]),
    "skein_collider_add": (status, [world, text, settings, handle]),
    "skein_motion_add": (status, [world, text, c.POINTER(Track), settings, handle]),
    "skein_method_set": (status, [world, text, settings]),
    "skein_remove": (status, [world, Handle]),
    "skein_set": (status, [world, Handle, text, Value]),
    "skein_get": (status, [world, Handle, text, c.POINTER(Value)]),
    "skein_field_is_live": (c.c_bool, [world, Handle, text]),
    "skein_object_count": (size, [world, c.c_int]),
    "skein_object_at": (Handle, [world, c.c_int, size]),
    "skein_object_kind": (c.POINTER(Kind), [world, Handle]),
    "skein_handle_valid": (c.c_bool, [world, Handle]),
    "skein_get_path": (status, [world, text, c.POINTER(Value)]),
    "skein_gradient": (status, [world, c.POINTER(GradientDesc), c.POINTER(GradientResult)]),
    "skein_world_reset": (status, [world]),
    "skein_world_time": (c.c_double, [world]),
    "skein_world_time_set": (status, [world, c.c_double]),
    "skein_particle_count": (size, [world]),
    "skein_particle_present": (c.c_bool, [world, size]),
    "skein_body_asleep": (c.c_bool, [world, Handle]),
    "skein_positions_copy": (status, [world, size, size, array]),
    "skein_velocities_copy": (status, [world, size, size, array]),
    "skein_positions_built": (status, [world, size, size, array]),
    "skein_positions_copy_to": (status, [world, size, size, Buffer]),
    "skein_velocities_copy_to": (status, [world, size, size, Buffer]),
    "skein_positions_set": (status, [world, size, size, array]),
    "skein_velocities_set": (status, [world, size, size, array]),
    "skein_particle_pin": (status, [world, size, c.c_bool]),
    "skein_pins_move": (status, [world, array, size, array]),
    "skein_snapshot_size": (size, [world]),
    "skein_snapshot_write": (status, [world, array, size, c.POINTER(size)]),
    "skein_snapshot_read": (status, [world, text, size]),
    "skein_body_surface": (status, [world, Handle, c.POINTER(Surface)]),
    "skein_body_vertices_copy": (status, [world, Handle, c.c_double, Buffer, Buffer]),
    "skein_cut": (status, [world, Handle, array, c.POINTER(size)]),
    "skein_cut_faces": (status, [world, Handle, array, size]),
    "skein_cut_mend": (status, [world, Handle]),
    "skein_body_cuts": (status, [world, Handle, c.POINTER(Cuts)]),
    "skein_body_elements": (status, [world, Handle, c.c_int, array, size, c.POINTER(size)]),
    "skein_body_select": (status, [world, Handle, text, array, size, c.POINTER(size)]),
    "skein_attachments_find": (status, [world, array, size, Handle, array]),
    "skein_collider_add_mesh": (status, [world, text, c.POINTER(Mesh), c.POINTER(Setting), c.POINTER(Handle)]),
    "skein_collider_vertices_set": (status, [world, Handle, array, size]),
    "skein_collider_triangles": (status, [world, Handle, c.POINTER(Triangles)]),
    "skein_collider_vertices_copy": (status, [world, Handle, Buffer]),
    "skein_force_probe": (status, [world, Handle, size, array, array]),
    "skein_world_profile": (status, [world, c.c_double, c.POINTER(Pass), size, c.POINTER(size)]),
    "skein_record_begin": (status, [world, c.POINTER(Recorder)]),
    "skein_record_end": (status, [world]),
    "skein_replay": (status, [world, text, size, c.POINTER(Difference)]),
    "skein_collider_pose": (status, [world, Handle, c.POINTER(Pose)]),
    "skein_collider_probe": (status, [world, Handle, size, array, array, array]),
    "skein_collider_teleport": (status, [world, Handle]),
    "skein_body_teleport": (status, [world, Handle, array, array]),
    "skein_constraint_count": (status, [world, Handle, c.POINTER(size)]),
    "skein_constraint_evaluate": (status, [world, Handle, size, c.POINTER(ConstraintValue), array, array, size]),
    "skein_surface_contacts_copy": (status, [world, c.POINTER(SurfaceContact), size, c.POINTER(size)]),
    "skein_contacts_copy": (status, [world, c.POINTER(Contact), size, c.POINTER(size)]),
    "skein_ray_cast": (status, [world, array, array, c.c_int, c.POINTER(Hit)]),
    "skein_world_statistics": (status, [world, array]),
    "skein_world_hash": (c.c_uint64, [world]),
    "skein_order_measure": (status, [world, size, size, array, c.c_double, c.POINTER(Order)]),
    "skein_stable_substep": (c.c_double, [text, c.c_void_p]),
    "skein_world_explain": (status, [world, c.c_double, WRITE, c.c_void_p]),
    "py_path_is_mesh": (c.c_bool, [text]),
    "py_scene_open": (c.c_void_p, [text, size, text, c.POINTER(text), REPORT, c.c_void_p]),
    "py_scene_build": (world, [c.c_void_p, c.POINTER(WorldDesc), REPORT, c.c_void_p]),
    "py_scene_settings": (c.c_void_p, [c.c_void_p]),
    "py_scene_text": (c.c_void_p, [c.c_void_p]),
    "py_scene_text_anywhere": (c.c_void_p, [c.c_void_p]),
    "py_scene_note": (c.c_bool, [c.c_void_p, text, REPORT, c.c_void_p]),
    "py_scene_view": (c.c_void_p, [c.c_void_p]),
    "py_scene_free": (None, [c.c_void_p]),
    "py_free": (None, [c.c_void_p]),
    "py_steps": (status, [world, c.c_double, size]),
    "py_steps_of_all": (size, [c.POINTER(world), size, c.c_double, size]),
    "py_advise": (c.c_double, [world, c.c_double, WRITE, c.c_void_p]),
    "py_study_open": (c.c_void_p, [text, size, text, REPORT, c.c_void_p]),
    "py_study_describe": (c.c_void_p, [c.c_void_p]),
    "py_study_run": (c.c_void_p, [c.c_void_p, size, c.c_int]),
    "py_study_stop": (None, [c.c_void_p]),
    "py_study_keep": (c.c_bool, [c.c_void_p, text, REPORT, c.c_void_p]),
    "py_study_row": (c.c_void_p, [c.c_void_p, size]),
    "py_study_add": (c.c_bool, [c.c_void_p, text, REPORT, c.c_void_p]),
    "py_study_tables": (c.c_bool, [c.c_void_p, REPORT, c.c_void_p]),
    "py_study_free": (None, [c.c_void_p]),
    "py_cache_open": (c.c_void_p, [text, c.POINTER(c.c_uint32), c.POINTER(c.c_double), error]),
    "py_cache_read": (status, [c.c_void_p, c.c_uint32, array, error]),
    "py_cache_close": (None, [c.c_void_p]),
    "py_fit_struct_size": (size, [text]),
    "py_version": (text, []),
    "py_struct_size": (size, [text]),
    "py_statistics_member": (text, [size, c.POINTER(size), c.POINTER(size), c.POINTER(c.c_bool)]),
}


def _place():
    """Where libskein.so lies, in full, whatever folder the program goes to later."""
    given = os.path.abspath(os.environ.get("SKEIN_LIBRARY") or os.path.dirname(__file__))
    wanted = os.environ.get("SKEIN_PRECISION") or "float"
    if wanted not in ("float", "double"):
        raise ImportError(f"SKEIN_PRECISION={wanted}: expected float or double")
    if wanted == "double" and os.path.isdir(given) and os.path.exists(os.path.join(given, "double")):
        given = os.path.join(given, "double")
    return os.path.join(given, "libskein.so") if os.path.isdir(given) else given


path = _place()
folder = os.path.dirname(path)


def _load():
    if not os.path.exists(path):
        raise ImportError(f"{path} is missing: the package is installed from its wheel ('make wheel' makes it), or "
                          "SKEIN_LIBRARY names the folder of a build's libskein.so (build/python)")
    loaded = c.CDLL(path)
    try:
        for name, (result, arguments) in CALLS.items():
            function = getattr(loaded, name)
            function.restype, function.argtypes = result, arguments
    except AttributeError as missing:
        raise ImportError(f"{path}: {missing}: it is no libskein.so of this package's version") from None
    for name, struct in STRUCTS.items():
        if loaded.py_struct_size(name.encode()) != c.sizeof(struct):
            raise ImportError(f"{path}: skein_{name} is laid out otherwise there: another version of the library")
    return loaded


lib = _load()

# The one that is there says how wide numbers in views are.
try:
    world_create, real, precision = lib.skein_world_create_float, np.dtype(np.float32), "float"
    if os.environ.get("SKEIN_PRECISION") == "double":
        raise ImportError(f"{path}: it computes in float, and SKEIN_PRECISION asks for double, which was not built here")
except AttributeError:
    world_create, real, precision = lib.skein_world_create_double, np.dtype(np.float64), "double"
world_create.restype, world_create.argtypes = world, [c.POINTER(WorldDesc), error]
position_view = getattr(lib, f"skein_position_view_{precision}")
velocity_view = getattr(lib, f"skein_velocity_view_{precision}")
for _view in position_view, velocity_view:
    _view.restype, _view.argtypes = View, [world]


def _statistics_members():
    """What skein_statistics has, as the library says: name, offset, count and sort of numbers."""
    offset, bytes_, whole, found = c.c_size_t(), c.c_size_t(), c.c_bool(), []
    while name := lib.py_statistics_member(len(found), c.byref(offset), c.byref(bytes_), c.byref(whole)):
        found.append((name.decode(), offset.value, bytes_.value // 8, "Q" if whole.value else "d"))
    return found


statistics_members, statistics_size = _statistics_members(), lib.py_struct_size(b"statistics")
OK, ERROR_MEMORY, ERROR_VALUE, ERROR_NAME, ERROR_HANDLE, ERROR_MESH, ERROR_FILE, ERROR_SYNTAX, ERROR_LIMIT = range(9)
BOOL, INT, INT2, INT3, REAL, REAL2, VEC3, CHOICE, TEXT = range(9)
BODY, CONSTRAINT, FORCE, COLLIDER, MOTION, METHOD = range(6)
CATEGORIES = ["body", "constraint", "force", "collider", "motion", "method"]
LISTS = ["bodies", "constraints", "forces", "colliders", "motions", "method"]  # as scenes call them


def take_text(pointer):
    """A text that C made for us, which goes; None where there was no memory."""
    if not pointer:
        raise MemoryError("out of memory")
    try:
        return c.string_at(pointer).decode()
    finally:
        lib.py_free(pointer)


def pointer_to(array):
    """The numbers of an array, or NULL."""
    return None if array is None else array.ctypes.data
