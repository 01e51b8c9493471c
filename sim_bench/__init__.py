"""The bench: the stand-in joint, the drive twins, joints with concealed physics, and the studies made on them."""
