"""A weight hung on a simulated joint, for trying what a user would do with a real one."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fricomp.errors import ParameterError
from fricomp.whole_file import write_whole

from ..stand_in import PACKAGED_MODELS, packaged_model

__all__ = ["hang_weight"]

PACKAGED_JOINTS = {
    "default_joint": ["joint"],
    "two_link_arm": ["shoulder", "elbow"],
    "six_joint_arm": ["base", "shoulder", "elbow", "wrist_1", "wrist_2", "wrist_3"],
}


def hang_weight(
    backend: str, configuration: Mapping[str, Any], joint: str, weight: tuple[float, float], file: Path
) -> dict[str, Any]:
    """The configuration of the same simulated joints with a weight on one of them.

    Args:
        backend: `sim`, or one of the twins in this process.
        configuration: Its own.
        joint: Name of the joint; empty for the first.
        weight: Mass [kg], and distance from the joint's axis [m], along the body that it moves.
        file: Where the changed MJCF file is written; with a mass of 0 an unchanged one.

    Raises:
        ParameterError: The model cannot be read, or has no such joint.
    """
    changed = dict(configuration)
    table = dict(changed if backend == "sim" else changed.get("sim", {}))
    name = str(table.get("model", "default_joint"))
    if not table.get("joints"):
        if name not in PACKAGED_JOINTS:
            raise ParameterError(f"name the joints of {name!r} that are to be driven, under [[joints]]")
        table["joints"] = [{"name": each} for each in PACKAGED_JOINTS[name]]
    source = packaged_model(name) if name in PACKAGED_MODELS else Path(name)
    write_whole(file, _with_weight(source, joint or table["joints"][0]["name"], *weight))
    table["model"] = str(file)
    return table if backend == "sim" else changed | {"sim": table}


def _with_weight(source: Path, joint: str, mass: float, lever: float) -> str:
    import mujoco
    import numpy as np

    try:
        model: Any = mujoco.MjSpec.from_file(str(source))
    except ValueError as error:
        raise ParameterError(f"{source} is not a model that MuJoCo can load: {error}") from error
    hinge = model.joint(joint)
    if hinge is None:
        raise ParameterError(f"{source} has no joint {joint!r}")
    if mass > 0.0:
        axis = np.array(hinge.axis) / np.linalg.norm(hinge.axis)
        along = np.array(hinge.parent.ipos) - np.array(hinge.pos)
        along -= (along @ axis) * axis
        size = float(np.linalg.norm(along))
        if size < 1e-9:
            raise ParameterError(f"the body of joint {joint!r} has its centre on the axis: nowhere to hang a weight")
        body = hinge.parent.add_body(name="hung_weight", pos=np.array(hinge.pos) + along * lever / size)
        body.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.01, 0, 0], mass=mass, contype=0, conaffinity=0)
    model.compile()
    return str(model.to_xml())
