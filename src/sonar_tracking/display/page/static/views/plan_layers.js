// What lies under the tracks of the plan: range rings, bearings, contacts, trails and the truth.

import { label } from "../canvas.js";
import { DEGREE, axisDistance, niceStep } from "../format.js";
import { palette } from "../palette.js";
import { TERMINATED, bearingTopics, pictureTopics, tracksAt, truthTopics } from "../picture.js";

const TRAIL_SECONDS = 600;
const FASTEST = 30; // m/s
const RAY_AGE = 20;

/** Range rings about own ship, or the middle, and directions. */
export function drawRings(pen, view) {
  const middle = view.ship ?? view.origin;
  const place = view.toScreen(middle.x, middle.y);
  const { width, height } = view.canvas;
  const step = niceStep(view.span / 9);
  const farthest = Math.hypot(Math.max(place.x, width - place.x), Math.max(place.y, height - place.y)) / view.scale;
  pen.font = "11px system-ui, sans-serif";
  pen.strokeStyle = palette.line;
  for (let r = step, i = 0; r < farthest && i < 40; r += step, i++) {
    pen.beginPath();
    pen.arc(place.x, place.y, r * view.scale, 0, 2 * Math.PI);
    pen.stroke();
  }
  const names = [];
  for (let degree = 0; degree < 360; degree += 30) {
    const angle = Math.PI / 2 - degree * DEGREE - view.up_angle;
    const [ux, uy] = [Math.cos(angle), -Math.sin(angle)];
    pen.globalAlpha = 0.5;
    pen.beginPath();
    pen.moveTo(place.x + ux * step * view.scale, place.y + uy * step * view.scale);
    pen.lineTo(place.x + ux * farthest * view.scale, place.y + uy * farthest * view.scale);
    pen.stroke();
    pen.globalAlpha = 1;
    const edge = reach(place, ux, uy, width, height, 15);
    if (edge > 60) names.push([String(degree).padStart(3, "0"), place.x + ux * edge, place.y + uy * edge]);
  }
  pen.textAlign = "center";
  for (const [text, x, y] of names) label(pen, text, x, y, palette.faint, palette.panel);
  pen.textAlign = "left";
  for (let r = step, i = 0; r < farthest && i < 40; r += step, i++) {
    const y = place.y + r * view.scale;
    if (y < height - 26) label(pen, axisDistance(r, farthest), place.x + 4, y, palette.faint, palette.panel);
  }
  pen.font = "12px system-ui, sans-serif";
}

/** Where each bearing sensor is, and the directions of its tracks. */
export function drawRays(pen, view, t) {
  const { history } = view.page;
  const length = 3 * view.span;
  for (const topic of bearingTopics(history)) {
    const frame = history.at(`bearings ${topic}`, t);
    if (!frame || t - frame.t > RAY_AGE || frame.sensor.x === null) continue;
    const from = view.toScreen(frame.sensor.x, frame.sensor.y);
    drawSensor(pen, view, from, frame.sensor.id);
    for (let i = 0; i < frame.id.length; i++) {
      if (frame.status[i] === TERMINATED) continue;
      for (const azimuth of [frame.azimuth[i], frame.other_azimuth[i]]) {
        if (!Number.isFinite(azimuth)) continue;
        const to = view.toScreen(frame.sensor.x + length * Math.cos(azimuth), frame.sensor.y + length * Math.sin(azimuth));
        pen.strokeStyle = palette.ray;
        pen.globalAlpha = 0.6;
        pen.setLineDash(frame.ambiguous[i] ? [7, 5] : []);
        pen.beginPath();
        pen.moveTo(from.x, from.y);
        pen.lineTo(to.x, to.y);
        pen.stroke();
      }
    }
    pen.setLineDash([]);
    pen.globalAlpha = 1;
  }
}

