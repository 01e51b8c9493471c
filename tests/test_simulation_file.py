"""Simulations are read as robots ship them: for mass and kinematics, without what their files lack."""

from __future__ import annotations

from pathlib import Path

import pytest

from fricomp.errors import DiagnosisError, ParameterError
from fricomp.simulation_file import compile_simulation

MJCF = """<mujoco><asset><mesh name="shell" file="none.stl"/><texture name="t" type="2d" file="none.png"/>
<material name="m" texture="t"/></asset><default><geom material="m"/></default>
<worldbody><geom type="plane" size="1 1 1"/>
<body><inertial pos="0 0 0.1" mass="2" diaginertia="0.1 0.1 0.1"/><joint name="a"/><geom type="mesh" mesh="shell"/>
<body name="hand"><joint name="b"/><geom type="mesh" mesh="shell"/>{geom}</body></body></worldbody></mujoco>"""
BOX = '<geom type="box" size="0.1 0.1 0.1" density="1000"/>'
URDF = """<robot name="arm"><link name="base"/><link name="link">
<inertial><origin xyz="0 0 0.2"/><mass value="1.5"/>
<inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial>
<{place}><geometry><mesh filename="package://arm_description/link.{ending}"/></geometry></{place}></link>
<joint name="elbow" type="revolute"><parent link="base"/><child link="link"/><axis xyz="0 1 0"/>
<limit lower="-3" upper="3" effort="1" velocity="1"/></joint></robot>"""


def test_meshes_textures_and_materials_that_are_not_there_play_no_part(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(MJCF.format(geom=BOX))
    model = compile_simulation(tmp_path / "arm.xml")
    assert model.body_mass.tolist() == pytest.approx([0.0, 2.0, 8.0])


@pytest.mark.parametrize("ending", ["stl", "dae", "obj"])
@pytest.mark.parametrize("place", ["visual", "collision"])
def test_meshes_of_a_ros_package_play_no_part(tmp_path: Path, place: str, ending: str) -> None:
    (tmp_path / "arm.urdf").write_text(URDF.format(place=place, ending=ending))
    model = compile_simulation(tmp_path / "arm.urdf")
    assert model.body_mass[-1] == pytest.approx(1.5)
    assert model.joint(0).name == "elbow"


def test_a_body_that_weighs_by_its_mesh_alone_is_named(tmp_path: Path) -> None:
    (tmp_path / "arm.xml").write_text(MJCF.format(geom=""))
    with pytest.raises(DiagnosisError, match="'hand' has no mass but that of a mesh"):
        compile_simulation(tmp_path / "arm.xml")


@pytest.mark.parametrize("text", [None, "no simulation", "<mujoco><worldbody><body/></mujoco>"])
def test_what_is_no_simulation_is_refused(tmp_path: Path, text: str | None) -> None:
    path = tmp_path / "arm.xml"
    if text is not None:
        path.write_text(text)
    with pytest.raises(ParameterError, match=r"arm\.xml"):
        compile_simulation(path)


@pytest.mark.parametrize(
    ("old", "new"),
    [('value="1.5"', 'value="${mass}"'), ('name="elbow"', 'name="${prefix}elbow"'), ("<link", "<xacro:macro /><link")],
)
def test_the_source_of_a_urdf_is_refused_with_what_makes_one_of_it(tmp_path: Path, old: str, new: str) -> None:
    path = tmp_path / "arm.urdf"
    path.write_text(URDF.format(place="visual", ending="dae").replace(old, new, 1))
    with pytest.raises(ParameterError, match=r"xacro arm\.urdf > robot\.urdf"):
        compile_simulation(path)


def test_what_xacro_leaves_of_other_programs_plays_no_part(tmp_path: Path) -> None:
    left = '<xacro:arg name="ns" default=""/><gazebo><plugin><ns>$(arg ns)</ns></plugin></gazebo></robot>'
    path = tmp_path / "arm.urdf"
    path.write_text(URDF.format(place="visual", ending="dae").replace("</robot>", left))
    assert compile_simulation(path).joint(0).name == "elbow"
