"""A CANopen node with a CiA 402 drive behind it."""
