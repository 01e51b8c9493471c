"""Ripple in the samples and late drives: on joints with known truth, and on public recordings where there are any."""

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import lfilter

from fricomp.diagnosis import DIAGNOSIS_SCHEMA, DiagnosisRecord, HeldOut, NamedEffect, Rival
from fricomp.diagnosis.samples.drive_path import find_drive_path
from fricomp.diagnosis.samples.fine_ripple import find_fine_ripple
from fricomp.fleet import SerialExecutor
from fricomp.recording import Recording, RecordingMetadata, find_public_data, read_public
from fricomp.sim_bench.studies.real import REAL_CASES, RealCase, RealOutcome, run_all, write_real_page


def _public(name: str) -> Recording:
    if find_public_data(name.partition("/")[0]) is None:
        pytest.skip(f"the public data of {name} are not here: set FRICOMP_DATA")
    return read_public(name)[0]


def _spinning(ripple: float, noise: float = 0.05) -> Recording:
    """A motor at some turns a second with Coulomb friction and a ripple of order 72."""
    t = np.linspace(0.0, 5.999, 6000)
    q = 6.0 * t + 0.9 * np.sin(2.0 * t)
    v, a = 6.0 + 1.8 * np.cos(2.0 * t), -3.6 * np.sin(2.0 * t)
    torque = 0.01 * a + 0.2 + 0.02 * v + ripple * np.sin(72.0 * q + 0.4)
    torque = torque + noise * np.random.default_rng(3).standard_normal(t.size)
    return Recording(time=t, position=q, torque=torque, metadata=RecordingMetadata(continuous=True))


def test_a_ripple_finer_than_the_rows_is_found_with_its_amplitude() -> None:
    found = find_fine_ripple(_spinning(0.15))
    assert found is not None
    strongest = found.harmonics[0]
    assert strongest.order == 72.0
    assert strongest.amplitude == pytest.approx(0.15, abs=4.0 * max(strongest.amplitude_error, 0.002))


def test_noise_is_no_ripple() -> None:
    assert find_fine_ripple(_spinning(0.0)) is None


def _driven(lag: float, seconds: float = 6.0) -> Recording:
    """A drive with a PD law on a jerky reference, against a load that nothing tells."""
    dt, rng = 2.5e-3, np.random.default_rng(5)
    n = int(seconds / dt)
    reference = lfilter([0.05], [1.0, -0.95], rng.standard_normal(n))
    position = lfilter([0.08], [1.0, -0.92], reference) + lfilter([0.01], [1.0, -0.99], rng.standard_normal(n))
    velocity = np.gradient(position, dt)
    told = 60.0 * (reference - position) - 0.4 * velocity
    keep = np.exp(-dt / lag) if lag > 0.0 else 0.0
    torque = lfilter([1.0 - keep], [1.0, -keep], told) + 0.1 * rng.standard_normal(n)
    columns = {"time": np.arange(n) * dt, "position": position, "velocity": velocity, "torque": torque}
    return Recording(position_reference=reference, **columns)


def test_the_lag_of_a_drive_is_found_against_an_unknown_load() -> None:
    path = find_drive_path(_driven(0.012))
    assert path is not None
    assert path.name == "drive_lag"
    assert path.value == pytest.approx(0.012, abs=0.002)
    assert path.errors["coulomb"] > 2.0 * path.errors["drive_lag"]


def test_a_prompt_drive_has_no_lag() -> None:
    assert find_drive_path(_driven(0.0)) is None


def test_a_series_elastic_drive_lags_and_friction_explains_nothing() -> None:
    path = find_drive_path(_public("anymal-sea/walk"))
    assert path is not None
    assert 0.007 < path.value < 0.018
    assert path.errors[path.name] < 0.7 * path.errors["law"]
    assert path.errors["coulomb"] > 0.99 * path.errors["law"]


@pytest.mark.slow
def test_a_geared_joint_ripples_with_its_known_period() -> None:
    found = find_fine_ripple(_public("nnfm-fairino-franka/fairino_s"))
    assert found is not None
    assert 2.0 * np.pi / found.harmonics[0].order == pytest.approx(0.00124, abs=1.5e-5)
    assert found.fall > 0.8


@pytest.mark.slow
def test_a_bare_motor_cogs_at_its_known_orders() -> None:
    found = find_fine_ripple(_public("laas-cogging/speed_without"))
    assert found is not None
    assert [harmonic.order for harmonic in found.harmonics[:2]] == [72.0, 18.0]


