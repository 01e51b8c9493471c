"""Mutation testing: change one thing in a module, and see whether its tests fail.

    python .ci/mutate.py                      # every target, 60 mutants each
    python .ci/mutate.py gate --count 0       # all mutants of one target
    python .ci/mutate.py gate --show          # the survivors, as they stand in the code

A target is a module and the tests that answer for it. The tests run once as they are, then once a mutant, each in a
process that is forked after the heavy libraries are imported. A mutant that its tests outlive is a gap in them, unless
it does the same as the module: `EQUIVALENT` lists those, each with its reason. They are not counted.
"""

from __future__ import annotations

import argparse
import ast
import copy
import importlib
import importlib.machinery
import importlib.util
import os
import random
import signal
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np  # noqa: F401 - imported once, before the processes are forked
import pytest

ROOT = Path(__file__).parent.parent
PRELOADED = ("scipy.optimize", "scipy.stats", "scipy.signal", "hypothesis", "msgspec", "typer")
SECONDS = 90  # for the tests of one mutant: one that runs longer is stuck in a loop, and counts as killed


class Target(NamedTuple):
    """A module and its tests, both from the root."""

    module: str
    tests: tuple[str, ...]


TARGETS = {
    "gate": Target("fricomp/control/gate/gate.py", ("tests/control/gate/test_gate.py",)),
    "limits": Target("fricomp/control/gate/limits.py", ("tests/control/gate/test_gate.py",)),
    "laws": Target("fricomp/laws/stribeck.py", ("tests/laws/test_laws.py",)),
    "likelihood": Target(
        "calibration/identification/estimation/likelihood.py",
        ("tests/calibration/identification/estimation/test_likelihood.py",),
    ),
    "mit": Target("adapters/mit/codec.py", ("tests/adapters/mit/test_codec.py",)),
    "moteus": Target("adapters/moteus/codec.py", ("tests/adapters/moteus/test_codec.py",)),
    "odrive": Target("adapters/odrive/codec.py", ("tests/adapters/odrive/test_codec.py",)),
    "dynamixel": Target("adapters/dynamixel/packet.py", ("tests/adapters/dynamixel/test_packet.py",)),
    "slcan": Target("adapters/slcan/codec.py", ("tests/adapters/slcan/test_codec.py",)),
    "canopen": Target("adapters/canopen/scaling.py", ("tests/adapters/canopen/test_scaling.py",)),
    "canopen_states": Target("adapters/canopen/state_machine.py", ("tests/adapters/canopen/test_scaling.py",)),
    "verdict": Target(
        "fricomp/diagnosis/verdict/judging.py",
        ("tests/diagnosis/verdict/test_judging.py", "tests/diagnosis/verdict/test_sample_or_rows.py"),
    ),
    "results": Target("fricomp/results.py", ("tests/test_results.py",)),
    "lock": Target("fricomp/folder_lock.py", ("tests/test_folder_lock.py",)),
    "whole_file": Target("fricomp/whole_file.py", ("tests/test_whole_file.py",)),
}


class Equivalent(NamedTuple):
    """Mutants of one line that do what the module does.

    Attributes:
        line: A part of the line, as it stands in the code.
        changes: How those changes begin.
        reason: Why nobody could tell the difference.
    """

    line: str
    changes: tuple[str, ...]
    reason: str


_BELOW_FLOAT32 = "the bound is no float that anybody sends; whether it passes itself makes no difference"
_SEEN_AGAIN = "a state that seems not to be well at first sight is looked at again limit by limit, with the same result"
_FAST_PATH = "a shape that is not known at once is read register by register, with the same result"

EQUIVALENT: dict[str, tuple[Equivalent, ...]] = {
    "dynamixel": (Equivalent("self._fields = [0] *", ("0 to",), "every field is written before it is packed"),),
    "gate": (
        Equivalent("self._open_ns = self._due_ns =", ("0 to",), "`arm` sets all of them before they are used"),
        Equivalent("if not (-limit <= velocity[j]", ("LtE", "USub"), _SEEN_AGAIN),
        Equivalent("if not temperature[j] <= hottest", ("LtE",), _SEEN_AGAIN),
        Equivalent(
            "                return False",
            ("returns None",),
            "both are false, and nobody but `observe` and `admit` looks",
        ),
        Equivalent("return not any(feedback.fault)", ("returns None",), _SEEN_AGAIN),
        Equivalent("rows = zip(feedback.position", ("True",), "another number of joints was refused before"),
        Equivalent("now_ns < self._open_ns or now_ns <", ("Lt to",), "at that very moment nothing is left to bound"),
        Equivalent("if not (abs(torque) <= limits[j]", ("LtE to",), "what is at its bound is bounded to itself"),
        Equivalent("steps = self._steps if elapsed >=", ("GtE to",), "a whole period gives the whole step either way"),
        Equivalent("goal = (limit if torque > limit", ("Gt to", "Lt to"), "what is at its bound is bounded to itself"),
        Equivalent("return before + step if goal >", ("Gt to", "Lt to"), "what is at its bound is bounded to itself"),
    ),
    "mit": (Equivalent("if not -limit <= torque", ("LtE", "USub"), "a torque within the limit saturates to itself"),),
    "moteus": (
        Equivalent(
            "WRITE_INT8, WRITE_FLOAT =", ("0 to",), "a count of one is joined to it by `|`, which sets that bit"
        ),
        Equivalent("READ_INT8, READ_FLOAT =", ("16", "28"), "a count of one or three is joined to it by `|`"),
        Equivalent("if torque > highest_torque or", ("Gt", "Lt"), "a torque at the bound is replaced by the bound"),
        Equivalent("torque = highest_torque if", ("Gt",), "a torque beyond the bound is not zero"),
        Equivalent("if fields[0::2] == SINGLE_HEADS", ("2 to", "0 to"), _FAST_PATH),
        Equivalent("fields[6]) == GROUPED_HEADS", ("0 to", "2 to", "6 to"), _FAST_PATH),
        Equivalent("< HIGHEST_FLOAT32", ("Lt to",), _BELOW_FLOAT32),
    ),
    "odrive": (Equivalent("< HIGHEST_FLOAT32", ("Lt to",), _BELOW_FLOAT32),),
}

