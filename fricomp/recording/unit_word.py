"""Units as the names of columns write them: in brackets, or behind the word of the quantity."""

import re
from collections.abc import Sequence
from typing import NamedTuple

from fricomp.recording.quantity_word import TOKEN
from fricomp.recording.unit import UNITS

UNKNOWN_UNIT = "?"
"""Stands for a unit that is one, and that nobody here knows: its column is asked about and never taken as SI."""

_SPELLED = {
    "deg": "deg degree degrees grad gradi graus grados graus·decimais degres degrés graden grader stopnie stopni stupne"
    " stupnů fok градусы градусов 度 mdeg=mdeg mgrad=mdeg mdegrees=mdeg millidegrees=mdeg cdeg=cdeg cdegrees=cdeg"
    " mrad=mrad urad=urad rad=rad rads=rad radian=rad radians=rad град рад=rad мрад=mrad 弧度=rad",
    "gon": "gon gons gradian gradians",
    "arcmin": "arcmin arcmins arcminute arcminutes arcsec=arcsec arcsecs=arcsec arcseconds=arcsec",
    "turns": "turn turns rev revs revolution revolutions rot rots rotation rotations mrev=mturns mrevs=mturns"
    " mturn=mturns mturns=mturns",
    "m": "m mm=mm cm=cm um=um inch=in in=in м мм=mm см=cm",
    "rad/s": "rad/s 弧度/秒 度/秒=deg/s gradi/s=deg/s graus/s=deg/s grados/s=deg/s degrés/s=deg/s graden/s=deg/s"
    " radps mrad/s=mrad/s mdeg/s=mdeg/s deg/s=deg/s dps=deg/s degps=deg/s рад/с град/с=deg/s grad/s=deg/s"
    " radians·per·second degrees·per·second=deg/s",
    "rpm": "rpm 1/min u/min umdr/min 转/分 转/分钟 tr/min giri/min obr/min omw/min"
    " varv/min ot/min rev/min r/min min^-1 об/мин krpm=krpm",
    "turns/s": "turns/s turn/s rev/s rot/s rps hz",
    "m/s": "m/s mm/s=mm/s cm/s=cm/s in/s=in/s м/с мм/с=mm/s",
    "rad/s^2": "rad/s^2 rad/s/s deg/s^2=deg/s^2 deg/s/s=deg/s^2 m/s^2=m/s^2 mm/s^2=mm/s^2",
    "Nm": "nm n·m mnm=mNm mn·m=mNm nmm=mNm n·mm=mNm ncm=Ncm n·cm=Ncm cnm=Ncm knm=kNm kn·m=kNm danm=daNm dan·m=daNm"
    " 牛米 牛·米 牛顿·米 н·м нм мн·м=mNm"
    " newton·meters newton·meter newton·metres kn·mm knmm kn·cm=daNm",
    "kgf·cm": "kgf·cm kg·cm kgfcm kgcm kgf·m=kgf·m kg·m=kgf·m kgfm=kgf·m kgm=kgf·m",
    "gf·cm": "gf·cm g·cm gfcm gcm unm=uNm un·m=uNm",
    "in·lbf": "in·lbf in·lb lbf·in lb·in inlbf inlb lbin lbfin",
    "ft·lbf": "ft·lbf ft·lb lbf·ft lb·ft ftlbf ftlb lbft lbfft",
    "oz·in": "oz·in ozf·in in·oz in·ozf ozin ozfin inoz",
    "N": "n kn=kN dan=daN lbf=lbf kgf=kgf kip=kip н кн=kN",
    "A": "a ma=mA amp=A amps=A ampere=A amperes=A arms=A a·rms=A apk=A ap=A а ма=mA 安 安培 毫安=mA",
    "V": "v mv=mV volt=V volts=V",
    "degC": "c degc ℃ k=K degf=degF",
    UNKNOWN_UNIT: "erpm ka kdeg",
}
"""Name of a unit, and how it is written in small letters; `as=NAME` where that is another one's."""
_NAMES = {
    spelled.partition("=")[0]: spelled.partition("=")[2] or unit
    for unit, all_of_it in _SPELLED.items()
    for spelled in all_of_it.split()
}
_KINDS = {
    "rad": "position", "m": "position", "rad/s": "velocity", "m/s": "velocity", "rad/s²": "acceleration",
    "m/s²": "acceleration", "N·m": "torque", "N": "torque", "A": "current", "V": "voltage", "°C": "temperature",
}  # fmt: skip
_ATOMS = frozenset(
    [
        *(
            "n",
            "kn",
            "mn",
            "nm",
            "mnm",
            "cm",
            "mm",
            "m",
            "km",
            "um",
            "s",
            "sec",
            "ms",
            "min",
            "h",
            "rad",
            "mrad",
            "deg",
        ),
        *("rev", "turn", "a", "ma", "v", "mv", "w", "kw", "kg", "kgf", "g", "gf", "lb", "lbf", "oz", "ozf", "in", "ft"),
        *("qc", "qcs", "pulse", "pulses", "count", "counts", "bit", "bits", "per", "thousand", "hundred", "mille"),
        *("permille", "permil", "promille", "percent", "rated", "nominal", "reference"),
        *("hz", "khz", "pu", "j", "c", "k", "pa", "bar", "inc", "lsb", "cnt", "cts", "digit", "digits", "u"),
        *("click", "clicks", "native", "user", "unit", "units", "microsteps"),
    ]
)
"""What units consist of: a text in brackets of nothing else is a unit, and no remark."""
_LONGEST_SYMBOL = 5
"""Letters of a symbol: what is shorter on both sides of a slash in brackets is a unit."""
_BRACKETS = re.compile(r"[\[(]([^\[\]()]*)[\])]")
_STEP = re.compile(r"(?:^|[\s(])\d*\.\d+\s*$")
"""A number before a unit: `2.69 [mA]` is what a step of a register is worth."""
_BARE = re.compile(
    r"(?<![A-Za-zА-яµμ])((?i:deg/sec|deg/s|deg_s|degps|dps|mdeg|deg|degrees|gradi|graus|grados|rad/sec|rad/s|rad_s|mrad|[uµμ]rad|rads|rad|1/min|min\^?-1|min⁻¹|u/min"
    r"|turns/s|turns|rev/s|rev|mnm|nmm|n[·._*-]?cm|cnm|knm|dan[·._*-]?m|nm|m?n[·._*]m|n[·._*-]mm|[uµμ]nm|[uµμ]n[·._*-]m|gf?[·._*-]?cm|kgf?[·._*-]?m|kgf?[·._*-]?cm|in[·._*-]?lbf?|lbf?[·._*-]in|ft[·._*-]?lbf?|lbf?[·._*-]ft|ozf?[·._*-]?in|in[·._*-]ozf?"
    r"|lbf|kgf|kip|ma|mm/s|mm_s|mm|[uµμ]m|m/s|cm|degc|kn|mv|e?rpm"
    r"|(?:radians|degrees)[_ ]per[_ ]second|radians|newton[_ ]met(?:er|re)s?|amperes"
    r"|рад/с|град/с|об/мин|мрад|рад|град|мн[·.*⋅]?м|н[·.*⋅]?м|мм/с|мм|см|ма|кн)|[АНм]|°/s|°C|°|A(?!\d)|V(?!\d)|m(?!\d)|N|C(?!\d))(?![A-Za-zА-я])"
)
_WIDE = {code: code - 0xFEE0 for code in range(0xFF01, 0xFF5F)} | str.maketrans("・･•∙‧【】〔〕", "·····[][]")
"""Letters, brackets and points between factors as Chinese and Japanese texts have them: `トルク（Ｎ・ｍ）`."""
_REGISTER = re.compile(r"0x[0-9A-Fa-f]+")
"""Address of a register, whose last letter is no unit: `0x606C`."""
_BEHIND_IN = re.compile(r"\bin ([^\s,;]+)$")
"""A unit at the end of a name: `Winkel in Grad`."""
_SYMBOLS = {
    word: symbol
    for symbol, words in {
        "deg": "deg degs degree degrees",
        "rad": "rad rads radian radians",
        "rev": "rev revs revolution revolutions turn turns rot rots rotation rotations",
        "s": "sec secs second seconds",
        "min": "min mins minute minutes",
        "n": "newton newtons",
        "nm": "newtonmeter newtonmeters newtonmetre newtonmetres",
        "m": "meter meters metre metres",
        "a": "amp amps ampere amperes",
        "lb": "lb lbs lbf pound pounds",
        "ft": "ft foot feet",
        "in": "in inch inches",
        "oz": "oz ozs ozf ounce ounces",
        "g": "gram grams",
    }.items()
    for word in words.split()
}
"""Words in which a unit is spelled out, and the symbols that they are."""
_SHORT = (
    *("mdeg", "cdeg", "mrad", "rpm", "rps", "dps", "radps", "degps", "nm", "mnm", "nmm", "ncm", "cnm", "knm", "ma"),
    *("urad", "gon", "arcmin", "arcsec", "mrev", "mrevs", "mturns", "krpm"),
    *("mm", "cm", "kg", "kgf", "kgcm", "kgfcm", "ozin", "inlb", "inlbf", "ftlb", "ftlbf", "lbft", "lbin"),
)
"""Units in a few letters that mean nothing else as a word of their own: `speedRpm`."""
_MILLI = ("nm", "a", "rad", "deg")
"""Symbols to which the letter before them belongs: `MNm`, `mAmps`."""
_PREFIXES = {"milli": "m", "centi": "c", "micro": "u", "kilo": "k"}
_AMBIGUOUS = frozenset(["in", "rot", "rotation", "min", "kg", "oz", "lb"])
"""Words that alone are as often none: `current_in` is what goes in."""
_LONGEST_PHRASE = 5
"""Words of a unit: `milli newton meters per second`."""
_INVERSE = re.compile(r"^(?:(rad|deg|mm|cm|m|rev|r|u)[\s·.*]?)?(s|min)(?:\^?-|⁻)([12¹²])$")
"""Units as powers: `min-1`, `rad s^-1`, `m·s⁻²`."""
_AS_RATE = {"deg": "deg/s", "mm": "mm/s", "m": "m/s", "turns": "turns/s", "rad": "rad/s", "cm": "cm/s"}
_AS_SECOND = {"deg": "deg/s^2", "mm": "mm/s^2", "m": "m/s^2", "rad": "rad/s^2"}
"""What the unit of a way means beside the word of a rate: `speed_deg`."""
_SI = ("rad", "rad/s", "rad/s^2", "Nm", "A", "degC")


