"""Motors in MIT mode: Damiao, T-Motor AK, Xiaomi CyberGear."""
