"""Convolution surfaces: smooth blends around a skeleton, on the quads of its scaffold."""

from scaffold_cad.convolution.field import ConvolutionField, FieldSamples, KernelName
from scaffold_cad.convolution.projection import project

__all__ = ["ConvolutionField", "FieldSamples", "KernelName", "project"]
