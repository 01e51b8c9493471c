"""Units of columns beyond a word in a name: numbers before them, and one quantity in several."""
