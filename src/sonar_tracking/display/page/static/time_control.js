// The time that is looked at: the live edge, or a time in the past; and the cursors A and B.

import { element, icon } from "./canvas.js";
import { clock, duration } from "./format.js";

const STEP = 2; // s of data
const RATES = [1, 2, 5, 10, 20, 60];

export class TimeControl extends EventTarget {
  constructor(history) {
    super();
    this.history = history;
    this.live = true;
    this.recording = null; // state of a recording; null = what is shown is live
    this.span = null; // data times of the first and last message of a recording
    this.asked = NaN; // time whose part of the recording was asked for
    this.paused = NaN; // the time looked at while it is not live
    this.playing = 0; // s of data a second of the wall
    this.marks = { A: null, B: null }; // {t, azimuth, frequency}, whatever the view knows
  }

  /** The data time that is looked at, s. */
  get now() {
    return this.live ? this.history.newest : this.paused;
  }

  get isPast() {
    return !this.live;
  }

  /** Whether the page does not hold all of a recording. */
  get isPart() {
    return Boolean(this.recording) && this.recording !== "whole";
  }

  get isReading() {
    return this.recording?.startsWith("reading") ?? false;
  }

  /** What can be looked at: the whole recording, or what is known. */
  get oldest() {
    return this.isPart ? this.span[0] : this.history.oldest;
  }

  get newest() {
    return this.isPart && this.recording !== "last part" ? this.span[1] : this.history.newest;
  }

  /** A part of the recording has come; nothing may have been recorded at the time asked for. */
  takePart() {
    this.asked = NaN;
    if (!this.live) this.paused = Math.min(Math.max(this.paused, this.history.oldest), this.history.newest);
  }

  /** Ask for the part of the recording around a time, if the page does not hold it. */
  fetchPart(t) {
    const held = t >= this.history.oldest && t <= this.history.newest;
    if (!this.isPart || held || t === this.asked) return;
    this.asked = t;
    this.dispatchEvent(new CustomEvent("part", { detail: t }));
  }

  changed() {
    this.dispatchEvent(new Event("change"));
  }

  pause() {
    if (this.live) this.paused = this.history.newest;
    this.live = false;
    this.playing = 0;
    this.changed();
  }

  resume() {
    this.playing = 0;
    if (this.isPart) return this.seek(this.newest);
    this.live = true;
    this.changed();
  }

  toggle() {
    if (this.live) this.pause();
    else if (this.playing) this.pause();
    else this.play(this.lastRate ?? 1);
  }

  seek(t) {
    const { oldest, newest } = this;
    if (!(newest >= oldest)) return;
    this.paused = Math.min(Math.max(t, oldest), newest);
    this.live = false;
    this.fetchPart(this.paused);
    this.changed();
  }

  step(seconds = STEP) {
    const from = this.now;
    if (this.live) this.pause();
    this.playing = 0;
    this.seek(from + seconds);
  }

  play(rate) {
    if (this.live) this.paused = this.history.newest;
    if (this.paused >= this.newest - 0.5) this.seek(this.oldest);
    this.live = false;
    this.playing = rate;
    this.lastRate = rate;
    this.changed();
  }

  /** Let playing time pass; returns whether it did. */
  pass(seconds) {
    if (!this.playing) return false;
    const comes = this.isPart && !(this.paused <= this.history.newest); // a part that is read
    if (!comes) this.paused += this.playing * seconds;
    if (this.isPart && this.paused < this.newest) {
      if (!this.isReading) this.fetchPart(this.paused);
    } else if (this.paused >= this.newest) {
      this.paused = this.newest;
      this.playing = 0;
      if (!this.recording) this.live = true;
    }
    this.changed();
    return true;
  }

  mark(name, values) {
    this.marks[name] = values;
    this.changed();
  }

  /** A stays; B follows; a third click begins anew. */
  markNext(values) {
    if (!this.marks.A || this.marks.B) this.marks = { A: values, B: null };
    else this.marks.B = values;
    this.changed();
  }
}

