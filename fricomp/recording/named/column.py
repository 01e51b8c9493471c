"""What the name of a column says: which quantity, of which joint, in which unit."""

import re
from dataclasses import dataclass

from fricomp.recording.quantity_word import TOKEN, WANTED, WORDS, find_object, split_words
from fricomp.recording.unit import UNITS
from fricomp.recording.unit_word import (
    UNKNOWN_UNIT,
    UnitWord,
    find_unit_words,
    kind_of_unit,
    make_narrow,
    read_unit,
    unit_for,
)

_MEASURED = {"measured": 2, "meas": 2, "actual": 2, "act": 2, "msr": 2, "state": 1, "states": 1}
_MEASURED |= dict.fromkeys(("feedback", "fb", "fdb", "fbk"), 1)
_MEASURED |= {"j": 0, "present": 2, "ist": 2, "est": 0, "estimate": 0, "estimated": 0}
_MEASURED |= {"value": 0, "values": 0, "data": 0, "signals": 0, "averaged": 0, "average": 0, "avg": 0, "mean": 0}
_MEASURED |= {"applied": 1, "computed": 0, "mech": 0, "mechanical": 0, "pv": 2, "phase": -1}
_MEASURED |= {"filtered": 0, "filt": 0, "active": 0, "in": 0, "ang": 0, "angular": 0, "dreh": 0}
_MEASURED |= {"измеренный": 2, "измеренная": 2, "измеренное": 2, "фактический": 2, "факт": 2, "угловая": 0, "실제": 2}
"""Words of columns that were measured, and how surely they say it: the feedback of a controller is a part of a command
as well. `tau_J` is a Franka's."""
_RATES = {"dot": ("velocity", "acceleration"), "ddot": ("acceleration", "")}
"""Words behind that of a position or a velocity which make a derivative of it."""
_CURRENT = re.compile(r"(?<![A-Za-z0-9])[iI](_?\d+$|_q(?![A-Za-z])|_act(?:ual)?(?:_?\d+)?$)")
"""`i_q`, `i0`, `I_3`, `i_actual_2`: the letter alone is as often a row's number or a joint's name."""

_MOTOR = ("motor", "rotor", "двигателя")
_STATES = ("state", "states")
"""Behind a motor's word: `motor_state[3].q` is Unitree's angle of the joint, and beside it stands its torque."""
_SENSOR = ("sensor", "load", "transducer", "loadcell")
"""Words of a torque that a sensor behind the gear measures."""
_OUTSIDE = ("ext", "external", "contact")
"""Words of a torque that an observer believes to come from outside; it is none of the joint's."""

_PARTS_OF_TORQUE = (
    *("ff", "feedforward", "gravity", "friction", "coriolis", "inertial", "dist", "disturbance", "comp"),
    *("compensation", "residual", "model"),
)
"""Words of a torque that is worked out, or a part of what the motor gives."""
_OUTSIDE_OF = {
    "torque": _PARTS_OF_TORQUE,
    "current": ("bus", "dc", "battery", "batt", "supply", "input", "total"),
    "position": ("elec", "electrical", "electric"),
}
"""Words of what is none of the joint's: parts of a torque, a current that goes into a drive, an angle within a pair of
poles.
"""
_UNIT_FIRST = re.compile(r"(mNm|Ncm|Nm|mA|mm|mrad|rad|deg|rpm)_(?=.)")
_AXES = ("i", "current", "currents", "curr", "cur", "amps", "strom", "voltage", "volt", "spannung")
"""Words beside which `q` and `d` are axes of the field."""

_NO_CHANNEL: tuple[str, ...] = ("err", "error", "errors", "constant", "kt", "limit", "limits", "dimensions", "inertia")
_NO_CHANNEL += ("min", "max", "std", "stdev", "stddev", "sd", "stderr", "sem", "variance")
"""Words of what is worked out from a channel, bounds it, or makes another one of it."""
_SWITCHES = ("enable", "enabled", "mode", "status", "flag", "fault", "id")
_OF_PATHS = (*_SWITCHES, "model")
"""Words of what switches a channel or says how it is; in front of a point or a slash they say whose it is."""

_OBSERVATION = re.compile(r"^observation\.(?:\w+\.(?=.*\.(?:pos|vel|effort|torque|current|load)$))?")
"""What LeRobot writes before the name of a joint and of what is said of it."""

_ADDRESS = re.compile(r"(?<=\w) ?\(0x(?!6)[0-9A-Fa-f]+\)$")
"""Of a register behind its name, which is no joint's; those of CiA 402 say what they hold [cia402]."""

_TIMES = ("time", "times", "stamp", "timestamp", "tout")
"""Last words of a column that says when another one was taken: `velocity.time`."""

