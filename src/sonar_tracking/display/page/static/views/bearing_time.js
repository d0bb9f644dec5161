// Bearing-time record: beam power over bearing and time, on three time scales side by side.

import { AXES, BearingAxis, coneOf, relativeText } from "../bearing_axis.js";
import { Canvas, element, label } from "../canvas.js";
import { bearing, clock, degrees, duration, fixed } from "../format.js";
import { Identities } from "../identity.js";
import { keptSelect, keptToggle, moreChoices, offer } from "../kept_choice.js";
import { palette } from "../palette.js";
import { readout } from "../readout.js";
import { RowRing, floorOf } from "../row_ring.js";
import { openTrackMenu } from "../track_menu.js";
import { BearingTimeTracks } from "./bearing_time_tracks.js";

const SCALES = [1, 5, 20]; // s a line
const LINE_HEIGHT = 2; // CSS pixels
const TOP = 17; // axis of bearings
const BETWEEN = 5; // panels

export class BearingTime {
  static id = "bearing_time";
  static title = "Bearing–time";

  constructor(body, tools, page) {
    this.page = page;
    this.canvas = new Canvas(body, "Bearing-time record: power over bearing and time");
    this.empty = element("div", { class: "empty" }, "No beams yet: snapshots or samples of an array make them.");
    body.append(this.empty);
    const ask = () => page.askDraw();
    this.source = element("select", { title: "Which beams", "aria-label": "Which beams" });
    this.source.addEventListener("change", ask);
    this.axis = keptSelect("btr axis", "Axis of bearings", AXES, "cone", ask);
    this.scales = keptSelect("btr scales", "Seconds a line", { all: "1, 5 and 20 s", 1: "1 s", 5: "5 s", 20: "20 s" }, "all", ask);
    this.range = keptSelect("btr range", "Range of levels", { 6: "6 dB", 10: "10 dB", 15: "15 dB", 20: "20 dB", 30: "30 dB" }, "20", ask);
    this.over = keptSelect("btr tracks", "Tracks over it", { bearings: "bearing tracks", picture: "fused tracks", none: "none" }, "bearings", ask);
    this.top = keptToggle("btr top", "", "Newest on top", true, ask);
    this.wrap = keptToggle("btr wrap", "", "Wrap instead of scroll", false, ask);
    const more = moreChoices(
      ["Seconds a line", this.scales], ["Range of levels", this.range], ["Tracks over it", this.over],
      ["Newest on top", this.top], ["Wrap, not scroll", this.wrap],
    );
    tools.append(this.source, this.axis, more);
    this.panels = SCALES.map((scale) => ({ scale, ring: new RowRing(), box: null }));
    this.tracks = new BearingTimeTracks(this);
    this.pointer = null;
    const canvas = this.canvas.element;
    canvas.addEventListener("pointermove", (event) => this.point(event));
    canvas.addEventListener("pointerleave", () => this.point(null));
    canvas.addEventListener("click", (event) => this.click(event));
    canvas.addEventListener("dblclick", (event) => this.menu(event));
    canvas.addEventListener("contextmenu", (event) => this.menu(event));
  }

  point(event) {
    this.pointer = event && { offsetX: event.offsetX, offsetY: event.offsetY };
    this.page.askDraw();
  }

  /** What is at a place of the canvas: panel, time, row, azimuth. */
  placeOf({ offsetX, offsetY }) {
    const panel = this.panels.find(({ box }) => box && offsetX >= box.x && offsetX < box.x + box.width);
    if (!panel || offsetY < panel.box.y || offsetY > panel.box.y + panel.box.height) return null;
    const share = (offsetX - panel.box.x) / panel.box.width;
    const t = panel.ring.timeAt(offsetY - panel.box.y, panel.box, this.wrap.isOn);
    const frame = this.rowAt(panel, t);
    const pose = frame ?? this.pose;
    if (!pose) return null;
    const azimuth = this.bearings.azimuthAt(share, pose);
    return { panel, t, frame, pose, share, azimuth, cone: this.bearings.whole ? coneOf(azimuth, pose) : this.bearings.coneAt(share, pose) };
  }

  rowAt(panel, t) {
    const { history } = this.page;
    const name = `waterfall ${this.topic} ${panel.scale}`;
    const stream = history.stream(name);
    const frame = stream?.frames[stream.after(t)];
    return frame && frame.t0 <= t ? frame : null;
  }

