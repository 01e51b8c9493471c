"""The usable parts of a recording: rows that are held, stray or at rest are left out, each with its reason."""
