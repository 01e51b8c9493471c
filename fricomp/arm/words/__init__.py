"""What the terminal says of an arm."""