  click(event) {
    const place = this.placeOf(event);
    if (!place) return;
    if (event.shiftKey) {
      this.page.time.markNext({ t: place.t, azimuth: place.azimuth });
      return;
    }
    const near = this.tracks.near(event.offsetX, place);
    if (near) this.page.selection.choose(this.identities.choiceOf(near));
    else this.page.selection.choose({ sensor: place.pose.sensor, beam: place.cone });
    this.page.askDraw();
  }

  /** What can be done with a bearing track, or with a bearing at which nothing is tracked. */
  menu(event) {
    event.preventDefault();
    const place = this.placeOf(event);
    if (!place) return;
    const near = this.tracks.near(event.offsetX, place);
    openTrackMenu(this.page, event, near && { topic: near.topic, id: near.id, sensor: near.sensor }, place.azimuth, { mark: { t: place.t, azimuth: place.azimuth } });
  }

  draw(t) {
    const { history, time } = this.page;
    const pen = this.canvas.begin(palette.panel);
    this.chooseSource();
    this.empty.hidden = Boolean(this.topic);
    if (!pen || !this.topic) return;
    this.bearings = new BearingAxis(this.axis.value);
    this.pose = history.at(`waterfall ${this.topic} ${SCALES[0]}`, t) ?? this.firstRow();
    if (!this.pose) return;
    this.identities = new Identities(history, this.page.selection, t);
    const shown = this.panels.filter(({ scale }) => this.scales.value === "all" || this.scales.value === String(scale));
    const width = (this.canvas.width - BETWEEN * (shown.length - 1)) / shown.length;
    for (const panel of this.panels) panel.box = null;
    shown.forEach((panel, place) => {
      panel.box = { x: place * (width + BETWEEN), y: TOP, width, height: this.canvas.height - TOP };
      this.drawPanel(pen, panel, t);
    });
    this.drawMarks(pen, time.marks);
    const place = this.pointer && this.placeOf(this.pointer);
    if (place) this.drawHover(pen, place);
  }

  chooseSource() {
    const { history } = this.page;
    const entries = [];
    for (const name of history.names("waterfall")) {
      const [, topic, scale] = name.split(" ");
      if (Number(scale) !== SCALES[0]) continue;
      const stream = history.stream(name);
      const frame = stream.frames[stream.frames.length - 1];
      entries.push([topic, frame.content, frame.sensor]);
    }
    const sensors = new Set(entries.map(([, , sensor]) => sensor));
    for (const entry of entries) if (sensors.size > 1) entry[1] = `${entry[2]} ${entry[1]}`;
    offer(this.source, entries);
    this.source.hidden = entries.length < 2;
    this.topic = this.source.value || null;
  }

  firstRow() {
    const stream = this.page.history.stream(`waterfall ${this.topic} ${SCALES[0]}`);
    return stream?.frames[stream.first] ?? null;
  }

  drawPanel(pen, panel, t) {
    const { history } = this.page;
    const { box, ring, scale } = panel;
    const name = `waterfall ${this.topic} ${scale}`;
    const openName = `waterfall_open ${this.topic} ${scale}`;
    const ramp = palette.ramp();
    const range = Number(this.range.value);
    pen.fillStyle = palette.dark ? "#04080d" : "#f4f6f8";
    pen.fillRect(box.x, box.y, box.width, box.height);
    ring.show(pen, box, {
      now: t,
      ratio: this.canvas.ratio,
      lineSeconds: scale / LINE_HEIGHT,
      newestOnTop: this.top.isOn,
      wrap: this.wrap.isOn,
      key: `${this.topic} ${this.axis.value} ${range} ${palette.dark} ${history.version}`,
      rows: (t0, t1) => history.between(name, t0, t1),
      open: () => history.at(openName, t),
      paint: (frame, line) => this.paint(frame, line, ramp, range),
    });
    this.drawAxis(pen, panel);
    if (this.over.value !== "none") this.tracks.draw(pen, panel, t);
    if (this.wrap.isOn) {
      pen.fillStyle = palette.accent;
      pen.fillRect(box.x, box.y + ring.edge(box) - 1, box.width, 2);
    }
  }

  paint(frame, line, ramp, range) {
    frame.floor ??= floorOf(frame.row);
    const levels = this.bearings.levels(frame, (this.levels = sized(this.levels, line.length)));
    const unit = 255 / range;
    for (let x = 0; x < line.length; x++) {
      const shade = (levels[x] - frame.floor + 1) * unit;
      line[x] = shade >= 0 ? ramp[Math.min(255, shade | 0)] : shade < 0 ? ramp[0] : 0;
    }
  }

