"""Formulas from Python functions: a function is called once with symbols, and what it does to them becomes a text.

    def spring(p0, p1, L=0.5):
        return length(p0 - p1) - L

    world.constraints.formula(constraint=spring, particles=[[0, 1]])     # "length(p0 - p1) - L", L = 0.5

Arguments p, p0 ... p7 are places, v, v0 ... v7 velocities, t the time; all others are parameters, whose defaults go along.
What stands twice is named once (`let`). The language is described in docs/formula.md; the library checks the text.
"""
import inspect
import math
import numbers
import re

NAMES = {  # what `skein formula --functions` lists, with so many arguments (None: as many as there are)
    "dot": 2, "cross": 2, "length": 1, "normalize": 1, "distance": 2, "vec3": 3, "angle": 2, "dihedral": 4, "sqrt": 1,
    "exp": 1, "log": 1, "pow": 2, "sin": 1, "cos": 1, "tan": 1, "asin": 1, "acos": 1, "atan2": 2, "abs": 1, "min": 2,
    "max": 2, "clamp": 3, "smoothstep": 3, "select": 3, "rest": 1,
}
POWER, MINUS, TIMES, PLUS, COMPARE, AND, OR = 7, 6, 5, 4, 3, 2, 1
LEAF = 8


class Formula(str):
    """A formula's text, with the parameters that it was traced with (`parameters`: their defaults, or None)."""

    parameters: dict

    def __new__(cls, text, parameters=None):
        made = super().__new__(cls, text)
        made.parameters = dict(parameters or {})
        return made


class Symbol:
    """A number or vector that is not known yet."""

    __slots__ = ("word", "operands", "level")
    __array_ufunc__ = None  # so that NumPy's numbers leave the operators to this class

    def __init__(self, word, operands=(), level=LEAF):
        self.word, self.operands, self.level = word, tuple(map(symbol, operands)), level

    def __add__(self, other):
        return Symbol("+", (self, other), PLUS)

    def __radd__(self, other):
        return Symbol("+", (other, self), PLUS)

    def __sub__(self, other):
        return Symbol("-", (self, other), PLUS)

    def __rsub__(self, other):
        return Symbol("-", (other, self), PLUS)

    def __mul__(self, other):
        return Symbol("*", (self, other), TIMES)

    def __rmul__(self, other):
        return Symbol("*", (other, self), TIMES)

    def __truediv__(self, other):
        return Symbol("/", (self, other), TIMES)

    def __rtruediv__(self, other):
        return Symbol("/", (other, self), TIMES)

    def __pow__(self, other):
        return Symbol("^", (self, other), POWER)

    def __rpow__(self, other):
        return Symbol("^", (other, self), POWER)

    def __neg__(self):
        return Symbol("-", (self,), MINUS)

    def __pos__(self):
        return self

    def __abs__(self):
        return Symbol("abs", (self,))

    def __lt__(self, other):
        return Symbol("<", (self, other), COMPARE)

    def __le__(self, other):
        return Symbol("<=", (self, other), COMPARE)

    def __gt__(self, other):
        return Symbol(">", (self, other), COMPARE)

    def __ge__(self, other):
        return Symbol(">=", (self, other), COMPARE)

    def __eq__(self, other):
        return Symbol("==", (self, other), COMPARE)

    def __ne__(self, other):
        return Symbol("!=", (self, other), COMPARE)

    def __and__(self, other):
        return Symbol("&&", (self, other), AND)

    def __or__(self, other):
        return Symbol("||", (self, other), OR)

    def __invert__(self):
        return Symbol("!", (self,), MINUS)

    __hash__ = object.__hash__

    def __getattr__(self, name):
        if re.fullmatch("[xyz]|[xyz]{3}", name):
            return Symbol("." + name, (self,))
        raise AttributeError(f"a formula has .x, .y, .z and three of them as a vector, no .{name}")

    def __getitem__(self, index):
        if index in (0, 1, 2):
            return getattr(self, "xyz"[index])
        raise IndexError("a vector has the components 0, 1 and 2")

    def __bool__(self):
        raise TypeError("a formula has no if, and, or: its value is not known yet. Take select(condition, yes, no), "
                        "and & | ~ between comparisons in brackets")

    def __float__(self):
        raise TypeError("a formula's value is not known yet: take skein.functions, not math")

    def __iter__(self):
        raise TypeError("a formula cannot be looped over: name its components .x, .y, .z")

    def __repr__(self):
        return f"<formula {text_of(self)!r}>"


