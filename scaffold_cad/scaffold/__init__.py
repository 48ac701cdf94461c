"""The scaffold: stars, collars, frames and sleeves, the coarse quad mesh and its certificate."""

from scaffold_cad.scaffold.scaffold import Scaffold, ScaffoldOptions, build_scaffold

__all__ = ["Scaffold", "ScaffoldOptions", "build_scaffold"]
