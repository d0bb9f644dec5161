// LOFAR: the spectrum of one beam over time, with its lines, a zoom and a harmonic cursor.

import { Canvas, element, label } from "../canvas.js";
import { openMenu } from "../commands.js";
import { clock, degrees, duration, fixed } from "../format.js";
import { askFor, chosenBeam, heardTracks } from "../heard_track.js";
import { Identities } from "../identity.js";
import { IntegratedRows, levelsOf, overBackground } from "../integrated_rows.js";
import { keptSelect, keptToggle, moreChoices, offer } from "../kept_choice.js";
import { ownShipLines } from "../own_ship_lines.js";
import { palette } from "../palette.js";
import { lineEntries, markEntry } from "../track_menu.js";
import { RowRing, floorOf, resample } from "../row_ring.js";
import { readout } from "../readout.js";
import { drawAxes, drawHarmonics, drawLines, drawMarks, drawOwnShipLines } from "./lofar_overlays.js";
import { SpectrumCurve } from "./spectrum_curve.js";

const LINE_HEIGHT = 2; // CSS pixels
const TOP = 17; // axis of frequencies
const CURVE = 46; // spectrum above the rows
const HALF_WIDTH = 20; // Hz, of the background
const QUIET = 2; // dB over the background that are drawn as ground: most of the noise
const NARROWEST = 4; // Hz shown

export class Lofar {
  static id = "lofar";
  static title = "LOFAR";

  constructor(body, tools, page) {
    this.page = page;
    this.canvas = new Canvas(body, "LOFAR: spectrum of one beam over time");
    this.empty = element("div", { class: "empty" });
    body.append(this.empty);
    const ask = () => page.askDraw();
    this.beam = element("select", { title: "Which beam", "aria-label": "Which beam" });
    this.beam.addEventListener("change", () => {
      this.picked = this.beam.value;
      ask();
    });
    this.seconds = keptSelect("lofar seconds", "Seconds a line", { 1: "1 s", 5: "5 s", 20: "20 s" }, "1", ask);
    this.range = keptSelect("lofar range", "Range of levels", { 10: "10 dB", 15: "15 dB", 25: "25 dB", 40: "40 dB" }, "15", ask);
    this.flat = keptToggle("lofar flat", "", "Levels over their background", true, ask);
    this.lines = keptToggle("lofar lines", "", "Lines that are followed", true, ask);
    this.harmonics = keptToggle("lofar harmonics", "harmonics", "Harmonic cursor (H): multiples of the frequency under the pointer; a click holds it", false, ask);
    this.order = keptSelect("lofar order", "Which harmonic the cursor is", Object.fromEntries([1, 2, 3, 4, 5, 6, 8, 10].map((n) => [n, `no. ${n}`])), "1", ask);
    const button = (text, title, act) => element("button", { title, "aria-label": title, onclick: act }, text);
    const more = moreChoices(
      ["Seconds a line", this.seconds], ["Range of levels", this.range],
      ["Levels over their background", this.flat], ["Lines that are followed", this.lines],
      ["The cursor is harmonic", this.order],
      ["Frequencies (wheel, drag)", element("span", {}, button("+", "Closer (+)", () => this.zoomAround(0.5, 0.6)),
        button("−", "Wider (−)", () => this.zoomAround(0.5, 1 / 0.6)), button("all", "All (double click)", () => this.zoomTo(null)))],
    );
    tools.append(this.beam, this.harmonics, more);
    this.curve = new SpectrumCurve(body);
    this.ring = new RowRing();
    this.integrated = new IntegratedRows();
    this.top = TOP;
    this.band = null;
    this.hover = null;
    this.held = NaN; // frequency the harmonic cursor is held at, Hz
    this.listen(this.canvas.element);
  }

  listen(canvas) {
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerleave", () => this.move(null));
    canvas.addEventListener("pointerdown", (event) => (this.drag = { x: event.offsetX, band: this.shownBand, moved: false }));
    addEventListener("pointerup", () => (this.drag = null));
    canvas.addEventListener("click", (event) => this.click(event));
    canvas.addEventListener("contextmenu", (event) => this.menu(event));
    canvas.addEventListener("dblclick", () => this.zoomTo(null));
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("keydown", (event) => this.key(event));
  }

