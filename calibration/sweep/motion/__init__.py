"""The joint in motion: cycle by cycle, from the first push through every plateau, stopped at any limit."""
