"""Signals of the targets: independent waveforms, levels, coherent groups, presence."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sonar_tracking.records.arrays import ComplexArray, FloatArray
from sonar_tracking.simulation.scenarios.target import TargetConfiguration


class SourceSignals:
    """Makes the signals of all targets from independent waveforms.

    Parameters
    ----------
    targets : sequence of TargetConfiguration
        The targets.
    generator : numpy.random.Generator
        Source of the random phases of coherent groups.

    Attributes
    ----------
    n_waveforms : int
        Independent waveforms needed: one a target outside groups and one a group.
    """

    def __init__(
        self, targets: Sequence[TargetConfiguration], generator: np.random.Generator
    ) -> None:
        self._targets = tuple(targets)
        self._generator = generator
        keys = [target.coherent_group or index for index, target in enumerate(targets)]
        waveforms = list(dict.fromkeys(keys))
        self.n_waveforms = len(waveforms)
        self._waveform = [waveforms.index(key) for key in keys]
        self._amplitudes = 10.0 ** (np.array([target.level_db for target in targets]) / 20.0)
        self._random_phases = generator.uniform(0.0, 2.0 * np.pi, len(targets))

    def signals(self, times: FloatArray, waveforms: ComplexArray) -> ComplexArray:
        """Return the signals of the next block.

        Parameters
        ----------
        times : ndarray, shape (n_snapshots,)
            s.
        waveforms : ndarray, shape (..., n_snapshots, n_waveforms), complex
            Of power 1 (linear).

        Returns
        -------
        ndarray, shape (..., n_snapshots, n_targets), complex
            Source signals at the first element, linear amplitude.
        """
        factors = np.empty((len(times), len(self._targets)), dtype=np.complex128)
        for index, target in enumerate(self._targets):
            factor = self._amplitudes[index] * target.is_heard(times)
            if target.coherent_group:
                factor = factor * np.exp(1j * self._phase(index, target, times))
            factors[:, index] = factor
        return waveforms[..., self._waveform] * factors

    def _phase(self, index: int, target: TargetConfiguration, times: FloatArray) -> FloatArray:
        if target.coherent_phase == "random":
            return np.full(len(times), self._random_phases[index])
        if target.coherent_phase == "random_per_block":
            return np.full(len(times), self._generator.uniform(0.0, 2.0 * np.pi))
        phase = np.full(len(times), np.radians(target.coherent_phase_deg))
        if target.coherent_phase == "turning":
            phase += np.radians(target.coherent_phase_rate_deg) * times
        return phase
