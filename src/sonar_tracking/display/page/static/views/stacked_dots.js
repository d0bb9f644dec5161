// Stacked dots: what the solution of the chosen track leaves of everything that was measured of it.
//
// Time runs downwards, the newest on top; each column is one sensor's bearings or one line. A right
// solution stacks its dots on the middle, within the band of two deviations. Own ship's turns are
// shaded: behind them a wrong range bends the column.

import { Canvas, element, label } from "../canvas.js";
import { clock, duration, fixed, niceStep, signed } from "../format.js";
import { askFor, chosenTrack } from "../heard_track.js";
import { keptSelect, keptToggle } from "../kept_choice.js";
import { palette } from "../palette.js";
import { readout } from "../readout.js";

const TOP = 34; // names and axes of the columns
const LEFT = 88; // axis of time and courses
const BETWEEN = 10;
const NARROWEST = 90; // of a column, CSS pixels
const DEGREE = Math.PI / 180;
const PERIOD = 5; // s of data between two solutions that the server keeps
const PAUSE = 150; // ms between two that are asked for
const PATIENCE = 5000; // ms until what was asked for is held not to come
const KEPT = 60; // s about the time that is looked at: dots are many
const SPANS = { 0: "all", 300: "5 min", 600: "10 min", 1800: "30 min" };

export class StackedDots {
  static id = "stacked_dots";
  static title = "Stacked dots";

  constructor(body, tools, page) {
    this.page = page;
    this.canvas = new Canvas(body, "Stacked dots: residuals of the chosen track over time");
    this.empty = element("div", { class: "empty" });
    body.append(this.empty);
    const ask = () => page.askDraw();
    this.span = keptSelect("dots span", "Time shown", SPANS, "0", ask);
    this.scaled = keptToggle("dots scaled", "in σ", "Residuals in deviations", false, ask);
    tools.append(this.span, this.scaled);
    this.hover = null;
    this.past = {}; // what was asked for, and of whom
    this.lastAsked = -Infinity;
    const canvas = this.canvas.element;
    canvas.addEventListener("pointermove", (event) => this.point({ x: event.offsetX, y: event.offsetY }));
    canvas.addEventListener("pointerleave", () => this.point(null));
    canvas.addEventListener("click", (event) => {
      if (event.shiftKey && this.scale) page.time.markNext({ t: this.scale.timeAt(event.offsetY) });
    });
  }

  point(place) {
    this.hover = place;
    this.page.askDraw();
  }

  /** The dots of the solution at the time that is looked at; they are asked for where they are not known. */
  frameAt(t) {
    const { history, selection, time } = this.page;
    const track = chosenTrack(history, selection.track, t);
    if (!track) return null;
    const key = `${track.topic} ${track.id}`;
    if (askFor(this, this.page, key, { view: "dots", topic: track.topic, track: track.id })) this.lastAsked = performance.now();
    const stream = history.stream(`dots ${key}`);
    const frame = stream?.at(t) ?? null;
    if (!time.live && !(frame && t - frame.t < 2 * PERIOD)) this.askForPast(track, key, t);
    stream?.keepAbout(t, KEPT);
    return frame ?? stream?.frames[0] ?? null; // until it comes, nothing flickers
  }

  /** Why there is nothing: it may still come. */
  absent() {
    const waits = performance.now() - this.lastAsked < PATIENCE;
    return waits ? "Waiting for the solution of the chosen track." : "No solution of the chosen track is known here.";
  }

  askForPast({ topic, id }, key, t) {
    if (performance.now() - this.lastAsked < PAUSE) return;
    const asks = askFor(this.past, this.page, `${key} ${Math.floor(t / PERIOD)}`, { view: "dots", topic, track: id, t });
    if (asks) this.lastAsked = performance.now();
  }

  draw(t) {
    const pen = this.canvas.begin(palette.panel);
    const frame = this.frameAt(t);
    const stacks = frame?.stacks ?? [];
    this.empty.hidden = stacks.length > 0;
    this.empty.textContent = this.page.selection.track
      ? !frame ? this.absent() : "The chosen track is made of no bearings or lines that are known here."
      : "Choose a track: what its solution leaves of the measurements is shown here.";
    this.scale = null;
    if (!pen || !stacks.length) return;
    const most = Math.max(1, Math.floor((this.canvas.width - LEFT) / NARROWEST));
    this.columns = stacks.slice(0, most).map((stack) => ({ stack }));
    this.scale = this.timeScale(t);
    for (const column of this.columns) Object.assign(column, this.measures(column.stack));
    const width = (this.canvas.width - LEFT - BETWEEN * (this.columns.length - 1)) / this.columns.length;
    this.columns.forEach((column, place) => Object.assign(column, { x: LEFT + place * (width + BETWEEN), width }));
    this.drawLegs(pen, t);
    for (const column of this.columns) this.drawColumn(pen, column);
    this.drawTimes(pen, frame, stacks.length - this.columns.length);
    this.drawMarks(pen);
    if (this.hover) this.drawHover(pen);
  }