  key(event) {
    if (event.key.toLowerCase() === "h") this.harmonics.click();
    else if (event.key === "+") this.zoomAround(0.5, 0.6);
    else if (event.key === "-") this.zoomAround(0.5, 1 / 0.6);
    else return;
    event.preventDefault();
  }

  move(event) {
    this.hover = event && { x: event.offsetX, y: event.offsetY };
    if (event && this.drag?.band && event.buttons) {
      const [low, high] = this.drag.band;
      const shift = ((this.drag.x - event.offsetX) / this.canvas.width) * (high - low);
      if (Math.abs(event.offsetX - this.drag.x) > 4) this.drag.moved = this.moved = true;
      if (this.drag.moved) this.zoomTo([low + shift, high + shift]);
    }
    this.page.askDraw();
  }

  click(event) {
    if (this.moved) {
      this.moved = false;
      return;
    }
    if (!this.box) return; // nothing was heard yet
    const frequency = this.frequencyAt(event.offsetX);
    const t = this.ring.timeAt(event.offsetY - TOP - CURVE, this.box, false);
    if (event.shiftKey) this.page.time.markNext({ t, frequency });
    else if (this.harmonics.isOn) this.held = Number.isFinite(this.held) ? NaN : frequency;
    this.page.askDraw();
  }

  /** What can be done with a frequency. */
  menu(event) {
    event.preventDefault();
    const frequency = this.frequencyAt(event.offsetX);
    if (!Number.isFinite(frequency)) return;
    const hold = () => {
      if (!this.harmonics.isOn) this.harmonics.click();
      this.held = frequency;
      this.page.askDraw();
    };
    const t = this.ring.timeAt(event.offsetY - TOP - CURVE, this.box, false);
    const entries = [
      ["Hold the harmonic cursor here", hold], markEntry(this.page, { t, frequency }),
      ...lineEntries(this.page, frequency, this.shownSensor, this.marked),
    ];
    openMenu(event.clientX, event.clientY, `${frequency.toFixed(2)} Hz`, entries);
  }

  wheel(event) {
    event.preventDefault();
    this.zoomAround(event.offsetX / this.canvas.width, event.deltaY > 0 ? 1.25 : 0.8);
  }

  zoomAround(share, factor) {
    if (!this.shownBand) return;
    const [low, high] = this.shownBand;
    const fixedAt = low + share * (high - low);
    this.zoomTo([fixedAt - (fixedAt - low) * factor, fixedAt + (high - fixedAt) * factor]);
  }

  zoomTo(band) {
    this.band = band;
    if (band && this.whole) {
      const most = this.whole[1] - this.whole[0];
      const width = Math.min(Math.max(band[1] - band[0], NARROWEST), most);
      const low = Math.min(Math.max(band[0], this.whole[0]), this.whole[1] - width);
      this.band = width >= most * 0.999 ? null : [low, low + width];
    }
    this.page.askDraw();
  }

  frequencyAt(x) {
    const [low, high] = this.shownBand ?? [NaN, NaN];
    return low + (x / this.canvas.width) * (high - low);
  }

  xOf(frequency) {
    const [low, high] = this.shownBand;
    return ((frequency - low) / (high - low)) * this.canvas.width;
  }

  /** The beam that is shown; it is asked for where it is a new one, or the connection is. */
  chooseBeam(t) {
    const { history, selection } = this.page;
    const heard = heardTracks(history, t);
    const chosen = chosenBeam(history, selection.track, t);
    this.identities = new Identities(history, selection, t);
    const entries = [["", chosen ? `chosen: ${this.beamText(chosen)}` : "chosen track"]];
    for (const each of heard) entries.push([`${each.sensor} ${each.track}`, this.beamText(each)]);
    offer(this.beam, entries);
    const picked = heard.find((each) => `${each.sensor} ${each.track}` === this.beam.value);
    const beam = picked ?? chosen ?? (selection.track ? null : heard[0]) ?? null;
    if (!beam) return null;
    const key = beam.track ? `${beam.sensor} ${beam.track}` : `${beam.sensor} ${beam.beam.toFixed(4)}`;
    const which = beam.track ? { track: beam.track } : { beam: Number(beam.beam.toFixed(4)) };
    if (askFor(this, this.page, key, { view: "lofar", sensor: beam.sensor, ...which })) this.forgetOthers(beam);
    return { ...beam, key };
  }

