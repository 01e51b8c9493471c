"""What two channels of a recording show of each other, whatever law the joint's motion obeys.

A drive that follows its command late, a motor torque beside that of a sensor, a position that follows the torque of a
drive whose output is held: none of them needs a model of the motion, so each is told beside any other answer, and where
the motion itself allows none.
"""
