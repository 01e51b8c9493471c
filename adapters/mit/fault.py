"""What the fault codes of MIT-mode motors mean, in words."""

# Beyond every vendor's own codes.
FAULT_NOT_ENABLED = 0x1001
FAULT_POSITION_EDGE = 0x1002

OWN_CODES = {
    FAULT_NOT_ENABLED: "it has stopped by itself: its watchdog, or a power cycle",
    FAULT_POSITION_EDGE: "its position is at the edge of what it can tell, and may be anywhere beyond",
}
DAMIAO_CODES = {
    0x8: "supply voltage too high",
    0x9: "supply voltage too low",
    0xA: "current too high",
    0xB: "power stage overheated",
    0xC: "motor overheated",
    0xD: "its watchdog has fired, because it heard nothing",
    0xE: "overloaded",
}
"""Status of a motor that is neither enabled nor disabled [damiao2024]."""
AK_CODES = {
    1: "motor overheated",
    2: "current too high",
    3: "supply voltage too high",
    4: "supply voltage too low",
    5: "encoder fault",
}
"""Those on which the vendor's manuals agree [cubemars2021]."""
CYBERGEAR_BITS = {
    0x01: "supply voltage too low",
    0x02: "current too high",
    0x04: "overheated",
    0x08: "magnetic encoder fault",
    0x10: "Hall sensor fault, or overloaded",
    0x20: "not calibrated",
}
"""Bits 16 to 21 of the identifier: of the CyberGear [xiaomi2023], and of a Robstride [robstride2024]."""
