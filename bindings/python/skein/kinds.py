"""The classes of all kinds: ClothBody, GravityForce ...; help(skein.kinds.ClothBody) has its fields with units."""
from . import _objects

for _class in _objects.CLASSES.values():
    globals()[_class.__name__] = _class
__all__ = [_class.__name__ for _class in _objects.CLASSES.values()]