_CLOCKS = ("time", "timestamp", "zeit")
"""First words of the time of another column, where both stand in two lines: `Time/Angle [s]` beside `Value/Angle`."""

REFERENCES = {"position": "position_reference", "velocity": "velocity_reference", "torque": "torque_command"}

_ROTARY = ("rad", "rad/s", "N·m")
"""Units that hardly anything but a joint has, so that the rest of a name may be the joint's own."""
_ANGLES = ("theta", "angle", "angles", "winkel", "omega", "drehzahl")
_FORCES = ("force", "kraft")
"""Words that say the unit of their quantity, or what it is not."""
_RAW: tuple[str, ...] = (
    "count",
    "counts",
    "tick",
    "ticks",
    "raw",
    "lsb",
    "increments",
    "pulses",
    "codes",
    "steps",
    "encoder",
)
_RAW += ("cnt", "cnts", "cts", "inc", "incs", "qc", "pulse", "digits")
_RAW += ("percent", "pct", "pwm", "duty", "permille")
"""Words of columns in units of a device or in parts of a rating, which no name says the size of."""
_SYMBOLS = {"position": "xyzs", "current": "i", "torque": "fmt", "velocity": "vw", "acceleration": "a"}
"""Letters by which a quantity is written."""
_ENCODER = ("encoder", "enc", "ticks", "counts")
"""Words of a position, where no other word is a quantity."""
_CURRENTS = ("cur",)
"""Words of a current, where no other word is a quantity: `pos_cur` is the position now."""
RAW_UNIT = "counts"
REPEATED = "#"
"""Before the number of a column that shares its name with others, of which it is not known which is meant."""


@dataclass(frozen=True)
class ColumnMeaning:
    """What a column holds.

    Attributes:
        channel: Channel of a recording.
        joint: What is left of the name: the joint's own, or a number.
        certainty: How surely the name says that it was measured, from 0.
        unit: Name of its unit; empty where it is that of SI, or not said; `RAW_UNIT` where it is that of a device,
            `UNKNOWN_UNIT` where it is one that nobody here knows.
        scale: What its numbers are multiplied by behind their unit.
    """

    channel: str
    joint: str
    certainty: int
    unit: str
    scale: float = 1.0


def read_column_name(name: str) -> ColumnMeaning | None:
    """Say what a column holds by its name; None where no word of it is a quantity.

    `q_3`, `Position3`, `actual_q_2`, `tau_J:4`, `shoulder.effort`, `/joint_states/elbow/velocity`, `q_cmd[deg]:1`.
    """
    name = without_observation(make_narrow(name))
    words = split_words(name)
    found = _find_quantity(name, words)
    if found is None:
        drive = find_object(name)
        if drive is not None:
            return ColumnMeaning(drive.channel, drive.left, 1, RAW_UNIT)
        unit = read_unit(name) if len(name) > 1 else ""  # `rad`, `mA`; single letters are as often a joint's name
        kind = kind_of_unit(unit)
        return ColumnMeaning(kind, "", 0, unit_for(kind, unit)) if kind and kind != "voltage" else None
    at, quantity = found
    said = _find_units(name, words[at])
    quantity = _settle_quantity(quantity, said)
    roles = {k: role for k in range(len(words)) if (role := _find_role(k, words, at, quantity, has_unit=bool(said)))}
    roles = {
        k: role for k, role in roles.items() if not any(one.span[0] < words[k][1][0] < one.span[1] for one in said)
    }
    roles |= {k: "number" for k, (word, span) in enumerate(words) if word in _OF_PATHS and _stands_in_path(name, span)}
    rate = next((words[k][0] for k, role in roles.items() if role == "rate"), "")
    if rate:
        quantity = _RATES[rate][("position", "velocity").index(quantity)]
    if not quantity or "outside" in roles.values() or ("wanted" in roles.values() and quantity not in REFERENCES):
        return None
    measured = [_MEASURED[words[k][0]] for k, role in roles.items() if role == "measured"]
    counted = said and re.split(r"[^a-z]", said[0].text.lower())[0] in _RAW
    is_raw = counted or "raw" in roles.values() or "%" in name or "‰" in name
    dropped = [words[at][1], *(one.span for one in said), *(words[k][1] for k in roles)]
    unit = "N" if words[at][0] in _FORCES else ""
    unit = RAW_UNIT if is_raw else unit_for(quantity, said[0].unit) if said else unit
    certainty = -1 if is_raw or unit == UNKNOWN_UNIT else max(measured, default=0)
    return ColumnMeaning(_find_channel(quantity, set(roles.values())), _cut_out(name, sorted(dropped)), certainty, unit)


