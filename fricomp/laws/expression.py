"""Formulas as trees: a term's own numpy code, called with symbols in place of numbers, leaves its formula behind.

    >>> v = Symbol("velocity")
    >>> str(np.exp(-((v / 0.05) ** 2)))
    'exp(negative(power(divide(velocity, 0.05), 2.0)))'

Numpy hands every function of a symbol over to it (`__array_ufunc__`, `__array_function__`), so the formula that
computes arrays and the one that is printed as Python, C or ONNX are the same lines of code.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from numpy.lib.mixins import NDArrayOperatorsMixin

from fricomp.errors import ParameterError

__all__ = [
    "FUNCTIONS",
    "Call",
    "Expression",
    "Number",
    "Symbol",
    "add_up",
    "as_expression",
    "differentiate",
    "find_symbols",
]

COMPARISONS = ("greater", "greater_equal", "less", "less_equal")
"""Functions that give a condition, of which `np.where` makes a choice."""

FUNCTIONS = (
    *("add", "subtract", "multiply", "divide", "power", "negative", "absolute", "sign", "maximum", "minimum"),
    *("exp", "expm1", "sin", "cos", "tanh", "arctan", "where"),
    *COMPARISONS,
)
"""Numpy's names of the functions that a formula may use; `np.clip` counts as a maximum of a minimum."""


class Expression(NDArrayOperatorsMixin):
    """A number, a symbol, or a function of other expressions."""

    __hash__ = object.__hash__  # a comparison makes a condition, so that equality cannot serve a dictionary

    def __array_ufunc__(self, ufunc: np.ufunc, method: str, *inputs: Any, **options: Any) -> Expression:
        if method != "__call__" or options:
            raise ParameterError(f"a formula cannot use np.{ufunc.__name__}.{method} or its options: {options}")
        return Call(ufunc.__name__, *map(as_expression, inputs))

    def __array_function__(
        self, function: Callable[..., Any], types: Any, inputs: tuple[Any, ...], options: Mapping[str, Any]
    ) -> Any:
        if function is np.where and len(inputs) == 3 and not options:
            condition, chosen, other = inputs
            if not isinstance(condition, Expression):
                return chosen if condition else other
            return Call("where", condition, as_expression(chosen), as_expression(other))
        if function is np.clip and len(inputs) == 3 and not options:
            value, low, high = inputs
            return np.minimum(np.maximum(value, low), high)
        raise _unknown(function.__name__)

    def __bool__(self) -> bool:
        raise ParameterError("a formula cannot decide by `if` on an input: use np.where")


class Number(Expression):
    """A constant; one a joint in a graph of several joints, as a tuple."""

    def __init__(self, value: float | tuple[float, ...]) -> None:
        self.value = value

    def __str__(self) -> str:
        return repr(self.value)


class Symbol(Expression):
    """An input, by a name that stands in the code, never in a file."""

    def __init__(self, name: str) -> None:
        self.name = name

    def __str__(self) -> str:
        return self.name


class Call(Expression):
    """A function of other expressions, by numpy's name.

    Raises:
        ParameterError: No printer knows the function.
    """

    def __init__(self, function: str, *arguments: Expression) -> None:
        if function not in FUNCTIONS:
            raise _unknown(function)
        self.function, self.arguments = function, arguments

    def __str__(self) -> str:
        return f"{self.function}({', '.join(map(str, self.arguments))})"


def _unknown(function: str) -> ParameterError:
    return ParameterError(f"a formula cannot use np.{function}: it may use np.{', np.'.join(FUNCTIONS)}, np.clip")


def as_expression(value: Any) -> Expression:
    """`value` as it is, or as a constant.

    Raises:
        ParameterError: It is no number.
    """
    if isinstance(value, Expression):
        return value
    if isinstance(value, int | float | np.number) or (isinstance(value, np.ndarray) and value.ndim == 0):
        return Number(float(value))
    raise ParameterError(f"a formula holds numbers and inputs only, got {value!r}")


def add_up(parts: Iterable[Any]) -> Expression:
    """The sum of the expressions that are given, those that are None aside; zero for none."""
    given = [part for part in parts if part is not None]
    total: Expression = sum(given[1:], given[0]) if given else Number(0.0)
    return total


def find_symbols(*expressions: Expression | None) -> frozenset[str]:
    """Names of the symbols in `expressions`."""
    found: set[str] = set()
    for expression in expressions:
        if isinstance(expression, Symbol):
            found.add(expression.name)
        elif isinstance(expression, Call):
            found |= find_symbols(*expression.arguments)
    return frozenset(found)


_DERIVATIVES: Mapping[str, Callable[[Any], Any]] = {
    "negative": lambda x: -1.0,
    "absolute": np.sign,
    "exp": np.exp,
    "expm1": np.exp,
    "sin": np.cos,
    "cos": lambda x: -np.sin(x),
    "tanh": lambda x: 1.0 - np.tanh(x) ** 2,
    "arctan": lambda x: 1.0 / (1.0 + x**2),
}
"""Derivative of each function of one argument; that of a sign is zero."""


def differentiate(expression: Expression, name: str) -> Expression | None:
    """Derivative by the symbol called `name`; None where it is zero everywhere. Jumps have none and count as flat."""
    if isinstance(expression, Symbol):
        return Number(1.0) if expression.name == name else None
    if not isinstance(expression, Call) or expression.function in ("sign", *COMPARISONS):
        return None
    function, arguments = expression.function, expression.arguments
    if function in _DERIVATIVES:
        inner = differentiate(arguments[0], name)
        return None if inner is None else as_expression(_DERIVATIVES[function](arguments[0]) * inner)
    if function in ("maximum", "minimum"):
        first, second = arguments if function == "maximum" else arguments[::-1]
        return differentiate(Call("where", Call("greater", first, second), *arguments), name)
    if function == "where":
        condition, *branches = arguments
        rates = [differentiate(branch, name) for branch in branches]
        if all(rate is None for rate in rates):
            return None
        return Call("where", condition, *(Number(0.0) if rate is None else rate for rate in rates))
    rate: Expression | None = _differentiate_two(function, arguments[0], arguments[1], name)
    return rate


def _differentiate_two(function: str, x: Any, y: Any, name: str) -> Any:
    """Derivative of a sum, difference, product, quotient or power."""
    dx, dy = differentiate(x, name), differentiate(y, name)
    if function == "power":
        if dy is not None:
            raise ParameterError("the exponent of a power in a formula must not depend on the velocity")
        if dx is None:
            return None
        return 2.0 * x * dx if isinstance(y, Number) and y.value == 2.0 else y * x ** (y - 1.0) * dx
    if function == "add":
        return dy if dx is None else dx if dy is None else dx + dy
    if function == "subtract":
        return (None if dy is None else -dy) if dx is None else dx if dy is None else dx - dy
    if function == "multiply":
        first, second = None if dx is None else dx * y, None if dy is None else x * dy
        return second if first is None else first if second is None else first + second
    first, second = None if dx is None else dx / y, None if dy is None else -x * dy / y**2
    return second if first is None else first if second is None else first + second