_SWAPPED: dict[type[ast.AST], type[ast.AST]] = {
    ast.Lt: ast.LtE, ast.LtE: ast.Lt, ast.Gt: ast.GtE, ast.GtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
    ast.Is: ast.IsNot, ast.IsNot: ast.Is, ast.In: ast.NotIn, ast.NotIn: ast.In, ast.Add: ast.Sub, ast.Sub: ast.Add,
    ast.Mult: ast.Div, ast.Div: ast.Mult, ast.FloorDiv: ast.Mult, ast.And: ast.Or, ast.Or: ast.And,
    ast.BitAnd: ast.BitOr, ast.BitOr: ast.BitAnd, ast.LShift: ast.RShift, ast.RShift: ast.LShift,
}  # fmt: skip
_SILENT = (ast.Raise, ast.JoinedStr, ast.arguments, ast.AnnAssign, ast.Assert)  # texts, defaults and types


_NAMED = (ast.ClassDef, ast.FunctionDef)  # their decorators and options, such as frozen, are declarations


class Mutant(NamedTuple):
    """One change: the line it is in, what it does, and the whole module with it."""

    line: int
    change: str
    tree: ast.Module


def list_mutants(source: str) -> list[Mutant]:
    """Every mutant of a module, in the order of its lines."""
    tree = ast.parse(source)
    found = []
    for number, node in enumerate(_walk(tree)):
        for change, alter in _changes(node):
            altered = copy.deepcopy(tree)
            twin = next(each for place, each in enumerate(_walk(altered)) if place == number)
            alter(twin)
            found.append(Mutant(getattr(node, "lineno", 0), change, ast.fix_missing_locations(altered)))
    return found


def _walk(node: ast.AST) -> Iterator[ast.AST]:
    """The nodes that are run, without those of messages, types and defaults."""
    declared = ("decorator_list", "keywords", "returns") if isinstance(node, _NAMED) else ()
    heads = [each for name in declared for each in _list(getattr(node, name, None))]
    for child in ast.iter_child_nodes(node):
        if child in heads or isinstance(child, _SILENT) or _is_plain_text(child):
            continue
        if isinstance(child, ast.Assign) and any(getattr(name, "id", "") == "__all__" for name in child.targets):
            continue
        yield child
        yield from _walk(child)


def _list(found: list[ast.AST] | ast.AST | None) -> list[ast.AST]:
    return found if isinstance(found, list) else [found] if found is not None else []


def _is_plain_text(node: ast.AST) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _changes(node: ast.AST) -> Iterator[tuple[str, Callable[[ast.AST], None]]]:
    if isinstance(node, ast.Compare):
        for place, operator in enumerate(node.ops):
            new = _SWAPPED[type(operator)]
            yield f"{_name(operator)} to {new.__name__}", lambda twin, p=place, n=new: _put(twin, "ops", p, n)
    elif isinstance(node, ast.BinOp | ast.BoolOp | ast.AugAssign) and type(node.op) in _SWAPPED:
        new = _SWAPPED[type(node.op)]
        yield f"{_name(node.op)} to {new.__name__}", lambda twin, n=new: setattr(twin, "op", n())
    elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not | ast.USub):
        yield f"{_name(node.op)} left out", lambda twin: setattr(twin, "op", ast.UAdd() if _is_minus(twin) else _Same())
    elif isinstance(node, ast.Constant) and isinstance(node.value, bool | int | float):
        value = (not node.value) if isinstance(node.value, bool) else node.value + 1
        if value != node.value:  # one more than a huge number is the same number
            yield f"{node.value} to {value}", lambda twin, v=value: setattr(twin, "value", v)
    elif isinstance(node, ast.If | ast.While | ast.IfExp):
        yield "condition turned", lambda twin: setattr(twin, "test", ast.UnaryOp(ast.Not(), twin.test))  # type: ignore[attr-defined]
    elif isinstance(node, ast.Return) and node.value is not None and not _is_none(node.value):
        yield "returns None", lambda twin: setattr(twin, "value", ast.Constant(None))


