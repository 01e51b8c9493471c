"""What was found beside what the simulation has: links, and what its file states of friction and rotors."""
