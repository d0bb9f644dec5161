// What can be done with a track, a direction or a line: choose, rename, command.

import { element } from "./canvas.js";
import { openMenu } from "./commands.js";
import { bearing } from "./format.js";
import { Identities } from "./identity.js";
import { isUnder } from "./own_ship_lines.js";
import { TERMINATED, bearingTopics, tracksAt } from "./picture.js";

const MOST_OTHERS = 14; // tracks in a menu
const LONGEST_NAME = 24;
const LISTS = ["passive/bearing_tracks", "active/tracks", "passive/tracks", "tracks"];

/** The name by which trackers know a topic: that in a graph without a namespace; "" = none of theirs. */
export function listOf(page, topic) {
  const below = `${page.hello?.namespace ?? ""}/`;
  const name = topic.startsWith(below) ? topic.slice(below.length) : topic;
  return LISTS.includes(name) ? name : "";
}

/**
 * The menu of a track of the picture, of a bearing track ({topic, id, sensor}), or of a direction;
 * there: {point: the place in the map, mark: what a cursor there would tell}, as far as known.
 */
export function openTrackMenu(page, event, row, azimuth, there = {}) {
  const place = { x: event.clientX, y: event.clientY };
  const who = new Identities(page.history, page.selection, page.time.now);
  const entries = row ? trackEntries(page, who, row, place) : directionEntries(page, azimuth, there.point);
  if (there.mark) entries.push(markEntry(page, there.mark));
  if (!page.commands.possible) entries.push(["Read only: no commands", () => page.commands.explain()]);
  openMenu(place.x, place.y, row ? titleOf(who, row) : `Bearing ${bearing(azimuth)}°`, entries);
}

/** The name of a track, and what it is in the list that hears it. */
function titleOf(who, row) {
  const name = who.nameOf(row);
  const owner = who.ownerOf(row);
  if (!owner || owner.topic === row.topic) return `Track ${name}`;
  return `Track ${name} (${row.sensor === undefined ? "of echoes" : "of bearings"}: ${row.id})`;
}

/** Set cursor A, or B after it, as Shift and a click do. */
export function markEntry(page, mark) {
  const { A, B } = page.time.marks;
  return [`Cursor ${!A || B ? "A" : "B"} here`, () => page.time.markNext(mark)];
}

function trackEntries(page, who, row, place) {
  const { commands, selection } = page;
  const list = listOf(page, row.topic);
  const entries = [["Choose", () => selection.choose(who.choiceOf(row))]];
  entries.push(["Rename…", () => rename(page, who.choiceOf(row))]);
  if (!commands.possible || !list) return entries;
  entries.push(["End track", () => commands.send({ command: "end_track", topic: list, id: row.id })]);
  if (list !== "passive/tracks") {
    entries.push(["Merge with…", () => openMergeMenu(page, who, row, list, place)]);
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

function openMergeMenu(page, who, row, list, place) {
  const others = row.sensor === undefined
    ? tracksAt(page.history, page.time.now, [row.topic])
    : bearingRows(page, row);
  const entries = others
    .filter((other) => other.id !== row.id)
    .map((other) => [
      `is the same target as ${titleOf(who, other).replace("Track ", "")}`,
      () => page.commands.send({ command: "merge_tracks", topic: list, id: row.id, other_id: other.id }),
    ]);
  openMenu(place.x, place.y, `${titleOf(who, row)}, which goes on,`, entries.slice(0, MOST_OTHERS));
}

function bearingRows(page, { topic, sensor }) {
  const frame = page.history.at(`bearings ${topic}`, page.time.now);
  const goesOn = (_, i) => frame.status[i] !== TERMINATED;
  return frame ? frame.id.filter(goesOn).map((id) => ({ topic, id, sensor })) : [];
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
export function lineEntries(page, frequency, sensor, marks) {
  if (!page.commands.possible || !(frequency > 0)) return [];
  const about = (command) => () => page.commands.send({ command, topic: "passive/tracks", frequency, sensor_id: sensor });
  const words = `${frequency.toFixed(1)} Hz is`;
  return marks.some((mark) => isUnder(mark, frequency, sensor))
    ? [[`${words} no line of own ship`, about("unmark_own_ship_line")]]
    : [[`${words} a line of own ship`, about("mark_own_ship_line")]];
}

/** Ask for a name; the page goes on meanwhile. */
export function rename(page, { topic, id }) {
  const input = element("input", { type: "text", maxlength: LONGEST_NAME, "aria-label": `Name of track ${id}` });
  input.value = page.selection.names.get(`${topic} ${id}`) ?? "";
  const act = () => giveName(page, topic, id, input.value.trim());
  const cancel = element("button", { type: "button", onclick: () => dialog.close() }, "Cancel");
  const dialog = element("dialog", { class: "ask" },
    element("form", { method: "dialog", onsubmit: act },
      element("strong", {}, `Name of track ${id}`), input, element("small", {}, "Empty: its number"),
      element("span", {}, cancel, element("button", { class: "on" }, "Rename"))));
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
  input.select();
}

function giveName(page, topic, id, name) {
  page.selection.rename(topic, id, name);
  const list = listOf(page, topic);
  if (name && list && page.commands.possible) {
    page.commands.send({ command: "rename_track", topic: list, id, name });
  }
}
