"""Terms that fit no curve as C, by the formulas of `fricomp.control.compensation.extra_terms`."""

from collections.abc import Mapping
from string import Template

from fricomp.control import CompensationSettings
from fricomp.control.compensation.extra_terms import TURNS_FORWARD, ExtraFormulas, find_bounds
from fricomp.export.c_source import C

EXTRA_FIELDS = """    $real position;           /* [$position_unit] */
    $real load_torque;        /* torque that the joint transmits to its load [$torque_unit] */
    $real temperature;        /* [degrees Celsius] */
    bool has_temperature;
    $real acceleration;       /* of the reference [$position_unit/s^2] */
"""

EXTRA_CHECKS = """    usable = usable && (isfinite(input->position) != 0) && (isfinite(input->load_torque) != 0);
    usable = usable && ((!input->has_temperature) || (isfinite(input->temperature) != 0));
    usable = usable && (isfinite(input->acceleration) != 0);
"""

_EXTRA = Template(
    """    {
$inputs        $real beside;
$after$formulas$kept        /* all of dry friction may vanish, but it never drives */
        beside = (beside < -level) ? -level : beside;
        torque += beside * tanh$f(direction / $smoothing);
    }
"""
)

_SPEED = Template(
    """        const $real fastest = (drive >= $zero) ? $high : $reverse_high;
        const $real sliding = (blended > $zero) ? blended : $zero;
        const $real speed = (sliding > fastest) ? fastest : sliding;
"""
)


def render_extra(extra: ExtraFormulas, settings: CompensationSettings, c: C) -> str:
    """The block that adds `extra` to the torque, and sets `drag` and `held`."""
    symbols, zero = extra.symbols, c.literal(0.0)
    names = {
        "is_forward": f"(drive >= {zero})",
        TURNS_FORWARD: f"(direction >= {zero})",
        "has_temperature": "input->has_temperature",
    }
    names |= {name: f"state->{name}" for step in extra.steps for name in step.states}
    states = [pair for step in extra.steps for pair in zip(step.states, step.after, strict=True)]
    return _EXTRA.substitute(
        real=c.real,
        f=c.suffix,
        smoothing=c.literal(settings.smoothing),
        inputs=_inputs(settings, symbols, c),
        after=c.assign({f"const {c.real} {name}_after": after for name, after in states}, names, prefix="s"),
        formulas=c.assign({"beside": extra.dry, "drag": extra.drag, "held": extra.held}, names),
        kept="".join(f"        state->{name} = {name}_after;\n" for name, _ in states),
    )


def _inputs(settings: CompensationSettings, symbols: frozenset[str], c: C) -> str:
    """Declarations of the inputs among `symbols`, held to their ranges."""
    bounds, text = find_bounds(settings), ""
    for name in ("velocity", "position", "load_torque", "temperature", "acceleration"):
        if name in symbols:
            value = "drive" if name == "velocity" else f"input->{name}"
            text += f"        const {c.real} {name} = {_held(value, bounds.get(name), c)};\n"
    low, high = settings.velocity_range
    edges: Mapping[str, str] = {"high": c.literal(high), "reverse_high": c.literal(-low)}
    return text + (_SPEED.substitute(edges, real=c.real, zero=c.literal(0.0)) if "speed" in symbols else "")


def _held(value: str, edges: tuple[float, float] | None, c: C) -> str:
    if edges is None:
        return value
    low, high = (c.literal(edge) for edge in edges)
    return f"({value} < {low}) ? {low} : (({value} > {high}) ? {high} : {value})"
