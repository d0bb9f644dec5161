// The active sonar: contacts of the last pings by bearing and range, the gates of the tracks with
// their thresholds, the tracks themselves.

import { Canvas, Labels, element, label } from "../canvas.js";
import { axisDistance, bearing, compass, distance, fixed, niceStep } from "../format.js";
import { Identities } from "../identity.js";
import { palette } from "../palette.js";
import { ownShipAt, tracksAt, TERMINATED } from "../picture.js";
import { trackSymbol } from "../symbols.js";
import { openTrackMenu } from "../track_menu.js";
import { axes } from "./plan.js";

const PINGS = 3; // the newest in full, older ones fainter
const MARGIN = { left: 52, right: 10, top: 8, bottom: 22 };
const NEAREST = 16;

export class RangeBearing {
  static id = "range_bearing";
  static title = "Active";

  constructor(body, tools, page) {
    this.page = page;
    this.canvas = new Canvas(body, "Contacts of the active sonar by bearing and range");
    this.relative = false;
    this.axis = element("button", { title: "True or relative bearing" }, "true °");
    this.axis.addEventListener("click", () => {
      this.relative = !this.relative;
      this.axis.textContent = this.relative ? "relative °" : "true °";
      page.askDraw();
    });
    this.words = element("span", { class: "figures" });
    tools.append(this.words, this.axis);
    this.readout = element("div", { class: "readout figures" });
    this.empty = element("div", { class: "empty" }, "No pings: there is no active sonar here, or it is silent.");
    body.append(this.readout, this.empty);
    const surface = this.canvas.element;
    surface.addEventListener("pointermove", (event) => { this.hover = { x: event.offsetX, y: event.offsetY }; page.askDraw(); });
    surface.addEventListener("pointerleave", () => { this.hover = null; page.askDraw(); });
    surface.addEventListener("click", (event) => this.click(event));
    surface.addEventListener("dblclick", (event) => this.click(event, true));
    surface.addEventListener("contextmenu", (event) => { event.preventDefault(); this.click(event, true); });
  }

  draw(t) {
    const pen = this.canvas.begin(palette.panel);
    if (!pen) return;
    const pings = Number.isFinite(t) ? this.pings(t) : [];
    this.empty.hidden = pings.length > 0;
    this.items = [];
    this.threshold = null;
    if (!pings.length) return void (this.words.textContent = "");
    const newest = pings[pings.length - 1];
    this.ship = ownShipAt(this.page.history, t);
    this.sensor = newest.sensor;
    this.identities = new Identities(this.page.history, this.page.selection, t);
    this.prepare(pings);
    this.drawGrid(pen);
    pen.save();
    pen.beginPath();
    pen.rect(MARGIN.left, MARGIN.top, this.width, this.height);
    pen.clip();
    this.drawGates(pen, newest, t);
    pings.forEach((ping, n) => this.drawContacts(pen, ping, n === pings.length - 1 ? 1 : 0.3));
    this.drawTracks(pen, t);
    pen.restore();
    this.drawReadout();
    const threshold = this.threshold ?? newest.detection_threshold_db;
    this.words.textContent = `${newest.range.length} contacts${Number.isFinite(threshold) ? `, threshold ${fixed(threshold, 1)} dB` : ""}`;
  }

  pings(t) {
    const { history } = this.page;
    const [name] = history.names("contacts");
    if (!name) return [];
    const newest = history.at(name, t);
    if (!newest || t - newest.t > 120) return [];
    const interval = newest.ping_interval ?? 10;
    return history.between(name, newest.t - (PINGS - 0.5) * interval, t);
  }

  prepare(pings) {
    const newest = pings[pings.length - 1];
    const far = newest.maximum_range ?? Math.max(1000, ...pings.map((ping) => Math.max(0, ...ping.range)));
    this.farthest = far * 1.02;
    this.width = this.canvas.width - MARGIN.left - MARGIN.right;
    this.height = this.canvas.height - MARGIN.top - MARGIN.bottom;
    this.bow = this.relative && this.ship ? compass(this.ship.yaw) : 0;
  }

