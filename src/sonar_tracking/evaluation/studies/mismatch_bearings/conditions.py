"""The conditions of the study: what arrives at the array, and what is true of it."""

from __future__ import annotations

from dataclasses import replace

from sonar_tracking.evaluation.studies.doa_coherent import scenes as published
from sonar_tracking.evaluation.studies.mismatch_bearings.array_errors import ArrayErrors
from sonar_tracking.evaluation.studies.mismatch_bearings.condition import Condition
from sonar_tracking.simulation.scenarios.array_configuration import (
    ArrayConfiguration,
    NoiseConfiguration,
)
from sonar_tracking.simulation.scenarios.bearing_motion import (
    LinearMotion,
    SinusoidalMotion,
    TableMotion,
)
from sonar_tracking.simulation.scenarios.scenario import Scenario
from sonar_tracking.simulation.scenarios.scenario_mapping import load_scenario
from sonar_tracking.simulation.scenarios.target import TargetConfiguration

BANDWIDTH = 100.0
"""Narrow enough for 32 elements, Hz."""

CONSTANT_DEG2 = 1e-6
"""Process noise of targets with constant rates, deg^2/s^3."""

TURNING_DEG2 = 0.01
"""About (largest bearing acceleration x sample period)^2 of five crossing targets, deg^2/s^3."""

WEAVING_DEG2 = 0.2
"""Mean square acceleration over the time it lasts: 10 deg to and fro in 21 s, deg^2/s^3."""

STAYING_DEG2 = 0.003
"""Mean square change of a rate of 0.3 deg/s that ends and begins again, a second, deg^2/s^3."""

APPROACHED, STAYED, PARTED = 30.0, 20.0, 30.0
"""Duration of the parts of an encounter, s."""

FAR_DEG = 10.0
"""From the middle at the beginning and at the end of an encounter, deg."""


def _scenario(
    *targets: TargetConfiguration, duration: float = 60.0, elements: int = 15, noise: float = 0.0
) -> Scenario:
    return Scenario(
        duration=duration,
        array=ArrayConfiguration(n_elements=elements, bandwidth=BANDWIDTH),
        noise=NoiseConfiguration(correlation=noise),
        targets=targets,
    )


def _still(bearing_deg: float, level_db: float = 0.0) -> TargetConfiguration:
    return TargetConfiguration(level_db=level_db, motion=LinearMotion(offset_deg=bearing_deg))


def _weaving(level_db: float) -> TargetConfiguration:
    motion = SinusoidalMotion(amplitude_deg=10.0, period=20.944)
    return TargetConfiguration(level_db=level_db, motion=motion)


def _pair(name: str, apart_deg: float, first_db: float, second_db: float) -> Condition:
    first, second = _still(10.0, first_db), _still(10.0 + apart_deg, second_db)
    return Condition(name, _scenario(first, second), CONSTANT_DEG2)


def _encounter(
    name: str, apart_deg: float, passing: bool, levels_db: tuple[float, float] = (0.0, 0.0)
) -> Condition:
    """Two that approach, stay near each other and part: to where they came from, or passing."""
    half, end = 0.5 * apart_deg, -FAR_DEG if passing else FAR_DEG
    times = (0.0, APPROACHED, APPROACHED + STAYED, APPROACHED + STAYED + PARTED)
    after = -half if passing else half
    bearings = (FAR_DEG, half, after, end)
    targets = tuple(
        TargetConfiguration(
            level_db=level,
            motion=TableMotion(times=times, bearings_deg=tuple(side * one for one in bearings)),
        )
        for side, level in zip((-1.0, 1.0), levels_db, strict=True)
    )
    return Condition(
        name,
        _scenario(*targets, duration=times[-1]),
        STAYING_DEG2,
        names_before=(10.0, 20.0),
        names_after=(times[-1] - 10.0, times[-1]),
    )


