"""Expressions printed as source text: each part that occurs more than once becomes a variable of its own."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from fricomp.laws.expression import COMPARISONS, Call, Expression, Number, Symbol

__all__ = ["PYTHON", "Language", "compile_python", "print_python", "print_source"]


class Language:
    """How a language writes numbers, functions and variables.

    Args:
        functions: Text of each function, with {0}, {1} and {2} in the place of its arguments.
        literal: Writes a number.
        variable: Text that brings a variable into being, with {name} and {value}.
    """

    def __init__(self, functions: Mapping[str, str], literal: Callable[[float], str], variable: str) -> None:
        self.functions, self.literal, self.variable = functions, literal, variable

    def template(self, call: Call) -> str:
        """The text of a function, whose arguments may occur several times in it."""
        exponent = call.arguments[-1]
        if call.function == "power" and isinstance(exponent, Number) and exponent.value == 2.0:
            return "({0} * {0})"  # which needs no power function
        return self.functions[call.function]


def print_source(
    expressions: Sequence[Expression], language: Language, names: Mapping[str, str], prefix: str
) -> tuple[list[str], list[str]]:
    """Lines that bring variables into being, and the text of each of `expressions` after them.

    Args:
        expressions: What is printed.
        language: How.
        names: Text of each symbol; those that are missing keep their names.
        prefix: What the names of the variables begin with.
    """
    return _Printer(language, names, prefix).print(expressions)


class _Printer:
    """Numbers every part of the expressions by its value, counts where the text needs it, then writes it."""

    def __init__(self, language: Language, names: Mapping[str, str], prefix: str) -> None:
        self._language, self._names, self._prefix = language, names, prefix
        self._numbers: dict[tuple[object, ...], int] = {}
        self._parts: list[tuple[Expression, tuple[int, ...]]] = []
        self._needed: list[int] = []
        self._texts: dict[int, str] = {}
        self._lines: list[str] = []

    def print(self, expressions: Sequence[Expression]) -> tuple[list[str], list[str]]:
        roots = [self._number(expression) for expression in expressions]
        self._needed = [0] * len(self._parts)
        for root in roots:
            self._needed[root] += 1
        for number in range(len(self._parts) - 1, -1, -1):  # every part comes after its arguments
            part, arguments = self._parts[number]
            if isinstance(part, Call) and self._needed[number]:
                template = self._language.template(part)
                for place, argument in enumerate(arguments):
                    self._needed[argument] += template.count(f"{{{place}}}")
        texts = [self._text(root) for root in roots]
        return self._lines, texts

    def _number(self, part: Expression) -> int:
        arguments = tuple(map(self._number, part.arguments)) if isinstance(part, Call) else ()
        key = (part.function, *arguments) if isinstance(part, Call) else (type(part), str(part))
        if key not in self._numbers:
            self._numbers[key] = len(self._parts)
            self._parts.append((part, arguments))
        return self._numbers[key]

    def _text(self, number: int) -> str:
        if number not in self._texts:
            part, arguments = self._parts[number]
            if isinstance(part, Call):
                text = self._language.template(part).format(*map(self._text, arguments))
                if self._needed[number] > 1 and part.function not in COMPARISONS:
                    name = f"{self._prefix}{len(self._lines)}"
                    self._lines.append(self._language.variable.format(name=name, value=text))
                    text = name
            elif isinstance(part, Symbol):
                text = self._names.get(part.name, part.name)
            else:
                assert isinstance(part, Number)
                assert isinstance(part.value, float)
                text = self._language.literal(part.value)
            self._texts[number] = text
        return self._texts[number]


def print_python_number(value: float) -> str:
    """`value` as Python writes it: nothing but a number ever comes out, whatever comes in."""
    value = float(value)
    if math.isfinite(value):
        return repr(value) if math.copysign(1.0, value) > 0.0 else f"({value!r})"
    return "nan" if math.isnan(value) else "inf" if value > 0.0 else "(-inf)"


PYTHON = Language(
    {
        "add": "({0} + {1})",
        "subtract": "({0} - {1})",
        "multiply": "({0} * {1})",
        "divide": "({0} / {1})",
        "power": "({0} ** {1})",
        "negative": "(-{0})",
        "absolute": "abs({0})",
        "sign": "(1.0 if {0} > 0.0 else -1.0 if {0} < 0.0 else 0.0)",
        "maximum": "({0} if {0} > {1} else {1})",
        "minimum": "({0} if {0} < {1} else {1})",
        "where": "({1} if {0} else {2})",
        "greater": "({0} > {1})",
        "greater_equal": "({0} >= {1})",
        "less": "({0} < {1})",
        "less_equal": "({0} <= {1})",
        **{name: f"{name}({{0}})" for name in ("exp", "expm1", "sin", "cos", "tanh")},
        "arctan": "atan({0})",
    },
    print_python_number,
    "{name} = {value}",
)
"""Python on plain floats, with the functions of `math`."""


def print_python(
    expressions: Sequence[Expression], names: Mapping[str, str] | None = None
) -> tuple[list[str], list[str]]:
    """`print_source` in Python."""
    return print_source(expressions, PYTHON, names or {}, "t")


def compile_python(lines: Sequence[str], name: str, **known: Any) -> Callable[..., Any]:
    """What `name` is after `lines`, which know the functions of `math` that formulas use and what is in `known`.

    The lines are made of this library's own words and of numbers; nothing that a file says may be part of them.
    """
    functions = {each: getattr(math, each) for each in ("exp", "expm1", "sin", "cos", "tanh", "atan", "inf", "nan")}
    scope: dict[str, Any] = functions | known
    exec(compile("\n".join(lines) + "\n", f"<{name}>", "exec"), scope)
    made: Callable[..., Any] = scope[name]
    return made
