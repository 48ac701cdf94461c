"""Every error that the package raises on purpose.

::

    ScaffoldCadError
    ├── SkeletonError        (ValueError)   a skeleton that cannot be scaffolded
    ├── PartitionError       (ValueError)   a star of directions without a partition
    ├── MeshError            (ValueError)   a mesh that is not what it must be
    ├── BrepError            (ValueError)   a B-rep that could not be made
    ├── FormatError          (ValueError)   a file that cannot be read or written
    ├── OptionError          (ValueError)   an argument out of its range, or of a wrong kind
    │   └── KeywordError     (TypeError)    an argument by a name that is not known
    └── MissingBackendError  (ImportError)  an optional package is absent
"""

from __future__ import annotations


class ScaffoldCadError(Exception):
    """Base of every error raised on purpose by this package."""


class SkeletonError(ScaffoldCadError, ValueError):
    """A skeleton that cannot be scaffolded; the message names the node or edge."""


class PartitionError(ScaffoldCadError, ValueError):
    """A star of directions that has no certified partition."""


class MeshError(ScaffoldCadError, ValueError):
    """A mesh that is not closed, not oriented, or has bad indices."""


class BrepError(ScaffoldCadError, ValueError):
    """A mesh whose B-rep could not be made."""


class FormatError(ScaffoldCadError, ValueError):
    """A file that cannot be read or written; the message names it and the line."""


class OptionError(ScaffoldCadError, ValueError):
    """An argument out of its range or of a wrong kind; the message names it and its value."""


class KeywordError(OptionError, TypeError):
    """An argument given by a name that the function does not have; the message has the nearest."""


class MissingBackendError(ScaffoldCadError, ImportError):
    """An optional package is absent; the message names the extra that brings it."""