def _pass_through(name: str, rate_deg: float, levels_db: tuple[float, float]) -> Condition:
    duration = 2.0 * FAR_DEG / rate_deg
    targets = tuple(
        TargetConfiguration(
            level_db=level,
            motion=LinearMotion(offset_deg=side * FAR_DEG, rate_deg=-side * rate_deg),
        )
        for side, level in zip((-1.0, 1.0), levels_db, strict=True)
    )
    return Condition(
        name,
        _scenario(*targets, duration=duration),
        CONSTANT_DEG2,
        names_before=(0.15 * duration, 0.3 * duration),
        names_after=(0.8 * duration, duration),
    )


_THREE = (_still(-30.0), _still(5.0), _still(40.0))


def _of_array(name: str, errors: ArrayErrors, level_db: float, elements: int = 15) -> Condition:
    targets = (_still(-20.0, level_db), _still(25.0, level_db))
    return Condition(name, _scenario(*targets, elements=elements), CONSTANT_DEG2, errors)


def _faint(level_db: float) -> Condition:
    motion = LinearMotion(offset_deg=-20.0, rate_deg=0.2)
    target = TargetConfiguration(level_db=level_db, motion=motion)
    return Condition(
        f"faint source, {level_db:.0f} dB", _scenario(target), CONSTANT_DEG2, faint=True
    )


_ALL = (
    *(
        Condition(
            f"bursts: {one.name}",
            replace(one.scenario(), array=replace(one.scenario().array, block_snapshots=200)),
            CONSTANT_DEG2,
            published=one,
        )
        for one in published.CONDITIONS
    ),
    Condition(
        "five crossing, 0 dB",
        replace(load_scenario("doa_fusion"), start=0.0, duration=40.0),
        TURNING_DEG2,
    ),
    Condition("weaving, 0 dB", _scenario(_weaving(0.0)), WEAVING_DEG2),
    Condition("weaving, 20 dB", _scenario(_weaving(20.0)), WEAVING_DEG2),
    _pair("pair 3 deg apart, 0 dB", 3.0, 0.0, 0.0),
    _pair("pair 3 deg apart, 10 dB", 3.0, 10.0, 10.0),
    _pair("pair 3 deg apart, 0 and 6 dB", 3.0, 0.0, 6.0),
    _pair("pair 2 deg apart, 0 dB", 2.0, 0.0, 0.0),
    _encounter("stay 2 deg apart, turn back", 2.0, passing=False),
    _encounter("stay 2 deg apart, turn back, 0 and 6 dB", 2.0, False, (0.0, 6.0)),
    _encounter("stay 2 deg apart, pass", 2.0, passing=True),
    _pass_through("pass through, 0.3 deg/s", 0.3, (0.0, 0.0)),
    _pass_through("pass through, 1 deg/s", 1.0, (0.0, 0.0)),
    Condition("noise correlation 0.3", _scenario(*_THREE, noise=0.3), CONSTANT_DEG2),
    Condition("noise correlation 0.6", _scenario(*_THREE, noise=0.6), CONSTANT_DEG2),
    Condition("noise correlation 0.6 alone", _scenario(noise=0.6), CONSTANT_DEG2),
    Condition("white noise alone", _scenario(duration=120.0), CONSTANT_DEG2),
    _of_array("gains 2 %, phases 2 deg, 20 dB", ArrayErrors(0.02, 2.0), 20.0),
    _of_array("gains 5 %, phases 5 deg, 10 dB", ArrayErrors(0.05, 5.0), 10.0),
    *(
        _of_array(f"{what}, {elements} elements, 20 dB", errors, 20.0, elements)
        for what, errors in (
            ("one channel inverted", ArrayErrors(inverted=True)),
            ("two channels exchanged", ArrayErrors(exchanged=True)),
        )
        for elements in (8, 15, 32)
    ),
    *(_faint(level) for level in (-8.0, -10.0, -12.0, -14.0, -16.0, -18.0, -20.0)),
    Condition("no faint source", _scenario(duration=300.0), CONSTANT_DEG2, faint=True),
)

CONDITIONS = {condition.name: condition for condition in _ALL}
"""All conditions by name, in the order of the tables."""
