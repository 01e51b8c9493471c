"""What `fricomp.calibrate`, `fricomp.identify` and `fricomp.diagnose` do; the commands of the same names call them."""
