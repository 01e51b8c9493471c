"""What a sweep will do: speeds, plateaus, their velocity over time, and what they can tell."""
