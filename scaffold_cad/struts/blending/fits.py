"""The least-squares fit of smooth patches to samples.

Of all smooth surfaces that one is best which has the least sum of squared distances from the
wanted samples and thin-plate energy. Both are sums over patches, and no join depends on the core
of a patch: what is best there follows from the rim, by matrices that are the same for all patches
of all nodes. What is left is the rims' share, and factored once a type.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.linalg import cho_factor
from scipy.linalg.lapack import dpotri

from scaffold_cad.base.arrays import Floats, Frozen, Ints
from scaffold_cad.base.kept import kept
from scaffold_cad.base.products import row_products
from scaffold_cad.struts.blending.layouts import Layout
from scaffold_cad.struts.blending.system import KEPT_BYTES, system_of


class TypeFit:
    """The fit of m nodes of one type, whose targets may change from round to round."""

    def __init__(self, twins: Ints, layout: Layout, rows: Floats) -> None:
        """Begin with the given control points among `rows` (3, m, 4 N, n_u, n_v)."""
        self._twins, self._layout, self._shape = twins, layout, rows.shape
        self._system = system_of(twins, layout)
        patches = rows.reshape(-1, len(twins), layout.u.count * layout.v.count)
        self._known = patches[:, :, layout.given]
        self._given = patches.reshape(len(patches), -1)[:, self._system.given]
        self._fixed = row_products(self._given, self._system.rim_of_given)
        self._targets: Floats = np.empty(0)
        self._rim = self._fixed

    def stiffen(self, stiffness: float) -> None:
        """Take another weight of the thin-plate energy, see `patch_fit`."""
        patch = self._patch = patch_fit(self._layout, stiffness)
        self._solving = free_of_pulls(self._twins, self._layout, stiffness)
        fixed = self._fixed[:, self._system.rims]
        self._pulled = self._known @ patch.pulls_of_given + fixed @ patch.pulls_of_rim
        self._still = self._known @ patch.samples_of_given

    def samples(self, wanted: Floats) -> Floats:
        """Return the samples of the surfaces that are best for those wanted, both (3, m, S)."""
        patch = self._patch
        self._targets = wanted.reshape(len(self._fixed), len(self._twins), -1)
        pulls = self._targets @ patch.pulls_of_samples + self._pulled
        at_free = self._system.pulls_at_free(pulls.reshape(len(pulls), -1))
        free = row_products(at_free, self._solving)
        self._rim = row_products(free, self._system.rim_of_free) + self._fixed
        rims = self._rim[:, self._system.rims]
        found = self._targets @ patch.samples_of_samples + rims @ patch.samples_of_rim
        found += self._still
        return np.asarray(found.reshape(wanted.shape))

    def control(self) -> Floats:
        """Return the control points of the last surfaces, (3, m, 4 N, n_u, n_v)."""
        patch, net = self._patch, self._system.net
        number = net.number.reshape(len(self._twins), -1)
        core = self._targets @ patch.core_of_samples + self._known @ patch.core_of_given
        core += self._rim[:, self._system.rims] @ patch.core_of_rim
        points = np.empty((len(core), net.count))
        points[:, : net.rim + net.given] = np.concatenate([self._rim, self._given], axis=1)
        points[:, number[:, self._layout.core]] = core
        return points[:, number].reshape(self._shape)


@dataclass(frozen=True, eq=False)
class PatchFit(Frozen):
    """What is best in a patch, for a layout and a stiffness.

    Rows are patches' coordinates, times these matrices. Pulls are what the energy falls by when
    points of the rim move; it is least where they are 0.
    """

    core_of_samples: Floats
    """From wanted samples to the core, (s, core)."""
    core_of_rim: Floats
    """From the rim to the core, (rim, core)."""
    core_of_given: Floats
    """From given points to the core, (given, core)."""
    samples_of_samples: Floats
    """From wanted samples to those of the patch, (s, s)."""
    samples_of_rim: Floats
    """From the rim to samples, (rim, s)."""
    samples_of_given: Floats
    """From given points to samples, (given, s)."""
    pulls_of_samples: Floats
    """From wanted samples to pulls, (s, rim)."""
    pulls_of_rim: Floats
    """From the rim to pulls, symmetrical, (rim, rim)."""
    pulls_of_given: Floats
    """From given points to pulls, (given, rim)."""


@lru_cache(maxsize=32)
def patch_fit(layout: Layout, stiffness: float) -> PatchFit:
    """Return what is best in a patch.

    Parameters
    ----------
    layout : how patches are cut and sampled
    stiffness : weight of the thin-plate energy against the mean of squared distances
    """
    rim, core, given = layout.rim, layout.core, layout.given
    sampled = layout.sampled  # (s, n)
    weighted = sampled.T * layout.weights  # (n, s)
    energy = weighted @ sampled + stiffness * layout.thin_plate
    inverse = np.linalg.inv(energy[np.ix_(core, core)])
    of_samples = (inverse @ weighted[core]).T
    of_rim = -(inverse @ energy[np.ix_(core, rim)]).T
    of_given = -(inverse @ energy[np.ix_(core, given)]).T
    across, inner = energy[np.ix_(core, rim)], sampled[:, core].T
    return PatchFit(
        of_samples,
        of_rim,
        of_given,
        of_samples @ inner,
        sampled[:, rim].T + of_rim @ inner,
        sampled[:, given].T + of_given @ inner,
        weighted[rim].T - of_samples @ across,
        -energy[np.ix_(rim, rim)] - of_rim @ across,
        -energy[np.ix_(given, rim)] - of_given @ across,
    )


def free_of_pulls(twins: Ints, layout: Layout, stiffness: float) -> Floats:
    """Return what takes pulls at the free numbers of a type, at free numbers 0, to the best ones.

    Parameters
    ----------
    twins : (4 N,) intp, the twin of each side
    layout : how patches are cut and sampled
    stiffness : see `patch_fit`

    Returns
    -------
    (k, k) float64, symmetrical
    """
    return _free_of_pulls(tuple(twins.tolist()), layout, stiffness)


@kept(KEPT_BYTES)
def _free_of_pulls(key: tuple[int, ...], layout: Layout, stiffness: float) -> Floats:
    system = system_of(np.array(key, dtype=np.intp), layout)
    pulls = patch_fit(layout, stiffness).pulls_of_rim
    count = system.wide  # free numbers that move the rims of many patches
    energy = np.zeros((len(system.rim_of_free),) * 2)
    wide = system.rim_of_free[:count, system.rims.reshape(-1)].reshape(-1, pulls.shape[0])
    pulled = (wide @ pulls).reshape(count, *system.rims.shape)  # (c, 4 N, rim)
    energy[:count, :count] = pulled.reshape(count, -1) @ wide.reshape(count, -1).T
    for patch, rim in enumerate(system.rims):
        moving = count + np.flatnonzero(system.rim_of_free[count:, rim].any(axis=1))
        part = system.rim_of_free[np.ix_(moving, rim)]
        energy[:count, moving] += pulled[:, patch] @ part.T
        energy[np.ix_(moving, moving)] += part @ pulls @ part.T
    energy[count:, :count] = energy[:count, count:].T
    inverse = dpotri(cho_factor(-energy)[0])[0]  # a third of the work of as many solutions
    upper = np.triu(inverse)
    return np.asarray(upper + np.triu(inverse, 1).T)
