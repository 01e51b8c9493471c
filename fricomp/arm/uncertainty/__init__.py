"""How well the numbers of an arm are known: `scatter` (stretches left out), `alternatives` and `averaging` (models)."""
