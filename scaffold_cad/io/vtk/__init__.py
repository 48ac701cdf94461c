"""VTK: lines of poly data and unstructured grids, in legacy files (.vtk) and XML (.vtp, .vtu).

Both are read here, not by VTK: its readers end the process on files that are damaged.
"""

# Importing these modules registers their formats.
from scaffold_cad.io.vtk import legacy, writing, xml  # noqa: F401
