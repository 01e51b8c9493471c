"""Which public recordings are diagnosed, what is hidden in them, and what others found."""

from dataclasses import dataclass


@dataclass(frozen=True)
class RealCase:
    """Recordings of one joint that are diagnosed together.

    Attributes:
        name: Short, also that of the folder.
        sources: Names for `fricomp.recording.read_public`.
        hidden: What is in them, as far as others or a simple fit could tell.
        expected: Effects of which one should be named or in its alias set; empty where none is promised.
        refuted: Effects that must not be named.
        listed: Effects of which `hidden` lists some, none of them promised; the page says whether one was found.
        published: Figures of others, in their own words and measures.
        remark: Why it does not come out, as far as that is known.
        arm: Name of the arm whose joints these are; empty for recordings of one joint.
        known: Known value, in SI units, of a parameter of the effect that is expected, by name.
    """

    name: str
    sources: tuple[str, ...]
    hidden: str
    expected: tuple[str, ...] = ()
    refuted: tuple[str, ...] = ()
    listed: tuple[str, ...] = ()
    published: str = ""
    remark: str = ""
    arm: str = ""
    known: tuple[tuple[str, float], ...] = ()

    @property
    def effects(self) -> frozenset[str]:
        """Effects that are in it, promised or not."""
        return frozenset((*self.expected, *self.listed))


_LOAD = ("load_coulomb", "load_quadratic", "load_stribeck")
_FRICTION = (
    *_LOAD,
    "stribeck_shape",
    "position_coulomb",
    "presliding_hysteresis",
    "power_law_viscous",
    "quadratic_drag",
)
_PLACE = ("position_coulomb", "cogging", "kinematic_error")

REAL_CASES = (
    RealCase(
        "ur10e-joint-2",
        ("ur10e/joint_2",),
        "friction that grows with the load of a joint that carries the arm",
        expected=_LOAD,
        published="simple fit of halves: 0.251 A without, 0.051 A with friction proportional to the load; Stribeck "
        "adds nothing (5 Hz low pass, above 0.03 rad/s)",
    ),
    RealCase(
        "ur10e-joint-1",
        ("ur10e/joint_1",),
        "control: the axis is vertical, so no gravity load",
        refuted=_LOAD,
        published="simple fit of halves: 0.088 A, 0.067 A with a richer speed curve, 0.065 A with load",
    ),
    RealCase(
        "ur10e-payload",
        ("ur10e/fourier", "ur10e/fourier_load"),
        "all joints on one exciting trajectory, without and with a payload of 2.805 kg",
        expected=("payload_error",),
        refuted=_FRICTION,
        published="the payload was weighed; with the published drive gains instead of those in the log it comes out "
        "some 12 % lower",
        arm="ur10e",
        known=(("mass", 2.805),),
    ),
    RealCase(
        "fairino-joint-3",
        ("nnfm-fairino-franka/fairino_s",),
        "ripple over position, about 0.00125 rad",
        expected=("cogging",),
        known=(("period", 0.00125),),
        published="RMS of the authors' models on the file: Coulomb-viscous 1.970, Stribeck 1.920, LuGre 11.3, PINN "
        "3.130, their network 1.337 N·m",
    ),
    RealCase(
        "fairino-joint-2",
        ("nnfm-fairino-franka/fairino_luoxuan",),
        "the same ripple, and a load that varies with position",
        expected=("cogging",),
        known=(("period", 0.00125),),
        published="RMS of the authors' models on the file: Coulomb-viscous 6.059, SVM 4.360, PINN 2.802, their network "
        "0.982 N·m",
        remark="the ripple has its period, but a size that grows with the speed fits better, and so slow a motion does "
        "not determine the inertia: one of some hundred kg·m² lets an uneven gear draw that better than cogging",
    ),
    RealCase(
        "franka-joint-7",
        ("nnfm-fairino-franka/franka_case4_slow",),
        "offset, weak position dependence",
        listed=_PLACE,
        published="RMS of the authors' models on the file: Coulomb-viscous 0.500, Stribeck 0.263, LuGre 0.260, PINN "
        "0.060, their network 0.035 N·m",
    ),
    RealCase(
        "laas-cogging",
        ("laas-cogging/speed_without",),
        "cogging of a bare motor, orders 72, 18, 12, 24, 36 a turn",
        expected=("cogging",),
        known=(("order", 72.0),),
        published="mean squared speed error 14 → 1.3 (rad/s)² with the authors' table fed forward",
    ),
    RealCase(
        "laas-cogging-compensated",
        ("laas-cogging/speed_with",),
        "the same motor with the authors' feed-forward: the current now carries the cogging torque on purpose",
        expected=("cogging",),
    ),
    RealCase(
        "anymal-sea",
        ("anymal-sea/walk",),
        "a series-elastic drive that follows its command late; legs touch the ground, so the load is unknown",
        expected=("torque_delay", "drive_lag"),
        refuted=_FRICTION,
        published="learned network 0.74 and 0.97 N·m, ideal actuator without delay 3.55 and 5.74 N·m (authors' other "
        "logs)",
    ),
    RealCase(
        "brfd-backlash",
        ("brfd-backlash/1hz_36lb",),
        "presliding of a band brake; a dead zone in it",
        expected=("presliding_hysteresis", "backlash"),
        published="authors' LuGre model on two earthquakes: relative error 0.508 and 0.628; simple fit of halves: "
        "Coulomb-viscous 0.665, Dahl 0.214",
        known=(("sigma_0", 2.98e6),),
    ),
    RealCase(
        "emps",
        ("emps/train", "emps/pulses"),
        "asymmetry, concave viscous curve, ripple of one motor turn (2.5 mm)",
        listed=("power_law_viscous", "stribeck_shape", *_PLACE),
        published="M 95.11 kg, F_v 203.5 N·s/m, F_c 20.39 N, offset -3.165 N",
    ),
    RealCase(
        "bam-xl330",
        ("bam-xl330/kp100_sin_sin",),
        "load-dependent friction that differs between driving and braking, supply sag; modest",
        listed=(*_LOAD, "supply_sag"),
        published="position error of a forward simulation: Coulomb-viscous 0.059, load-dependent 0.055 rad",
        remark="the torque is a voltage, sampled at 188 Hz with skew between its channels",
    ),
    RealCase(
        "servo-large",
        ("servo-presliding/large_1", "servo-presliding/large_2", "servo-presliding/large_5"),
        "direction asymmetry, running-in",
        listed=("thermal_friction",),
        published="F_c 0.0149, F_s 0.0230 N·m, σ₀ 1.387 N·m/rad (unverified)",
    ),
    RealCase(
        "servo-presliding",
        ("servo-presliding/presliding_1",),
        "presliding loops six encoder counts high",
        published="σ₀ 1.387 N·m/rad (unverified)",
    ),
    RealCase(
        "laas-standstill",
        ("laas-cogging/stopped",),
        "holding current at 3142 places of a turn",
        published="R² 0.963 of 20 harmonics from the forward pass on the reverse pass",
    ),
    RealCase("daisy-flexible-arm", ("daisy-flexible-arm/sweep",), "an elastic arm; torque and acceleration only"),
)
