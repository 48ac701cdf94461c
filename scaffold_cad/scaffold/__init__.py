"""The scaffold: stars, collars, frames and sleeves, the coarse quad mesh and its certificate."""

from scaffold_cad.base.frames import rotation_minimizing_frames
from scaffold_cad.scaffold.embedding import Embedding
from scaffold_cad.scaffold.scaffold import Scaffold, ScaffoldOptions, build_scaffold

__all__ = [
    "Embedding",
    "Scaffold",
    "ScaffoldOptions",
    "build_scaffold",
    "rotation_minimizing_frames",
]
