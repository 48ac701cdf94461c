"""Files: skeletons and meshes read, and what the package makes written.

`read_skeleton` reads a file, repairs the faults that real files have, and logs what it did;
`read_triangles` reads a mesh as it is; `write` is in `scaffold_cad.io.write`. Each format has a
module of its own name, which reads and writes it, and registers both when it is imported. A module
whose name begins with an underscore is what formats share.

A format is known by suffix (`known_suffixes`), or by content where the suffix is unknown or wrong;
`register_reader`, `register_mesh_reader` and `register_writer` add to it, and `unregister` takes
out again. So does a package with a module as an entry point of the group ``scaffold_cad.readers``.
"""

# Importing these modules registers their formats; of two for one suffix the later is asked first.
from scaffold_cad.io import (  # noqa: F401
    abaqus,
    brep,
    bvh,
    cgd,
    cjson,
    compas,
    csv,
    dxf,
    gel,
    gltf,
    gml,
    gmsh,
    graphml,
    gxl,
    iges,
    med,
    mol,
    mol2,
    nastran,
    nml,
    node_link,
    obj,
    off,
    opensees,
    pdb,
    ply,
    points_edges,
    polylines,
    pyskelton,
    rhino,
    slicer,
    spatial_frame,
    step,
    stl,
    svg,
    swc,
    tgf,
    threemf,
    tinker,
    tubetk,
    vtk,
)
from scaffold_cad.io._raw import RawSkeleton
from scaffold_cad.io.cgd import read_nets
from scaffold_cad.io.fields import read_field
from scaffold_cad.io.json import skeleton_to_json
from scaffold_cad.io.meshes import read_triangles
from scaffold_cad.io.networkx import skeleton_from_networkx, skeleton_to_networkx
from scaffold_cad.io.reading import (
    BYTES_PER_EDGE,
    read_raw,
    read_skeleton,
    read_with_repairs,
)
from scaffold_cad.io.register import (
    known_formats,
    known_suffixes,
    mesh_formats,
    register_mesh_reader,
    register_reader,
    register_writer,
    unregister,
    written_formats,
    written_suffixes,
)
from scaffold_cad.io.stacks import write_layers
from scaffold_cad.io.threemf import read_assembly
from scaffold_cad.io.threemf.streaming import write_repeated

__all__ = [
    "BYTES_PER_EDGE",
    "RawSkeleton",
    "known_formats",
    "known_suffixes",
    "mesh_formats",
    "read_assembly",
    "read_field",
    "read_nets",
    "read_raw",
    "read_skeleton",
    "read_triangles",
    "read_with_repairs",
    "register_mesh_reader",
    "register_reader",
    "register_writer",
    "skeleton_from_networkx",
    "skeleton_to_json",
    "skeleton_to_networkx",
    "unregister",
    "write_layers",
    "write_repeated",
    "written_formats",
    "written_suffixes",
]
