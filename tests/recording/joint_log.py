"""The good log of the study on flawed ones, for the tests of recordings."""

from fricomp.sim_bench.studies.logs.good_log import COULOMB, INERTIA, VISCOUS, joint_log

__all__ = ["COULOMB", "INERTIA", "VISCOUS", "joint_log"]
