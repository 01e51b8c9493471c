"""How fast the signals of an arm may change, and by how much its torques are late."""
