// What can be done with a track or a direction: choose, rename, command.

import { openMenu } from "./commands.js";
import { bearing } from "./format.js";

export function openTrackMenu(page, event, row, azimuth) {
  const entries = [];
  const title = row ? `Track ${page.selection.nameOf(row.topic, row.id)}` : `Bearing ${bearing(azimuth)}°`;
  if (row) {
    entries.push(["Choose", () => page.selection.choose({ topic: row.topic, id: row.id })]);
    entries.push(["Rename…", () => rename(page, row)]);
  }
  openMenu(event.clientX, event.clientY, title, entries);
}

export function rename(page, row) {
  const name = prompt("Name of the track (empty: its number)", page.selection.names.get(row.key) ?? "");
  if (name !== null) page.selection.rename(row.topic, row.id, name.trim().slice(0, 24));
}
