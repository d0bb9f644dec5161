// The tracks of the picture as a table: sorted, pinned, named.

import { element } from "../canvas.js";
import { UNKNOWN, bearing, degrees, distance, duration, fixed, place } from "../format.js";
import { palette } from "../palette.js";
import { SIDE, SOURCE, STATUS, ownShipAt, polar, tracksAt } from "../picture.js";
import { openTrackMenu, rename } from "../track_menu.js";

const KNOT = 1.943844;

// Words, key to sort by, how it is shown, numeric, explanation.
const COLUMNS = [
  ["track", (r) => r.id, null, true, "Number or name; double click renames, right click commands"],
  ["source", (r) => r.source, (r) => sourceText(r), false, "What hears it"],
  ["status", (r) => r.status, (r) => STATUS[r.status] ?? "?", false, "Status"],
  ["bearing °", (r) => -r.seen.azimuth, (r) => plus(bearing(r.seen.azimuth), degrees(Math.min(r.seen.azimuthDeviation, Math.PI))), true, "True bearing from own ship, and its standard deviation"],
  ["range", (r) => r.seen.range, (r) => plus(distance(r.seen.range), fixed(r.seen.rangeDeviation, 0)), true, "Distance from own ship, and its standard deviation in metres"],
  ["course °", (r) => -r.seen.course, (r) => courseText(r), true, "Course, and its standard deviation"],
  ["speed kn", (r) => r.seen.speed, (r) => plus(fixed(r.seen.speed * KNOT, 1), fixed(r.seen.speedDeviation * KNOT, 1)), true, "Speed, and its standard deviation"],
  ["exists", (r) => r.existence, (r) => fixed(r.existence, 2), true, "Probability that there is a target"],
  ["observable", (r) => r.observability, (r) => fixed(r.observability, 2), true, "0: the position cannot be told from what is heard; 1: it can"],
  ["age", (r) => -r.initiated, (r) => duration(r.t - r.initiated), true, "Since the track was started"],
  ["heard", (r) => -r.updated, (r) => duration(r.t - r.updated), true, "Since its last measurement"],
  ["sensors", (r) => r.contributors.length, (r) => sensorsText(r), false, "Who contributes, with the numbers there"],
  ["place", (r) => r.y, (r) => r.place, true, "Latitude and longitude; sorted from south to north"],
];

export class TrackTable {
  static id = "tracks";
  static title = "Tracks";

  constructor(body, tools, page) {
    this.page = page;
    this.order = { column: 0, down: false };
    this.pinned = new Set();
    body.classList.add("scrolls");
    this.heads = COLUMNS.map(([words, , , numeric, title], column) => {
      const button = element("button", { title: `${title}. Click to sort.`, onclick: () => this.sort(column) }, words);
      return element("th", { class: cellClass(column, numeric), scope: "col" }, button);
    });
    this.rows = element("tbody");
    this.table = element("table", {}, element("thead", {}, element("tr", {}, element("th", {}, ""), ...this.heads)), this.rows);
    body.append(this.table);
    this.empty = element("div", { class: "empty" }, "No tracks yet.");
    body.append(this.empty);
    this.count = element("span", { class: "figures" });
    tools.append(this.count);
    this.lines = new Map();
    this.rows.addEventListener("click", (event) => this.click(event));
    this.rows.addEventListener("dblclick", (event) => this.withRow(event, (row) => rename(page, row)));
    this.rows.addEventListener("contextmenu", (event) => {
      event.preventDefault();
      this.withRow(event, (row) => openTrackMenu(page, event, row, row.seen.azimuth));
    });
    this.rows.addEventListener("keydown", (event) => {
      if (event.key === "Enter") this.withRow(event, (row) => this.choose(row));
    });
  }

  sort(column) {
    this.order = { column, down: this.order.column === column && !this.order.down };
    this.page.askDraw();
  }

  withRow(event, act) {
    const line = event.target.closest("tr");
    if (line?.row) act(line.row);
  }

  click(event) {
    this.withRow(event, (row) => {
      if (event.target.closest("button.pin")) {
        if (!this.pinned.delete(row.key)) this.pinned.add(row.key);
        this.page.askDraw();
      } else {
        this.choose(row);
      }
    });
  }

  choose(row) {
    const { selection } = this.page;
    selection.choose(selection.isChosen(row.topic, row.id) ? null : { topic: row.topic, id: row.id });
  }

