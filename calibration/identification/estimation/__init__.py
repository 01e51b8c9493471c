"""Fits of friction laws to points: separable form, likelihood, start, optimum, network, outliers."""