  /** Spectra of other beams are large, and are sent again when they are chosen again. */
  forgetOthers(beam) {
    const { streams } = this.page.history;
    for (const name of this.page.history.names("lofar")) {
      const { frames } = streams.get(name);
      const { sensor, track } = frames[frames.length - 1];
      if (sensor !== beam.sensor || track !== beam.track) streams.delete(name);
    }
  }

  beamText({ sensor, track, beam }) {
    if (!track) return `${sensor}, beam ${degrees(beam)}°`;
    return `${sensor}, track ${this.identities.nameOf({ topic: "", id: track, sensor })}`;
  }

  streamOf(beam) {
    const { history } = this.page;
    for (const name of history.names("lofar")) {
      const stream = history.stream(name);
      const frame = stream.frames[stream.frames.length - 1];
      if (frame.sensor !== beam.sensor || frame.track !== beam.track) continue;
      if (beam.track || Math.abs(frame.beam - beam.beam) < 1e-3) return stream;
    }
    return null;
  }

  draw(t) {
    const pen = this.canvas.begin(palette.panel);
    const beam = this.chooseBeam(t);
    const stream = beam && this.streamOf(beam);
    const rows = stream ? this.rowsFor(stream, beam, t) : null;
    this.empty.hidden = Boolean(stream);
    this.empty.textContent = this.page.selection.track && !beam
      ? "The chosen track is not heard by an array with samples. A click in the bearing–time record listens there."
      : beam ? "Waiting for the spectrum of this beam." : "No samples of an array yet: its beams have spectra.";
    if (!pen || !stream) return this.curve.hide();
    const newest = stream.frames[stream.frames.length - 1];
    this.shownSensor = beam.sensor;
    const { first, step, count } = newest.frequency;
    this.whole = [Math.max(0, first - step / 2), first + (count - 0.5) * step];
    this.shownBand = this.band ?? this.whole;
    this.box = { x: 0, y: TOP + CURVE, width: this.canvas.width, height: this.canvas.height - TOP - CURVE };
    this.drawRows(pen, rows, t, newest, beam);
    drawAxes(pen, this);
    this.showCurve(rows(t - 30, t), newest);
    this.marked = ownShipLines(this.page.history, t, beam.sensor);
    drawOwnShipLines(pen, this, this.marked);
    if (this.lines.isOn && beam.track) drawLines(pen, this, beam, t);
    drawMarks(pen, this);
    const cursor = Number.isFinite(this.held) ? this.held : this.hover ? this.frequencyAt(this.hover.x) : NaN;
    if (this.harmonics.isOn && Number.isFinite(cursor)) drawHarmonics(pen, this, cursor);
    label(pen, this.beamText(beam), 4, this.canvas.height - 9, palette.text, palette.panel);
    if (this.hover) this.drawHover(pen, rows);
  }

  rowsFor(stream, beam) {
    const key = `${beam.key} ${this.page.history.version}`;
    return (t0, t1) => this.integrated.between(stream, Number(this.seconds.value), t0, t1, key);
  }

