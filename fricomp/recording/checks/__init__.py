"""What may mislead about a recording: clock, channels, units, signs and kinds of motion."""
