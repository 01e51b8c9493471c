"""Words for the quantities of a joint, as the names of columns have them in several languages."""

import re
import unicodedata
from typing import NamedTuple

_UPPER, _LOWER = "A-ZÀ-ÖØ-ÞЁА-ЯІЇ", "a-zß-öø-žа-яёії"
TOKEN = re.compile(
    rf"[{_UPPER}]+(?![{_LOWER}])|[{_UPPER}]?[{_LOWER}]+|\d+|[\u3040-\u30ff\u4e00-\u9fff]+|[\uac00-\ud7a3]+|[θφωτ]"
)

_QUANTITIES = {
    "position": """q pos position positions angle angles theta qpos winkel posizione phi ang displacement stroke weg
        lage posicion posicao positie poloha pozycja angulo angolo hoek vinkel kat uhel szog kulma aci konum
        угол положение позиция координата кут θ φ 位置 角度 角 转角 轉角 각도 위치 fpos""",
    "velocity": """dq qd qdot geschw vel velo velocity velocities speed omega spd qvel dtheta thetadot geschwindigkeit
        drehzahl vitesse velocidad velocidade velocita snelheid hastighet rychlost predkosc nopeus hiz sebesseg
        скорость швидкість ω 角速度 速度 转速 轉速 回転数 각속도 속도 fvel""",
    "acceleration": "ddq qdd qddot acc acceleration accelerations qacc beschleunigung ускорение",
    "torque": """tau torque torques effort efforts eff moment trq torq tq tor force drehmoment kraft couple coppia
        frc koppel vridmoment momentti tork nyomatek pwm duty момент сила усилие τ 力矩 扭矩 转矩 轉矩 トルク 토크""",
    "current": """current currents amps iq iqf curr strom courant corriente corrente akim virta
        ток струм 电流 電流 전류""",
    "temperature": "temp temperature temperatures temperatur температура 温度 溫度 온도",
}
"""Words for a quantity, in small letters without accents: English, and those of spreadsheets in other languages.

Single letters but q are left out: they are as often a joint's name."""

TIMES: tuple[str, ...] = (
    *("t", "ts", "time", "times", "timestamp", "timestamps", "stamp", "stamps", "tstamp", "elapsed", "date", "datum"),
    *("clock", "zeit", "uhrzeit", "zeitstempel", "temps", "heure", "tiempo", "hora", "fecha", "tempo", "tijd", "tid"),
    *("czas", "cas", "zaman", "aika", "ido", "tout", "ipoc", "zeitpunkt"),
    *("время", "час", "时间", "時間", "时刻", "時刻", "시간"),
)
"""Words for a time."""

_LONGEST_WORD = 60
"""Letters of a word that may be two: what is longer is none."""
_COMPOUND = re.compile(
    r"(\w+)(drehmoment|moment|geschwindigkeit|drehzahl|beschleunigung|winkel|strom|temperatur|kraft|position)"
)
"""Words that German joins to one: `Gelenkwinkel`, `Sollposition`."""
_GLUED = re.compile(
    r"((?:joint|jnt|actuator|motor|axis|link)+)"
    r"(pos|position|angle|vel|velocity|speed|acc|frc|force|torque|trq|effort|current|temp|temperature)"
)
"""Words that simulators and drives write as one: `jointpos`, `actuatorfrc`, `motorspeed`."""
_JOINED = re.compile(
    r"(.+?)(角速度|位置|角度|速度|转速|轉速|力矩|扭矩|转矩|轉矩|トルク|电流|電流|温度|溫度|角|각도|위치|각속도|속도|토크|전류)"
)
"""Words that Chinese, Japanese and Korean join to one."""


_TWO_WORDS = (_COMPOUND, _GLUED, _JOINED)

WANTED: tuple[str, ...] = (
    *("cmd", "command", "commands", "commanded", "cmptd", "ref", "reference", "des", "desired"),
    *("target", "targets", "goal", "goals", "setpoint", "setpoints", "soll", "set", "demand", "demanded", "consigne"),
    *("action", "actions", "sp"),
    *("目标", "目標", "指令", "期望", "设定", "목표", "지령"),
    *("заданный", "заданная", "заданное", "задание", "уставка"),
)
"""Words of what a joint is asked for."""


_BRACKETS = re.compile(r"\[[^\[\]]*\D[^\[\]]*\]|\([^()]*\)")
"""What stands in brackets behind a name and is no number: a unit, such as `[reference unit]`."""


def _simplify_letters(word: str) -> str:
    """A word in small letters without accents, each letter as one."""
    letters = (unicodedata.normalize("NFD", letter)[0] for letter in word.lower())
    return word if not word.isascii() and word[0] >= "\u3040" else "".join(letters)


WORDS = {_simplify_letters(word): quantity for quantity, words in _QUANTITIES.items() for word in words.split()}
_KNOWN = WORDS.keys() | {_simplify_letters(word) for word in TIMES}


def split_words(name: str) -> list[tuple[str, tuple[int, int]]]:
    """The words of a name in small letters, with where they stand; those that German joins are two."""
    words = []
    for match in TOKEN.finditer(name):
        word, (start, end) = _simplify_letters(match.group()), match.span()
        is_whole = word in WORDS or len(word) > _LONGEST_WORD
        joined = None if is_whole else next(filter(None, (one.fullmatch(word) for one in _TWO_WORDS)), None)
        if joined:
            cut = start + joined.end(1)
            words += [(joined.group(1), (start, cut)), (joined.group(2), (cut, end))]
        else:
            words.append((word, (start, end)))
    return words


def count_known(names: list[str]) -> int:
    """Number of names of which a word is a quantity or a time."""
    return sum(any(word in _KNOWN for word, _ in split_words(name)) for name in names)


def says_asked_for(name: str) -> bool:
    """Whether a column or topic is called as what a joint was asked for: `q_ref`, `/arm/goal`, a policy's `action`."""
    return any(word in WANTED for word, _ in split_words(_BRACKETS.sub("", name)))


_OBJECTS = {
    **dict.fromkeys(("6064", "6063"), "position"),
    **dict.fromkeys(("606C", "6069"), "velocity"),
    "6077": "torque",
    "6078": "current",
    **dict.fromkeys(("6062", "607A"), "position_reference"),
    **dict.fromkeys(("606B", "60FF"), "velocity_reference"),
    **dict.fromkeys(("6071", "6074"), "torque_command"),
}
"""Channels of the objects of a drive, by their addresses [cia402]."""
_ADDRESS = re.compile(
    rf"(?<![0-9A-Za-z])(?:0x)?({'|'.join(_OBJECTS)})(?:h|[:._ -]?(?:sub ?)?0?0)?(?![0-9A-Za-z])", re.IGNORECASE
)
"""An address, with the index 0 below it: `0x6064`, `6064h`, `6064:00`."""


class ObjectName(NamedTuple):
    """A column that is called as an object.

    Attributes:
        channel: Channel of a recording.
        left: The rest of the name, the joint's own.
    """

    channel: str
    left: str


def find_object(name: str) -> ObjectName | None:
    """The object that a column is called as, `axis1.0x6064`; None where it is none that is read.

    Args:
        name: Of the column.
    """
    found = _ADDRESS.search(name)
    if found is None:
        return None
    left = re.sub(r"[^0-9A-Za-z]+", "_", f"{name[: found.start()]} {name[found.end() :]}").strip("_")
    return ObjectName(_OBJECTS[found.group(1).upper()], left)