class UnitWord(NamedTuple):
    """A unit in a name.

    Attributes:
        unit: Its name, or `UNKNOWN_UNIT`.
        span: Where it stands.
        text: As it is written.
    """

    unit: str
    span: tuple[int, int]
    text: str


def find_unit_words(name: str, begin: int) -> list[UnitWord]:
    """The units that a name states from a place on: those in brackets, or else those that stand alone.

    Args:
        name: Of a column.
        begin: Where the word of its quantity begins.
    """
    found, name = list[UnitWord](), make_narrow(name)
    for match in _BRACKETS.finditer(name):
        unit = read_bracket(match.group(1))
        if unit and _STEP.search(name[: match.start()]):
            unit = UNKNOWN_UNIT
        if unit and match.start() > begin:
            found.append(UnitWord(unit, match.span(), match.group(1)))
    if found:
        return found
    behind = _BEHIND_IN.search(name)
    if behind and behind.start() > begin and read_unit(behind.group(1)):
        return [UnitWord(read_unit(behind.group(1)), behind.span(), behind.group(1))]
    name = _REGISTER.sub(lambda number: " " * len(number.group()), name)
    phrases = _find_phrases(name, begin)
    bare = [(match, read_unit(match.group())) for match in _BARE.finditer(name) if match.start() > begin]
    apart = [UnitWord(unit, match.span(), match.group()) for match, unit in bare if unit]
    said = _take_longest([*apart, *phrases])
    return [one._replace(unit=UNKNOWN_UNIT) if _STEP.search(_spaced(name[: one.span[0]])) else one for one in said]


