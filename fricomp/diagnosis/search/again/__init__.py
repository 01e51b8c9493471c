"""What a search has shown that asks for another one: another base, another noise, a torque that acts late."""
