"""What `fricomp diagnose` consists of on the terminal: warnings, arms, and the folder that it writes."""
