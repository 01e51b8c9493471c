"""Numbers in which a term of a joint is not linear, found from what a fit leaves: an order, a speed, a gap."""
