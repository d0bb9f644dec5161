"""Make scenarioNN.npz from a folder scenarioN of the Autoferry sensor fusion data set.

python maritime_contacts.py sensor_fusion_dataset/scenario2 recorded_scans
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any

import numpy as np

RADAR = 2
TARGETS = (1, 2)


def extract(folder: Path) -> dict[str, Any]:
    """Return the radar scans of a scenario with the true positions of both boats.

    Detections and truth have one entry a scan, in the same order, nearly that of time, and times
    count from the first one. A scan lists all norths, then all easts, relative to own ship.
    """
    scans = _scans(folder / f"{folder.name}_detections.json")
    truths = json.loads((folder / f"{folder.name}_groundTruth.json").read_text())
    start = scans[0]["time"]
    order = sorted(
        (index for index, scan in enumerate(scans) if scan["sensorID"] == RADAR),
        key=lambda index: scans[index]["time"],
    )
    positions = [
        {boat["targetID"]: boat["position"][:2] for boat in truths[index]} for index in order
    ]
    contacts = [_contacts(scans[index]["measurement"]) for index in order]
    relative = np.concatenate(contacts)
    return {
        "t0_unix_s": start,
        "radar_scan_t_s": np.array([scans[index]["time"] - start for index in order]),
        "radar_scan_own_ne_m": np.array([scans[index]["ownshipPosition"] for index in order]),
        "radar_truth_ne_m": np.array([[scan[boat] for boat in TARGETS] for scan in positions]),
        "radar_det_scan": np.repeat(np.arange(len(order)), [len(scan) for scan in contacts]),
        "radar_det_range_m": np.hypot(relative[:, 0], relative[:, 1]),
        "radar_det_bearing_deg": np.degrees(np.arctan2(relative[:, 1], relative[:, 0])) % 360.0,
    }


def _scans(path: Path) -> list[dict[str, Any]]:
    scans: list[dict[str, Any]] = json.loads(path.read_text())
    return scans


def _contacts(measurement: list[Any]) -> np.ndarray[Any, Any]:
    values = np.array(measurement, dtype=float)
    return values.reshape(2, -1).T if values.size else np.empty((0, 2))


if __name__ == "__main__":
    source, output = map(Path, sys.argv[1:])
    output.mkdir(exist_ok=True)
    number = int(re.sub(r"\D", "", source.name))
    np.savez_compressed(output / f"scenario{number:02d}.npz", **extract(source))
