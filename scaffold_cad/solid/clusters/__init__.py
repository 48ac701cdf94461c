"""Clusters of crowded struts as fields, joined to the struts beside them."""

from scaffold_cad.solid.clusters.fields import whole_struts
from scaffold_cad.solid.clusters.surface import surface_of, unseen

__all__ = ["surface_of", "unseen", "whole_struts"]
