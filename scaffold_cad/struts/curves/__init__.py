"""Curves: chains of short edges as one strut that bends smoothly."""