def symbol(x):
    """A number, or three of them, as a symbol."""
    if isinstance(x, Symbol):
        return x
    if isinstance(x, numbers.Number) or getattr(x, "ndim", None) == 0:
        if not math.isfinite(x):
            raise ValueError(f"a formula's numbers are finite, not {x}")
        return Symbol("-", (Symbol(_number(-x)),), MINUS) if x < 0 else Symbol(_number(x))
    if hasattr(x, "__len__") and len(x) == 3:
        return Symbol("vec3", tuple(x))
    raise TypeError(f"expected a number, three numbers or a formula, not {x!r}")


def _number(x):
    return repr(int(x)) if float(x).is_integer() and abs(x) < 1e15 else repr(float(x))


def _function(name, count):
    plain = getattr(math, name, None) or {"abs": abs, "min": min, "max": max}.get(name)

    def call(*given):
        if len(given) != count:
            raise TypeError(f"{name}() takes {count} argument{'s' * (count > 1)}, not {len(given)}")
        if plain and not any(isinstance(x, Symbol) for x in given):
            return plain(*given)
        return Symbol(name, given)

    call.__name__ = call.__qualname__ = name
    call.__doc__ = f"{name}() of formulas: see docs/formula.md"
    return call


# ---- from symbols to a text ----


def _count_uses(root):
    uses, order, stack = {}, [], [(root, False)]
    while stack:
        node, done = stack.pop()
        if done:
            order.append(node)
        elif id(node) in uses:
            uses[id(node)] += 1
        else:
            uses[id(node)] = 1
            stack.append((node, True))
            stack.extend((operand, False) for operand in reversed(node.operands))
    return uses, order


def text_of(root):
    """The text, with a line of `let` for each part that is used more than once."""
    uses, order = _count_uses(root)
    written, lines, names = {}, [], 0
    for node in order:
        text, level = _write(node, written)
        if uses[id(node)] > 1 and node.operands and node is not root:
            names += 1
            lines.append(f"let part{names} = {text};")
            text, level = f"part{names}", LEAF
        written[id(node)] = text, level
    return "\n".join(lines + [written[id(root)][0]])


def _write(node, written):
    def operand(i, least):
        text, level = written[id(node.operands[i])]
        return text if level >= least else f"({text})"

    count = len(node.operands)
    if not count:
        return node.word, LEAF
    if node.word[0] == ".":
        return operand(0, LEAF) + node.word, LEAF
    if node.word in NAMES:
        return f"{node.word}({', '.join(written[id(x)][0] for x in node.operands)})", LEAF
    if count == 1:
        return node.word + operand(0, POWER), MINUS
    if node.level == POWER:
        return f"{operand(0, LEAF)}^{operand(1, LEAF)}", POWER
    # to the left alike without brackets, but for comparisons; to the right tighter
    left = operand(0, node.level + (node.level == COMPARE))
    return f"{left} {node.word} {operand(1, node.level + 1)}", node.level


RESERVED = re.compile(r"[pv][0-7]?|t|pi")


def formula(function):
    """A Python function as a formula: a text that knows its parameters. Texts stay as they are."""
    if isinstance(function, str):
        return function if isinstance(function, Formula) else Formula(function)
    arguments, parameters = [], {}
    for name, argument in inspect.signature(function).parameters.items():
        if argument.kind not in (argument.POSITIONAL_ONLY, argument.POSITIONAL_OR_KEYWORD, argument.KEYWORD_ONLY):
            raise TypeError(f"{function.__name__}(): a formula's arguments are named one by one, without *{name}")
        if not RESERVED.fullmatch(name):
            parameters[name] = None if argument.default is argument.empty else float(argument.default)
        arguments.append((argument.kind is argument.KEYWORD_ONLY, name))
    made = function(*(Symbol(name) for keyword, name in arguments if not keyword),
                    **{name: Symbol(name) for keyword, name in arguments if keyword})
    if made is None:
        raise TypeError(f"{function.__name__}() returns nothing: a formula is what a function returns")
    text = text_of(symbol(made))
    used = set(re.findall(r"[A-Za-z_]\w*", text))
    return Formula(text, {name: value for name, value in parameters.items() if name in used})


FUNCTIONS = {name: _function(name, count) for name, count in NAMES.items()}
pi = Symbol("pi")
