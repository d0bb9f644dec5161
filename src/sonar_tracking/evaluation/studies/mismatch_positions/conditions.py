"""The conditions of the study: the published scenes with errors and motions nobody has told."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from sonar_tracking.evaluation.studies.mismatch_positions.condition import (
    BELIEVING,
    Condition,
    LastingErrors,
    ZigZag,
    lasting_factor,
)
from sonar_tracking.evaluation.studies.mismatch_positions.motions import (
    TURN_START,
    turning_scene,
    zigzag,
)
from sonar_tracking.evaluation.studies.tma_frequency_fusion.scenarios import scenario
from sonar_tracking.tma.estimators.range_bank_configuration import RangeBankConfiguration

SCENES = ("S1", "S2", "S3")

PRECISE, WANDER = 0.05, 0.1
"""White deviation of lines, and what they wander by, Hz."""

FAR_TARGET = (24_000.0, 18_000.0, -3.0, 0.0)
"""30 km away, m and m/s."""

TOLD_FAR = replace(BELIEVING, maximum_range=40_000.0)


def _published(name: str) -> Condition:
    return Condition(name, scenario(name))


def _correlated(name: str, time_constant: float) -> Condition:
    return Condition(
        f"bearing errors last {time_constant:g} s, {name}",
        scenario(name),
        LastingErrors(azimuth_time=time_constant),
        told_azimuth=lasting_factor(time_constant),
    )


def _understated(name: str, factor: float) -> Condition:
    return Condition(
        f"bearing deviation told 1/{factor:g}, {name}", scenario(name), claimed_azimuth=1.0 / factor
    )


def _overstated(name: str, factor: float) -> Condition:
    return Condition(
        f"bearing deviation told {factor:g} times, {name}", scenario(name), claimed_azimuth=factor
    )


def _wandering(name: str, time_constant: float) -> Condition:
    told = np.hypot(PRECISE, WANDER * lasting_factor(time_constant)) / PRECISE
    return Condition(
        f"lines wander 0.1 Hz over {time_constant:g} s, {name}",
        replace(scenario(name), frequency_deviation=PRECISE),
        LastingErrors(wander=WANDER, wander_time=time_constant),
        told_frequency=float(told),
    )


def _accelerating(density: float) -> RangeBankConfiguration:
    """Return what is told of a target that has random accelerations all the time, m/s^2."""
    return replace(
        BELIEVING,
        acceleration=density,
        manoeuvre_acceleration=density,
        wander_acceleration=density,
    )


def _unsteady(name: str, acceleration: float) -> Condition:
    """Return a target whose velocity wanders: random accelerations, m/s^2, new each second."""
    scene = replace(scenario(name), acceleration=acceleration)
    told = _accelerating(acceleration)
    return Condition(f"accelerations of {acceleration:g} m/s\u00b2, {name}", scene, told=told)


def _weaving(name: str, angle_deg: float) -> Condition:
    """Return a target whose velocity changes at random as much as that of the zig-zag does."""
    scene = scenario(name)
    change = 2.0 * np.hypot(*scene.target[2:]) * np.sin(np.radians(0.5 * angle_deg))
    density = float(change / np.sqrt(80.0))
    weave = ZigZag(angle_deg)
    return Condition(
        f"zig-zag by {angle_deg:g} deg, {name}", scene, weave, told=_accelerating(density)
    )


def _in_step() -> Condition:
    """Return the zig-zag that turns 20 s after own ship does, again and again."""
    scene = scenario("S1")
    changes = zigzag(scene.target[2:], 30.0, 80, scene.times.size, 80, 1)
    return replace(
        _weaving("S1", 30.0),
        name="zig-zag by 30 deg in step with own ship, S1",
        scene=replace(scene, commanded=changes),
        draw=ZigZag(30.0, drawn=False),
    )


def _turn(own_ship_turns: bool, rate_deg: float, lines: int) -> Condition:
    side = "port" if rate_deg > 0.0 else "starboard"
    tonals = {0: "no tonal", 1: "a tonal", 4: "four tonals"}[lines]
    straight = "" if own_ship_turns else ", own ship always straight"
    scene = turning_scene(own_ship_turns, rate_deg, lines)
    lateral = float(np.hypot(*scene.target[2:]) * np.radians(abs(rate_deg)))
    told = RangeBankConfiguration(
        learn_errors=False,
        manoeuvre_acceleration=lateral * (90.0 / abs(rate_deg)) ** 0.5,
        manoeuvre_interval=float(scene.times.size),
        manoeuvre_duration=90.0 / abs(rate_deg),
        weave_probability=0.0,
        wander_probability=0.0,
    )
    name = f"turn to {side} at {abs(rate_deg):g} deg/s, {tonals}{straight}"
    return Condition(name, scene, told=told, settled=TURN_START)


def _far(name: str) -> Condition:
    scene = replace(scenario(name), target=np.array(FAR_TARGET))
    return Condition(f"30 km away, {name}", scene, told=TOLD_FAR)


CONDITIONS = {
    condition.name: condition
    for condition in (
        *(_published(name) for name in SCENES),
        _correlated("S1", 10.0),
        _correlated("S3", 10.0),
        _correlated("S1", 60.0),
        _understated("S1", 2.0),
        _understated("S3", 2.0),
        _understated("S1", 4.0),
        _wandering("S1", 10.0),
        _wandering("S3", 10.0),
        _wandering("S3", 60.0),
        *(_weaving(name, 30.0) for name in SCENES),
        _weaving("S1", 60.0),
        _in_step(),
        *(_turn(True, rate, lines) for lines in (0, 1) for rate in (3.0, -3.0, 1.0, -1.0)),
        _turn(True, -1.0, 4),
        _turn(False, 3.0, 4),
        _turn(False, -1.0, 4),
        _turn(False, -1.0, 1),
        _far("S1"),
        _far("S3"),
        _overstated("S1", 2.0),
        _overstated("S3", 2.0),
        _overstated("S1", 4.0),
        *(_unsteady(name, size) for name in ("S1", "S3") for size in (0.02, 0.05)),
    )
}
"""By name, in the order of the tables."""