def read_column_unit(name: str) -> ColumnMeaning | None:
    """Say what a column holds by the unit in its name, where no word of it is a quantity: `i_mA`, `elbow_Nm`.

    A unit of one letter, or of a length, belongs to a name of one letter alone: `phase_A` is no current. Behind a path
    that letter is `i`, `x` or what else it is the symbol of.
    """
    said = find_unit_words(name, 0)
    kind = kind_of_unit(said[0].unit) if said else ""
    if kind in ("", "voltage", "temperature") or _find_quantity(name, split_words(name)) is not None:
        return None
    words = [one for one in split_words(name) if not (one[1][0] < said[0].span[1] and said[0].span[0] < one[1][1])]
    words = [one for one in words if one[0] not in _OF_PATHS or not _stands_in_path(name, one[1])]
    roles = {k: role for k in range(len(words)) if (role := _find_role(k, words, -1, kind, has_unit=True))}
    is_rotary = UNITS[said[0].unit].si in _ROTARY
    said_of_it = [words[k] for k, role in roles.items() if not is_rotary and role in ("measured", "wanted")]  # i_meas
    own = [one for one in words if not _stands_in_path(name, one[1]) and one not in said_of_it]
    is_alone = len(words) - len(said_of_it) == 1
    is_letter = len(own) == 1 and len(own[0][0]) == 1 and (is_alone or own[0][0] in _SYMBOLS.get(kind, ""))
    if not is_rotary and not is_letter:
        return None
    if "outside" in roles.values() or ("wanted" in roles.values() and kind not in REFERENCES):
        return None
    dropped = [said[0].span, *(words[k][1] for k in roles), *(one[1] for one in own if is_letter)]
    channel = _find_channel(kind, set(roles.values()))
    return ColumnMeaning(channel, _cut_out(name, sorted(dropped)), -1, unit_for(kind, said[0].unit))


def says_current(name: str) -> bool:
    """Whether a column that stands for a torque is a current without a unit: `current`, or the letter `i` alone.

    The letter is as often a number of rows, so that it is none of its own accord.
    """
    meaning = read_column_name(name)
    is_letter = re.split(r"[/.]", name)[-1].strip().lower() == "i"
    return is_letter or (meaning is not None and meaning.channel == "current" and not meaning.unit)


def find_bare_unit(name: str) -> str:
    """The unit of a column that stands for a torque, where its words say it alone: A of a current, V of a voltage."""
    if says_current(name):
        return "A"
    words = {word for word, _ in split_words(name)}
    return "V" if words & set(_AXES[_AXES.index("voltage") :]) and not find_unit_words(name, -1) else ""


def says_counts(name: str) -> bool:
    """Whether a word of a name is a unit of a device, and not only that it is an encoder's."""
    return any(word in (*_RAW, "cpr") and word not in _ENCODER[:2] for word, _ in split_words(name))


def without_observation(name: str) -> str:
    """A name without what LeRobot writes before that of a joint and of what is said of it, and without an address."""
    return without_address(_OBSERVATION.sub("", name))


def without_address(name: str) -> str:
    """A name without the address of a register in brackets behind it: `POSITION(0x001)`."""
    return _ADDRESS.sub("", name)


def _settle_quantity(quantity: str, said: list[UnitWord]) -> str:
    """The quantity that word and unit agree on: `q-axis [A]` is a current; nothing where they contradict each other."""
    kind = kind_of_unit(said[0].unit) if said else ""
    if not kind or kind == quantity or (quantity == "torque" and kind in ("current", "voltage")):
        return quantity
    if kind == "position" and quantity in ("velocity", "acceleration"):
        return quantity  # speed_deg: degrees a second
    if quantity in ("position", "velocity") and kind in ("velocity", "acceleration", "current"):
        return kind
    return "torque" if (quantity, kind) == ("current", "torque") else ""


def _find_units(name: str, word: tuple[str, tuple[int, int]]) -> list[UnitWord]:
    """The units that a name states behind the word of its quantity, or in front of all: `mNm_tau`."""
    said = find_unit_words(name, word[1][0])
    if word[0] in _ANGLES or WORDS.get(word[0]) == "torque":  # theta_m and tau_m are a motor's, and not in metres
        said = [one for one in said if one.text not in ("m", "mm")]
    first = None if said else _UNIT_FIRST.match(name)
    return [UnitWord(read_unit(first[1]), first.span(), first[1])] if first else said


