"""Diagnoses that need no diagnosis: what a proof must make of them is known."""

import json
from collections.abc import Sequence
from typing import Any

from fricomp.sim_bench.studies.kit.blind import BlindAnswer
from tests.fleet.working import die_the_first_time

SCHEMA = "fricomp.diagnosis/1"


def answer(verdict: str, names: Sequence[str] = (), **fields: Any) -> BlindAnswer:
    """A diagnosis with these names."""
    effects = [{"name": name, "kind": "physics", "parameters": {}, "indistinguishable_from": []} for name in names]
    record = {"schema": SCHEMA, "verdict": verdict, "effects": effects} | fields
    return BlindAnswer(json.dumps(record).encode(), b"", 1.5, "")


def always_consistent(files: dict[str, bytes]) -> BlindAnswer:
    """Sees nothing, ever."""
    return answer("consistent")


def always_cogging(files: dict[str, bytes]) -> BlindAnswer:
    """Names cogging, whatever it is given."""
    return answer("missing_physics", ["cogging"])


def dies_once(files: dict[str, bytes]) -> BlindAnswer:
    """Kills its worker the first time anybody calls it, as a machine that fails would."""
    die_the_first_time()
    return answer("consistent")
