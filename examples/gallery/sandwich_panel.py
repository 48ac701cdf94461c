"""A sandwich panel: two skins, between them an octet lattice of round struts, open at its sides."""

from manifold3d import Manifold

from scaffold_cad import round_struts, tile, to_solid, write

CELL, COUNTS, RADIUS, SKIN = 12.0, (6, 4, 1), 0.9, 1.2
"""Size of a cell, mm; cells; radius of struts and thickness of the skins, mm."""


def make() -> Manifold:
    """Return the panel; the skins cover the outermost nodes."""
    core = to_solid(round_struts(tile("octet", CELL, COUNTS, radius=RADIUS)), sides=12)
    low_x, low_y, _, high_x, high_y, _ = core.bounding_box()
    flat = Manifold.cube([high_x - low_x, high_y - low_y, 1.0]).translate([low_x, low_y, -0.5])
    skin, height = flat.scale([1, 1, SKIN]), CELL * COUNTS[2]
    room = flat.scale([1, 1, height + SKIN]).translate([0, 0, height / 2])
    # What stands out of the skins is cut off.
    return (core ^ room) + skin + skin.translate([0, 0, height])


if __name__ == "__main__":
    write(make(), "sandwich_panel.stl")
