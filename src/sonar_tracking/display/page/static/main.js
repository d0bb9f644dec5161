// Puts the page together: the connection feeds the history, the views draw what the time control asks.

import { element, icon } from "./canvas.js";
import { Commands, closeMenu } from "./commands.js";
import { bearing, clock, duration, fixed } from "./format.js";
import { History } from "./history.js";
import { Layout } from "./layout.js";
import { palette } from "./palette.js";
import { ownShipAt } from "./picture.js";
import { PROTOCOL, Socket } from "./socket.js";
import { TimeBar, TimeControl } from "./time_control.js";
import { cells, keyTexts } from "./views.js";

// ms between two pictures: of new data, and of what the hand does.
const DATA_PAUSE = 250;
const HAND_PAUSE = 40;
const byId = (id) => document.getElementById(id);

class Page {
  constructor() {
    this.history = new History();
    this.time = new TimeControl(this.history);
    this.selection = new Selection();
    this.health = null;
    this.datum = null;
    this.connection = "connecting";
    this.heard = performance.now();
    this.dirty = true;
    this.drawn = 0;
    this.moved = false; // by hand: to be drawn at once
    const ask = () => this.askDraw();
    this.time.addEventListener("part", (event) => this.socket.send({ kind: "seek", t: event.detail }));
    for (const source of [this.time, palette, this.selection]) source.addEventListener("change", ask);
    document.addEventListener("redraw", ask);
    this.socket = new Socket((frame) => this.take(frame), (news, reason) => this.tell(news, reason));
    this.commands = new Commands(this.socket, (sentence) => this.toast(sentence));
    this.bar = new TimeBar(byId("bottom"), this.time, this.history);
    this.layout = new Layout(byId("cells"), byId("tabs"), cells, (one, body, tools) => new one(body, tools, this));
    byId("theme").append(icon("shade"));
    byId("theme").addEventListener("click", () => this.toast(`Colours: ${palette.next()}`));
    byId("help").addEventListener("click", () => this.help());
    addEventListener("keydown", (event) => this.key(event));
    setInterval(() => (this.dirty = true), 1000); // ages, and whether the data are stale
    this.last = performance.now();
    requestAnimationFrame((now) => this.tick(now));
  }

  askDraw() {
    this.moved = true;
  }

  take(frame) {
    this.heard = performance.now();
    const act = this[`on_${frame.kind}`];
    if (act) act.call(this, frame);
    else (this.incoming ?? this.history).add(frame);
    this.dirty = true;
  }

  on_hello(frame) {
    if (frame.version !== PROTOCOL) location.reload();
    this.hello = frame;
    this.title = frame.title || "sonar_tracking";
    this.selection.enter(frame.run);
    byId("title").textContent = this.title;
    document.title = `${this.title} – sonar_tracking`;
    this.commands.allowed = frame.may_command;
    this.time.recording = frame.recording;
    this.time.span = frame.span;
    if (frame.recording) this.history.kept = Infinity;
  }

  on_sources() {}

  on_datum(frame) {
    this.datum = frame;
  }

  on_recording(frame) {
    this.time.recording = frame.state;
    if (!this.time.isReading) this.time.takePart();
  }

  /** Another part of the recording comes, as an operator has looked for it. */
  on_part() {
    this.history.clear();
  }

  on_health(frame) {
    this.health = frame;
  }

  /** A command takes effect: names are shown in every page, and in replays. */
  on_command(frame) {
    (this.incoming ?? this.history).add(frame);
    const topic = `${this.hello?.namespace ?? ""}/${frame.topic}`;
    if (frame.command === "rename_track") this.selection.rename(topic, frame.id, frame.name);
  }

  on_command_result(frame) {
    this.toast(frame.sentence, !frame.ok);
  }

  /** From here on the past comes, oldest first; what is shown stays until it is complete. */
  on_history() {
    this.incoming = new History(this.history.kept);
  }

  on_live() {
    const [earlier, now] = [this.history, this.incoming];
    this.incoming = null;
    if (!now) return;
    if (earlier.title === this.title) now.continueFrom(earlier);
    const kept = this.history.version;
    Object.assign(this.history, now);
    this.history.version = kept + 1;
    this.history.title = this.title;
    if (!this.time.live) this.time.seek(this.time.paused);
  }

  on_begin() {
    this.history.clear();
    this.time.resume();
    this.toast("The clock of the data has gone back: the picture begins anew.");
  }

  tell(news, reason) {
    this.connection = news;
    if (news === "gone") this.incoming = null;
    if (news === "gone" && reason) this.toast(reason);
    this.dirty = true;
  }

  toast(sentence, bad = false) {
    const toast = byId("toast");
    toast.textContent = sentence;
    toast.classList.toggle("bad", bad);
    toast.hidden = false;
    clearTimeout(this.toasting);
    this.toasting = setTimeout(() => (toast.hidden = true), 3000 + 40 * sentence.length);
  }

  tick(now) {
    const passed = this.time.pass(Math.min(0.5, (now - this.last) / 1000));
    this.last = now;
    const due = now - this.drawn >= (this.moved || passed ? HAND_PAUSE : DATA_PAUSE);
    if ((this.dirty || this.moved || passed) && due) {
      this.dirty = this.moved = false;
      this.drawn = now;
      this.draw();
    }
    requestAnimationFrame((next) => this.tick(next));
  }