/** The bar at the bottom: buttons, the scroll bar of time, the cursors. */
export class TimeBar {
  constructor(parent, time, history) {
    this.time = time;
    this.history = history;
    const button = (inside, title, act) => element("button", { title, "aria-label": title, onclick: act }, inside);
    this.toggle = button(icon("pause"), "Pause or play (space)", () => time.toggle());
    this.rate = element("select", { title: "Speed of playing", "aria-label": "Speed of playing" });
    for (const rate of RATES) this.rate.append(element("option", { value: rate }, `${rate}×`));
    this.rate.addEventListener("change", () => {
      time.lastRate = Number(this.rate.value);
      if (time.playing) time.play(time.lastRate);
    });
    this.slider = element("input", { type: "range", min: 0, max: 1000, step: "any", value: 1000, "aria-label": "Time that is looked at" });
    this.slider.addEventListener("input", () => {
      time.playing = 0;
      time.seek(this.from + (this.to - this.from) * (Number(this.slider.value) / 1000));
    });
    this.shown = element("span", { class: "shown" });
    this.behind = element("span");
    this.edge = button("live", "To the newest data (End)", () => time.resume());
    this.edge.className = "live";
    this.marks = element("span", { class: "figures marks", title: "Cursors A and B: Shift and click in a view; Escape clears them" });
    parent.append(
      button(icon("back"), "A step back (←; Shift: half a minute)", (e) => time.step(e.shiftKey ? -30 : -STEP)),
      this.toggle,
      button(icon("on"), "A step on (→; Shift: half a minute)", (e) => time.step(e.shiftKey ? 30 : STEP)),
      this.rate, this.slider, element("span", { class: "figures time" }, this.shown, this.behind), this.edge, this.marks,
    );
  }

  draw() {
    const { time, history } = this;
    this.from = time.oldest;
    this.to = time.newest;
    const known = history.newest >= history.oldest;
    const share = known && this.to > this.from ? (time.now - this.from) / (this.to - this.from) : 1;
    if (document.activeElement !== this.slider || time.live || time.playing) this.slider.value = 1000 * share;
    this.slider.setAttribute("aria-valuetext", known ? clock(time.now) : "no data");
    const runs = time.live || time.playing;
    const wanted = runs ? "pause" : "play";
    if (this.toggle.dataset.icon !== wanted) {
      this.toggle.dataset.icon = wanted;
      this.toggle.replaceChildren(icon(wanted));
    }
    this.edge.textContent = time.recording ? "end" : "live";
    this.edge.classList.toggle("on", time.live);
    const behind = time.newest - time.now;
    this.shown.textContent = known ? clock(time.now) : "";
    this.behind.textContent = known && !time.live && behind >= 0.5 ? `  −${duration(behind)}` : "";
    this.marks.textContent = marksText(time.marks);
  }
}

function marksText({ A, B }) {
  if (!A) return "";
  if (!B) return `A ${markText(A)}`;
  const parts = [`B−A ${duration(B.t - A.t)}`];
  if (Number.isFinite(A.azimuth) && Number.isFinite(B.azimuth)) {
    let turned = ((A.azimuth - B.azimuth) * 180) / Math.PI;
    turned -= 360 * Math.round(turned / 360);
    parts.push(`${turned >= 0 ? "+" : "−"}${Math.abs(turned).toFixed(1)}°`);
  }
  if (Number.isFinite(A.frequency) && Number.isFinite(B.frequency)) {
    parts.push(`${(B.frequency - A.frequency).toFixed(2)} Hz`);
  }
  if (Number.isFinite(A.x) && Number.isFinite(B.x)) {
    parts.push(`${Math.hypot(B.x - A.x, B.y - A.y).toFixed(0)} m`);
  }
  return parts.join("  ");
}

function markText(mark) {
  const parts = [clock(mark.t)];
  if (Number.isFinite(mark.azimuth)) {
    parts.push(`${((((90 - (mark.azimuth * 180) / Math.PI) % 360) + 360) % 360).toFixed(1)}°`);
  }
  if (Number.isFinite(mark.frequency)) parts.push(`${mark.frequency.toFixed(2)} Hz`);
  return parts.join(" ");
}
