"""Hollow struts: insides of nodes, how thick walls are, sockets."""
