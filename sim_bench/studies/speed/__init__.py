"""How long everything takes, in units of a fixed amount of arithmetic, and how that grows with what is given."""
