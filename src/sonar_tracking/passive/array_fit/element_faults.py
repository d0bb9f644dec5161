"""Elements that are inverted, or exchanged with another one: found by what a strong source needs.

The eigenvectors of strong sources lie in the span of as many steering vectors, so that their null
spectrum has as many valleys down to the noise. An inverted element, or two channels in each other's
place, lift them. With the fault undone they are deep again, and with no other one: each is tried,
and the one that leaves less than a quarter of the floors, and half of what any other leaves, in two
covariances, is believed. It is then undone in the data. A fault that has been mended is found in
the same way, as the same fault again.

Faults that a source does not show (channels at which its wave has the same phase are exchanged)
are found as soon as its bearing is another one; until then they do no harm either.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sonar_tracking.passive.array_fit.strong_sources import StrongSources
from sonar_tracking.records.arrays import FloatArray, IntArray

Fault = tuple[int, ...]
"""Of one element, which is inverted, or of two, which are exchanged."""

_LEFT, _LEFT_OF_OTHERS = 0.25, 0.5
_VOTES = 2
_ANOTHER = 2.0
"""Over the usual floor: something has happened to the array."""

_REFINED = 6
"""Faults whose valleys are sought to the floor, the best ones on the grid."""


@dataclass(frozen=True)
class ElementFaults:
    """Faults found, and the one that is suspected.

    Attributes
    ----------
    found : tuple of Fault
        By the numbers of the elements.
    suspected : Fault
        The one that the last covariance showed; empty = none.
    votes : int
        Covariances that have shown it.
    n_misfits : int
        Covariances that did not fit.
    usual : float
        Usual floor of those, pure number.
    """

    found: tuple[Fault, ...] = ()
    suspected: Fault = ()
    votes: int = 0
    n_misfits: int = 0
    usual: float = 0.0

    def order_and_signs(self, n_elements: int) -> tuple[IntArray, FloatArray]:
        """Return which channel is that of each element, and its sign.

        Parameters
        ----------
        n_elements : int
            Of the array.

        Returns
        -------
        order : ndarray of int, shape (n_elements,)
            Channels.
        signs : ndarray, shape (n_elements,)
            1 or -1, pure numbers.
        """
        order, signs = np.arange(n_elements), np.ones(n_elements)
        for fault in self.found:
            if len(fault) == 1:
                signs[fault[0]] *= -1.0
            else:
                order[list(fault)] = order[list(fault[::-1])]
                signs[list(fault)] = signs[list(fault[::-1])]
        return order, signs

    def update(self, strong: StrongSources) -> ElementFaults:
        """Return the faults after one more covariance, in which those found are undone.

        Parameters
        ----------
        strong : StrongSources
            In that covariance.
        """
        if strong.fits:
            return replace(self, suspected=(), votes=0) if self.suspected else self
        floor, misfits = strong.floor, self.n_misfits + 1
        usual = 0.9 * self.usual + 0.1 * floor if self.usual else floor
        another = floor > _ANOTHER * self.usual
        if not (self.votes or another or misfits & (misfits - 1) == 0):
            return replace(self, n_misfits=misfits, usual=usual)
        fault = _likely_fault(strong)
        votes = self.votes + 1 if fault == self.suspected else 1
        if fault and votes >= _VOTES:
            return ElementFaults(_toggled(self.found, fault))
        return ElementFaults(self.found, fault, votes if fault else 0, misfits, usual)


def _likely_fault(strong: StrongSources) -> Fault:
    """Return the fault that explains the floors and that no other one does; empty = none."""
    vectors = strong.vectors
    faults = _all_faults(len(vectors))
    undone = np.broadcast_to(vectors, (len(faults), *vectors.shape)).copy()
    for number, fault in enumerate(faults):
        if len(fault) == 1:
            undone[number, fault[0]] *= -1.0
        else:
            undone[number, list(fault)] = vectors[list(fault[::-1])]
    left = strong.floors_of(undone, refined=False)
    best = np.argsort(left, kind="stable")[:_REFINED]
    left = strong.floors_of(undone[best], refined=True)
    first, second = np.argsort(left, kind="stable")[:2]
    if left[first] > _LEFT * strong.floor or left[first] > _LEFT_OF_OTHERS * left[second]:
        return ()
    return tuple(int(strong.elements[place]) for place in faults[int(best[first])])


def _all_faults(n_elements: int) -> list[Fault]:
    pairs = np.stack(np.triu_indices(n_elements, 1), axis=-1).tolist()
    return [*((element,) for element in range(n_elements)), *map(tuple, pairs)]


def _toggled(found: tuple[Fault, ...], fault: Fault) -> tuple[Fault, ...]:
    """Return the faults with one more, or without it if it was there."""
    if fault in found:
        return tuple(each for each in found if each != fault)
    return (*found, fault)
