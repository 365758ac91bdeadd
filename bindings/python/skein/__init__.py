"""Skein: real-time particle dynamics. Cloth, jelly, rope and flocks, with the same bits as the command.

    import skein

    world = skein.World()
    cloth = world.bodies.cloth(grid=(33, 33), pins="top corners")
    world.forces.gravity()
    cloth.stretch.stiffness = 2e4
    world.step(1 / 60, count=60)
    print(world.positions.shape, world.hash())

Units are SI: metres, kilograms, seconds, newtons; y is up. What fails raises a SkeinError that names the place.
docs/python.md walks through all of it.
"""
from . import _library, functions, kinds
from ._errors import (FileFault, HandleFault, LimitFault, MemoryFault, MeshFault, NameFault, SkeinError, SyntaxFault,
                      ValueFault)
from ._fits import Fit, fit
from ._formula import Formula, formula
from ._gradient import Gradient
from ._objects import Body, Collider, Constraint, Force, Method, Motion, Object, ObjectList
from ._pictures import Film, Image, film
from ._recording import Recording
from ._scene import scenes
from ._studies import study
from ._world import DEFAULT_STEP, State, World
from ._worlds import Environment, Environments, Worlds

_number = _library.lib.skein_version()
__version__ = f"{_number // 1000000}.{_number // 1000 % 1000}.{_number % 1000}"
precision = _library.precision

__all__ = [
    "Body", "Collider", "Constraint", "DEFAULT_STEP", "Environment", "Environments", "FileFault", "Film", "Fit", "Force",
    "Formula", "Gradient", "HandleFault", "Image", "LimitFault", "MemoryFault", "MeshFault", "Method", "Motion", "NameFault", "Object",
    "ObjectList", "Recording", "SkeinError", "State", "SyntaxFault", "ValueFault", "World", "Worlds", "film", "fit", "formula", "functions",
    "kinds", "precision", "scenes", "study",
]
