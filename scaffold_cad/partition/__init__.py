"""Partitions of the sphere around a branch point: one spherical quad for each direction."""

from scaffold_cad.partition.certificate import Certificate, certify
from scaffold_cad.partition.partitions import Partition, Partitions
from scaffold_cad.partition.sphere import partition_sphere, partition_spheres

__all__ = [
    "Certificate",
    "Partition",
    "Partitions",
    "certify",
    "partition_sphere",
    "partition_spheres",
]
