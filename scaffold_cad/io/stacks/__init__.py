"""Files of layers: Common Layer Interface, 3MF slices, drawings and images of each layer."""

from scaffold_cad.io.stacks.writing import STACK_SUFFIXES, check_stack, write_layers

__all__ = ["STACK_SUFFIXES", "check_stack", "write_layers"]