def _is_preposition(words: Sequence[str]) -> bool:
    """Whether the first word is no inch: `angle_in_degrees`, `torque_in_oz_in`, but `torque_in_lb`."""
    return words[0] == "in" and (_read_symbol(words[1]) not in ("lb", "oz") or words[-1] == "in")


def _read_symbol(word: str) -> str:
    """The symbol that a word of a unit is; empty where it is none. `milliamps` is one word of a prefix and another."""
    if word in _SHORT:
        return word
    prefix = next((one for one in _PREFIXES if word.startswith(one) and word != one), "")
    symbol = _SYMBOLS.get(word.removeprefix(prefix), "")
    return f"{_PREFIXES.get(prefix, '')}{symbol}" if symbol else ""


def _take_longest(said: Sequence[UnitWord]) -> list[UnitWord]:
    """Of units that overlap the longer one, in their order."""
    taken = list[UnitWord]()
    for one in sorted(said, key=lambda one: one.span[0] - one.span[1]):
        if not any(a < one.span[1] and one.span[0] < b for _, (a, b), _ in taken):
            taken.append(one)
    letters = [one for one in taken if len(one.text) == 1]
    kept = [one for one in taken if one not in letters] or taken  # `q_m_deg` is a motor's angle, and in no metres
    return sorted(kept, key=lambda one: one.span)


