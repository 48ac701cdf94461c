"""Round struts: exact cylinders and cones, blends at nodes, and the proof that they are sound."""
