"""Logs as they come: good ones with flaws put into them, and what is made of them."""
