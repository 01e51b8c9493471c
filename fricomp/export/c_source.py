"""Formulas as C99, in double or single precision."""

import sys
from collections.abc import Mapping

import numpy as np

from fricomp.laws.expression import Expression
from fricomp.laws.source import Language, print_source

_LARGEST_FLOAT, _LARGEST_DOUBLE = float(np.finfo(np.float32).max), sys.float_info.max


class C:
    """One precision of C.

    Attributes:
        real: The type.
        suffix: What the names of its functions of `math.h` end in.

    Args:
        is_float: Whether it is single precision.
    """

    def __init__(self, is_float: bool) -> None:
        self.real, self.suffix = ("float", "f") if is_float else ("double", "")
        self._largest = _LARGEST_FLOAT if is_float else _LARGEST_DOUBLE
        zero, one, f = self.literal(0.0), self.literal(1.0), self.suffix
        functions = {
            "add": "({0} + {1})",
            "subtract": "({0} - {1})",
            "multiply": "({0} * {1})",
            "divide": "({0} / {1})",
            "power": f"pow{f}({{0}}, {{1}})",
            "negative": "(-{0})",
            "absolute": f"fabs{f}({{0}})",
            "sign": f"(({{0}} > {zero}) ? {one} : (({{0}} < {zero}) ? -{one} : {zero}))",
            "maximum": f"fmax{f}({{0}}, {{1}})",
            "minimum": f"fmin{f}({{0}}, {{1}})",
            "where": "({0} ? {1} : {2})",
            "greater": "({0} > {1})",
            "greater_equal": "({0} >= {1})",
            "less": "({0} < {1})",
            "less_equal": "({0} <= {1})",
            "arctan": f"atan{f}({{0}})",
            **{name: f"{name}{f}({{0}})" for name in ("exp", "expm1", "sin", "cos", "tanh")},
        }
        self._language = Language(functions, self.literal, f"const {self.real} {{name}} = {{value}};")

    def literal(self, value: float) -> str:
        """`value` as a constant."""
        if abs(value) > self._largest:
            size = "INFINITY" if self.suffix else "(double)INFINITY"
            return size if value > 0.0 else f"-{size}"
        text = repr(float(value))
        text = text if "e" in text or "." in text else f"{text}.0"
        return f"{text}F" if self.suffix else text

    def assign(
        self,
        formulas: Mapping[str, Expression],
        names: Mapping[str, str] | None = None,
        indent: str = "        ",
        prefix: str = "t",
    ) -> str:
        """Statements that give each variable, or each declaration of one, its formula.

        Args:
            formulas: By what stands left of the equals sign.
            names: Text of symbols that are no variables.
            indent: Before each line.
            prefix: What the names of variables that are needed on the way begin with; one a block.
        """
        lines, texts = print_source(list(formulas.values()), self._language, names or {}, prefix)
        lines += [f"{left} = {text};" for left, text in zip(formulas, texts, strict=True)]
        return "".join(f"{indent}{line}\n" for line in lines)
