"""Forward dynamics of the concealed joint in closed loop, 20 substeps a millisecond (20 kHz).

Beside the true motion the kernel carries the friction core of the joint without any effect along the same motion,
so that every sample knows the torque that a rigid joint with the right parameters leaves unexplained:

    concealed = torque - (J a + G(q) + friction without effects)
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from .compiled import Record, compile_cached
from .drive import advance_drive, compute_command
from .environment import advance_attached, compute_position_torque
from .friction import (
    advance_bristles,
    advance_memory,
    compute_base_level,
    compute_friction_level,
    compute_viscous_torque,
)
from .plant import ELEMENTS, STATE

SAMPLE_PERIOD = 1e-3  # [s]
SUBSTEPS = 20
_DT = SAMPLE_PERIOD / SUBSTEPS
_SET_VALUED = 3.0
_COLUMNS = 10


class Motion(NamedTuple):
    """What the joint really did, at the sample instants; torques and acceleration are means over one period
    centred there. All arrays have shape (n_samples,).

    Attributes:
        position: [rad]
        velocity: [rad/s]
        acceleration: [rad/s²]
        torque: What the drive reports, without noise [N·m].
        concealed: What a rigid joint with the right parameters leaves unexplained [N·m].
        sense: Dry friction without effects over its level, -1 to 1.
        load: Transmitted load torque [N·m].
        command: Controller output [N·m].
        seen: What the encoder shows [rad].
        winding: Temperature rise of the winding [K].
    """

    position: NDArray[np.float64]
    velocity: NDArray[np.float64]
    acceleration: NDArray[np.float64]
    torque: NDArray[np.float64]
    concealed: NDArray[np.float64]
    sense: NDArray[np.float64]
    load: NDArray[np.float64]
    command: NDArray[np.float64]
    seen: NDArray[np.float64]
    winding: NDArray[np.float64]


@compile_cached
def _compute_gravity(q: float, p: Record) -> float:
    return float(p.gravity * np.sin(q + p.gravity_angle))


@compile_cached
def _compute_spring(position: float, velocity: float, s: Record, p: Record) -> float:
    """Torque through the flexible transmission with this end of it on the motor's side [N·m], none inside the gap."""
    stretch = position - s.link_position
    half = 0.5 * p.gap
    stretch -= min(max(stretch, -half), half)
    if stretch == 0.0 and p.gap > 0.0:
        return 0.0
    linear = p.stiffness * stretch
    damping = p.spring_damping * (velocity - s.link_velocity)
    return float(linear * (1.0 + p.hardening * linear * linear) + damping)


@compile_cached
def _compute_kinematic(s: Record, p: Record) -> tuple[float, float]:
    """Inertia and load seen through a transmission with a position error, by Lagrange's equation."""
    angle = p.kinematic_order * s.position + p.kinematic_phase
    error = p.kinematic * np.sin(angle)
    slope = 1.0 + p.kinematic * p.kinematic_order * np.cos(angle)
    bend = -p.kinematic * p.kinematic_order**2 * np.sin(angle)
    inertia = p.inertia - p.link_inertia + p.link_inertia * slope * slope
    load = _compute_gravity(s.position + error, p) * slope + p.link_inertia * slope * bend * s.velocity * s.velocity
    return float(inertia), float(load)


@compile_cached
def _advance_link(dt: float, s: Record, p: Record) -> tuple[float, float]:
    """Inertia [kg·m²] on the motor's side of the transmission and the load torque there [N·m]."""
    if p.flexible > 0.0:
        angle = p.kinematic_order * s.position + p.kinematic_phase
        slope = 1.0 + p.kinematic * p.kinematic_order * np.cos(angle)
        torque = _compute_spring(s.position + p.kinematic * np.sin(angle), s.velocity * slope, s, p)
        link_acceleration = (torque - _compute_gravity(s.link_position, p)) / p.link_inertia
        s.link_velocity += dt * link_acceleration
        s.link_position += dt * s.link_velocity
        s.load = torque
        return float(p.inertia - p.link_inertia), float(torque * slope)
    inertia, load = p.inertia, _compute_gravity(s.position, p)
    if p.kinematic != 0.0:
        inertia, load = _compute_kinematic(s, p)
    s.load += (load + p.link_inertia * s.acceleration - s.load) * (1.0 - np.exp(-dt / 1e-3))
    return float(inertia), float(load)


@compile_cached
def _follow_shadow(dt: float, z: np.ndarray, shares: np.ndarray, s: Record, p: Record) -> float:
    """Dry friction without effects over its level, along the true motion."""
    v = s.felt_velocity
    if p.core == _SET_VALUED:
        if s.velocity != 0.0:
            return float(np.sign(s.velocity))
        slope = p.viscous_forward if v >= 0.0 else p.viscous_reverse
        needed = s.current - _compute_gravity(s.felt_position, p) - p.inertia * s.acceleration - slope * v
        level = compute_base_level(v if v != 0.0 else 1e-12 * np.sign(needed), p)
        return float(min(max(needed / level, -1.0), 1.0))
    level = compute_base_level(v, p)
    shape = (p.core, p.base_sigma_0, p.base_sigma_1, p.slip_rate)
    return float(advance_bristles(v, dt, level, shape, z, shares) / level)


