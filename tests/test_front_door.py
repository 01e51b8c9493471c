"""What stands at the top of the package: there, typed, light, and doing what the commands do."""

from __future__ import annotations

import signal
import subprocess
import sys
import threading
import typing
from pathlib import Path

import numpy as np
import pytest

import fricomp
from fricomp.calibration.sweep import Calibration
from fricomp.errors import MissingExtraError, SweepAborted
from fricomp.laws import Cogging, FrictionLaw, Viscous
from fricomp.model import FrictionModel

QUICK = fricomp.SweepSettings(
    speeds="0.01,0.03,0.05,0.08,0.3,1.5", repeats=1, dwell=0.4, warm_up=0.2, tare=0.5, breakaway_positions=1
)


def test_dir_shows_the_public_names_and_nothing_else() -> None:
    assert dir(fricomp) == sorted([*fricomp.__all__, "__version__"])
    assert "TYPE_CHECKING" not in dir(fricomp)


@pytest.mark.parametrize(
    "name", ["calibrate", "identify", "diagnose", "read_recording", "load_model", "Compensator", "ControlLoop"]
)
def test_a_newcomers_names_are_there_and_say_what_they_do(name: str) -> None:
    assert name in fricomp.__all__
    assert (getattr(fricomp, name).__doc__ or "").strip()


def test_the_folders_of_a_loop_and_of_a_diagnosis_stay_small_enough_to_learn() -> None:
    import fricomp.control
    import fricomp.diagnosis

    assert len(fricomp.control.__all__) <= 20
    nouns = [line for line in (fricomp.diagnosis.__doc__ or "").splitlines() if line.startswith("- `")]
    assert 10 <= len(nouns) <= 15


def test_every_lazy_name_is_declared_for_type_checkers_where_it_lives() -> None:
    source = Path(fricomp.__file__).read_text()
    declared = source[source.index("if TYPE_CHECKING:") : source.index("__all__")]
    for name, (module, _) in fricomp._HOMES.items():
        lines = [line for line in declared.splitlines() if line.strip().startswith(f"from {module} import")]
        assert any(name in line for line in lines), (name, module)
    assert set(fricomp._HOMES) <= set(fricomp.__all__)


@pytest.mark.parametrize(
    ("name", "package", "extra"),
    [("calibrate", "scipy", "calibrate"), ("identify", "scipy", "calibrate"), ("diagnose", "numba", "diagnose")],
)
def test_a_name_whose_packages_are_missing_says_which_extra_brings_them(name: str, package: str, extra: str) -> None:
    code = f"import sys; sys.modules[{package!r}] = None; import fricomp; fricomp.{name}"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert f"{package}" in done.stderr.splitlines()[-1]
    assert f"pip install '.[{extra}]'" in done.stderr.splitlines()[-1]


@pytest.fixture(scope="module")
def calibration(tmp_path_factory: pytest.TempPathFactory) -> tuple[Calibration, Path, list[str]]:
    out, told = tmp_path_factory.mktemp("calibrated") / "run", []
    options = fricomp.CalibrationOptions()
    found = fricomp.calibrate(
        "sim", settings=QUICK, options=options, out=out, progress=lambda text, done: told.append(text)
    )
    return found, out, told


def test_calibrate_finds_the_friction_of_the_simulated_joint_and_writes_the_run(
    calibration: tuple[Calibration, Path, list[str]],
) -> None:
    found, out, told = calibration
    assert found.model.forward.coulomb_torque == pytest.approx(0.15, rel=0.03)
    written = {path.name for path in out.iterdir()}
    assert {"run.json", "recording.csv", "friction.json", "friction.onnx", "report.html"} <= written
    assert fricomp.load_model(out / "friction.json").law == found.model.law
    assert any("warming up" in text for text in told)


def test_calibrate_does_not_replace_a_run_unless_told(calibration: tuple[Calibration, Path, list[str]]) -> None:
    with pytest.raises(SweepAborted, match="overwrite"):
        fricomp.calibrate("sim", settings=QUICK, out=calibration[1])


def test_calibrate_takes_its_configuration_as_a_table() -> None:
    with pytest.raises(fricomp.FricompError, match="'canopen', but 'sim' is asked for"):
        fricomp.calibrate("sim", config={"backend": "canopen"})


def test_calibrate_outside_the_main_thread_warns_of_signals_that_it_cannot_hear(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(signal, "getsignal", lambda number: signal.SIG_DFL)  # another test may have left a handler
    heard: list[BaseException] = []

    def run() -> None:
        try:
            with pytest.warns(RuntimeWarning, match="hears no signal"):
                fricomp.calibrate("sim", joint="no such joint")
        except fricomp.FricompError as error:
            heard.append(error)

    thread = threading.Thread(target=run)
    thread.start()
    thread.join()
    assert "no joint" in str(heard[0])


def test_a_calibration_shows_itself(calibration: tuple[Calibration, Path, list[str]]) -> None:
    found = calibration[0]
    assert repr(found).startswith("<Calibration of joint joint: converged, 1")
    assert "\n" not in repr(found)
    for result in (found, found.result):
        text = result.summary()
        assert "stribeck.forward.coulomb_torque" in text
        assert "N·m·s/rad" in text
        assert "<td>stribeck.forward.coulomb_torque</td>" in result._repr_html_()
        figure = result.plot()
        assert [axes.get_xlabel() for axes in figure.axes] == ["speed [rad/s]"] * 2
        assert figure._repr_png_().startswith(b"\x89PNG")  # type: ignore[attr-defined]


def test_a_friction_model_shows_itself() -> None:
    model = FrictionModel(FrictionLaw((Viscous(0.02), Cogging(0.1, 0.0, 10.0))), joint="elbow")
    assert repr(model) == "<FrictionModel of joint elbow: viscous + cogging [N·m]>"
    assert "viscous.coefficient" in model.summary() or "viscous.viscous_coefficient" in model.summary()
    (axes,) = model.plot().axes
    assert axes.get_ylabel() == "friction torque [N·m]"
    assert {tuple(np.sign(line.get_xdata())) for line in axes.lines}  # both directions, apart at rest


def test_a_recording_shows_itself() -> None:
    recording = fricomp.Recording.from_channels(
        {"time": [0.0, 0.1, 0.2], "position": [0.0, 1.0, 2.0], "torque": [1.0, 1.0, 3.0]}
    )
    assert repr(recording) == "<Recording of joint joint: 0.2 s, 10 Hz, position, torque [N·m]>"
    assert "position  rad   0       2" in recording.summary()
    assert [axes.get_ylabel() for axes in recording.plot("torque").axes] == ["torque [N·m]"]
    with pytest.raises(fricomp.FricompError, match="no channel 'speed': it has time, position, torque"):
        recording.plot("speed")


def test_a_picture_without_matplotlib_names_the_extra(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    with pytest.raises(MissingExtraError, match=r"pip install '\.\[report\]'"):
        FrictionModel(FrictionLaw((Viscous(0.02),))).plot()


def test_public_functions_annotate_every_argument() -> None:
    for name in fricomp.__all__:
        thing = getattr(fricomp, name)
        if callable(thing) and not isinstance(thing, type):
            hints = thing.__annotations__
            names = thing.__code__.co_varnames[: thing.__code__.co_argcount + thing.__code__.co_kwonlyargcount]
            assert set(names) <= set(hints), name
    assert typing.TYPE_CHECKING is False
