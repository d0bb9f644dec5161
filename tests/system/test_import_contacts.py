"""Recorded contacts through the graph: CSV files, bag, replay; the same tracks as offline."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import yaml

from sonar_tracking.active.contact_tracker import make_contact_tracker
from sonar_tracking.active.contacts.contact_tracker_configuration import ContactTrackerConfiguration
from sonar_tracking.bags.importers.contact_messages import contacts_cdr, odometry_cdr
from sonar_tracking.bags.importers.import_contacts import (
    CONTACTS_TOPIC,
    ODOMETRY_TOPIC,
    ContactSensor,
    read_pings,
)
from sonar_tracking.bags.storage.bag_records import (
    CONTACTS_TYPE,
    position_tracks_of,
)
from sonar_tracking.bags.storage.reader import read_bag
from sonar_tracking.bags.storage.writer import BagWriter
from sonar_tracking.display.bag_contents import bag_contents
from sonar_tracking.evaluation.metrics.score_bag import score_bag
from sonar_tracking.message_reading.own_ship_reading import ODOMETRY_TYPE
from tests.system.command_line import refused, report_of, run_command

N_PINGS = 40
PARAMETERS = {
    "sound_speed": 0.0,
    "clutter_density": 1e-5,
    "acceleration_deviation": 0.1,
    "initial_speed_deviation": 3.0,
    "initial_existence": 0.05,
}


def write_files(folder: Path) -> tuple[Path, Path]:
    """Write contacts of two targets and of clutter, heard by a moving own ship, and the truth."""
    generator = np.random.default_rng(4)
    starts, velocity = np.array([[-200.0, 150.0], [100.0, 300.0]]), np.array([[2.0, 1.0], [-2, -1]])
    contacts = ["time_s,range_m,bearing_deg,own_east_m,own_north_m"]
    truth = ["time_s,target,east_m,north_m"]
    for ping in range(N_PINGS):
        own = np.array([1.5 * ping, -0.5 * ping])
        true = starts + ping * velocity
        clutter = generator.uniform(-400.0, 400.0, (generator.poisson(3.0), 2))
        seen = np.concatenate([true + generator.normal(0.0, 3.0, (2, 2)), clutter]) - own
        for east, north in seen:
            bearing = np.degrees(np.arctan2(east, north))
            contacts.append(
                f"{ping},{np.hypot(east, north):.3f},{bearing:.4f},{own[0]:g},{own[1]:g}"
            )
        truth.extend(f"{ping},boat{n},{e:g},{m:g}" for n, (e, m) in enumerate(true))
    contacts.append("30,far away,90,0,0")
    paths = folder / "contacts.csv", folder / "truth.csv"
    for path, lines in zip(paths, (contacts, truth), strict=True):
        path.write_text("\n".join(lines))
    return paths


def test_recorded_contacts_are_tracked_by_the_graph(tmp_path: Path) -> None:
    contacts, truth = write_files(tmp_path)
    parameters = tmp_path / "parameters.yaml"
    parameters.write_text(yaml.safe_dump({"hpda_tracker": PARAMETERS}))
    bag, recorded, json = tmp_path / "bag", tmp_path / "recorded", tmp_path / "report.json"
    imported = run_command(
        tmp_path, "import", "contacts", contacts, "--output", bag, "--truth", truth,
        "--range-deviation", 3, "--bearing-deviation-deg", 1, "--parameters", parameters,
    )  # fmt: skip
    assert imported.returncode == 0, imported.stdout
    assert f"{N_PINGS} pings" in imported.stdout and "truth of 2 targets" in imported.stdout
    assert "range_m is 'far away', not a number" in imported.stdout
    done = run_command(
        tmp_path, "replay", bag, "--rate", "max", "--record", recorded, "--json", json,
        "--cutoff", 50, "--plots", tmp_path / "drawn", pictures=True,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    assert (tmp_path / "drawn" / "tactical_plot.png").exists()
    score = report_of(json)["score"]["positions"]["/active/tracks"]
    assert score["rmse_m"] < 4.0 and score["identity_swaps"] == 0
    assert score["held_share"] > 0.85 and score["cutoff_m"] == 50.0
    assert "--clock --topics /active/contacts /own_ship/odometry; " in done.stdout

    # The truth is in the new recording too: it can be scored and drawn, and has changed nothing.
    again = read_bag(recorded)
    truth_topic = ["/truth/tracks"]
    assert list(again.messages(truth_topic)) == list(read_bag(bag).messages(truth_topic))
    assert again.topics["/truth/tracks"].role == "truth"
    assert score_bag(recorded, cutoff_m=50.0)["/active/tracks"].to_mapping() == score
    assert len(bag_contents(again).position_truth["/truth/tracks"]) == 2

    sensor = ContactSensor(range_deviation=3.0, bearing_deviation_deg=1.0)
    tracker = make_contact_tracker(ContactTrackerConfiguration(**PARAMETERS))  # type: ignore[arg-type]
    offline = [tracker.update(ping).tracks for ping in read_pings(contacts, sensor).pings]
    through_graph = list(position_tracks_of(read_bag(recorded), "/active/tracks"))
    assert [tracks.stamp for tracks in through_graph] == [tracks.stamp for tracks in offline]
    for ours, theirs in zip(offline, through_graph, strict=True):
        np.testing.assert_array_equal(ours.id, theirs.id)
        np.testing.assert_array_equal(ours.state, theirs.state)
        np.testing.assert_array_equal(ours.covariance, theirs.covariance)


def test_contacts_that_cannot_be_used_are_refused_in_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "contacts.csv").write_text("time_s,range_m\n0,1\n")
    words = ("import", "contacts", tmp_path / "contacts.csv", "--output", tmp_path / "bag")
    assert "bearing_deg" in refused(tmp_path, *words)
    assert not (tmp_path / "bag").exists()


def test_odometry_in_a_file_of_its_own_is_there_in_time(tmp_path: Path) -> None:
    """Pings that do not tell where they were sent wait for it; nothing is said to be missing."""
    contacts, _ = write_files(tmp_path)
    recorded = read_pings(contacts, ContactSensor(range_deviation=3.0, bearing_deviation_deg=1.0))
    unknown = (np.nan, np.nan)
    data = {
        "contacts": [
            (ping.stamp, contacts_cdr(replace(ping, sensor_position=unknown)))
            for ping in recorded.pings
        ],
        "odometry": [
            (state.stamp, odometry_cdr(state))
            for state in map(recorded.own_ship.state, range(N_PINGS))
        ],
    }
    types = {
        "contacts": (CONTACTS_TOPIC, CONTACTS_TYPE),
        "odometry": (ODOMETRY_TOPIC, ODOMETRY_TYPE),
    }
    both = tmp_path / "both"
    both.mkdir()
    for number, (name, messages) in enumerate(data.items()):
        topic, kind = types[name]
        writer = BagWriter(tmp_path / name)
        writer.add_topic(topic, kind)
        for stamp, message in messages:
            writer.write(topic, stamp, message)
        writer.close()
        shutil.copy(tmp_path / name / f"{name}_0.mcap", both / f"run_{number}.mcap")
    parameters, json = tmp_path / "parameters.yaml", tmp_path / "report.json"
    parameters.write_text(yaml.safe_dump({"hpda_tracker": PARAMETERS}))
    done = run_command(
        tmp_path, "replay", both, "--rate", "max", "--parameters", parameters, "--json", json
    )
    assert done.returncode == 0, done.stdout
    report = report_of(json)
    assert report["topics"]["/active/tracks"]["messages"] == N_PINGS
    said = " ".join(report["warnings"])
    assert not any(words in said for words in ("nothing received", "missed", "own_ship"))
