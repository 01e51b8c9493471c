"""Words for what says, beside numbers, whose they are and what: names of columns in tables, keys in documents."""

JOINT_LABELS = ("joint", "joint_name", "motor", "motor_name", "axis", "actuator", "drive")
"""Whose a number is."""

SIGNAL_LABELS = (
    *("__name__", "name", "target", "metric", "field", "_field", "measurement", "label", "refid"),
    *("signal", "variable", "channel", "topic", "key", "tag", "series"),
    *("nodeid", "node_id", "displayname", "display_name", "browsename"),
)
"""What a number is; where several of these are there, the first of them says it."""
