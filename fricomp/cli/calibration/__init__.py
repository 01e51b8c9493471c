"""What `fricomp calibrate` consists of on the terminal: plan, start, resume, torque constant."""
