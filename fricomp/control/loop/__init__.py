"""The control loop in real time, its check before it runs, its log, and how it ends."""