def test_the_logged_gains_of_a_real_arm_are_those_of_its_log() -> None:
    recordings, folder = {one.metadata.joint: one for one in _arm()}, find_public_data("ur10e")
    assert folder is not None
    log = np.genfromtxt(folder / "ur-20_02_19_14harm50sec.csv", delimiter=",")
    for number in (2, 3, 4):
        velocity, current, told = (log[:, first + number - 1] for first in (7, 19, 25))
        table = np.column_stack([current, velocity, np.tanh(velocity / 0.02), np.ones(len(log))])
        seen = np.isfinite(table).all(axis=1) & np.isfinite(told)
        gain = float(np.linalg.lstsq(table[seen], told[seen], rcond=None)[0][0])
        assert recordings[f"joint_{number}"].metadata.extra["drive_gain_logged"] == pytest.approx(gain, rel=0.005)


def _arm() -> tuple[Recording, ...]:
    if find_public_data("ur10e") is None:
        pytest.skip("the public data of ur10e are not here: set FRICOMP_DATA")
    return read_public("ur10e/fourier")


CASE = RealCase("case", ("set/recording",), "load", expected=("load_coulomb",), refuted=("cogging",))


def _outcome(name: str, rivals: tuple[Rival, ...] = (), case: RealCase = CASE) -> RealOutcome:
    effect = NamedEffect(name=name, kind="physics", parameters={}, indistinguishable_from=("load_coulomb",), share=0.9)
    held = HeldOut(
        rmse_before=0.25, rmse_after=0.05, noise_floor=0.04, unit="A", ci95_reduction=(0.7, 0.9), explained=0.9
    )
    record = DiagnosisRecord(
        schema=DIAGNOSIS_SCHEMA, verdict="missing_physics", effects=(effect,), heldout=held, rivals=rivals
    )
    return RealOutcome(case, record, "", 1.0)


def test_an_alias_counts_as_reached_and_a_refuted_name_does_not() -> None:
    assert _outcome("load_quadratic").reached is True
    assert _outcome("cogging").reached is False


@pytest.mark.parametrize("expected", [(), ("cogging",)])
def test_a_case_without_an_answer_did_not_come_out_as_expected(expected: tuple[str, ...]) -> None:
    case = RealCase("control", ("set/recording",), "no load", expected=expected, refuted=("load_coulomb",))
    assert RealOutcome(case, None, "a reason", 1.0).reached is False
    assert RealOutcome(RealCase("other", (), "nothing"), None, "a reason", 1.0).reached is None


def test_what_cannot_be_told_from_the_answer_is_no_refused_rival() -> None:
    alias = Rival(effects=("load_coulomb",), gain=9.0, refused="another is simpler")
    assert _outcome("load_quadratic", (alias,)).strongest_rejected == ""
    other = Rival(effects=("end_stop",), gain=5.0, refused="pulls")
    assert _outcome("load_quadratic", (alias, other)).strongest_rejected == "end_stop: pulls"


def test_the_page_counts_what_is_known_and_was_not_found(tmp_path: Path) -> None:
    cases = [RealCase(name, (), "ripple", listed=(effect,)) for name, effect in (("a", "cogging"), ("b", "end_stop"))]
    outcomes = [_outcome("end_stop", case=case) for case in (*cases, RealCase("c", (), "nothing"))]
    write_real_page([*outcomes, _outcome("load_quadratic")], tmp_path / "real.md", "Measured now.")
    text = (tmp_path / "real.md").read_text()
    assert "| a | `end_stop` | 0.25 → 0.05 (0.04) A | – | not found | 1 |" in text
    assert "| – | found: end_stop | 1 |" in text
    assert "| – | nothing promised | 1 |" in text
    assert "Measured now.\n\n| recording |" in text
    assert "Of 3 in which effects are known, 1 name one of them, 1 more have it in a set, 1 do not find it." in text
    assert "Other names: a (end_stop); case (load_quadratic)." in text
    assert text.count("Nothing known: 1.") == 1


def test_the_page_names_the_strongest_refused_rival(tmp_path: Path) -> None:
    rivals = (Rival(effects=("load_quadratic",), gain=9.0), Rival(effects=("end_stop",), gain=5.0, refused="pulls"))
    write_real_page([_outcome("load_quadratic", rivals)], tmp_path / "real.md", "Measured now.")
    text = (tmp_path / "real.md").read_text()
    assert "end_stop: pulls" in text
    assert "| case | `load_quadratic` | 0.25 → 0.05 (0.04) A | – | in its alias set | 1 |" in text


def test_an_absent_recording_is_told_and_kept_for_the_page(tmp_path: Path) -> None:
    case = RealCase("absent", ("emps/no_such_recording",), "nothing")
    (first,), _ = run_all([case], tmp_path, (SerialExecutor(), 1))
    assert first.record is None
    assert first.error
    (again,), _ = run_all([case], tmp_path, (SerialExecutor(), 1), resume=True)
    assert again == first


def test_cases_have_names_of_their_own() -> None:
    assert len({case.name for case in REAL_CASES}) == len(REAL_CASES)
