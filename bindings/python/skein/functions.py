"""The functions of formulas: `from skein.functions import *` beside the functions that are traced.

Given numbers they are numbers; given symbols they are symbols. docs/formula.md describes each.
"""
from . import _formula

__all__ = [*_formula.FUNCTIONS, "pi"]
globals().update(_formula.FUNCTIONS)
pi = _formula.pi
