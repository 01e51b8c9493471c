"""Which joint a column is of, by what its name shares with others."""