@compile_cached
def _advance_substep(
    time: float, outside: tuple[float, float, float], z: np.ndarray, shares: np.ndarray, s: Record, p: Record
) -> None:
    """Advance the joint by one substep; `outside` is disturbance [N·m], temperature [°C], factor on friction."""
    disturbance, temperature, factor = outside
    applied = advance_drive(time, _DT, s, p)
    s.felt_position, s.felt_velocity = s.position, s.velocity
    inertia, load = _advance_link(_DT, s, p)
    advance_memory(s.velocity, _DT, s, p)
    v = s.lagged_velocity
    net = (
        applied
        - load
        - compute_viscous_torque(v, temperature, s, p)
        - compute_position_torque(s.position, s.velocity, p)
    )
    net -= advance_attached(_DT, s, p) + disturbance
    # A joint at rest is held by the friction of the direction in which it is pushed.
    level = compute_friction_level(v if v != 0.0 else 1e-12 * np.sign(net), temperature, factor, s, p)
    if p.core == _SET_VALUED:
        dry = min(max(net + inertia * s.velocity / _DT, -level), level)
    else:
        dry = advance_bristles(s.velocity, _DT, level, (p.core, p.sigma_0, p.sigma_1, p.slip_rate), z, shares)
    s.acceleration = (net - dry) / inertia
    s.velocity += _DT * s.acceleration
    if p.core == _SET_VALUED and abs(dry) < level:
        s.velocity = 0.0
    s.position += _DT * s.velocity


@compile_cached
def _observe(z: np.ndarray, shares: np.ndarray, s: Record, p: Record, total: np.ndarray) -> None:
    """Add this substep's acceleration, torque, concealed torque, sense and load to `total`."""
    sense = _follow_shadow(_DT, z, shares, s, p)
    v = s.felt_velocity
    slope = p.viscous_forward if v >= 0.0 else p.viscous_reverse
    level = compute_base_level(v if v != 0.0 else 1e-12 * sense, p)
    known = p.inertia * s.acceleration + _compute_gravity(s.felt_position, p) + slope * v + sense * level
    total[0] += s.acceleration
    total[1] += s.current
    total[2] += s.current - known
    total[3] += sense
    total[4] += s.load


@compile_cached
def _run(
    reference: np.ndarray, outside: np.ndarray, shares: np.ndarray, state: np.ndarray, plant: np.ndarray
) -> np.ndarray:
    """The closed loop over all samples; columns as the fields of `Motion`."""
    s, p = state[0], plant[0]
    n = reference.shape[0]
    out = np.zeros((n, _COLUMNS))
    z, z_shadow = np.zeros(shares.shape[1]), np.zeros(shares.shape[1])
    early, late = np.zeros(5), np.zeros(5)
    for k in range(n):
        out[k, 0], out[k, 1] = s.position, s.velocity
        s.command = compute_command(reference[k, 0], reference[k, 1], SAMPLE_PERIOD, s, p)
        out[k, 7], out[k, 8], out[k, 9] = s.command, s.last_measured, s.winding
        around = (outside[k, 0], outside[k, 1], outside[k, 2])
        early[:] = 0.0
        half = SUBSTEPS // 2
        for i in range(half):
            _advance_substep(k * SAMPLE_PERIOD + i * _DT, around, z, shares, s, p)
            _observe(z_shadow, shares, s, p, early)
        for c in range(5):
            out[k, 2 + c] = (early[c] + (late[c] if k > 0 else early[c])) / SUBSTEPS
        late[:] = 0.0
        for i in range(half):
            _advance_substep(k * SAMPLE_PERIOD + (half + i) * _DT, around, z, shares, s, p)
            _observe(z_shadow, shares, s, p, late)
    return out


def simulate(
    plant: NDArray[np.void],
    reference: NDArray[np.float64],
    outside: NDArray[np.float64],
    shares: NDArray[np.float64],
) -> Motion:
    """Run the plant in closed loop from rest at the first reference.

    Args:
        plant: See `build_plant`, shape (1,).
        reference: Position [rad] and velocity [rad/s], shape (n_samples, 2).
        outside: Disturbance torque [N·m], temperature [°C] and factor on friction, shape (n_samples, 3).
        shares: Strengths and stiffnesses of the Maxwell elements, shape (2, ELEMENTS).
    """
    assert shares.shape == (2, ELEMENTS)
    state = np.zeros(1, dtype=STATE)
    for name in ("position", "link_position", "cable_position", "detent_position", "absorber_position"):
        state[name] = reference[0, 0]
    state["last_measured"] = reference[0, 0]
    out = _run(np.ascontiguousarray(reference), np.ascontiguousarray(outside), shares, state, plant)
    return Motion(*(np.ascontiguousarray(column) for column in out.T))