function drawSensor(pen, view, place, name) {
  if (view.ship && Math.hypot(place.x - view.toScreen(view.ship.x, view.ship.y).x, place.y - view.toScreen(view.ship.x, view.ship.y).y) < 8) return;
  pen.strokeStyle = palette.own;
  pen.strokeRect(place.x - 4, place.y - 4, 8, 8);
  label(pen, name, place.x + 8, place.y - 8, palette.faint, palette.panel);
}

/** Contacts of the last ping. */
export function drawContacts(pen, view, t) {
  const { history } = view.page;
  for (const name of history.names("contacts")) {
    const frame = history.at(name, t);
    if (!frame || t - frame.t > 60) continue;
    pen.fillStyle = palette.contact;
    for (let i = 0; i < frame.x.length; i++) {
      if (!Number.isFinite(frame.x[i])) continue;
      const place = view.toScreen(frame.x[i], frame.y[i]);
      const size = frame.amplitude_db[i] > 16 ? 2.5 : 1.5;
      pen.fillRect(place.x - size, place.y - size, 2 * size, 2 * size);
    }
  }
}

/** Where targets truly are. */
export function drawTruth(pen, view, t) {
  pen.strokeStyle = palette.truth;
  for (const row of tracksAt(view.page.history, t, truthTopics(view.page.history))) {
    const { x, y } = view.toScreen(row.x, row.y);
    pen.beginPath();
    pen.moveTo(x - 5, y - 5); pen.lineTo(x + 5, y + 5);
    pen.moveTo(x - 5, y + 5); pen.lineTo(x + 5, y - 5);
    pen.stroke();
  }
}

/** Where tracks and own ship have been. */
export function drawTrails(pen, view, t) {
  const { history } = view.page;
  const trails = new Map();
  const wanted = new Set(view.rows.map((row) => row.key));
  for (const topic of pictureTopics(history)) {
    const frames = history.between(`tracks ${topic}`, t - TRAIL_SECONDS, t);
    const step = Math.max(1, Math.floor(frames.length / 150));
    for (let n = 0; n < frames.length; n += step) {
      const frame = frames[n];
      for (let i = 0; i < frame.id.length; i++) {
        const key = `${topic} ${frame.id[i]}`;
        if (!wanted.has(key)) continue;
        if (!trails.has(key)) trails.set(key, []);
        trails.get(key).push({ ...view.toScreen(frame.x[i], frame.y[i]), t: frame.t });
      }
    }
  }
  for (const row of view.rows) polyline(pen, view, trails.get(row.key), palette.track(row.id), 0.75);
  const states = history.between("own_ship", t - TRAIL_SECONDS, t);
  const step = Math.max(1, Math.floor(states.length / 200));
  const own = states.filter((_, n) => n % step === 0).map((state) => ({ ...view.toScreen(state.x, state.y), t: state.t }));
  polyline(pen, view, own, palette.own, 0.6);
}

function polyline(pen, view, places, colour, alpha) {
  if (!places || places.length < 2) return;
  pen.strokeStyle = colour;
  pen.globalAlpha = alpha;
  pen.lineWidth = 1.3;
  pen.beginPath();
  let before = null;
  for (const place of places) {
    if (!Number.isFinite(place.x)) continue;
    // A solution that jumps is no motion: no line is drawn to it.
    const far = before && Math.hypot(place.x - before.x, place.y - before.y) / view.scale > FASTEST * (place.t - before.t) + 50;
    if (before && !far) pen.lineTo(place.x, place.y);
    else pen.moveTo(place.x, place.y);
    before = place;
  }
  pen.stroke();
  pen.globalAlpha = 1;
  pen.lineWidth = 1;
}

/** How far a ray from a place goes until it is so near to the edge of the picture. */
function reach(place, ux, uy, width, height, inset) {
  const across = ux > 0 ? (width - inset - place.x) / ux : ux < 0 ? (inset - place.x) / ux : Infinity;
  const down = uy > 0 ? (height - inset - place.y) / uy : uy < 0 ? (inset - place.y) / uy : Infinity;
  return Math.min(across, down);
}
