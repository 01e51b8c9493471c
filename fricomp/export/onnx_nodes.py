"""Formulas as nodes of an ONNX graph, for any number of joints at once."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from fricomp.laws import FloatArray
from fricomp.laws.expression import Call, Expression, Number, Symbol, as_expression

OPERATORS: Mapping[str, str] = {
    "add": "Add",
    "subtract": "Sub",
    "multiply": "Mul",
    "divide": "Div",
    "power": "Pow",
    "negative": "Neg",
    "absolute": "Abs",
    "sign": "Sign",
    "maximum": "Max",
    "minimum": "Min",
    "exp": "Exp",
    "expm1": "Exp",  # less one
    "sin": "Sin",
    "cos": "Cos",
    "tanh": "Tanh",
    "arctan": "Atan",
    "where": "Where",
    "greater": "Greater",
    "greater_equal": "GreaterOrEqual",
    "less": "Less",
    "less_equal": "LessOrEqual",
}
"""Operator of each function of a formula."""


class NodeWriter:
    """Writes expressions as nodes; what occurs twice is computed once.

    Attributes:
        nodes: The nodes so far.
        constants: Numbers by name, each of shape (1, 1) or (n_joints, 1).

    Args:
        make_node: `onnx.helper.make_node`.
    """

    def __init__(self, make_node: Callable[..., Any]) -> None:
        self.nodes: list[Any] = []
        self.constants: dict[str, FloatArray] = {}
        self._make_node = make_node
        self._known: dict[tuple[object, ...], str] = {}

    def write(self, expression: Expression, output: str) -> None:
        """Write the nodes of `expression`, whose value has the name `output`."""
        self.nodes.append(self._make_node("Identity", [self._name(expression)], [output]))

    def _name(self, part: Expression) -> str:
        if isinstance(part, Symbol):
            return part.name
        if isinstance(part, Number):
            key: tuple[object, ...] = (str(part),)
            if key not in self._known:
                self._known[key] = f"number_{len(self.constants)}"
                self.constants[self._known[key]] = np.atleast_1d(np.asarray(part.value, dtype=np.float64))[:, None]
            return self._known[key]
        assert isinstance(part, Call)
        inputs = [self._name(argument) for argument in part.arguments]
        if part.function == "expm1":
            return self._add("Sub", [self._add("Exp", inputs), self._name(Number(1.0))])
        return self._add(OPERATORS[part.function], inputs)

    def _add(self, operator: str, inputs: Sequence[str]) -> str:
        key = (operator, *inputs)
        if key not in self._known:
            self._known[key] = f"value_{len(self.nodes)}"
            self.nodes.append(self._make_node(operator, inputs, [self._known[key]]))
        return self._known[key]


def make_column(values: Sequence[float]) -> Any:
    """One number a joint; a single one where they are all the same."""
    return Number(tuple(values) if len(set(values)) > 1 else float(values[0]))


def merge_joints(formulas: Sequence[Expression | None]) -> Expression | None:
    """One formula for all joints, from that of each; None counts as zero, and comes back where all are None.

    Formulas that differ in their numbers alone become one, with a number a joint. Others are added, each held to zero
    for the joints that it is not of.
    """
    shapes = [None if formula is None else _describe_shape(formula) for formula in formulas]
    total: Any = None
    for shape in dict.fromkeys(shape for shape in shapes if shape is not None):
        mine = [each == shape for each in shapes]
        first = shapes.index(shape)
        merged: Any = _merge([formula if own else formulas[first] for formula, own in zip(formulas, mine, strict=True)])
        if not all(mine):
            is_mine = as_expression(make_column([float(own) for own in mine])) > 0.0
            merged = Call("where", as_expression(is_mine), merged, Number(0.0))
        total = merged if total is None else total + merged
    found: Expression | None = total
    return found


def _describe_shape(formula: Expression) -> str:
    """A formula without its numbers."""
    if isinstance(formula, Call):
        return f"{formula.function}({','.join(map(_describe_shape, formula.arguments))})"
    return "0" if isinstance(formula, Number) else str(formula)


def _merge(formulas: Sequence[Any]) -> Expression:
    first = formulas[0]
    if isinstance(first, Call):
        arguments = zip(*(formula.arguments for formula in formulas), strict=True)
        return Call(first.function, *map(_merge, arguments))
    if isinstance(first, Number):
        column: Expression = make_column([formula.value for formula in formulas])
        return column
    assert isinstance(first, Symbol)
    return first
