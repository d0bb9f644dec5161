// A picture of rows over time in a ring of lines: a new row costs its own lines, whatever is shown.
//
// Each line stands for a span of data time, counted from time zero, and has its place in the ring by
// its number. A row fills the lines whose middles lie within its own span; what nobody fills stays
// empty, so that a gap is seen as long as it was.

export class RowRing {
  constructor() {
    this.canvas = document.createElement("canvas");
    this.pen = this.canvas.getContext("2d", { alpha: true });
    this.key = null;
  }

  /**
   * Bring the ring up to a time and draw it.
   *
   * box: {x, y, width, height} in CSS pixels; rows(t0, t1): frames with t0, t1 and row;
   * paint(frame, line): fills a Uint32Array of colours; key: changes when painted lines are void.
   */
  show(pen, box, { now, lineSeconds, ratio, newestOnTop, wrap, rows, open, paint, key }) {
    const width = Math.max(1, Math.round(box.width * ratio));
    const height = Math.max(1, Math.round(box.height * ratio));
    const span = lineSeconds / ratio;
    this.prepare(width, height, span, newestOnTop, key);
    const last = Math.floor(now / span);
    if (!(last >= this.last) || last - this.last >= height) {
      this.pen.clearRect(0, 0, width, height);
      this.filled = (last - height + 1) * span;
    } else {
      this.clear(this.last + 1, last);
    }
    this.last = last;
    for (const frame of rows(this.filled, now)) {
      this.fill(frame, paint);
      this.filled = Math.max(this.filled, frame.t1);
    }
    const begun = open?.();
    if (begun && begun.t1 > this.filled && begun.t0 <= now) this.fill(begun, paint);
    this.blit(pen, box, wrap);
  }

  prepare(width, height, span, newestOnTop, key) {
    const whole = `${width} ${height} ${span} ${newestOnTop} ${key}`;
    if (whole === this.key) return;
    this.key = whole;
    if (this.canvas.width !== width || this.canvas.height !== height) {
      this.canvas.width = width;
      this.canvas.height = height;
      this.image = new ImageData(width, 1);
      this.line = new Uint32Array(this.image.data.buffer);
    }
    Object.assign(this, { width, height, span, newestOnTop, last: NaN, filled: -Infinity });
  }

  place(line) {
    const place = ((line % this.height) + this.height) % this.height;
    return this.newestOnTop ? this.height - 1 - place : place;
  }

  clear(from, to) {
    for (let line = from; line <= to; line++) this.pen.clearRect(0, this.place(line), this.width, 1);
  }

  fill(frame, paint) {
    const first = Math.max(Math.ceil(frame.t0 / this.span - 0.5), this.last - this.height + 1);
    const end = Math.min(Math.ceil(frame.t1 / this.span - 0.5), this.last + 1);
    if (end <= first) return;
    paint(frame, this.line);
    for (let line = first; line < end; line++) this.pen.putImageData(this.image, 0, this.place(line));
  }

  /** Draw the ring unrolled, or as it is. */
  blit(pen, box, wrap) {
    pen.imageSmoothingEnabled = false;
    const unit = box.height / this.height;
    const newest = this.place(this.last);
    // Lines from the top of the picture down: the first is `top`, then on round the ring.
    const top = wrap ? 0 : this.newestOnTop ? newest : (newest + 1) % this.height;
    const rest = this.height - top;
    pen.drawImage(this.canvas, 0, top, this.width, rest, box.x, box.y, box.width, rest * unit);
    if (top) {
      pen.drawImage(this.canvas, 0, 0, this.width, top, box.x, box.y + rest * unit, box.width, top * unit);
    }
  }

  /** Height of a time below the top of the box, CSS pixels; NaN = it is not in the picture. */
  yOf(t, box, wrap) {
    const unit = box.height / this.height;
    const line = t / this.span;
    const age = this.last + 1 - line;
    if (age < 0 || age > this.height) return NaN;
    if (!wrap) return (this.newestOnTop ? age : this.height - age) * unit;
    const place = ((line % this.height) + this.height) % this.height;
    return (this.newestOnTop ? this.height - place : place) * unit;
  }

  /** The time at a height below the top of the box, s. */
  timeAt(y, box, wrap) {
    const place = (y / box.height) * this.height;
    if (!wrap) return (this.last + 1 - (this.newestOnTop ? place : this.height - place)) * this.span;
    const inRing = this.newestOnTop ? this.height - place : place;
    const now = ((this.last % this.height) + this.height) % this.height;
    const age = (((now + 1 - inRing) % this.height) + this.height) % this.height;
    return (this.last + 1 - age) * this.span;
  }

  /** Height of the edge between new and old, where the picture wraps, CSS pixels. */
  edge(box) {
    const place = this.place(this.last);
    return ((this.newestOnTop ? place : place + 1) * box.height) / this.height;
  }
}

/** Level of a row over pixel x: between two columns, or the loudest of those the pixel covers. */
export function resample(row, from, step, out) {
  const most = row.length - 1;
  if (step <= 1.2) {
    for (let x = 0; x < out.length; x++) {
      const place = from + (x + 0.5) * step - 0.5;
      if (place < -0.5 || place > most + 0.5) {
        out[x] = NaN;
        continue;
      }
      const low = Math.min(Math.max(Math.floor(place), 0), Math.max(most - 1, 0));
      const share = Math.min(Math.max(place - low, 0), 1);
      out[x] = row[low] + share * (row[Math.min(low + 1, most)] - row[low]);
    }
    return out;
  }
  for (let x = 0; x < out.length; x++) {
    const first = Math.max(Math.floor(from + x * step), 0);
    const end = Math.min(Math.max(Math.floor(from + (x + 1) * step), first + 1), most + 1);
    let loudest = NaN;
    for (let i = first; i < end; i++) if (!(row[i] <= loudest)) loudest = row[i];
    out[x] = loudest;
  }
  return out;
}

/** The level that a share of a row does not exceed, dB. */
export function floorOf(row, share = 0.3) {
  const sorted = Float32Array.from(row).sort();
  return sorted[Math.floor(share * (sorted.length - 1))];
}
