"""Clusters of crowded struts as fields, joined to the struts beside them."""

from scaffold_cad.solid.clusters.fields import whole_struts
from scaffold_cad.solid.clusters.surface import polygon_slack, surface_of, unseen

__all__ = ["polygon_slack", "surface_of", "unseen", "whole_struts"]
