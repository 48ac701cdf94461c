"""Round struts: exact sections, and blends at the nodes that are solved for node by node."""
