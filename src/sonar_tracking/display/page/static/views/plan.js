// The plan: own ship, tracks with their ellipses, trails, bearings, contacts and the truth.

import { Canvas, Labels, element, icon, label } from "../canvas.js";
import { openTrackMenu } from "../track_menu.js";
import { bearing, distance, fixed, place as placeText } from "../format.js";
import { keptToggle } from "../kept_choice.js";
import { palette } from "../palette.js";
import { SIDE, SOURCE, STATUS, otherShipsAt, ownShipAt, polar, tracksAt } from "../picture.js";
import { trackSymbol, ownShipSymbol } from "../symbols.js";
import { drawContacts, drawRays, drawRings, drawTrails, drawTruth } from "./plan_layers.js";

const KNOT = 1.943844; // in m/s
const CHI_95 = Math.sqrt(5.991); // of an ellipse that holds 95 % of the plane's normal distribution
const LEADER_SECONDS = 180;
const NEAREST = 20; // pixels from a click to what it means
const LAYERS = [
  ["rays", "bearings", true], ["contacts", "contacts", true], ["ellipses", "95 %", true],
  ["trails", "trails", true], ["truth", "truth", false],
];

export class Plan {
  static id = "plan";
  static title = "Plan";

  constructor(body, tools, page) {
    this.page = page;
    this.canvas = new Canvas(body, "Plan of own ship and tracks");
    this.span = 14000; // m across the smaller side
    this.centre = null; // null = own ship
    this.courseUp = false;
    this.layers = Object.fromEntries(LAYERS.map(([name, , on]) => [name, on]));
    this.makeTools(tools);
    this.readout = element("div", { class: "readout figures" });
    body.append(this.readout);
    this.listen(this.canvas.element);
  }

  makeTools(tools) {
    for (const [name, words] of LAYERS) {
      const button = element("button", { "aria-pressed": this.layers[name], class: this.layers[name] ? "on" : "" }, words);
      button.addEventListener("click", () => {
        this.layers[name] = !this.layers[name];
        button.classList.toggle("on", this.layers[name]);
        button.setAttribute("aria-pressed", this.layers[name]);
        this.page.askDraw();
      });
      tools.append(button);
    }
    this.up = element("button", { title: "North up or course up" }, "N up");
    this.up.addEventListener("click", () => {
      this.courseUp = !this.courseUp;
      this.up.textContent = this.courseUp ? "C up" : "N up";
      this.page.askDraw();
    });
    this.home = element("button", { title: "Own ship in the centre", "aria-label": "Own ship in the centre" }, icon("home"));
    this.home.addEventListener("click", () => this.recentre(null));
    const zoom = (factor, text, title) =>
      element("button", { class: "zoom", title, "aria-label": title, onclick: () => this.zoom(factor) }, text);
    this.measuring = keptToggle("plan measure", "↔", "Measure by dragging (also: Alt and drag)", false, () => {});
    tools.append(this.measuring, this.up, this.home, zoom(0.7, icon("nearer"), "Nearer (+)"), zoom(1 / 0.7, icon("farther"), "Farther (−)"));
  }

  recentre(place) {
    this.centre = place;
    this.page.askDraw();
  }

  zoom(factor, x, y) {
    const before = x === undefined ? null : this.toMap(x, y);
    this.span = Math.min(Math.max(this.span * factor, 100), 2e6);
    if (before && this.centre) {
      this.prepare();
      const after = this.toMap(x, y);
      this.centre = { x: this.centre.x + before.x - after.x, y: this.centre.y + before.y - after.y };
    }
    this.page.askDraw();
  }