class _Same(ast.Not):
    """Takes the place of `not`; `_Unparser` leaves it out."""


def _is_minus(twin: ast.AST) -> bool:
    return isinstance(getattr(twin, "op", None), ast.USub)


def _is_none(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and node.value is None


def _name(operator: ast.AST) -> str:
    return type(operator).__name__


def _put(twin: ast.AST, field: str, place: int, new: type[ast.AST]) -> None:
    getattr(twin, field)[place] = new()


class _LeaveOut(ast.NodeTransformer):
    def visit_UnaryOp(self, node: ast.UnaryOp) -> ast.AST:
        self.generic_visit(node)
        return node.operand if isinstance(node.op, _Same) else node


def run_tests(target: Target, mutant: Mutant | None) -> bool:
    """Whether the tests of a target pass, with a mutant or with the module as it is."""
    sys.stdout.flush()
    child = os.fork()
    if child == 0:
        _run_in_child(target, mutant)
    _, status = os.waitpid(child, 0)
    return status == 0


def _run_in_child(target: Target, mutant: Mutant | None) -> None:
    """Never returns."""
    quiet = os.open(os.devnull, os.O_WRONLY)
    os.dup2(quiet, 1)
    os.dup2(quiet, 2)
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(SECONDS)
    code = 1
    try:
        if mutant is not None:
            _replace_module(ROOT / target.module, _LeaveOut().visit(mutant.tree))
        code = int(pytest.main(["-x", "-q", "-p", "no:cacheprovider", "-W", "ignore", *target.tests]))
    finally:
        os._exit(code)


def _replace_module(path: Path, tree: ast.Module) -> None:
    """Whoever imports the file at a path gets the tree instead."""
    code = compile(ast.fix_missing_locations(tree), str(path), "exec")
    usual = importlib.machinery.SourceFileLoader.get_code

    def get_code(loader: importlib.machinery.SourceFileLoader, name: str) -> object:
        return code if Path(loader.path).resolve() == path.resolve() else usual(loader, name)

    importlib.machinery.SourceFileLoader.get_code = get_code  # type: ignore[method-assign, assignment]


def measure(name: str, count: int, seed: int, show: bool) -> tuple[int, int]:
    """Mutants of a target that were killed, and all that were tried.

    Raises:
        SystemExit: Its tests fail without a mutant.
    """
    target = TARGETS[name]
    source = (ROOT / target.module).read_text(encoding="utf-8")
    if not run_tests(target, None):
        sys.exit(f"{name}: the tests {' '.join(target.tests)} fail as they are")
    mutants = list_mutants(source)
    same = [(mutant, reason) for mutant in mutants if (reason := find_reason(name, source, mutant))]
    mutants = [mutant for mutant in mutants if not find_reason(name, source, mutant)]
    tried = mutants if count == 0 else random.Random(seed).sample(mutants, min(count, len(mutants)))
    alive = sorted((m for m in tried if run_tests(target, m)), key=lambda mutant: mutant.line)
    killed = len(tried) - len(alive)
    print(f"{name}: {killed} of {len(tried)} killed, {killed / len(tried):.0%} ({len(mutants)} in all)", flush=True)
    for mutant in alive if show else ():
        print(f"  {target.module}:{mutant.line}: {mutant.change}: {source.splitlines()[mutant.line - 1].strip()}")
    for mutant, reason in same if show else ():
        print(f"  not counted: {target.module}:{mutant.line}: {mutant.change}: {reason}")
    return killed, len(tried)


def find_reason(name: str, source: str, mutant: Mutant) -> str:
    """Why a mutant of a target is equivalent; empty where it is not known to be."""
    line = source.splitlines()[mutant.line - 1] if mutant.line else ""
    known = EQUIVALENT.get(name, ())
    return next((one.reason for one in known if one.line in line and mutant.change.startswith(one.changes)), "")


def main() -> None:
    """Measure the targets that are asked for; exit status 1 where fewer than 85 % of their mutants are killed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("targets", nargs="*", choices=[*TARGETS, []], metavar="target")
    parser.add_argument("--count", type=int, default=60, help="mutants a target, drawn by the seed; 0 for all")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--show", action="store_true", help="print the survivors")
    asked = parser.parse_args()
    os.chdir(ROOT)
    sys.path.insert(0, str(ROOT))
    for name in PRELOADED:
        importlib.import_module(name)
    found = [measure(name, asked.count, asked.seed, asked.show) for name in asked.targets or TARGETS]
    killed, tried = (sum(column) for column in zip(*found, strict=True))
    print(f"all: {killed} of {tried} killed, {killed / tried:.0%}")
    sys.exit(killed < 0.85 * tried)


if __name__ == "__main__":
    main()
