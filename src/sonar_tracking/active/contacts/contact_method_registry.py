"""The methods that track several targets from contacts in clutter."""

from __future__ import annotations

from dataclasses import dataclass

from sonar_tracking.method_registry import MethodEntry, MethodRegistry, trait

_ACTIVE = "sonar_tracking.active"


@dataclass(frozen=True)
class ContactMethodEntry(MethodEntry):
    """A method that tracks contacts.

    Its factory takes a :class:`~sonar_tracking.active.contacts.contact_tracker_configuration.\
ContactTrackerConfiguration` and returns a
    :class:`~sonar_tracking.active.contact_tracker.ContactTracker`.

    Attributes
    ----------
    has_gates : bool
        Has a gate for each track, in which a threshold can be set.
    estimates_existence : bool
        Each track has a probability of existence, which confirms and ends it.
    """

    has_gates: bool = trait("thresholds can be set in its gates")
    estimates_existence: bool = trait("existence probability of each track")


CONTACT_METHODS = MethodRegistry(
    "hpda_tracker.method",
    ContactMethodEntry(
        "integrated",
        f"{_ACTIVE}.multi_target_tracker:integrated_tracker",
        "LM-IPDA, all contacts by distance and amplitude likelihood, with turning motion modes",
        label="integrated",
        paper="Musicki, La Scala 2008",
        has_gates=True,
        estimates_existence=True,
    ),
    ContactMethodEntry(
        "hpda_kalman",
        f"{_ACTIVE}.multi_target_tracker:hpda_kalman_tracker",
        "HPDA, the one contact best by amplitude rank",
        label="HPDA, Kalman",
        paper="Kim, Song 2007",
        has_gates=True,
        estimates_existence=True,
    ),
    ContactMethodEntry(
        "hpda_particle",
        f"{_ACTIVE}.multi_target_tracker:hpda_particle_tracker",
        "HPDA that follows confirmed targets with particles",
        label="HPDA, particles",
        paper="Kim, Song 2007",
        has_gates=True,
        estimates_existence=True,
    ),
    ContactMethodEntry(
        "roi_clustering",
        f"{_ACTIVE}.baselines.region_tracker:RegionTracker",
        "regions of interest over successive pings, without existence probability, for comparison",
        label="clustering",
        paper="as in Kim, Song 2007",
    ),
    ContactMethodEntry(
        "smc_phd",
        f"{_ACTIVE}.baselines.smc_phd:DensityTracker",
        "probability hypothesis density of particles, existence is the weight of a peak, for "
        "comparison",
        label="SMC-PHD",
        paper="as in Kim, Song 2007",
    ),
)
