"""The tanh network of the paper: evaluation, derivative, training steps, ONNX."""

from .architecture import LAYER_SIZES, TanhNetwork, forward, forward_with_jacobian, join_parameters, split_parameters
from .distillation import Distillation, distil
from .onnx_file import OPSET, save_network

__all__ = [
    "LAYER_SIZES",
    "OPSET",
    "Distillation",
    "TanhNetwork",
    "distil",
    "forward",
    "forward_with_jacobian",
    "join_parameters",
    "save_network",
    "split_parameters",
]