  drawAxis(pen, { box, ring, scale }) {
    pen.save();
    pen.font = "11px system-ui, sans-serif";
    pen.strokeStyle = palette.faint;
    pen.textAlign = "center";
    const ticks = this.bearings.ticks(box.width, this.pose);
    ticks.forEach(([share, text], place) => {
      const x = box.x + share * box.width;
      pen.textAlign = place === 0 ? "left" : place === ticks.length - 1 ? "right" : "center";
      pen.fillStyle = palette.faint;
      pen.fillText(text, x, TOP / 2);
      pen.globalAlpha = 0.25;
      pen.beginPath();
      pen.moveTo(x, box.y);
      pen.lineTo(x, box.y + box.height);
      pen.stroke();
      pen.globalAlpha = 1;
    });
    pen.textAlign = "left";
    const every = [10, 30, 60, 120, 300, 600, 1200, 1800, 3600].find((s) => (s / scale) * LINE_HEIGHT >= 42) ?? 7200;
    const oldest = Math.max((ring.last - ring.height + 1) * ring.span, this.page.history.oldest);
    for (let time = Math.ceil(oldest / every) * every; time <= (ring.last + 1) * ring.span; time += every) {
      const y = box.y + ring.yOf(time, box, this.wrap.isOn);
      if (!(y > box.y + 7 && y < box.y + box.height - 20)) continue;
      label(pen, every % 60 ? clock(time) : clock(time).slice(0, 5), box.x + 3, y, palette.text, palette.panel);
    }
    label(pen, `${scale} s a line`, box.x + 3, box.y + box.height - 9, palette.text, palette.panel);
    pen.restore();
  }

  drawMarks(pen, marks) {
    for (const [name, mark] of Object.entries(marks)) {
      if (!mark) continue;
      for (const { box, ring, scale } of this.panels) {
        if (!box) continue;
        const y = box.y + ring.yOf(mark.t, box, this.wrap.isOn);
        if (!Number.isFinite(y)) continue;
        const pose = this.rowAt({ scale }, mark.t) ?? this.pose;
        const x = box.x + this.bearings.shareOf(mark.azimuth, pose) * box.width;
        pen.strokeStyle = palette[name.toLowerCase()];
        pen.lineWidth = 1.5;
        pen.beginPath();
        pen.moveTo(box.x, y);
        pen.lineTo(box.x + box.width, y);
        if (Number.isFinite(x)) {
          pen.moveTo(x, box.y);
          pen.lineTo(x, box.y + box.height);
        }
        pen.stroke();
        label(pen, name, Number.isFinite(x) ? x + 4 : box.x + 4, y - 8, pen.strokeStyle, palette.panel);
      }
    }
    pen.lineWidth = 1;
  }

  drawHover(pen, { t, azimuth, cone, pose, frame, share }) {
    pen.strokeStyle = palette.accent;
    pen.globalAlpha = 0.8;
    for (const { box, ring } of this.panels) {
      if (!box) continue;
      const y = box.y + ring.yOf(t, box, this.wrap.isOn);
      const x = box.x + share * box.width;
      pen.beginPath();
      pen.moveTo(x, box.y);
      pen.lineTo(x, box.y + box.height);
      if (Number.isFinite(y)) {
        pen.moveTo(box.x, y);
        pen.lineTo(box.x + box.width, y);
      }
      pen.stroke();
    }
    pen.globalAlpha = 1;
    const words = [clock(t), `−${duration(this.page.time.now - t)}`];
    if (pose.angles.of === "sine") {
      const mirrored = 2 * pose.axis_azimuth - azimuth;
      words.push(`${bearing(azimuth)}° or ${bearing(mirrored)}°`);
    } else words.push(`${bearing(azimuth)}°`);
    words.push(relativeText(azimuth, pose.heading), `cone ${degrees(cone)}°`);
    if (frame) words.push(`${fixed(this.levelAt(frame, share), 1)} dB`);
    readout(pen, this.canvas, words.join("   "));
  }

  levelAt(frame, share) {
    const count = 4096;
    const levels = this.bearings.levels(frame, (this.probe ??= new Float32Array(count)));
    return levels[Math.min(count - 1, Math.floor(share * count))];
  }
}

function sized(array, length) {
  return array?.length === length ? array : new Float32Array(length);
}
