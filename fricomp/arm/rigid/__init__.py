"""The rigid body of an arm: its file, the motion of its links, what they weigh, the torque of each such number."""