  /** Residuals and their deviations as they are drawn, and how far the axis goes. */
  measures(stack) {
    const isLine = Number.isFinite(stack.frequency);
    const unit = this.scaled.isOn ? null : isLine ? 1 : DEGREE;
    const values = Array.from(stack.residual, (value, i) => value / (unit ?? stack.deviation[i]));
    const bands = Array.from(stack.deviation, (value) => (unit ? value / unit : 1));
    const shown = values.filter((_, i) => stack.times[i] >= this.scale.begin);
    const sizes = shown.map(Math.abs).filter(Number.isFinite).sort((a, b) => a - b);
    const usual = bands.filter(Number.isFinite).sort((a, b) => a - b)[bands.length >> 1] ?? 0;
    const reach = Math.max(1.15 * (sizes[Math.floor(0.97 * (sizes.length - 1))] ?? 0), 4 * usual, 1e-6);
    const name = this.scaled.isOn ? "σ" : isLine ? "Hz" : "°";
    return { values, bands, usual, reach, name, isLine };
  }

  timeScale(t) {
    const end = t;
    const oldest = Math.min(...this.columns.map(({ stack }) => stack.times[0]));
    const span = Number(this.span.value);
    const begin = span ? end - span : oldest;
    const height = this.canvas.height - TOP - 4;
    const length = Math.max(end - begin, 10);
    return {
      begin, end, height, length,
      yOf: (time) => TOP + ((end - time) / length) * height,
      timeAt: (y) => end - ((y - TOP) / height) * length,
    };
  }

  drawLegs(pen, t) {
    const { history } = this.page;
    const legs = history.at("legs", t) ?? history.stream("legs")?.frames.at(-1);
    if (!legs) return;
    pen.save();
    pen.beginPath();
    pen.rect(0, TOP, this.canvas.width, this.scale.height);
    pen.clip();
    pen.font = "11px system-ui, sans-serif";
    for (const leg of legs.legs) {
      const top = this.scale.yOf(Math.min(leg.t1, this.scale.end));
      const bottom = this.scale.yOf(leg.t0);
      if (bottom < TOP || top > this.canvas.height) continue;
      if (leg.turning) {
        pen.fillStyle = palette.legs;
        pen.fillRect(0, top, this.canvas.width, bottom - top);
      }
      if (bottom - top < 26) continue;
      const middle = (Math.max(top, TOP) + Math.min(bottom, this.canvas.height)) / 2;
      pen.fillStyle = palette.faint;
      pen.fillText(leg.turning ? `→ ${courseText(leg)}` : courseText(leg), 3, middle);
    }
    pen.restore();
  }

  drawColumn(pen, column) {
    const { x, width, stack, values, bands, usual, reach, isLine } = column;
    const middle = x + width / 2;
    const xOf = (value) => middle + (Math.min(Math.max(value / reach, -1), 1) * width) / 2;
    column.xOf = xOf;
    pen.save();
    pen.strokeStyle = palette.line;
    pen.strokeRect(x + 0.5, TOP + 0.5, width - 1, this.scale.height - 1);
    pen.fillStyle = palette.accent;
    pen.globalAlpha = 0.1;
    pen.fillRect(xOf(-2 * usual), TOP, xOf(2 * usual) - xOf(-2 * usual), this.scale.height);
    pen.globalAlpha = 1;
    pen.strokeStyle = palette.faint;
    pen.beginPath();
    pen.moveTo(middle, TOP);
    pen.lineTo(middle, TOP + this.scale.height);
    pen.stroke();
    this.drawColumnAxis(pen, column);
    pen.beginPath();
    pen.rect(x, TOP, width, this.scale.height);
    pen.clip();
    let far = 0;
    for (let i = 0; i < values.length; i++) {
      const y = this.scale.yOf(stack.times[i]);
      if (!(y >= TOP - 2 && y <= this.canvas.height + 2) || !Number.isFinite(values[i])) continue;
      const off = Math.abs(values[i]) > 3 * bands[i];
      far += off;
      pen.strokeStyle = pen.fillStyle = off ? palette.bad : isLine ? palette.good : palette.accent;
      pen.globalAlpha = 0.35;
      pen.fillRect(xOf(values[i] - bands[i]), y - 0.5, xOf(values[i] + bands[i]) - xOf(values[i] - bands[i]), 1);
      pen.globalAlpha = 1;
      pen.beginPath();
      if (off) {
        // Shape tells it as well as colour.
        pen.moveTo(xOf(values[i]) - 2.6, y - 2.6);
        pen.lineTo(xOf(values[i]) + 2.6, y + 2.6);
        pen.moveTo(xOf(values[i]) - 2.6, y + 2.6);
        pen.lineTo(xOf(values[i]) + 2.6, y - 2.6);
        pen.stroke();
      } else {
        pen.arc(xOf(values[i]), y, 1.9, 0, 2 * Math.PI);
        pen.fill();
      }
    }
    pen.restore();
    column.far = far;
  }

