"""Round struts as triangles: rings at nodes, bands along struts, ends."""
