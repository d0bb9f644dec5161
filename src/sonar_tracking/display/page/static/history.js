// What the page knows: frames by stream, each stream in order of data time, within a bounded time.
//
// A stream is one kind of one topic, or of one sensor and time scale. What is unknown in a
// column of numbers is NaN.

const KEPT_SECONDS = 45 * 60;
const MOST_FRAMES = 60000; // of one stream: 20 rows a second for 50 minutes
const REPLACED = new Set(["waterfall_open"]); // only the newest counts
const LASTING = new Set(["command"]); // whose effect lasts, however long ago they were
const TOLD = new Set(["hello", "health", "sources", "history", "live", "recording", "begin", "command_result"]);

export function streamName(frame) {
  const parts = [frame.kind];
  for (const name of ["topic", "sensor_name", "scale", "beam", "track"]) {
    if (frame[name] !== undefined && typeof frame[name] !== "object") parts.push(frame[name]);
  }
  if (frame.topic === undefined && typeof frame.sensor === "string") parts.push(frame.sensor);
  return parts.join(" ");
}

class Stream {
  constructor(kind) {
    this.frames = [];
    this.first = 0; // frames before it are forgotten
    this.lasting = LASTING.has(kind);
  }

  add(frame) {
    const frames = this.frames;
    const last = frames[frames.length - 1];
    if (frames.length === this.first || frame.t > last.t) {
      frames.push(frame);
    } else {
      const place = this.after(frame.t);
      const same = !this.lasting && place > this.first && frames[place - 1].t === frame.t;
      frames.splice(same ? place - 1 : place, same ? 1 : 0, frame);
    }
  }

  forget(oldest) {
    if (this.lasting) return;
    const frames = this.frames;
    while (this.first < frames.length - 1 && frames[this.first].t < oldest) frames[this.first++] = null;
    while (frames.length - this.first > MOST_FRAMES) frames[this.first++] = null;
    if (this.first > 256 && this.first > frames.length / 4) {
      this.frames = frames.slice(this.first);
      this.first = 0;
    }
  }

  /** Keep the newest frame, and those about a time. */
  keepAbout(t, seconds) {
    if (this.lasting) return;
    const newest = this.frames[this.frames.length - 1];
    this.frames = this.frames.slice(this.first).filter((frame) => frame === newest || Math.abs(frame.t - t) <= seconds);
    this.first = 0;
  }

  /** Index behind the last frame whose time is not after t. */
  after(t) {
    let low = this.first;
    let high = this.frames.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.frames[middle].t <= t) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  at(t) {
    const place = this.after(t);
    return place > this.first ? this.frames[place - 1] : null;
  }

  between(t0, t1) {
    return this.frames.slice(this.after(t0 - 1e-9), this.after(t1));
  }
}

export class History {
  constructor(keptSeconds = KEPT_SECONDS) {
    this.kept = keptSeconds;
    this.clear();
  }

  clear() {
    this.streams = new Map();
    this.oldest = Infinity;
    this.newest = -Infinity;
    this.version = (this.version ?? 0) + 1; // changes when the past changes
  }

  /** Take a frame; a row of a picture has its payload in frame.row. */
  add(frame) {
    if (TOLD.has(frame.kind) || !Number.isFinite(frame.t)) return;
    packColumns(frame);
    const name = streamName(frame);
    let stream = this.streams.get(name);
    if (!stream) this.streams.set(name, (stream = new Stream(frame.kind)));
    if (REPLACED.has(frame.kind)) stream.frames.length = 0;
    stream.add(frame);
    if (stream.lasting) return;
    if (frame.t > this.newest) this.newest = frame.t;
    if (frame.t < this.oldest) this.oldest = frame.t;
    const oldest = this.newest - this.kept;
    if (oldest > this.oldest) this.oldest = oldest;
    stream.forget(oldest);
  }

  /** Put the past of an earlier connection before what is known: a server that was started anew. */
  continueFrom(earlier) {
    if (!(earlier.newest >= earlier.oldest) || this.newest < earlier.newest - 5) return;
    const begin = this.oldest;
    for (const [name, stream] of earlier.streams) {
      const before = stream.frames.slice(stream.first, stream.after(begin - 1e-9));
      let own = this.streams.get(name);
      if (own && stream.lasting) continue; // told from the beginning again
      if (!own) this.streams.set(name, (own = new Stream(name.split(" ")[0])));
      own.frames = before.concat(own.frames.slice(own.first));
      own.first = 0;
      own.forget(this.newest - this.kept);
    }
    this.oldest = Math.max(Math.min(begin, earlier.oldest), this.newest - this.kept);
    this.version++;
  }

  /** Names of the streams of a kind, sorted. */
  names(kind) {
    const found = [];
    for (const name of this.streams.keys()) {
      if (name === kind || name.startsWith(`${kind} `)) found.push(name);
    }
    return found.sort();
  }

  stream(name) {
    return this.streams.get(name) ?? null;
  }

  /** The newest frame of a stream not after t; null if there is none. */
  at(name, t) {
    return this.streams.get(name)?.at(t) ?? null;
  }

  /** Frames of a stream in [t0, t1]. */
  between(name, t0, t1) {
    return this.streams.get(name)?.between(t0, t1) ?? [];
  }

  /** Topics of a kind, e.g. of "tracks". */
  topics(kind) {
    return this.names(kind).map((name) => name.slice(kind.length + 1));
  }

  get size() {
    let count = 0;
    for (const stream of this.streams.values()) count += stream.frames.length - stream.first;
    return count;
  }
}

/** What is unknown is null in the frame, and NaN from here on: a plain array of numbers is small. */
function packColumns(frame) {
  for (const key of Object.keys(frame)) {
    const value = frame[key];
    if (!Array.isArray(value) || !value.includes(null)) continue;
    if (value.every((entry) => entry === null || typeof entry === "number")) {
      frame[key] = value.map((entry) => entry ?? NaN);
    }
  }
}