  /** Degrees on the axis: compass 0 to 360, or relative −180 to 180. */
  across(azimuth) {
    const degrees = (compass(azimuth) - this.bow + 720) % 360;
    return this.relative && degrees > 180 ? degrees - 360 : degrees;
  }

  place(azimuth, range) {
    const share = (this.across(azimuth) - (this.relative ? -180 : 0)) / 360;
    return { x: MARGIN.left + share * this.width, y: MARGIN.top + (1 - range / this.farthest) * this.height };
  }

  placeOf(x, y) {
    const [dx, dy] = [x - this.sensor.x, y - this.sensor.y];
    return this.place(Math.atan2(dy, dx), Math.hypot(dx, dy));
  }

  azimuthAt(px) {
    const degrees = ((px - MARGIN.left) / this.width) * 360 + (this.relative ? -180 : 0) + this.bow;
    return ((90 - degrees) * Math.PI) / 180;
  }

  drawGrid(pen) {
    pen.strokeStyle = palette.line;
    pen.fillStyle = palette.faint;
    pen.font = "11px system-ui, sans-serif";
    pen.textAlign = "center";
    const step = this.width > 520 ? 30 : this.width > 300 ? 60 : 90;
    const first = this.relative ? -180 : 0;
    for (let degree = first; degree <= first + 360; degree += step) {
      const x = MARGIN.left + ((degree - first) / 360) * this.width;
      pen.beginPath();
      pen.moveTo(x, MARGIN.top);
      pen.lineTo(x, MARGIN.top + this.height);
      pen.stroke();
      const edge = degree === first + 360;
      const text = this.relative ? String(degree) : String(degree % 360).padStart(3, "0");
      pen.textAlign = edge ? "right" : degree === first ? "left" : "center";
      pen.fillText(text, x, this.canvas.height - 10);
    }
    pen.textAlign = "right";
    const stride = niceStep((this.farthest / this.height) * 45);
    for (let range = 0; range < this.farthest; range += stride) {
      const y = MARGIN.top + (1 - range / this.farthest) * this.height;
      pen.beginPath();
      pen.moveTo(MARGIN.left, y);
      pen.lineTo(MARGIN.left + this.width, y);
      pen.stroke();
      pen.fillText(axisDistance(range, this.farthest), MARGIN.left - 4, Math.max(y, 8));
    }
    pen.textAlign = "left";
    pen.font = "12px system-ui, sans-serif";
  }

  drawContacts(pen, ping, alpha) {
    pen.fillStyle = palette.text;
    const floor = ping.detection_threshold_db ?? 8;
    for (let i = 0; i < ping.range.length; i++) {
      const place = this.place(ping.azimuth[i], ping.range[i]);
      const over = ping.amplitude_db.length ? ping.amplitude_db[i] - floor : 3;
      const size = Math.min(4, Math.max(1, 1 + over / 4));
      pen.globalAlpha = alpha * Math.min(1, 0.45 + over / 14);
      pen.fillRect(place.x - size, place.y - size, 2 * size, 2 * size);
      if (alpha === 1) this.items.push({ ...place, text: `echo  ${fixed(ping.amplitude_db[i], 1)} dB  ${bearing(ping.azimuth[i])}°  ${distance(ping.range[i])}` });
    }
    pen.globalAlpha = 1;
  }

