"""Names, types and kinds of the topics of the graph (no ROS import)."""

from __future__ import annotations

from dataclasses import dataclass, replace
from enum import Enum

CLOCK_TOPIC = "/clock"
DIAGNOSTICS_TOPIC = "/diagnostics"
PROGRESS_TOPIC = "flow/done"
TIME_TOPIC = "flow/time"
"""The time of a run, for its own sources of data: ``/clock`` is open to whoever publishes it."""

BEGIN_TOPIC = "flow/begin"
"""When a scenario began, where no simulation time tells it; kept for late readers."""

DATUM_TOPIC = "map/datum"
"""Where the origin of ``map`` is (``sensor_msgs/NavSatFix``), in a live graph; kept likewise."""


class TopicKind(Enum):
    """How a topic is transported: see :mod:`sonar_tracking.graph.node_base.quality_of_service`."""

    DATA = "data"
    """Reliable, volatile, keep-last(flow depth)."""
    TRACKS = "tracks"
    """A complete picture: as DATA, and the latest one is kept for late readers."""
    COMMANDS = "commands"
    """As DATA, and all of a run are kept for late readers."""


class TopicRole(Enum):
    """What a topic is for when a recording is replayed or scored."""

    INPUT = "input"
    """Comes from a sensor or simulator; a replay publishes it."""
    OUTPUT = "output"
    """Computed by the nodes; a replay compares it."""
    TRUTH = "truth"
    """Known to a simulator only; for scoring."""
    DISPLAY = "display"
    """A picture for people: recorded, but neither played by a replay nor compared."""


@dataclass(frozen=True)
class Topic:
    """One data topic.

    Attributes
    ----------
    name : str
        Relative name, e.g. ``"array/snapshots"``.
    message_type : str
        E.g. ``"sonar_tracking_msgs/msg/ArraySnapshots"``.
    kind : TopicKind
        How it is transported.
    role : TopicRole
        What it is for.
    description : str
        One line of what it carries.
    """

    name: str
    message_type: str
    kind: TopicKind
    role: TopicRole
    description: str

    def below(self, station: str) -> Topic:
        """Return the topic of a station by its namespace; an absolute name stays."""
        if not station or self.name.startswith("/"):
            return self
        return replace(self, name=f"{station}/{self.name}")


