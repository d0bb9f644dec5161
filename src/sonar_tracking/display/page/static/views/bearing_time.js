// Bearing-time record: beam power over bearing and time, on three time scales side by side.

import { AXES, BearingAxis, coneOf, relativeText } from "../bearing_axis.js";
import { Canvas, element, label } from "../canvas.js";
import { bearing, clock, degrees, duration, fixed } from "../format.js";
import { Identities } from "../identity.js";
import { keptSelect, keptToggle, moreChoices, offer } from "../kept_choice.js";
import { palette } from "../palette.js";
import { bearingTopics, pictureTopics, polar, tracksAt, ownShipAt } from "../picture.js";
import { readout } from "../readout.js";
import { RowRing, floorOf } from "../row_ring.js";
import { openTrackMenu } from "../track_menu.js";

const SCALES = [1, 5, 20]; // s a line
const LINE_HEIGHT = 2; // CSS pixels
const TOP = 17; // axis of bearings
const BETWEEN = 5; // panels
const POINT_HEIGHT = 2; // pixels between two points of a track
const MOST_RIMMED = 40; // tracks; lines of more have no rim, and are drawn on one side of the array
const MOST_NAMED = 60; // tracks; of more only the chosen one has its name
const NEAR = 9; // pixels from a track that count as on it

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
    const near = this.trackNear(event.offsetX, place);
    if (near) this.page.selection.choose(this.identities.choiceOf(near));
    else this.page.selection.choose({ sensor: place.pose.sensor, beam: place.cone });
    this.page.askDraw();
  }

  /** What can be done with a bearing track, or with a bearing at which nothing is tracked. */
  menu(event) {
    event.preventDefault();
    const place = this.placeOf(event);
    if (!place) return;
    const near = this.trackNear(event.offsetX, place);
    openTrackMenu(this.page, event, near && { topic: near.topic, id: near.id, sensor: near.sensor }, place.azimuth, { mark: { t: place.t, azimuth: place.azimuth } });
  }

  trackNear(x, { panel, t }) {
    let best = null;
    let nearest = NEAR;
    for (const line of this.trackLines(panel, t - 3 * panel.scale, t + 3 * panel.scale)) {
      for (const point of line.points) {
        const apart = Math.abs(panel.box.x + point.share * panel.box.width - x);
        if (apart < nearest) [nearest, best] = [apart, line];
      }
    }
    return best;
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
    if (this.over.value !== "none") this.drawTracks(pen, panel, t);
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

  /** Lines of a panel, made anew where there are newer tracks, or others are looked at. */
  linesOf(panel, t) {
    const { history } = this.page;
    const kind = this.over.value === "picture" ? "tracks" : "bearings";
    const newest = history.topics(kind).map((topic) => history.at(`${kind} ${topic}`, t)?.t);
    const key = [this.topic, this.bearings.mode, kind, panel.box.height, history.version, ...newest].join();
    if (panel.linesKey !== key) {
      panel.lines = this.trackLines(panel, t - panel.ring.height * panel.ring.span, t);
      panel.linesKey = key;
    }
    return panel.lines;
  }

  /** Lines of tracks between two times: {topic, id, sensor, points: [{t, share, other}]}. */
  trackLines(panel, t0, t1) {
    return this.over.value === "picture" ? this.pictureLines(panel, t0, t1) : this.bearingLines(panel, t0, t1);
  }

  bearingLines(panel, t0, t1) {
    const { history } = this.page;
    const lines = new Map();
    for (const topic of bearingTopics(history)) {
      const frames = history.between(`bearings ${topic}`, t0, t1);
      if (frames[0]?.sensor.id !== this.pose.sensor) continue;
      const apart = frames[frames.length - 1].id.length > MOST_RIMMED ? 4 * POINT_HEIGHT : POINT_HEIGHT;
      for (const frame of thinned(frames, panel.box.height / apart)) {
        const [own, other] = this.sharesOf(frame);
        for (let i = 0; i < frame.id.length; i++) {
          if (frame.status[i] === 3) continue;
          const key = frame.id[i];
          if (!lines.has(key)) lines.set(key, { topic, id: key, sensor: frame.sensor.id, points: [] });
          lines.get(key).points.push({ t: frame.t, share: own[i], other: other[i] });
        }
      }
    }
    return [...lines.values()];
  }

  /** Where the tracks of a list are on the axis, on both sides of the array; kept with the list. */
  sharesOf(frame) {
    if (frame.axisMode === this.bearings.mode) return frame.axisShares;
    const pose = this.poseOf(frame);
    const [own, other] = [new Float32Array(frame.id.length), new Float32Array(frame.id.length).fill(NaN)];
    const cone = this.bearings.mode === "cone" && frame.angle_kind === "cone";
    for (let i = 0; i < own.length; i++) {
      own[i] = cone ? this.bearings.shareOfCone(frame.arrival_angle[i], pose) : this.bearings.shareOf(frame.azimuth[i], pose);
      if (this.bearings.whole) other[i] = this.bearings.shareOf(frame.other_azimuth[i], pose);
    }
    frame.axisMode = this.bearings.mode;
    return (frame.axisShares = [own, other]);
  }

  /** How the array lay when bearings were heard: its axis, and the bow. */
  poseOf(frame) {
    const ship = ownShipAt(this.page.history, frame.t);
    return { axis_azimuth: frame.sensor.axis_azimuth, heading: ship?.yaw ?? NaN, angles: this.pose.angles };
  }

  pictureLines(panel, t0, t1) {
    const { history } = this.page;
    const lines = new Map();
    const step = Math.max((t1 - t0) / panel.box.height, 2);
    const topics = pictureTopics(history);
    for (let time = t0; time <= t1; time += step) {
      const row = history.at(`waterfall ${this.topic} ${SCALES[0]}`, time) ?? this.pose;
      const ship = ownShipAt(history, time);
      if (!ship) continue;
      const pose = { axis_azimuth: row.axis_azimuth, heading: ship.yaw, angles: row.angles };
      for (const track of tracksAt(history, time, topics)) {
        if (track.status === 0) continue;
        if (!lines.has(track.key)) lines.set(track.key, { topic: track.topic, id: track.id, points: [] });
        lines.get(track.key).points.push({ t: time, share: this.bearings.shareOf(polar(track, ship).azimuth, pose), other: NaN });
      }
    }
    return [...lines.values()];
  }

  drawTracks(pen, panel, t) {
    const { box, ring } = panel;
    pen.save();
    pen.beginPath();
    pen.rect(box.x, box.y, box.width, box.height);
    pen.clip();
    pen.lineJoin = "round";
    const names = [];
    const lines = this.linesOf(panel, t);
    const chosenLine = lines.find((line) => this.identities.isChosen(line));
    for (const line of lines) {
      const chosen = line === chosenLine;
      const many = lines.length > MOST_RIMMED && !chosen;
      for (const side of this.bearings.whole && !many ? ["share", "other"] : ["share"]) {
        // A rim of the ground keeps the line apart from the loudest and the quietest beams.
        if (!many) {
          pen.strokeStyle = palette.panel;
          pen.globalAlpha = 0.65;
          pen.lineWidth = chosen ? 5 : 3.2;
          this.drawLine(pen, panel, line, side);
          pen.globalAlpha = 1;
        }
        pen.strokeStyle = this.identities.colourOf(line);
        pen.lineWidth = chosen ? 2.6 : 1.3;
        this.drawLine(pen, panel, line, side);
      }
      const newest = line.points[line.points.length - 1];
      const y = box.y + ring.yOf(newest.t, box, this.wrap.isOn);
      if (Number.isFinite(y) && (chosen || lines.length <= MOST_NAMED)) names.push({ line, chosen, x: box.x + newest.share * box.width, y });
    }
    this.drawNames(pen, box, names);
    pen.restore();
  }

  /** Names at the newest ends of the lines; those that would cover another stand a row further in. */
  drawNames(pen, box, names) {
    const inwards = this.top.isOn ? 1 : -1;
    const taken = [];
    names.sort((a, b) => a.x - b.x);
    for (const { line, chosen, x, y } of names) {
      const text = this.identities.nameOf(line);
      pen.font = chosen ? "bold 12px system-ui, sans-serif" : "12px system-ui, sans-serif";
      const width = pen.measureText(text).width + 4;
      const left = x + 4 + width > box.x + box.width ? x - 2 - width : x + 4;
      let row = Math.min(Math.max(y + 9 * inwards, box.y + 9), box.y + box.height - 9);
      const covers = (other) => Math.abs(other.row - row) < 13 && left < other.right && left + width > other.left;
      for (let tries = 0; tries < 8 && taken.some(covers); tries++) row += 13 * inwards;
      taken.push({ left, right: left + width, row });
      pen.textAlign = "left";
      label(pen, text, left, row, this.identities.colourOf(line), palette.panel);
    }
  }

  drawLine(pen, { box, ring }, line, side) {
    pen.setLineDash(side === "other" ? [3, 4] : []);
    pen.beginPath();
    let before = null;
    for (const point of line.points) {
      const y = ring.yOf(point.t, box, this.wrap.isOn);
      const share = point[side];
      const here = Number.isFinite(y) && Number.isFinite(share) ? { x: box.x + share * box.width, y: box.y + y, share, t: point.t } : null;
      const joined = here && before && Math.abs(here.share - before.share) < 0.4 && Math.abs(here.y - before.y) < box.height / 2 && here.t - before.t < 30;
      if (here && joined) pen.lineTo(here.x, here.y);
      else if (here) pen.moveTo(here.x, here.y);
      before = here;
    }
    pen.stroke();
    pen.setLineDash([]);
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

/** At most so many frames, evenly chosen, the newest among them. */
function thinned(frames, most) {
  const step = Math.ceil(frames.length / Math.max(most, 1));
  return step <= 1 ? frames : frames.filter((_, i) => (frames.length - 1 - i) % step === 0);
}