def _find_role(k: int, words: list[tuple[str, tuple[int, int]]], at: int, quantity: str, *, has_unit: bool) -> str:
    """What a word says of the quantity beside it; nothing where it is of the joint's name."""
    word = words[k][0]
    if word == "id" and k + 1 < len(words) and words[k + 1][0].isdigit():
        return "number"  # of the motor, as a bus calls it
    if _is_q_axis(k, words) or (word == "axis" and k and _is_q_axis(k - 1, words)):
        return "number"
    if _is_axis(k, words):
        return "number" if word == "q" else "outside"
    if _is_of_another(word, quantity) or (quantity == "current" and word == "in" and k == len(words) - 1):
        return "outside"
    if word in _RATES and k == at + 1 and quantity in ("position", "velocity"):
        return "rate"
    is_asked = word == "applied" and quantity not in ("torque", "current")  # such a torque acts; a motion is commanded
    if word in WANTED or is_asked or (word == "d" and k > at):
        return "wanted"
    if word in _MEASURED:
        return "measured"
    if quantity == "position" and word in _MOTOR and not (k + 1 < len(words) and words[k + 1][0] in _STATES):
        return "motor"
    if quantity == "torque" and word in (*_SENSOR, *_OUTSIDE):
        return "sensor" if word in _SENSOR else "outside"
    return "raw" if word in (*_RAW, *_ENCODER) and not has_unit else ""


def _is_q_axis(k: int, words: list[tuple[str, tuple[int, int]]]) -> bool:
    """Whether a word begins `Q axis`, that of the current which makes the torque, beside another quantity."""
    is_said = words[k][0] == "q" and k + 1 < len(words) and words[k + 1][0] == "axis"
    return is_said and any(word in WORDS and word != "q" for word, _ in words)


def _is_of_another(word: str, quantity: str) -> bool:
    """Whether a word says that a column is no measured channel of the joint."""
    return word in (*_NO_CHANNEL, *_SWITCHES, *_OUTSIDE_OF.get(quantity, ()))


def _is_axis(k: int, words: list[tuple[str, tuple[int, int]]]) -> bool:
    """Whether a word is `q` or `d` beside that of a current or a voltage: `current_q`, `motor.voltage.d`."""
    beside = [words[j][0] for j in (k - 1, k + 1) if 0 <= j < len(words)]
    return words[k][0] in ("q", "d") and any(word in _AXES for word in beside)


def _stands_in_path(name: str, span: tuple[int, int]) -> bool:
    """Whether a word stands before the last point or slash of a name."""
    return span[1] <= max(name.rfind("."), name.rfind("/"))


def _find_channel(quantity: str, roles: set[str]) -> str:
    if "wanted" in roles:
        return REFERENCES[quantity]
    return "motor_position" if "motor" in roles else "load_torque" if "sensor" in roles else quantity


def _find_quantity(name: str, words: list[tuple[str, tuple[int, int]]]) -> tuple[int, str] | None:
    """The word that is a quantity, the last of several, and which; None where there is none."""
    if "/" in name and words and words[0][0] in _CLOCKS:
        return None
    spoken = [
        word
        for word, (start, _) in words
        if not word.isdigit() and name[:start].count("[") <= name.count("]", 0, start)
    ]
    if spoken and spoken[-1] in _TIMES:
        return None
    letter = next((k for k, (word, _) in enumerate(words) if word == "i"), None)
    if letter is not None and len(words) > 1 and _CURRENT.search(name):  # and neither a position nor a joint's name
        return letter, "current"  # i_q
    known = [
        k for k, (word, _) in enumerate(words) if word in WORDS and not (_is_q_axis(k, words) or _is_axis(k, words))
    ]
    if len(known) > 1 and words[known[-1]][0] == "amps" and WORDS[words[known[-2]][0]] == "current":
        known.pop()  # the unit
    if known:
        return known[-1], WORDS[words[known[-1]][0]]
    for short, quantity in ((_ENCODER, "position"), (_CURRENTS, "current")):
        counted = [k for k, (word, _) in enumerate(words) if word in short]
        if counted:
            return counted[0], quantity
    return None


def _cut_out(name: str, spans: list[tuple[int, int]]) -> str:
    """What is left of a name, its last part where it is a path, with one underscore for all marks between words."""
    for start, end in reversed(spans):
        name = f"{name[:start]}\0{name[end:]}"
    parts = [part for part in re.split(r"[/\0]", name) if re.search(r"\w", part.strip("_"))]
    tail = "_".join(parts[-1:] if "/" in name else parts)
    return re.sub(r"[^0-9A-Za-z]+", "_", tail).strip("_")


def simplify_joint(name: str) -> str:
    """The words of a joint's name that tell it from others, so that `joint_1`, `J1` and `1` are the same."""
    words = [match.group().lower() for match in TOKEN.finditer(name)]
    kept = [word for word in words if word not in ("joint", "joints", "j", "jnt", "axis")]
    return "_".join(str(int(word)) if word.isdigit() else word for word in kept)


def name_joint(left: str) -> str:
    """Name of a joint: what a column calls it, or `joint_3` where that is a number."""
    return f"joint_{int(left)}" if left.isdigit() else left