  draw() {
    this.drawHead();
    this.bar.draw();
    const t = this.time.now;
    for (const view of this.layout.visible()) {
      try {
        view.draw(t);
      } catch (error) {
        console.error(error); // one view must not take the others with it
      }
    }
  }

  drawHead() {
    const [words, kind, alarm] = this.state();
    const state = byId("state");
    if (state.textContent !== words) state.textContent = words;
    state.className = `state ${kind}`;
    const line = byId("alarm");
    if (line.textContent !== alarm) line.textContent = line.title = alarm;
    byId("clock").textContent = clock(this.time.now);
    const ship = Number.isFinite(this.time.now) ? ownShipAt(this.history, this.time.now) : null;
    byId("ship").textContent = ship
      ? `own ship ${bearing(ship.yaw, 0)}°  ${fixed(Math.hypot(ship.vx, ship.vy) * 1.94384, 1)} kn`
      : "";
  }

  /** One word for the state, its kind, and a sentence if an operator must not trust the picture. */
  state() {
    if (this.connection !== "connected") {
      const words = this.connection === "gone" ? "no connection" : "connecting";
      const alarm = this.connection === "gone" ? "The server of this page is gone: what is shown is old. It is called again every second." : "";
      return [words, this.connection === "gone" ? "bad" : "wait", alarm];
    }
    if (this.time.isReading) return ["reading the recording", "wait", ""];
    if (this.time.recording) return [this.time.playing ? `playing ${this.time.playing}×` : "recording", "past", ""];
    if (!(this.history.newest > -Infinity)) return ["waiting for data", "wait", ""];
    const gone = (this.health?.nodes ?? []).filter((node) => !node.alive).map((node) => node.name);
    const alarms = [];
    if (this.health?.stale) alarms.push(`No data for ${duration(this.health.quiet)}: the clock stands, or the run has ended.`);
    else if (gone.length) alarms.push(`Not heard of any more: ${gone.join(", ")}.`);
    const alarm = alarms.join(" ");
    if (this.health?.stale) return ["stale", "bad", alarm];
    if (!this.time.live) return [this.time.playing ? `playing ${this.time.playing}×` : "paused", "past", alarm];
    return ["live", gone.length ? "wait" : "ok", alarm];
  }

  key(event) {
    if (event.target.matches?.("input[type=text], select, textarea") || event.ctrlKey || event.metaKey || event.altKey) return;
    const { time, layout } = this;
    const far = event.shiftKey ? 30 : 2;
    const onButton = event.target.matches?.("button, a");
    const acts = {
      " ": onButton ? null : () => time.toggle(),
      ArrowLeft: () => time.step(-far),
      ArrowRight: () => time.step(far),
      PageUp: () => time.step(-300),
      PageDown: () => time.step(300),
      Home: () => time.seek(time.oldest),
      End: () => time.resume(),
      f: () => layout.enlarge(layout.large ? null : layout.focused?.current ?? "plan"),
      t: () => this.toast(`Colours: ${palette.next()}`),
      "?": () => this.help(),
      Escape: () => this.escape(),
    };
    [...layout.views.keys()].forEach((id, place) => (acts[String(place + 1)] = () => layout.select(id, true)));
    const act = acts[event.key.length === 1 ? event.key.toLowerCase() : event.key];
    if (!act || (event.target === this.bar.slider && event.key.startsWith("Arrow"))) return;
    event.preventDefault();
    act();
  }

  escape() {
    closeMenu();
    if (this.layout.large) this.layout.enlarge(null);
    else {
      this.time.marks = { A: null, B: null };
      this.selection.choose(null);
      this.time.changed();
    }
  }

  help() {
    const dialog = byId("keys");
    dialog.replaceChildren(element("strong", {}, "Keys and symbols"));
    const list = element("dl");
    for (const [key, words] of keyTexts) list.append(element("dt", {}, key), element("dd", {}, words));
    dialog.append(list, element("button", { onclick: () => dialog.close() }, "Close"));
    dialog.showModal();
  }
}

/** What the operator looks at: a track of the picture, {topic, id}, or nothing. */
class Selection extends EventTarget {
  constructor() {
    super();
    this.track = null;
    this.run = null;
    this.names = new Map();
  }

  /** Names hold in one run: the numbers of another are other targets. */
  enter(run) {
    if (run === this.run) return;
    const kept = JSON.parse(localStorage.getItem("names") ?? "{}");
    this.run = run;
    this.names = new Map(kept.run === run ? Object.entries(kept.names) : []);
    this.choose(null);
  }

  choose(track) {
    this.track = track;
    this.dispatchEvent(new Event("change"));
  }

  isChosen(topic, id) {
    return this.track !== null && this.track.topic === topic && this.track.id === id;
  }

  /** The name an operator has given a track, or its number. */
  nameOf(topic, id) {
    return this.names.get(`${topic} ${id}`) ?? String(id);
  }

  rename(topic, id, name) {
    if (name) this.names.set(`${topic} ${id}`, name);
    else this.names.delete(`${topic} ${id}`);
    localStorage.setItem("names", JSON.stringify({ run: this.run, names: Object.fromEntries(this.names) }));
    this.dispatchEvent(new Event("change"));
  }
}

window.page = new Page();