  /** Gates of 3 standard deviations about the predicted positions, with the threshold in force there. */
  drawGates(pen, ping, t) {
    const { history } = this.page;
    const [name] = history.names("threshold");
    const frame = name ? history.at(name, t) : null;
    if (!frame || Math.abs(frame.t - ping.t) > 60) return;
    this.threshold = frame.search_threshold_db;
    pen.font = "10px system-ui, sans-serif";
    for (let i = 0; i < frame.track_id.length; i++) {
      const [xx, xy, yy] = frame.gate_covariance.slice(3 * i, 3 * i + 3);
      if (!(xx > 0)) continue;
      const [major, minor, angle] = axes(xx, xy, yy);
      pen.strokeStyle = palette.ray;
      pen.setLineDash([3, 3]);
      pen.beginPath();
      let before = null;
      for (let n = 0; n <= 24; n++) {
        const turn = (n / 24) * 2 * Math.PI;
        const [a, b] = [3 * major * Math.cos(turn), 3 * minor * Math.sin(turn)];
        const place = this.placeOf(frame.x[i] + a * Math.cos(angle) - b * Math.sin(angle), frame.y[i] + a * Math.sin(angle) + b * Math.cos(angle));
        if (before && Math.abs(place.x - before.x) < this.width / 2) pen.lineTo(place.x, place.y);
        else pen.moveTo(place.x, place.y);
        before = place;
      }
      pen.stroke();
      pen.setLineDash([]);
      const middle = this.placeOf(frame.x[i], frame.y[i]);
      this.items.push({ ...middle, text: `gate of track ${this.gateName(frame, i)}  threshold ${fixed(frame.threshold_db[i], 1)} dB` });
      // The threshold of the search stands above the picture: only one that differs is written.
      if (Math.abs(frame.threshold_db[i] - frame.search_threshold_db) > 0.05) {
        label(pen, `${fixed(frame.threshold_db[i], 1)} dB`, middle.x + 9, middle.y + 12, palette.faint, palette.panel);
      }
    }
    pen.font = "12px system-ui, sans-serif";
  }

  /** Gates are of the tracks of echoes. */
  gateName(frame, i) {
    return this.identities.nameOf({ topic: this.echoTopics()[0] ?? "", id: frame.track_id[i] });
  }

  echoTopics() {
    return this.page.history.topics("tracks").filter((topic) => /(^|\/)active\/tracks$/.test(topic));
  }

  drawTracks(pen, t) {
    const topics = this.echoTopics();
    const shown = [];
    const who = this.identities;
    for (const row of tracksAt(this.page.history, t, topics)) {
      if (row.status === TERMINATED) continue;
      const place = this.placeOf(row.x, row.y);
      const chosen = who.isChosen(row);
      trackSymbol(pen, place.x, place.y, row, who.colourOf(row), palette.panel, chosen ? palette.text : null);
      shown.push([row, place]);
      this.items.push({ ...place, row, text: `track ${who.nameOf(row)}  (of echoes: ${row.id})` });
    }
    const labels = new Labels();
    for (const [, place] of shown) labels.keepFree(place);
    for (const [row, place] of shown) labels.put(pen, who.nameOf(row), place.x, place.y, palette.text, palette.panel);
  }

  nearest(x, y, tracksOnly) {
    let best = null;
    let least = NEAREST;
    for (const item of this.items ?? []) {
      if (tracksOnly && !item.row) continue;
      const away = Math.hypot(item.x - x, item.y - y) + (item.row ? 0 : 4);
      if (away < least) [best, least] = [item, away];
    }
    return best;
  }

  click(event, menu = false) {
    if (!this.sensor) return;
    const azimuth = this.azimuthAt(event.offsetX);
    const range = (1 - (event.offsetY - MARGIN.top) / this.height) * this.farthest;
    const x = this.sensor.x + range * Math.cos(azimuth);
    const y = this.sensor.y + range * Math.sin(azimuth);
    const mark = { t: this.page.time.now, azimuth, x, y };
    if (event.shiftKey) return this.page.time.markNext(mark);
    const item = this.nearest(event.offsetX, event.offsetY, true);
    if (menu) openTrackMenu(this.page, event, item?.row, azimuth, { point: mark, mark });
    else this.page.selection.choose(item ? this.identities.choiceOf(item.row) : null);
  }

  drawReadout() {
    let text = "";
    if (this.hover && this.hover.x > MARGIN.left) {
      const azimuth = this.azimuthAt(this.hover.x);
      const range = (1 - (this.hover.y - MARGIN.top) / this.height) * this.farthest;
      const item = this.nearest(this.hover.x, this.hover.y, false);
      text = item ? item.text : range > 0 ? `${bearing(azimuth)}°  ${distance(range)}` : "";
    }
    if (this.readout.textContent !== text) this.readout.textContent = text;
  }
}
