// What can be done with a track, a direction or a line: choose, rename, command.

import { openMenu } from "./commands.js";
import { bearing } from "./format.js";
import { bearingTopics, tracksAt } from "./picture.js";

const LISTS = ["passive/bearing_tracks", "active/tracks", "passive/tracks", "tracks"];

/** The name by which trackers know a topic: that in a graph without a namespace; "" = none of theirs. */
export function listOf(page, topic) {
  const below = `${page.hello?.namespace ?? ""}/`;
  const name = topic.startsWith(below) ? topic.slice(below.length) : topic;
  return LISTS.includes(name) ? name : "";
}

/** The menu of a track of the picture, of a bearing track ({topic, id, bearing: true}), or of a direction. */
export function openTrackMenu(page, event, row, azimuth, point = null) {
  const place = { x: event.clientX, y: event.clientY };
  const entries = row ? trackEntries(page, row, place) : directionEntries(page, azimuth, point);
  const title = row ? `Track ${page.selection.nameOf(row.topic, row.id)}` : `Bearing ${bearing(azimuth)}°`;
  if (!page.commands.possible) entries.push(["Read only: no commands", () => page.commands.explain()]);
  openMenu(place.x, place.y, title, entries);
}

function trackEntries(page, row, place) {
  const { commands, selection } = page;
  const list = listOf(page, row.topic);
  const entries = [["Choose", () => selection.choose({ topic: row.topic, id: row.id })]];
  entries.push(["Rename…", () => rename(page, row)]);
  if (!commands.possible || !list) return entries;
  entries.push(["End track", () => commands.send({ command: "end_track", topic: list, id: row.id })]);
  if (list !== "passive/tracks") {
    entries.push(["Merge with…", () => openMergeMenu(page, row, list, place)]);
  }
  const sided = sideRow(page, row);
  if (sided) {
    for (const [side, words] of [[1, "left"], [2, "right"]]) {
      const act = () => commands.send({ command: "choose_side", topic: "passive/tracks", id: sided.id, side });
      entries.push([`The target is ${words} of the array`, act]);
    }
  }
  return entries;
}

/** The row of the passive list whose side can be chosen: the row itself, or what it was made from. */
function sideRow(page, row) {
  if (!row.side) return null;
  if (listOf(page, row.topic) === "passive/tracks") return row;
  const below = `${page.hello?.namespace ?? ""}/passive/tracks`;
  const rows = tracksAt(page.history, page.time.now, [below]);
  return rows.find((other) => other.bearingTrack === row.bearingTrack && other.side === row.side) ?? null;
}

function openMergeMenu(page, row, list, place) {
  const others = row.bearing
    ? bearingRows(page, row.topic)
    : tracksAt(page.history, page.time.now, [row.topic]);
  const entries = others
    .filter((other) => other.id !== row.id)
    .map((other) => [
      `is the same target as ${page.selection.nameOf(other.topic, other.id)}`,
      () => page.commands.send({ command: "merge_tracks", topic: list, id: row.id, other_id: other.id }),
    ]);
  openMenu(place.x, place.y, `Track ${page.selection.nameOf(row.topic, row.id)}, which goes on,`, entries.slice(0, 14));
}

function bearingRows(page, topic) {
  const frame = page.history.at(`bearings ${topic}`, page.time.now);
  return frame ? [...frame.id].map((id) => ({ topic, id })) : [];
}

/** Start a track: of bearings, where a direction is an angle from broadside, or of echoes at a point. */
function directionEntries(page, azimuth, point) {
  if (!page.commands.possible) return [];
  const entries = bearingEntries(page, azimuth);
  if (point && page.history.names("contacts").length) {
    const act = () => page.commands.send({ command: "start_track", topic: "active/tracks", x: point.x, y: point.y });
    entries.push(["Start a track of echoes here", act]);
  }
  return entries;
}

function bearingEntries(page, azimuth) {
  const array = arrayFrame(page);
  if (!array || !Number.isFinite(azimuth)) return [];
  const angle = Math.asin(Math.max(-1, Math.min(1, Math.cos(azimuth - array.sensor.axis_azimuth))));
  const act = () => page.commands.send({ command: "start_track", topic: "passive/bearing_tracks", arrival_angle: angle });
  return [[`Start a bearing track at ${bearing(azimuth)}°`, act]];
}

function arrayFrame(page) {
  const topic = bearingTopics(page.history).find((name) => listOf(page, name));
  const frame = topic ? page.history.at(`bearings ${topic}`, page.time.now) : null;
  return frame && frame.angle_kind === "cone" && frame.sensor.axis_azimuth !== null ? frame : null;
}

/** Lines about a frequency are own ship's, or are no longer: for the view of frequencies. */
export function lineEntries(page, frequency, sensor = "") {
  if (!page.commands.possible || !(frequency > 0)) return [];
  const about = (command) => () => page.commands.send({ command, topic: "passive/tracks", frequency, sensor_id: sensor });
  return [
    [`${frequency.toFixed(1)} Hz is a line of own ship`, about("mark_own_ship_line")],
    [`${frequency.toFixed(1)} Hz is not own ship's`, about("unmark_own_ship_line")],
  ];
}

export function rename(page, row) {
  const given = prompt("Name of the track (empty: its number)", page.selection.names.get(`${row.topic} ${row.id}`) ?? "");
  if (given === null) return;
  const name = given.trim().slice(0, 24);
  page.selection.rename(row.topic, row.id, name);
  const list = listOf(page, row.topic);
  if (name && list && page.commands.possible) {
    page.commands.send({ command: "rename_track", topic: list, id: row.id, name });
  }
}
