"""Files of layers: Common Layer Interface, 3MF slices, drawings and images of each layer."""

from scaffold_cad.io.stacks.writing import STACK_SUFFIXES, write_layers

__all__ = ["STACK_SUFFIXES", "write_layers"]
