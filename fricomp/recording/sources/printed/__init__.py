"""Texts that are a table but for the form in which their program prints it, one form a module, made plain."""
