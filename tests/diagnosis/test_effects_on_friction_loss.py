"""Effects of joints whose friction is MuJoCo's own, which creeps by default: an independent plant names the same."""

from __future__ import annotations

import pytest

from fricomp.diagnosis import Diagnosis, diagnose

from .friction_loss import STICKING, FrictionLoss, recording, simulated

_SECONDS = 16.0


def _diagnosed(truth: FrictionLoss, kind: str) -> Diagnosis:
    return diagnose(recording(truth, kind, duration=_SECONDS, rate=500))


def _only(found: Diagnosis, name: str) -> dict[str, float]:
    assert [effect.name for effect in found.effects] == [name], found.sentences
    return {key: one.value for key, one in found.effects[0].parameters.items()}


@pytest.mark.slow
def test_cogging_beside_friction_that_creeps() -> None:
    found = _diagnosed(FrictionLoss(cogging=0.3), "rests")
    assert _only(found, "cogging")["order"] == pytest.approx(12.0, abs=0.1)
    assert found.record.base["creep_velocity"].value > 0.0


@pytest.mark.slow
@pytest.mark.parametrize(
    "truth",
    [FrictionLoss(load_friction=0.2), FrictionLoss(load_friction=0.2, time=0.002, impedance=STICKING)],
    ids=["creeping", "sticking"],
)
def test_load_friction_whatever_the_friction_itself(truth: FrictionLoss) -> None:
    """Its refit moves gravity, and with it the load, whose sign counts most about zero."""
    found = _diagnosed(truth, "rests")
    assert _only(found, "load_coulomb")["coefficient"] == pytest.approx(0.2, abs=0.01)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("truth", "kind", "name"),
    [(FrictionLoss(cogging=1.0), "rests", "cogging"), (FrictionLoss(load_friction=0.2), "sweep", "load_coulomb")],
    ids=["cogging", "load"],
)
def test_creep_that_shows_only_beside_the_effect(truth: FrictionLoss, kind: str, name: str) -> None:
    """A ripple nearly as large as the friction, or a sweep, hides from the base alone that the friction creeps."""
    found = _diagnosed(truth, kind)
    _only(found, name)
    assert found.record.base["creep_velocity"].value > 0.0


@pytest.mark.slow
@pytest.mark.parametrize("drag", [0.0, 0.4])
@pytest.mark.parametrize(("kind", "level"), [("rests", 0.2), ("multisine", 0.3)])
def test_a_log_of_a_simulator_without_noise_shows_what_is_missing_and_nothing_else(
    kind: str, level: float, drag: float
) -> None:
    """Its friction creeps far slower than it moves, and what our own arithmetic leaves is no physics."""
    found = diagnose(simulated(FrictionLoss(level=level, drag=drag), kind, duration=_SECONDS, rate=500))
    assert [effect.name for effect in found.effects] == (["quadratic_drag"] if drag else []), found.sentences
    assert found.record.verdict == ("missing_physics" if drag else "consistent")