  drawColumnAxis(pen, { x, width, reach, name, stack, xOf }) {
    pen.font = "11px system-ui, sans-serif";
    pen.textAlign = "center";
    pen.fillStyle = palette.text;
    pen.fillText(stack.label, x + width / 2, 9, width);
    pen.fillStyle = palette.faint;
    if (width < 200) {
      pen.fillText(`±${Number(reach.toPrecision(2))} ${name}`, x + width / 2, 25, width);
      return;
    }
    const step = niceStep((2 * reach) / Math.max(2, width / 52));
    for (let k = Math.ceil(-reach / step); k * step <= reach; k++) {
      const place = xOf(k * step);
      if (place < x + 14 || place > x + width - 14) continue;
      const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
      pen.fillText(k === 0 ? `0 ${name}` : signed(k * step, digits), place, 25);
      pen.fillRect(place - 0.5, TOP - 3, 1, 3);
    }
  }

  drawTimes(pen, frame, hidden) {
    const { begin, end, length, height, yOf } = this.scale;
    const every = [10, 30, 60, 120, 300, 600, 1200, 3600].find((s) => (s / length) * height >= 40) ?? 7200;
    pen.save();
    pen.font = "11px system-ui, sans-serif";
    for (let time = Math.ceil(begin / every) * every; time <= end; time += every) {
      const y = yOf(time);
      if (y < TOP + 6 || y > this.canvas.height - 8) continue;
      pen.fillStyle = palette.line;
      pen.fillRect(LEFT - 4, y, 4, 1);
      pen.textAlign = "right";
      label(pen, every % 60 ? clock(time).slice(3) : clock(time).slice(0, 5), LEFT - 6, y, palette.text, palette.panel);
    }
    pen.textAlign = "left";
    pen.fillStyle = palette.text;
    const { selection } = this.page;
    pen.fillText(`track ${selection.nameOf(frame.topic, frame.track)}`, 3, 9, LEFT - 6);
    pen.fillStyle = palette.faint;
    if (hidden > 0) pen.fillText(`+${hidden} more`, 3, 25, LEFT - 6);
    pen.restore();
  }

  drawMarks(pen) {
    for (const [name, mark] of Object.entries(this.page.time.marks)) {
      const y = mark ? this.scale.yOf(mark.t) : NaN;
      if (!(y >= TOP && y <= this.canvas.height)) continue;
      pen.strokeStyle = palette[name.toLowerCase()];
      pen.beginPath();
      pen.moveTo(LEFT, y);
      pen.lineTo(this.canvas.width, y);
      pen.stroke();
      label(pen, name, LEFT + 3, y - 8, pen.strokeStyle, palette.panel);
    }
  }

  drawHover(pen) {
    const { x, y } = this.hover;
    const column = this.columns.find((each) => x >= each.x && x <= each.x + each.width);
    if (!column || y < TOP) return;
    let [best, nearest] = [-1, 20 ** 2];
    for (let i = 0; i < column.values.length; i++) {
      const apart = (column.xOf(column.values[i]) - x) ** 2 + (this.scale.yOf(column.stack.times[i]) - y) ** 2;
      if (apart < nearest) [nearest, best] = [apart, i];
    }
    const rms = Math.sqrt(mean(column.stack.residual.map((r, i) => (r / column.stack.deviation[i]) ** 2)));
    const words = [column.stack.label, `rms ${fixed(rms, 1)} σ`];
    if (best >= 0) {
      const time = column.stack.times[best];
      const unit = column.isLine ? 1 : DEGREE;
      words.push(`${clock(time)}  −${duration(this.scale.end - time)}`);
      words.push(`${signed(column.stack.residual[best] / unit, 3)} ± ${fixed(column.stack.deviation[best] / unit, 3)} ${column.isLine ? "Hz" : "°"}`);
      pen.strokeStyle = palette.text;
      pen.beginPath();
      pen.arc(column.xOf(column.values[best]), this.scale.yOf(time), 5, 0, 2 * Math.PI);
      pen.stroke();
    }
    readout(pen, this.canvas, words.join("   "));
  }
}

function courseText(leg) {
  return `${String(Math.round(leg.course_deg) % 360).padStart(3, "0")}°`;
}

function mean(values) {
  const known = Array.from(values).filter(Number.isFinite);
  return known.reduce((sum, value) => sum + value, 0) / Math.max(known.length, 1);
}
