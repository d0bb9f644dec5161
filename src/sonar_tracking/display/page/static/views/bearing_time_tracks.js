// Tracks over the bearing-time record: where each was on the axis, on both sides of the array.

import { label } from "../canvas.js";
import { palette } from "../palette.js";
import { bearingTopics, ownShipAt, pictureTopics, polar, tracksAt } from "../picture.js";

const SCALE_OF_ROWS = 1; // s a line, of those that say how the array lay
const POINT_HEIGHT = 2; // pixels between two points of a track
const MOST_RIMMED = 40; // tracks; lines of more have no rim, and are drawn on one side of the array
const MOST_NAMED = 60; // tracks; of more only the chosen one has its name
const NEAR = 9; // pixels from a track that count as on it

export class BearingTimeTracks {
  /** view: the bearing-time record, with its axis, its pose and its choices as last drawn. */
  constructor(view) {
    this.view = view;
  }

  /** The track a pointer is on, or null. */
  near(x, { panel, t }) {
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

  /** Lines of a panel, made anew where there are newer tracks, or others are looked at. */
  linesOf(panel, t) {
    const { history } = this.view.page;
    const kind = this.view.over.value === "picture" ? "tracks" : "bearings";
    const newest = history.topics(kind).map((topic) => history.at(`${kind} ${topic}`, t)?.t);
    const key = [this.view.topic, this.view.bearings.mode, kind, panel.box.height, history.version, ...newest].join();
    if (panel.linesKey !== key) {
      panel.lines = this.trackLines(panel, t - panel.ring.height * panel.ring.span, t);
      panel.linesKey = key;
    }
    return panel.lines;
  }

  /** Lines of tracks between two times: {topic, id, sensor, points: [{t, share, other}]}. */
  trackLines(panel, t0, t1) {
    return this.view.over.value === "picture" ? this.pictureLines(panel, t0, t1) : this.bearingLines(panel, t0, t1);
  }

  bearingLines(panel, t0, t1) {
    const { history } = this.view.page;
    const lines = new Map();
    for (const topic of bearingTopics(history)) {
      const frames = history.between(`bearings ${topic}`, t0, t1);
      if (frames[0]?.sensor.id !== this.view.pose.sensor) continue;
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
    if (frame.axisMode === this.view.bearings.mode) return frame.axisShares;
    const pose = this.poseOf(frame);
    const [own, other] = [new Float32Array(frame.id.length), new Float32Array(frame.id.length).fill(NaN)];
    const cone = this.view.bearings.mode === "cone" && frame.angle_kind === "cone";
    for (let i = 0; i < own.length; i++) {
      own[i] = cone ? this.view.bearings.shareOfCone(frame.arrival_angle[i], pose) : this.view.bearings.shareOf(frame.azimuth[i], pose);
      if (this.view.bearings.whole) other[i] = this.view.bearings.shareOf(frame.other_azimuth[i], pose);
    }
    frame.axisMode = this.view.bearings.mode;
    return (frame.axisShares = [own, other]);
  }

  /** How the array lay when bearings were heard: its axis, and the bow. */
  poseOf(frame) {
    const ship = ownShipAt(this.view.page.history, frame.t);
    return { axis_azimuth: frame.sensor.axis_azimuth, heading: ship?.yaw ?? NaN, angles: this.view.pose.angles };
  }

  pictureLines(panel, t0, t1) {
    const { history } = this.view.page;
    const lines = new Map();
    const step = Math.max((t1 - t0) / panel.box.height, 2);
    const topics = pictureTopics(history);
    for (let time = t0; time <= t1; time += step) {
      const row = history.at(`waterfall ${this.view.topic} ${SCALE_OF_ROWS}`, time) ?? this.view.pose;
      const ship = ownShipAt(history, time);
      if (!ship) continue;
      const pose = { axis_azimuth: row.axis_azimuth, heading: ship.yaw, angles: row.angles };
      for (const track of tracksAt(history, time, topics)) {
        if (track.status === 0) continue;
        if (!lines.has(track.key)) lines.set(track.key, { topic: track.topic, id: track.id, points: [] });
        lines.get(track.key).points.push({ t: time, share: this.view.bearings.shareOf(polar(track, ship).azimuth, pose), other: NaN });
      }
    }
    return [...lines.values()];
  }

  draw(pen, panel, t) {
    const { box, ring } = panel;
    pen.save();
    pen.beginPath();
    pen.rect(box.x, box.y, box.width, box.height);
    pen.clip();
    pen.lineJoin = "round";
    const names = [];
    const lines = this.linesOf(panel, t);
    const chosenLine = lines.find((line) => this.view.identities.isChosen(line));
    for (const line of lines) {
      const chosen = line === chosenLine;
      const many = lines.length > MOST_RIMMED && !chosen;
      for (const side of this.view.bearings.whole && !many ? ["share", "other"] : ["share"]) {
        // A rim of the ground keeps the line apart from the loudest and the quietest beams.
        if (!many) {
          pen.strokeStyle = palette.panel;
          pen.globalAlpha = 0.65;
          pen.lineWidth = chosen ? 5 : 3.2;
          this.drawLine(pen, panel, line, side);
          pen.globalAlpha = 1;
        }
        pen.strokeStyle = this.view.identities.colourOf(line);
        pen.lineWidth = chosen ? 2.6 : 1.3;
        this.drawLine(pen, panel, line, side);
      }
      const newest = line.points[line.points.length - 1];
      const y = box.y + ring.yOf(newest.t, box, this.view.wrap.isOn);
      if (Number.isFinite(y) && (chosen || lines.length <= MOST_NAMED)) names.push({ line, chosen, x: box.x + newest.share * box.width, y });
    }
    this.drawNames(pen, box, names);
    pen.restore();
  }

  /** Names at the newest ends of the lines; those that would cover another stand a row further in. */
  drawNames(pen, box, names) {
    const inwards = this.view.top.isOn ? 1 : -1;
    const taken = [];
    names.sort((a, b) => a.x - b.x);
    for (const { line, chosen, x, y } of names) {
      const text = this.view.identities.nameOf(line);
      pen.font = chosen ? "bold 12px system-ui, sans-serif" : "12px system-ui, sans-serif";
      const width = pen.measureText(text).width + 4;
      const left = x + 4 + width > box.x + box.width ? x - 2 - width : x + 4;
      let row = Math.min(Math.max(y + 9 * inwards, box.y + 9), box.y + box.height - 9);
      const covers = (other) => Math.abs(other.row - row) < 13 && left < other.right && left + width > other.left;
      for (let tries = 0; tries < 8 && taken.some(covers); tries++) row += 13 * inwards;
      taken.push({ left, right: left + width, row });
      pen.textAlign = "left";
      label(pen, text, left, row, this.view.identities.colourOf(line), palette.panel);
    }
  }

  drawLine(pen, { box, ring }, line, side) {
    pen.setLineDash(side === "other" ? [3, 4] : []);
    pen.beginPath();
    let before = null;
    for (const point of line.points) {
      const y = ring.yOf(point.t, box, this.view.wrap.isOn);
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
}

/** At most so many frames, evenly chosen, the newest among them. */
function thinned(frames, most) {
  const step = Math.ceil(frames.length / Math.max(most, 1));
  return step <= 1 ? frames : frames.filter((_, i) => (frames.length - 1 - i) % step === 0);
}