def _spaced(name: str) -> str:
    """A name with spaces for the marks between its words: the number in `pos_0.1deg` is one by itself."""
    return name.replace("_", " ")


def _find_phrases(name: str, begin: int) -> list[UnitWord]:
    """The units that are words of their own or several: `posDeg`, `velocity_deg_per_sec`, `TorqueNewtonMeters`."""
    words = [match for match in TOKEN.finditer(name) if match.start() > begin]
    found, k = list[UnitWord](), 0
    while k < len(words):
        longest = range(min(_LONGEST_PHRASE, len(words) - k), 0, -1)
        count = next((n for n in longest if _read_phrase(words[k : k + n])), 0)
        if count:
            span = words[k].start(), words[k + count - 1].end()
            found.append(UnitWord(_read_phrase(words[k : k + count]), span, name[slice(*span)]))
        k += count or 1
    return found


def _read_phrase(matches: Sequence[re.Match[str]]) -> str:
    """Name of the unit that words following each other spell; empty where they spell none.

    A time behind another unit divides it. A letter in front of a unit belongs to it where nothing stands between.
    """
    words = [match.group().lower() for match in matches]
    if not words or (len(words) == 1 and words[0] in _AMBIGUOUS) or _is_preposition(words):
        return ""
    spelled, prefix, over = "", "", False
    for k, word in enumerate(words):
        joined = k + 1 < len(words) and matches[k].end() == matches[k + 1].start()
        if word in _PREFIXES or (word == "m" and joined and _read_symbol(words[k + 1]) in _MILLI):
            prefix += _PREFIXES.get(word, word)
        elif word in ("per", "p") and spelled and not over:
            over = True
        else:
            short = word == "s" if spelled else word == "m" and words[k + 1 : k + 2] in (["s"], ["sec"], ["per"])
            symbol = word if short else _read_symbol(word)
            if not symbol or (symbol in ("s", "min") and not spelled):
                return ""
            mark = "" if not spelled else "/" if over or symbol in ("s", "min") else "·"
            spelled, prefix, over = f"{spelled}{mark}{prefix}{symbol}", "", False
    if prefix or over:
        return ""
    return _NAMES.get(spelled, UNKNOWN_UNIT if len(words) > 1 else "")


def make_narrow(name: str) -> str:
    """A name with letters, brackets and points of the usual width, each in its place."""
    return name if name.isascii() else name.translate(_WIDE)


