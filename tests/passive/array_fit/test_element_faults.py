"""Inverted and exchanged elements are named and undone, good ones are left alone."""

from __future__ import annotations

import numpy as np
import pytest

from sonar_tracking.geometry import line_array, steering_vectors
from sonar_tracking.passive.array_fit.element_faults import ElementFaults, Fault
from sonar_tracking.passive.array_fit.strong_sources import StrongSources, strong_sources
from sonar_tracking.passive.sources.moving_source_counting import sample_covariance
from sonar_tracking.records.arrays import ComplexArray
from tests.passive.crossing_scene import WAVENUMBER, circular_noise


def faulty(data: ComplexArray, fault: Fault) -> ComplexArray:
    data = data.copy()
    if len(fault) == 1:
        data[:, fault[0]] *= -1.0
    elif fault:
        data[:, list(fault)] = data[:, list(fault[::-1])]
    return data


def strong_in(data: ComplexArray) -> StrongSources | None:
    n_elements = data.shape[1]
    positions, elements = line_array(n_elements, 0.5), np.arange(n_elements)
    covariances = sample_covariance(data)[None]
    return strong_sources(covariances, len(data), positions, WAVENUMBER, elements)[0]


def watched(fault: Fault, n_elements: int, angles_deg: list[float], level: float) -> ElementFaults:
    """Return the faults after four covariances of 100 snapshots, those found undone."""
    generator, faults = np.random.default_rng(3), ElementFaults()
    vectors = steering_vectors(
        line_array(n_elements, 0.5), np.deg2rad(np.array(angles_deg)), WAVENUMBER
    )
    for _ in range(4):
        sources = 10.0 ** (level / 20.0) * circular_noise(generator, 100, len(angles_deg))
        data = sources @ vectors.T + circular_noise(generator, 100, n_elements)
        order, signs = faults.order_and_signs(n_elements)
        strong = strong_in(faulty(data, fault)[:, order] * signs)
        assert strong is not None
        faults = faults.update(strong)
    return faults


@pytest.mark.parametrize("n_elements", [8, 15, 32])
@pytest.mark.parametrize("angles", [[-20.0], [-20.0, 27.0]])
@pytest.mark.parametrize("fault", [(0,), (4,), (3, 6), (1, 5)])
def test_the_fault_is_named(n_elements: int, angles: list[float], fault: Fault) -> None:
    assert watched(fault, n_elements, angles, 20.0).found == (fault,)


@pytest.mark.parametrize("n_elements", [8, 15, 32])
@pytest.mark.parametrize("angles", [[-20.0], [-20.0, 27.0], [0.0]])
def test_an_array_as_described_has_no_fault(n_elements: int, angles: list[float]) -> None:
    faults = watched((), n_elements, angles, 20.0)
    assert faults == ElementFaults()


def test_errors_of_an_array_that_is_not_calibrated_are_no_fault() -> None:
    generator = np.random.default_rng(8)
    gains = 1.0 + 0.05 * generator.standard_normal(15)
    phases = np.exp(1j * np.deg2rad(5.0) * generator.standard_normal(15))
    vector = steering_vectors(line_array(15, 0.5), np.array([0.3]), WAVENUMBER)[:, 0]
    faults = ElementFaults()
    for _ in range(8):
        source = 10.0 * circular_noise(generator, 100, 1)
        data = source * (vector * gains * phases) + circular_noise(generator, 100, 15)
        strong = strong_in(data)
        assert strong is not None
        faults = faults.update(strong)
    assert faults.found == ()
    assert faults.n_misfits == 8


def test_a_fault_that_is_mended_is_withdrawn() -> None:
    generator, faults = np.random.default_rng(5), ElementFaults(found=((4,),))
    vector = steering_vectors(line_array(15, 0.5), np.array([0.3]), WAVENUMBER)[:, 0]
    for _ in range(3):
        data = 10.0 * circular_noise(generator, 100, 1) * vector
        order, signs = faults.order_and_signs(15)
        strong = strong_in((data + circular_noise(generator, 100, 15))[:, order] * signs)
        assert strong is not None
        faults = faults.update(strong)
    assert faults.found == ()


def test_faults_together_are_undone_in_turn() -> None:
    generator = np.random.default_rng(6)
    data = circular_noise(generator, 4, 8)
    order, signs = ElementFaults(found=((3, 6), (3,))).order_and_signs(8)
    assert np.array_equal(data[:, order] * signs, faulty(faulty(data, (3, 6)), (3,)))


def test_weak_sources_are_not_judged() -> None:
    generator = np.random.default_rng(7)
    vector = steering_vectors(line_array(15, 0.5), np.array([0.3]), WAVENUMBER)[:, 0]
    weak = circular_noise(generator, 100, 1) * vector + circular_noise(generator, 100, 15)
    assert strong_in(weak) is None
