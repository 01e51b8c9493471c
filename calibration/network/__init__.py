"""The tanh network of the paper: evaluation, derivative, training steps, ONNX."""

from .architecture import LAYER_SIZES, TanhNetwork, forward, forward_with_jacobian
from .distillation import distil
from .onnx_file import save_network

__all__ = [
    "LAYER_SIZES",
    "TanhNetwork",
    "distil",
    "forward",
    "forward_with_jacobian",
    "save_network",
]