def read_unit(text: str) -> str:
    """Name of the unit that a text is; empty where it is none."""
    return _NAMES.get(_spell(text, bare=True), "")


def kind_of_unit(unit: str) -> str:
    """The quantity that a unit is of; empty where it is unknown."""
    return _KINDS.get(UNITS[unit].si, "") if unit in UNITS else ""


def unit_for(quantity: str, unit: str) -> str:
    """The unit's name beside this quantity; empty where it is that of SI."""
    if quantity == "velocity":
        unit = _AS_RATE.get(unit, unit)
    if quantity == "acceleration":
        unit = _AS_SECOND.get(unit, unit)
    if quantity == "torque" and unit == "A":
        return unit
    return "" if unit in _SI else unit


_POWER = r"10(?:\^?[-−]\d+|⁻[⁰¹²³⁴-⁹]+)"
_FACTORS = (
    re.compile(
        rf"^\s*[x×·*]?\s*(?:{_POWER}|[eE][-−]\d+\s|(?:1\s*/\s*)?\d*[.,]?\d+(?:[eE][+-]?\d+)?)\s*[x×·*]?\s*(?=[^\d\s/^⁻])"
    ),
    re.compile(rf"(?<=\w)\s*(?:[x×·*]\s*(?:{_POWER}|\d+)|[eE][-−]\d+)\s*$"),
    re.compile(
        r"^\s*(?:raw|scaled|milli|centi|micro|kilo|tenths?|hundredths?|thousandths?)[\s-]+(?:of\s+)?", re.IGNORECASE
    ),
)
"""What stands about a unit of which numbers are so many: `1e-3 deg`, `1/1000 Nm`, `10⁻³ rad`, `Nm x 100`, `milli-A`."""
_AXIS = re.compile(r"[A-Z]\d{1,2}")
"""A capital and a number, as robots call their axes; no unit is written so."""


def read_bracket(text: str) -> str:
    """The unit in brackets; empty where it is a number, a remark, or an axis: `pos[J1]`, `torque (A2)`."""
    if not read_unit(text) and any(
        rest != text and read_unit(rest) for rest in (one.sub("", text) for one in _FACTORS)
    ):
        return _NAMES.get(_spell(text), "") or _read_phrase(list(TOKEN.finditer(text))) or UNKNOWN_UNIT
    spelled = "" if _AXIS.fullmatch(text.strip()) else _spell(text)
    if spelled.startswith(UNKNOWN_UNIT):
        return UNKNOWN_UNIT
    if not spelled or spelled.isdigit():
        return ""
    if spelled in _NAMES:
        return _NAMES[spelled]
    phrase = _read_phrase(list(TOKEN.finditer(text)))
    if phrase and not re.search(r"\d", spelled):
        return phrase
    atoms = [atom for atom in re.split(r"[·/^\d%‰:]+", spelled) if atom]
    is_fraction = "/" in spelled and all(len(atom) <= _LONGEST_SYMBOL for atom in atoms)
    is_unit = is_fraction or all(atom in _ATOMS or atom in _NAMES or _read_symbol(atom) for atom in atoms)
    return UNKNOWN_UNIT if is_unit and (atoms or re.search(r"[/%‰]", spelled)) else ""


def _spell(text: str, *, bare: bool = False) -> str:
    """A unit as the table has it: in small letters of usual width, a point between factors."""
    text = (
        make_narrow(text).strip().lower().replace("°c", "degc").replace("°", "deg").replace("µ", "u").replace("μ", "u")
    )
    text = re.sub(r"\bsec\b", "s", text).replace("²", "^2").replace("**2", "^2")
    if bare:
        text = re.sub(r"^(rad|deg|mm|m)_s$", r"\1/s", text)
    text = _INVERSE.sub(lambda found: f"{found[1] or '1'}/{found[2]}{'^2' if found[3] in '2²' else ''}", text)
    return re.sub(r"\s*[*.\-⋅×_·]\s*|\s+(?=\w)", "·", text).replace(" ", "")
