"""The commands ``sonar-tracking import``: recorded data into a bag."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from sonar_tracking.cli_loading import needs
from sonar_tracking.errors import ConfigurationError

import_app = typer.Typer(help="Bring recorded data into a bag.", no_args_is_help=True)


_GEOMETRY = Annotated[Path, typer.Option(help="YAML file with the element positions.")]
_OUTPUT = Annotated[Path, typer.Option(help="The new bag.")]
_FREQUENCY = Annotated[
    float | None, typer.Option(help="Centre of the narrow band bearings are made of, Hz.")
]
_BANDWIDTH = Annotated[float | None, typer.Option(help="Width of the narrow band, Hz.")]
_BEARINGS = "CSV or npz: time_s, target, arrival_angle_deg"
_PARAMETERS = Annotated[
    Path | None, typer.Option(help="YAML file: node, parameter, value; kept for the replay.")
]
_SEVERAL = "; a directory of consecutive files, or repeat it"
_POSITIONS = "NMEA log with AIS; or CSV or npz: time_s, target, east_m, north_m"
_OWN_SHIP = Annotated[
    list[Path] | None,
    typer.Option(help=f"NMEA log; or CSV or npz: time_s, east_m, north_m, heading_deg{_SEVERAL}."),
]
_TRUE_POSITIONS = Annotated[list[Path] | None, typer.Option(help=f"{_POSITIONS}{_SEVERAL}.")]
_TRUTH = Annotated[
    list[Path] | None,
    typer.Option(help=f"{_BEARINGS}. Of time series also: {_POSITIONS}{_SEVERAL}."),
]
_DATUM = Annotated[
    str,
    typer.Option(
        help="LATITUDE,LONGITUDE[,HEIGHT] of the origin of map, degrees and m; default: the first "
        "place in the files, if they tell places."
    ),
]
_ORIGIN = Annotated[str, typer.Option(help="Instant of time_s = 0.")]
_EPOCH = Annotated[
    str | None,
    typer.Option(help="Instant of the first sample; default: by the file names or files."),
]
_TIME_PATTERN = Annotated[
    str | None,
    typer.Option(help="How the time stands in the file names, e.g. %Y%m%d_%H%M%S."),
]


@import_app.command("samples")
def time_series(
    source: Annotated[
        Path, typer.Argument(help="Audio file, or a directory: consecutive, or one a hydrophone.")
    ],
    geometry: _GEOMETRY,
    output: _OUTPUT,
    frequency: _FREQUENCY = None,
    bandwidth: _BANDWIDTH = None,
    own_ship: _OWN_SHIP = None,
    truth: _TRUTH = None,
    epoch: _EPOCH = None,
    time_pattern: _TIME_PATTERN = None,
    parameters: _PARAMETERS = None,
    datum: _DATUM = "",
) -> None:
    """Bring audio files into a bag of the element time series.

    WAV, RF64, FLAC, W64, AIFF and CAF. Times come from the names of the usual recorders, from
    --time-pattern, or from the bext chunk; --epoch goes before them. Gaps between files stay
    gaps; overlaps and drift are reported. The replay makes bearings and frequency lines of them,
    and positions if --own-ship tells how own ship moved.
    """
    importer = needs("sonar_tracking.graph.verbs.import_command")
    print(
        importer.import_audio_samples(
            source,
            geometry,
            frequency,
            bandwidth,
            output,
            own_ship or None,
            truth or None,
            parameters,
            importer.given_time(epoch, time_pattern),
            importer.given_datum(datum),
        )
    )


@import_app.command()
def wav(
    file: Annotated[Path, typer.Argument(help="Audio file, or a directory of them.")],
    geometry: _GEOMETRY,
    output: _OUTPUT,
    frequency: _FREQUENCY = None,
    bandwidth: _BANDWIDTH = None,
    samples: Annotated[
        bool, typer.Option("--samples", help="Keep the time series: the replay finds lines too.")
    ] = False,
    own_ship: Annotated[
        list[Path] | None, typer.Option(help="With --samples: as for import samples.")
    ] = None,
    truth: _TRUTH = None,
    epoch: _EPOCH = None,
    time_pattern: _TIME_PATTERN = None,
    parameters: _PARAMETERS = None,
    datum: _DATUM = "",
) -> None:
    """Bring a multichannel audio file into a bag.

    By default of narrowband snapshots; with --samples of the element time series themselves, as
    'import samples' does.
    """
    importer = needs("sonar_tracking.graph.verbs.import_command")
    time, place = importer.given_time(epoch, time_pattern), importer.given_datum(datum)
    if samples:
        done = importer.import_audio_samples(
            file, geometry, frequency, bandwidth, output, own_ship or None, truth or None,
            parameters, time, place,
        )  # fmt: skip
    elif own_ship:
        raise ConfigurationError("--own-ship goes with --samples; give both, or neither.")
    else:
        done = importer.import_wav_file(
            file, geometry, frequency, bandwidth, output, truth or None, parameters, time, place
        )
    print(done)


@import_app.command()
def contacts(
    file: Annotated[Path, typer.Argument(help="CSV or npz with one line, or entry, a contact.")],
    output: _OUTPUT,
    own_ship: _OWN_SHIP = None,
    truth: _TRUE_POSITIONS = None,
    range_deviation: Annotated[
        float, typer.Option(help="Standard deviation of ranges without their own, m.")
    ] = 0.0,
    bearing_deviation_deg: Annotated[
        float, typer.Option(help="The same of directions, degrees.")
    ] = 0.0,
    maximum_range: Annotated[
        float, typer.Option(help="Of the survey, m; 0: that of the farthest contact.")
    ] = 0.0,
    latency: Annotated[
        float, typer.Option(help="By which the times are later than the pings, s.")
    ] = 0.0,
    epoch: _ORIGIN = "2026-01-01T00:00:00Z",
    parameters: _PARAMETERS = None,
    datum: _DATUM = "",
) -> None:
    """Bring recorded contacts into a bag of pings, with own ship and truth.

    Columns: time_s (or unix_time_s), range_m, bearing_deg (compass; or azimuth_deg, from east
    anticlockwise; or relative_bearing_deg, from the bow clockwise). Optional: amplitude (linear,
    noise mean 1; or amplitude_db), range_deviation_m, bearing_deviation_deg, own_east_m with
    own_north_m (or own_latitude_deg with own_longitude_deg) and own_heading_deg. latitude_deg and
    longitude_deg may stand for east_m and north_m in every table. Lines of one time are one ping; a
    line with neither range nor direction is a ping that heard nothing. A line that cannot be used
    is left out and named.
    """
    importer = needs("sonar_tracking.graph.verbs.import_command")
    sensor = {
        "range_deviation": range_deviation,
        "bearing_deviation_deg": bearing_deviation_deg,
        "maximum_range": maximum_range,
        "latency": latency,
        "epoch": epoch,
    }
    place = importer.given_datum(datum)
    beside = own_ship or None, truth or None
    print(importer.import_contacts_file(file, output, sensor, *beside, parameters, place))


@import_app.command()
def bearings(
    file: Annotated[Path, typer.Argument(help="CSV or npz with one line, or entry, a bearing.")],
    output: _OUTPUT,
    stations: Annotated[
        Path | None, typer.Option(help="CSV or npz: sensor, east_m, north_m, up_m, heading_deg.")
    ] = None,
    own_ship: _OWN_SHIP = None,
    truth: _TRUE_POSITIONS = None,
    bearing_deviation_deg: Annotated[
        float, typer.Option(help="Standard deviation of bearings without their own, degrees.")
    ] = 0.0,
    frequency_deviation: Annotated[
        float, typer.Option(help="The same of frequency lines, Hz.")
    ] = 0.2,
    epoch: _ORIGIN = "2026-01-01T00:00:00Z",
    parameters: _PARAMETERS = None,
    datum: _DATUM = "",
) -> None:
    """Bring recorded bearings into a bag whose replay finds positions.

    Columns: time_s (or unix_time_s), bearing_deg (compass; or azimuth_deg, from east
    anticlockwise; or relative_bearing_deg, from the bow clockwise; or cone_angle_deg, from the axis
    of a line array; or arrival_angle_deg, from its broadside). Optional: sensor, track (a label;
    without it the tracks are found), bearing_deviation_deg, elevation_deg with
    elevation_deviation_deg, frequency_hz with frequency_deviation_hz. A sensor that --stations does
    not name is aboard own ship.
    """
    importer = needs("sonar_tracking.graph.verbs.import_command")
    sensor = {
        "bearing_deviation_deg": bearing_deviation_deg,
        "frequency_deviation": frequency_deviation,
        "epoch": epoch,
    }
    beside = own_ship or None, truth or None
    sources = importer.BearingSources(stations, *beside, importer.given_datum(datum))
    print(importer.import_bearings_file(file, output, sensor, sources, parameters))


@import_app.command()
def nmea(
    files: Annotated[
        list[Path],
        typer.Argument(help="Logs of NMEA 0183, or directories: own ship, AIS."),
    ],
    output: _OUTPUT,
    epoch: Annotated[
        str, typer.Option(help="Its date is that of logs without one (RMC, ZDA).")
    ] = "2026-01-01T00:00:00Z",
    datum: _DATUM = "",
) -> None:
    """Bring logs of navigation receivers and of AIS into a bag: own ship, and ships as the truth.

    Own ship by GGA, RMC, HDT, VTG and VHW; ships by AIS (VDM), each with its MMSI, interpolated
    between its reports. To use the same logs beside the data of a sensor, give them to its import:
    --own-ship LOG --truth LOG.
    """
    importer = needs("sonar_tracking.graph.verbs.import_command")
    print(importer.import_nmea_logs(files, output, importer.given_datum(datum), epoch))