SNAPSHOTS = Topic(
    "array/snapshots",
    "sonar_tracking_msgs/msg/ArraySnapshots",
    TopicKind.DATA,
    TopicRole.INPUT,
    "contiguous blocks of narrowband array snapshots",
)
SUBSPACES = Topic(
    "array/subspaces",
    "sonar_tracking_msgs/msg/SubspaceEstimates",
    TopicKind.DATA,
    TopicRole.OUTPUT,
    "signal subspaces around each sample time",
)
BEARING_TRACKS = Topic(
    "passive/bearing_tracks",
    "sonar_tracking_msgs/msg/BearingTracks",
    TopicKind.TRACKS,
    TopicRole.OUTPUT,
    "all bearing tracks at each sample time",
)
TRUE_BEARING_TRACKS = Topic(
    "truth/bearing_tracks",
    "sonar_tracking_msgs/msg/BearingTracks",
    TopicKind.TRACKS,
    TopicRole.TRUTH,
    "true bearings of the simulated targets",
)
TRUE_TRACKS = Topic(
    "truth/tracks",
    "sonar_tracking_msgs/msg/Tracks",
    TopicKind.TRACKS,
    TopicRole.TRUTH,
    "true positions of the simulated targets",
)
ODOMETRY = Topic(
    "own_ship/odometry",
    "nav_msgs/msg/Odometry",
    TopicKind.DATA,
    TopicRole.INPUT,
    "own ship's pose in map and twist in own_ship/base_link",
)
SAMPLES = Topic(
    "array/samples",
    "sonar_tracking_msgs/msg/ArraySamples",
    TopicKind.DATA,
    TopicRole.INPUT,
    "contiguous blocks of broadband element time series",
)
LOFAR = Topic(
    "array/lofar",
    "sensor_msgs/msg/Image",
    TopicKind.DATA,
    TopicRole.OUTPUT,
    "normalised spectrum of each beam, row by row",
)
FREQUENCY_LINES = Topic(
    "passive/frequency_lines",
    "sonar_tracking_msgs/msg/FrequencyLines",
    TopicKind.DATA,
    TopicRole.OUTPUT,
    "narrowband lines heard at one instant",
)
PASSIVE_TRACKS = Topic(
    "passive/tracks",
    "sonar_tracking_msgs/msg/Tracks",
    TopicKind.TRACKS,
    TopicRole.OUTPUT,
    "positions of the targets heard, with both sides of an ambiguous bearing",
)
ALIGNMENTS = Topic(
    "passive/alignment",
    "sonar_tracking_msgs/msg/ArrayAlignments",
    TopicKind.TRACKS,
    TopicRole.OUTPUT,
    "how the arrays are turned from what their data tell",
)
STATION_ALIGNMENTS = Topic(
    "passive/station_alignment",
    "sonar_tracking_msgs/msg/ArrayAlignments",
    TopicKind.TRACKS,
    TopicRole.OUTPUT,
    "how stations are turned from what their data tell, by what several of them hear",
)
OWN_TRACKS = Topic(
    "own_tracks",
    "sonar_tracking_msgs/msg/Tracks",
    TopicKind.TRACKS,
    TopicRole.OUTPUT,
    "tracks without what other ships tell, for them; where their tracks are taken",
)
FUSED_TRACKS = Topic(
    "tracks",
    "sonar_tracking_msgs/msg/Tracks",
    TopicKind.TRACKS,
    TopicRole.OUTPUT,
    "one row a target, whatever hears it",
)
FUSED_MARKERS = Topic(
    "markers",
    "visualization_msgs/msg/MarkerArray",
    TopicKind.TRACKS,
    TopicRole.DISPLAY,
    "tracks for RViz and Foxglove, with uncertainty ellipses",
)
PASSIVE_MARKERS = Topic(
    "passive/markers",
    "visualization_msgs/msg/MarkerArray",
    TopicKind.TRACKS,
    TopicRole.DISPLAY,
    "passive/tracks for RViz and Foxglove, with uncertainty ellipses",
)
CONTACTS = Topic(
    "active/contacts",
    "sonar_tracking_msgs/msg/Contacts",
    TopicKind.DATA,
    TopicRole.INPUT,
    "contacts of an active sonar, ping by ping",
)
ACTIVE_TRACKS = Topic(
    "active/tracks",
    "sonar_tracking_msgs/msg/Tracks",
    TopicKind.TRACKS,
    TopicRole.OUTPUT,
    "positions of the targets that return echoes",
)
ACTIVE_THRESHOLD = Topic(
    "active/threshold",
    "sonar_tracking_msgs/msg/DetectionThreshold",
    TopicKind.DATA,
    TopicRole.OUTPUT,
    "detection thresholds used in the gates of the tracks",
)
ACTIVE_MARKERS = Topic(
    "active/markers",
    "visualization_msgs/msg/MarkerArray",
    TopicKind.TRACKS,
    TopicRole.DISPLAY,
    "active/tracks for RViz and Foxglove, with uncertainty ellipses",
)
BEARING_MARKERS = Topic(
    "passive/bearing_markers",
    "visualization_msgs/msg/MarkerArray",
    TopicKind.TRACKS,
    TopicRole.DISPLAY,
    "bearing tracks of all stations as rays, for RViz and Foxglove",
)
CONTACT_MARKERS = Topic(
    "active/contact_markers",
    "visualization_msgs/msg/MarkerArray",
    TopicKind.TRACKS,
    TopicRole.DISPLAY,
    "the contacts of a ping where they are, coloured by their amplitude",
)
CONTACT_POINTS = Topic(
    "active/contact_points",
    "sensor_msgs/msg/PointCloud2",
    TopicKind.DATA,
    TopicRole.DISPLAY,
    "the contacts of a ping as a point cloud: x, y, z, amplitude, range, azimuth",
)
GATE_MARKERS = Topic(
    "active/gate_markers",
    "visualization_msgs/msg/MarkerArray",
    TopicKind.TRACKS,
    TopicRole.DISPLAY,
    "the gates of the tracks, and the thresholds that are in force there",
)
TRANSFORMS = Topic(
    "/tf",
    "tf2_msgs/msg/TFMessage",
    TopicKind.DATA,
    TopicRole.DISPLAY,
    "own ship in map, and sensors that are not mounted on it",
)
FIXED_TRANSFORMS = Topic(
    "/tf_static",
    "tf2_msgs/msg/TFMessage",
    TopicKind.TRACKS,
    TopicRole.DISPLAY,
    "sensors that are mounted on own ship, in own_ship/base_link",
)
COMMANDS = Topic(
    "operator/commands",
    "sonar_tracking_msgs/msg/OperatorCommand",
    TopicKind.COMMANDS,
    TopicRole.INPUT,
    "what operators tell the trackers, with the stamp at which it takes effect",
)
REQUESTS = Topic(
    "operator/requests",
    "sonar_tracking_msgs/msg/OperatorCommand",
    TopicKind.DATA,
    TopicRole.OUTPUT,
    "what operators ask for; whoever moves the clock makes commands of it",
)
DIAGNOSTICS = Topic(
    DIAGNOSTICS_TOPIC,
    "diagnostic_msgs/msg/DiagnosticArray",
    TopicKind.DATA,
    TopicRole.DISPLAY,
    "the state of every node",
)
