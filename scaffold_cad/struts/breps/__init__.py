"""Round struts as faces: exact cylinders and cones, patches, circles."""
