"""Protects the scripts that make the extracts of recorded data: on small files like the owners'."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat, wavfile

from sonar_tracking.evaluation.studies.maritime_contacts.scenarios import read_scenarios
from sonar_tracking.evaluation.studies.room_array.responses import read_room_responses
from sonar_tracking.evaluation.studies.ship_bearings.data import read_bearings
from tests.docs.code_blocks import DOCS

EXTRACTS = DOCS / "reference" / "extracts"


def run_script(name: str, *arguments: object) -> None:
    subprocess.run([sys.executable, EXTRACTS / name, *map(str, arguments)], check=True)


def test_radar_scans_of_a_scenario(tmp_path: Path) -> None:
    folder = tmp_path / "scenario2"
    folder.mkdir()
    # Times in the order of the file; two contacts, a lidar scan, none, one.
    scans: list[dict[str, Any]] = [
        {"sensorID": 2, "time": 100.0, "ownshipPosition": [1, 2], "measurement": [[3, 4], [4, -3]]},
        {"sensorID": 1, "time": 100.5, "ownshipPosition": [1, 2], "measurement": [9, 9]},
        {"sensorID": 2, "time": 103.4, "ownshipPosition": [3, 4], "measurement": [-2, 0]},
        {"sensorID": 2, "time": 101.7, "ownshipPosition": [2, 3], "measurement": []},
    ]
    truth = [
        [{"targetID": boat, "position": [10.0 * boat + n, -n, 0.0]} for boat in (2, 1)]
        for n in range(4)
    ]
    (folder / "scenario2_detections.json").write_text(json.dumps(scans))
    (folder / "scenario2_groundTruth.json").write_text(json.dumps(truth))
    run_script("maritime_contacts.py", folder, tmp_path / "scans")
    (scenario,) = read_scenarios(tmp_path / "scans")
    assert scenario.name == "scenario02"
    assert scenario.times.tolist() == [0.0, 101.7 - 100.0, 103.4 - 100.0]
    assert [values.tolist() for values in scenario.range] == [[5.0, 5.0], [], [2.0]]
    # Azimuths from the east, anticlockwise: the first contact is 3 m north, 4 m east.
    np.testing.assert_allclose(np.degrees(scenario.azimuth[0]), [36.87, 126.87], atol=0.01)
    np.testing.assert_allclose(np.degrees(scenario.azimuth[2]), [-90.0], atol=1e-9)
    assert scenario.own_ship.tolist() == [[2, 1], [3, 2], [4, 3]]
    assert scenario.truth[1].tolist() == [[-3.0, 13.0], [-3.0, 23.0]]


@pytest.mark.slow
def test_responses_of_seven_sources(tmp_path: Path) -> None:
    generator = np.random.default_rng(1)
    samples = generator.integers(-100, 100, (9, 480, 32)).astype(np.int16)
    for source in range(9):
        wavfile.write(tmp_path / f"rir_source_{source + 1}.wav", 1000, samples[source])
    location = generator.uniform(0.0, 1.0, (9, 2))
    savemat(tmp_path / "source_location.mat", {"sourceLocation": location})
    run_script("room_responses.py", tmp_path, tmp_path / "responses.npz")
    with np.load(tmp_path / "responses.npz") as extract:
        assert extract["rir"].shape == (7, 32, 300)
        assert extract["rir"][5].tolist() == samples[7, :300].T.tolist()
        assert extract["source_xz_m"].tolist() == location[[0, 1, 2, 3, 4, 7, 8]].tolist()
    assert read_room_responses(tmp_path / "responses.npz").responses.shape == (7, 32, 300)


@pytest.mark.slow
def test_directions_of_a_ship(tmp_path: Path) -> None:
    """A ship that rests 1000 m east of an array 1000 m deep is heard from there, 45 degrees up."""
    day, north_of_equator = 6650.0, 0.0
    seconds = np.array([10.0, 11.0, 12.0, 9.0, 10.0, 14.0, 15.0])  # a clock that steps back once
    baselines = np.random.default_rng(2).normal(0.0, 1.0, (6, 3))
    delays = baselines @ np.array([1.0, 0.0, 1.0]) / np.sqrt(2.0) / 1500.0
    east = np.degrees(1000.0 / 6378137.0)
    files = {
        "Hmatrix_": {"H": baselines, "c": 1500.0, "recLoc": [north_of_equator, 0.0, -1000.0]},
        "shipTDOA": {"T": day + seconds / 86400.0, "TDOA": np.tile(delays, (7, 1))},
        "shipLatLon": {
            "T": day + np.arange(0.0, 30.0) / 86400.0,
            "Lat": np.full(30, north_of_equator),
            "Lon": np.full(30, east),
        },
    }
    for name, content in files.items():
        savemat(tmp_path / f"SOCAL_E_63_EE_{name}.mat", content)
    run_script("ship_bearings.py", tmp_path, tmp_path / "bearings.npz", "EE", 0, 20)
    (array,) = read_bearings(tmp_path / "bearings.npz")
    # The seconds between the step back and the leap after it are left out.
    np.testing.assert_allclose(array.times, [10.0, 11.0, 12.0, 15.0], atol=1e-4)
    np.testing.assert_allclose(array.azimuth, 0.0, atol=1e-9)
    np.testing.assert_allclose(np.degrees(array.elevation), 45.0)
    np.testing.assert_allclose(array.ship, np.tile([1000.0, 0.0], (4, 1)), atol=1e-3)
    np.testing.assert_allclose(array.position, [0.0, 0.0, -1000.0], atol=1e-9)
