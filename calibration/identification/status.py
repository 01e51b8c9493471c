"""How an identification ended, in one word."""

from enum import StrEnum


class Status(StrEnum):
    """How an identification ended; the points of `LACK_OF_FIT` do not follow the law within their scatter."""

    CONVERGED = "converged"
    LACK_OF_FIT = "lack_of_fit"
    NOT_CONVERGED = "not_converged"
    WRONG_BASIN_SUSPECTED = "wrong_basin_suspected"
    NOT_IDENTIFIABLE = "not_identifiable"
