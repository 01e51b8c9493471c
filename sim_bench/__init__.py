"""The bench: the stand-in joint, the drive twins, joints with concealed physics, and the studies made on them."""

if __name__ == "sim_bench":
    raise ImportError("sim_bench is a part of fricomp, with other classes under this name: import fricomp.sim_bench")
