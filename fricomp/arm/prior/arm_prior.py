"""Standard deviations that a recording is met with."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ArmPrior:
    """Standard deviations before the recording. They decide where a motion says little, and nothing where it says much.

    Attributes:
        links: Of each coordinate of a link's inertia, relative: 0.1 is a mass, and a size, that are right to some
            20 %. Make it larger where the links' masses are guessed, smaller where they were weighed.
        rotors: Of a rotor's inertia, as part of what the simulation states and what the torques allow. It is what
            simulations know least: a URDF holds none, and an MJCF often one number for all joints. Make it smaller
            where rotors were measured.
        friction: Of each friction torque, as part of the joint's typical torque. Wide, since nobody knows friction.
        stribeck: Of what a Stribeck curve has above its Coulomb level, as part of that level: gears have up to one.
        spring: Of a spring's stiffness, as part of the Coulomb level per radian: a cable pulls by about what the joint
            rubs. Where gravity varies with the joint, a wider one lets a spring be anything that links may weigh.
        load_friction: Of friction per transmitted torque [N·m/N·m]; gears have 0.04 to 0.29 [bittencourt2010].
        delay: Of the time by which all torques are late behind the positions [s].
        tilt: Of how far gravity leans over along each level axis [rad], where the recording asks for it: by eye, bases
            are level to a degree.
        gain: Of the factor on all torques, relative to 1, where the recording is found to ask for one. A gain and the
            masses of all links are nearly the same.
        opened: As `links`, of a link that the recording shows to be off: a payload is several links.
    """

    links: float = 0.1
    rotors: float = 1.0
    friction: float = 3.0
    stribeck: float = 0.5
    spring: float = 1.0
    load_friction: float = 0.3
    delay: float = 0.01
    tilt: float = 0.02
    gain: float = 0.1
    opened: float = 1.0
