"""Adapters measured: against independent encoders, under garbage, in time, and over a serial line."""
