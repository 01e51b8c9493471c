"""Whether identifications of joints whose friction is known find it, and how many of them take a second."""
