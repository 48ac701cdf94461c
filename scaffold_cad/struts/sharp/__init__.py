"""Sharp nodes: the union of a node's cylinders, cones and ball, without fillets and booleans."""
