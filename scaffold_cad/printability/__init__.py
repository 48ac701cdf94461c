"""Whether a part can be printed, what is in the way, and where.

>>> from scaffold_cad import Skeleton
>>> from scaffold_cad.printability import check_printability
>>> strut = Skeleton([[0, 0, 0], [0, 0, 9]], [[0, 1]], 0.2)
>>> report = check_printability(strut, "sls")
>>> report.printable
False
>>> [finding.name for finding in report.failures]
['strut_diameter', 'wall_thickness']
"""

from scaffold_cad.io import read_triangles
from scaffold_cad.printability.check import assert_printable, check_printability
from scaffold_cad.printability.processes import MATERIALS, PROCESSES, Process
from scaffold_cad.printability.report import Finding, Report

__all__ = [
    "MATERIALS",
    "PROCESSES",
    "Finding",
    "Process",
    "Report",
    "assert_printable",
    "check_printability",
    "read_triangles",
]
