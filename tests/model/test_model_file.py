"""The model file keeps everything, and refuses what it cannot trust."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import jsonschema
import msgspec
import numpy as np
import pytest

from fricomp.errors import ModelFileError, ParameterError
from fricomp.laws import BidirectionalStribeck, Coulomb, Dahl, FrictionLaw, SmoothedCoulomb, StribeckCurve
from fricomp.model import (
    Covariance,
    FrictionModel,
    Provenance,
    Validity,
    decode_model,
    encode_model,
    load_model,
    model_json_schema,
    save_model,
)


def example() -> FrictionModel:
    curve = StribeckCurve(0.15, 0.60, 0.05, 0.02)
    law = FrictionLaw((BidirectionalStribeck(curve, StribeckCurve(0.2, 0.7, 0.05, 0.03)), Dahl(0.1, 1e3)))
    names = ("stribeck.forward.coulomb_torque", "stribeck.reverse.viscous_coefficient")
    return FrictionModel(
        law.with_term(SmoothedCoulomb(0.1, 0.01, "arctan")),
        joint="shoulder",
        torque_unit="A",
        validity=Validity(velocity=(-1.0, 1.2), temperature=(20.0, 41.0)),
        covariance=Covariance(names, np.array([[4e-6, 1e-7], [1e-7, 9e-6]]), degrees_of_freedom=32),
        provenance=Provenance("pinn", "ab" * 32, "2026-01-01T00:00:00Z", "0.1.0", 7, {"noise": "relative"}),
    )


def test_a_model_survives_the_file_unchanged(tmp_path: Path) -> None:
    model = example()
    save_model(model, tmp_path / "friction.json")
    back = load_model(tmp_path / "friction.json")
    assert (back.law, back.validity, back.provenance) == (model.law, model.validity, model.provenance)
    assert (back.joint, back.motion, back.torque_unit) == ("shoulder", "rotary", "A")
    assert back.covariance is not None
    np.testing.assert_array_equal(back.covariance.matrix, model.covariance.matrix)  # type: ignore[union-attr]
    assert back.covariance.degrees_of_freedom == 32


def test_a_file_that_does_not_say_degrees_of_freedom_is_read() -> None:
    data = msgspec.json.decode(encode_model(example()))
    del data["covariance"]["degrees_of_freedom"]
    back = decode_model(msgspec.json.encode(data)).covariance
    assert back is not None
    assert back.degrees_of_freedom is None


def test_a_model_equals_what_its_file_holds_and_no_other() -> None:
    model = example()
    assert decode_model(encode_model(model)) == model
    assert model.covariance is not None
    vaguer = Covariance(model.covariance.names, 2.0 * model.covariance.matrix)
    assert replace(model, covariance=vaguer) != model
    assert replace(model, covariance=None) != model


def test_a_reference_load_may_be_in_any_unit() -> None:
    """Models of earlier versions have it in that of the torque."""
    data = encode_model(example())
    assert decode_model(data.replace(b'"as normal_load"', b'"N"')) == decode_model(data)


def test_the_file_names_units_and_standard_deviations() -> None:
    first = msgspec.json.decode(encode_model(example()))["law"][0]["parameters"]["forward.coulomb_torque"]
    assert first == {"value": 0.15, "unit": "A", "standard_deviation": 0.002}


def test_the_published_schema_describes_the_file() -> None:
    jsonschema.validate(msgspec.json.decode(encode_model(example())), model_json_schema())


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b'"fricomp.model/1"', b'"fricomp.model/2"', "newer"),
        (b'"fricomp.model/1"', b'"fricomp.model/0"', "a model file has"),
        (b'"fricomp.model/1"', b'"urdf/1"', "a model file has"),
        (b'"value": 0.15', b'"value": -0.15', "as a magnitude"),
        (b'"value": 0.15', b'"value": "0.15"', "damaged"),
        (b'"stribeck"', b'"grease"', "unknown friction term"),
        (b"forward.coulomb_torque", b"forward.culomb_torque", "damaged"),
        (b'"load.load_sensitivity"', b'"load"', "has no parameter load"),
        (b'"unit": "A"', b'"unit": "mA"', "'mA'; a rotary model with torque in A has 'A' there"),
        (b'"torque_unit": "A"', b'"torque_unit": "Nm"', "forward.coulomb_torque in 'A'; .* has 'Nm' there"),
        (b'"joint"', b'"jiont"', "damaged"),
        (b'"rotary"', b'"circular"', "damaged"),
        (b"}\n", b"", "damaged"),
    ],
)
def test_a_file_that_cannot_be_trusted_is_refused_in_one_sentence(old: bytes, new: bytes, message: str) -> None:
    data = encode_model(example())
    assert old in data
    with pytest.raises(ModelFileError, match=message) as error:
        decode_model(data.replace(old, new), "friction.json")
    assert "friction.json" in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("content", [b"", b"\x80\x04pickle", b"[]", b"null", b'{"schema": 1}', b"\xff\xfe"])
def test_foreign_bytes_are_refused(tmp_path: Path, content: bytes) -> None:
    (tmp_path / "m.json").write_bytes(content)
    with pytest.raises(ModelFileError, match="not a fricomp model file"):
        load_model(tmp_path / "m.json")


def test_missing_and_unwritable_files_say_so(tmp_path: Path) -> None:
    with pytest.raises(ModelFileError, match="cannot read"):
        load_model(tmp_path / "none.json")
    save_model(example(), tmp_path / "new" / "folder" / "m.json")
    with pytest.raises(ModelFileError, match="cannot make the folder"):
        save_model(example(), tmp_path / "new" / "folder" / "m.json" / "m.json")


def test_a_model_without_a_stribeck_curve_says_what_it_has() -> None:
    with pytest.raises(ParameterError, match="its terms are coulomb"):
        _ = FrictionModel(FrictionLaw((Coulomb(1.0),))).forward


@pytest.mark.parametrize("matrix", [np.eye(2), -np.eye(1), np.full((1, 1), np.nan)])
def test_an_impossible_covariance_is_refused(matrix: np.ndarray) -> None:
    with pytest.raises(ParameterError, match="covariance"):
        Covariance(("coulomb.coulomb_torque",), matrix)


def test_a_name_that_is_no_text_is_an_error_of_the_librarys_own(tmp_path: Path) -> None:
    model = FrictionModel(FrictionLaw((Coulomb(0.1),)), joint="el\ud800bow")
    with pytest.raises(ModelFileError, match=r"'el\\ud800bow' of the model is no text in UTF-8"):
        save_model(model, tmp_path / "friction.json")
    assert list(tmp_path.iterdir()) == []
