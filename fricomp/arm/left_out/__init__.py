"""Times that an arm's answer leaves out, and why."""