  draw(t) {
    const { history } = this.page;
    const known = Number.isFinite(t);
    const ship = known ? ownShipAt(history, t) : null;
    const rows = known ? tracksAt(history, t) : [];
    const { datum } = this.page;
    this.table.classList.toggle("placeless", !datum);
    for (const row of rows) {
      row.seen = polar(row, ship);
      row.place = place(row.x, row.y, datum);
    }
    this.arrange(rows);
    this.empty.hidden = rows.length > 0;
    const confirmed = rows.filter((row) => row.status === 1).length;
    this.count.textContent = rows.length ? `${confirmed} confirmed of ${rows.length}` : "";
    this.heads.forEach((head, column) => {
      const order = this.order.column === column ? (this.order.down ? "descending" : "ascending") : "none";
      if (head.getAttribute("aria-sort") !== order) head.setAttribute("aria-sort", order);
    });
    this.show(rows);
  }

  arrange(rows) {
    const key = COLUMNS[this.order.column][1];
    const sign = this.order.down ? -1 : 1;
    const pinned = (row) => (this.pinned.has(row.key) ? 0 : 1);
    const value = (row) => (Number.isFinite(key(row)) ? key(row) : Infinity);
    rows.sort((a, b) => pinned(a) - pinned(b) || sign * (value(a) - value(b) || 0) || a.id - b.id);
  }

  /** Lines stay where their track stays: nothing jumps or flickers, and the focus is not lost. */
  show(rows) {
    const gone = new Set(this.lines.keys());
    rows.forEach((row, place) => {
      gone.delete(row.key);
      let line = this.lines.get(row.key);
      if (!line) this.lines.set(row.key, (line = this.makeLine()));
      this.fill(line, row);
      if (this.rows.children[place] !== line) this.rows.insertBefore(line, this.rows.children[place] ?? null);
    });
    for (const key of gone) {
      this.lines.get(key).remove();
      this.lines.delete(key);
    }
  }

  makeLine() {
    const pin = element("button", { class: "pin", title: "Keep on top", "aria-label": "Keep on top" }, "○");
    const line = element("tr", { tabindex: 0 }, element("td", {}, pin));
    COLUMNS.forEach(([, , , numeric], column) => line.append(element("td", { class: cellClass(column, numeric) })));
    line.cells[1].append(element("span", { class: "swatch" }), document.createTextNode(""));
    return line;
  }

  fill(line, row) {
    line.row = row;
    const chosen = this.page.selection.isChosen(row.topic, row.id);
    const name = `${STATUS[row.status]}${chosen ? " chosen" : ""}`;
    if (line.className !== name) line.className = name;
    const pin = line.cells[0].firstChild;
    const sign = this.pinned.has(row.key) ? "●" : "○";
    if (pin.textContent !== sign) pin.textContent = sign;
    line.cells[1].firstChild.style.background = palette.track(row.id);
    const side = SIDE[row.side] ? ` ${SIDE[row.side]}` : "";
    setText(line.cells[1].lastChild, this.page.selection.nameOf(row.topic, row.id) + side);
    for (let column = 1; column < COLUMNS.length; column++) setText(line.cells[column + 1], COLUMNS[column][2](row));
  }
}

function cellClass(column, numeric) {
  return `${numeric ? "n" : ""}${COLUMNS[column][0] === "place" ? " place" : ""}`;
}

function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

function plus(value, deviation) {
  return value === UNKNOWN || deviation === UNKNOWN ? value : `${value} ±${deviation}`;
}

/** A course is unknown where there is no way on, or its deviation is all round. */
function courseText(row) {
  const { course, speed, courseDeviation } = row.seen;
  if (!(speed > 0.3) || courseDeviation > Math.PI / 2) return UNKNOWN;
  return plus(bearing(course, 0), degrees(courseDeviation, 0));
}

function sourceText(row) {
  const words = { 0: "echoes", 1: "bearings", 4: "fixed" };
  const found = [...new Set(row.contributors.map((entry) => words[entry[1]]).filter(Boolean))];
  return found.length ? found.join(" + ") : (SOURCE[row.source] ?? "?");
}

function sensorsText(row) {
  return row.contributors.map(([, , sensor, id]) => `${sensor || "?"} ${id}`).join(", ");
}