  listen(surface) {
    surface.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.zoom(Math.exp(event.deltaY * 0.0015), event.offsetX, event.offsetY);
    }, { passive: false });
    this.fingers = new Map();
    surface.addEventListener("pointerdown", (event) => {
      surface.setPointerCapture(event.pointerId);
      this.fingers.set(event.pointerId, { x: event.offsetX, y: event.offsetY });
      this.pressed = { x: event.offsetX, y: event.offsetY, moved: false, measure: event.altKey || this.measuring.isOn };
    });
    surface.addEventListener("pointermove", (event) => this.move(event));
    surface.addEventListener("pointerup", (event) => this.fingers.delete(event.pointerId));
    surface.addEventListener("click", (event) => this.click(event));
    surface.addEventListener("dblclick", (event) => this.menu(event));
    surface.addEventListener("pointercancel", (event) => this.fingers.delete(event.pointerId));
    surface.addEventListener("pointerleave", () => { this.hover = null; this.page.askDraw(); });
    surface.addEventListener("contextmenu", (event) => this.menu(event));
    surface.addEventListener("keydown", (event) => {
      const factor = { "+": 0.7, "-": 1 / 0.7 }[event.key];
      if (factor) this.zoom(factor);
    });
  }

  move(event) {
    const place = { x: event.offsetX, y: event.offsetY };
    this.hover = place;
    const before = this.fingers.get(event.pointerId);
    if (before && this.fingers.size === 2) {
      const [other] = [...this.fingers].filter(([id]) => id !== event.pointerId).map(([, p]) => p);
      const apart = (p) => Math.hypot(p.x - other.x, p.y - other.y);
      this.zoom(apart(before) / Math.max(apart(place), 1));
      this.pressed.moved = true;
    } else if (before) {
      const far = Math.hypot(place.x - this.pressed.x, place.y - this.pressed.y) > 4;
      this.pressed.moved ||= far;
      if (this.pressed.moved && this.pressed.measure) {
        this.measure = { from: this.toMap(this.pressed.x, this.pressed.y), to: this.toMap(place.x, place.y) };
      } else if (this.pressed.moved) {
        const [a, b] = [this.toMap(before.x, before.y), this.toMap(place.x, place.y)];
        const from = this.centre ?? { x: this.origin.x, y: this.origin.y };
        this.centre = { x: from.x + a.x - b.x, y: from.y + a.y - b.y };
      }
    }
    if (before) this.fingers.set(event.pointerId, place);
    this.page.askDraw();
  }

  /** What is at a place of the canvas: a track, or nothing but a direction. */
  placeOf({ offsetX, offsetY }) {
    const place = this.toMap(offsetX, offsetY);
    const { ship } = this;
    const azimuth = ship ? Math.atan2(place.y - ship.y, place.x - ship.x) : NaN;
    return { row: this.nearest(offsetX, offsetY), azimuth, ...place, t: this.page.time.now };
  }

  click(event) {
    const dragged = this.pressed?.moved;
    this.pressed = null;
    if (dragged) return;
    this.measure = null;
    const { row, ...mark } = this.placeOf(event);
    if (event.shiftKey) this.page.time.markNext(mark);
    else this.page.selection.choose(row && { topic: row.topic, id: row.id });
  }

  menu(event) {
    event.preventDefault();
    const { row, ...mark } = this.placeOf(event);
    if (row) this.page.selection.choose({ topic: row.topic, id: row.id });
    openTrackMenu(this.page, event, row, mark.azimuth, { point: mark, mark });
  }

  /** The menu of a direction at a place of the screen. */
  menuAt(clientX, clientY, azimuth) {
    openTrackMenu(this.page, { clientX, clientY }, null, azimuth);
  }

  nearest(x, y) {
    let best = null;
    let least = NEAREST;
    for (const row of this.rows ?? []) {
      const place = this.toScreen(row.x, row.y);
      const away = Math.hypot(place.x - x, place.y - y);
      if (away < least) [best, least] = [row, away];
    }
    return best;
  }

  /** What the pixels mean: set before anything is drawn or picked. */
  prepare() {
    const { width, height } = this.canvas;
    const ship = this.ship;
    this.origin = this.centre ?? { x: ship?.x ?? this.anchor?.x ?? 0, y: ship?.y ?? this.anchor?.y ?? 0 };
    this.scale = Math.min(width, height) / this.span;
    const up = this.courseUp && ship ? ship.yaw - Math.PI / 2 : 0;
    this.cos = Math.cos(up);
    this.sin = Math.sin(up);
    this.up_angle = up;
  }

  toScreen(x, y) {
    const [dx, dy] = [x - this.origin.x, y - this.origin.y];
    const [rx, ry] = [this.cos * dx + this.sin * dy, -this.sin * dx + this.cos * dy];
    return { x: this.canvas.width / 2 + rx * this.scale, y: this.canvas.height / 2 - ry * this.scale };
  }

  toMap(px, py) {
    const rx = (px - this.canvas.width / 2) / this.scale;
    const ry = -(py - this.canvas.height / 2) / this.scale;
    return { x: this.origin.x + this.cos * rx - this.sin * ry, y: this.origin.y + this.sin * rx + this.cos * ry };
  }

  draw(t) {
    const { history } = this.page;
    const pen = this.canvas.begin(palette.panel);
    if (!pen) return;
    this.ship = Number.isFinite(t) ? ownShipAt(history, t) : null;
    this.rows = Number.isFinite(t) ? tracksAt(history, t) : [];
    if (!this.ship && this.rows.length) this.anchor ??= { x: this.rows[0].x, y: this.rows[0].y };
    this.prepare();
    drawRings(pen, this);
    if (!Number.isFinite(t)) return;
    if (this.layers.rays) drawRays(pen, this, t);
    if (this.layers.contacts) drawContacts(pen, this, t);
    if (this.layers.truth) drawTruth(pen, this, t);
    if (this.layers.trails) drawTrails(pen, this, t);
    for (const row of this.rows) if (this.layers.ellipses) this.drawEllipse(pen, row);
    this.labels = new Labels();
    for (const row of this.rows) this.labels.keepFree(this.toScreen(row.x, row.y));
    for (const row of this.rows) this.drawTrack(pen, row);
    for (const other of otherShipsAt(history, t)) {
      const place = this.toScreen(other.x, other.y);
      ownShipSymbol(pen, place, other, this.up_angle, this.scale * LEADER_SECONDS, palette.faint);
      pen.fillStyle = palette.faint;
      pen.fillText(other.name, place.x + 11, place.y - 8);
    }
    if (this.ship) ownShipSymbol(pen, this.toScreen(this.ship.x, this.ship.y), this.ship, this.up_angle, this.scale * LEADER_SECONDS, palette.own);
    this.drawMarks(pen);
    this.drawMeasure(pen);
    this.drawReadout();
  }

  drawEllipse(pen, row) {
    if (!(row.pxx > 0) || !Number.isFinite(row.x) || !Number.isFinite(row.pxy)) return;
    const [major, minor, angle] = axes(row.pxx, row.pxy, row.pyy);
    const place = this.toScreen(row.x, row.y);
    pen.strokeStyle = palette.track(row.id);
    pen.setLineDash(row.status === 0 ? [4, 4] : []);
    pen.beginPath();
    pen.ellipse(place.x, place.y, CHI_95 * major * this.scale, CHI_95 * minor * this.scale, -(angle - this.up_angle), 0, 2 * Math.PI);
    pen.stroke();
    pen.globalAlpha = 0.07;
    pen.fillStyle = palette.track(row.id);
    pen.fill();
    pen.globalAlpha = 1;
    pen.setLineDash([]);
  }

  drawTrack(pen, row) {
    if (!Number.isFinite(row.x)) return;
    const place = this.toScreen(row.x, row.y);
    const { width, height } = this.canvas;
    if (place.x < -50 || place.y < -50 || place.x > width + 50 || place.y > height + 50) return;
    const colour = palette.track(row.id);
    const tip = this.toScreen(row.x + LEADER_SECONDS * row.vx, row.y + LEADER_SECONDS * row.vy);
    pen.strokeStyle = colour;
    if (Number.isFinite(tip.x) && Math.hypot(row.vx, row.vy) > 0.3) {
      pen.beginPath();
      pen.moveTo(place.x, place.y);
      pen.lineTo(tip.x, tip.y);
      pen.stroke();
    }
    const chosen = this.page.selection.isChosen(row.topic, row.id);
    trackSymbol(pen, place.x, place.y, row, colour, palette.panel, chosen ? palette.text : null);
    const side = SIDE[row.side] ? ` ${SIDE[row.side][0].toUpperCase()}` : "";
    pen.font = `${chosen ? "bold " : ""}12px system-ui, sans-serif`;
    this.labels.put(pen, this.page.selection.nameOf(row.topic, row.id) + side, place.x, place.y, palette.text, palette.panel);
    pen.font = "12px system-ui, sans-serif";
  }

  drawMarks(pen) {
    for (const [name, mark] of Object.entries(this.page.time.marks)) {
      if (!mark || !Number.isFinite(mark.x)) continue;
      const { x, y } = this.toScreen(mark.x, mark.y);
      pen.strokeStyle = palette[name.toLowerCase()];
      pen.beginPath();
      pen.moveTo(x - 8, y); pen.lineTo(x + 8, y);
      pen.moveTo(x, y - 8); pen.lineTo(x, y + 8);
      pen.stroke();
      label(pen, name, x + 6, y - 8, palette[name.toLowerCase()], palette.panel);
    }
  }

  drawMeasure(pen) {
    if (!this.measure) return;
    const { from, to } = this.measure;
    const [a, b] = [this.toScreen(from.x, from.y), this.toScreen(to.x, to.y)];
    pen.strokeStyle = palette.accent;
    pen.beginPath();
    pen.moveTo(a.x, a.y);
    pen.lineTo(b.x, b.y);
    pen.stroke();
    const text = `${bearing(Math.atan2(to.y - from.y, to.x - from.x))}°  ${distance(Math.hypot(to.x - from.x, to.y - from.y))}`;
    label(pen, text, Math.min(b.x + 8, this.canvas.width - 110), b.y, palette.text, palette.panel);
  }

  drawReadout() {
    let text = "";
    if (this.hover) {
      const row = this.nearest(this.hover.x, this.hover.y);
      const place = row ?? this.toMap(this.hover.x, this.hover.y);
      const from = this.ship ?? this.origin;
      const azimuth = Math.atan2(place.y - from.y, place.x - from.x);
      text = `${bearing(azimuth)}°  ${distance(Math.hypot(place.x - from.x, place.y - from.y))}`;
      if (this.page.datum) text += `  ${placeText(place.x, place.y, this.page.datum)}`;
      if (row) {
        const seen = polar(row, this.ship);
        const name = this.page.selection.nameOf(row.topic, row.id);
        text = `${name}  ${SOURCE[row.source]}, ${STATUS[row.status]}  ${text}  course ${bearing(seen.course, 0)}°  ${fixed(seen.speed * KNOT, 1)} kn`;
      }
    }
    if (this.readout.textContent !== text) this.readout.textContent = text;
  }
}

/** Standard deviations along the axes of a covariance, and the direction of the larger one. */
export function axes(xx, xy, yy) {
  const mean = (xx + yy) / 2;
  const half = Math.hypot((xx - yy) / 2, xy);
  return [Math.sqrt(mean + half), Math.sqrt(Math.max(mean - half, 0)), 0.5 * Math.atan2(2 * xy, xx - yy)];
}