  drawRows(pen, rows, t, newest, beam) {
    const { history } = this.page;
    const ramp = palette.ramp();
    const range = Number(this.range.value);
    const { first, step } = newest.frequency;
    const width = Math.max(1, Math.round(this.box.width * this.canvas.ratio));
    const [low, high] = this.shownBand;
    const perPixel = (high - low) / step / width;
    const from = (low - first) / step + 0.5;
    this.pixels = this.pixels?.length === width ? this.pixels : new Float32Array(width);
    pen.fillStyle = palette.dark ? "#04080d" : "#f4f6f8";
    pen.fillRect(0, this.box.y, this.box.width, this.box.height);
    this.ring.show(pen, this.box, {
      now: t,
      ratio: this.canvas.ratio,
      lineSeconds: Number(this.seconds.value) / LINE_HEIGHT,
      newestOnTop: true,
      wrap: false,
      key: `${beam.key} ${this.seconds.value} ${range} ${this.flat.isOn} ${low} ${high} ${palette.dark} ${history.version}`,
      // A row that has grown since it was drawn is drawn again.
      rows: (t0, t1) => rows(t0 - Number(this.seconds.value), t1).filter((sum) => sum.t1 > t0 || sum.drawn !== sum.weight),
      paint: (sum, line) => {
        sum.drawn = sum.weight;
        const levels = resample(this.levelsFor(sum), from, perPixel, this.pixels);
        const floor = this.flat.isOn ? QUIET : (sum.floor ??= floorOf(levelsOf(sum), 0.5));
        const unit = 255 / range;
        for (let x = 0; x < line.length; x++) {
          const shade = (levels[x] - floor) * unit;
          line[x] = shade >= 0 ? ramp[Math.min(255, shade | 0)] : shade < 0 ? ramp[0] : 0;
        }
      },
    });
  }

  levelsFor(sum) {
    const row = levelsOf(sum);
    if (!this.flat.isOn) return row;
    this.over = this.over?.length === row.length ? this.over : new Float32Array(row.length);
    return overBackground(row, Math.round(HALF_WIDTH / sum.frequency.step), this.over);
  }

  /** The mean spectrum of the last half minute, above the rows. */
  showCurve(sums, newest) {
    if (!sums.length) return this.curve.hide();
    const key = `${sums[0].t0} ${sums[sums.length - 1].t} ${this.flat.isOn} ${this.seconds.value} ${this.asked}`;
    if (this.curveKey !== key) {
      this.curveKey = key;
      this.levels = Float32Array.from(this.levelsFor(this.meanOf(sums, newest)));
    }
    const { first, step } = newest.frequency;
    if (this.frequencies?.length !== this.levels.length || this.frequencies[0] !== first) {
      this.frequencies = Float64Array.from(this.levels, (_, i) => first + i * step);
    }
    const box = { y: TOP, width: this.canvas.width, height: CURVE };
    this.curve.show(box, this.shownBand, this.frequencies, this.levels, this.flat.isOn);
  }

  meanOf(sums, newest) {
    const mean = { power: new Float32Array(newest.frequency.count), weight: 0, row: null, frequency: newest.frequency };
    for (const sum of sums) {
      const levels = levelsOf(sum);
      for (let i = 0; i < mean.power.length; i++) mean.power[i] += sum.weight * 10 ** (levels[i] / 10);
      mean.weight += sum.weight;
    }
    return mean;
  }

  drawHover(pen, rows) {
    const { x, y } = this.hover;
    const frequency = this.frequencyAt(x);
    pen.strokeStyle = palette.accent;
    pen.globalAlpha = 0.8;
    pen.beginPath();
    pen.moveTo(x, TOP);
    pen.lineTo(x, this.canvas.height);
    if (y > this.box.y) {
      pen.moveTo(0, y);
      pen.lineTo(this.box.width, y);
    }
    pen.stroke();
    pen.globalAlpha = 1;
    const words = [`${fixed(frequency, 2)} Hz`];
    if (this.harmonics.isOn) {
      const at = Number.isFinite(this.held) ? this.held : frequency;
      words.unshift(`f₀ ${fixed(at / Number(this.order.value), 3)} Hz`);
    }
    if (y > this.box.y) {
      const t = this.ring.timeAt(y - this.box.y, this.box, false);
      words.push(clock(t), `−${duration(this.page.time.now - t)}`);
      const sum = rows(t, t + 1e-3)[0];
      if (sum) {
        const place = Math.round((frequency - sum.frequency.first) / sum.frequency.step);
        words.push(`${fixed(levelsOf(sum)[place], 1)} dB/Hz`, `${fixed(this.levelsFor(sum)[place], 1)} dB over`);
        words.push(`beam ${degrees(sum.angle)}°`);
      }
    }
    readout(pen, this.canvas, words.join("   "));
  }
}
