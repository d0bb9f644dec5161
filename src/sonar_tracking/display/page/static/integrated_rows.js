// Rows of a stream integrated to longer ones: mean power, not mean decibels.

const CLIPPING = 3; // backgrounds above which a column stands out
const PASSES = 7;

export class IntegratedRows {
  constructor() {
    this.key = null;
  }

  /** Rows of so many seconds that overlap [t0, t1]; stream: of frames with t0, t1 and row in dB. */
  between(stream, seconds, t0, t1, key) {
    const first = stream.frames[stream.first];
    const whole = `${key} ${seconds} ${first?.row.length}`;
    if (whole !== this.key || !(first?.t >= this.oldest)) {
      Object.assign(this, { key: whole, oldest: first?.t ?? -Infinity, rows: [], sum: null, last: -Infinity });
    }
    for (let i = stream.after(this.last); i < stream.frames.length; i++) this.add(stream.frames[i], seconds);
    return this.rows.filter((row) => row.t1 > t0 && row.t0 < t1);
  }

  add(frame, seconds) {
    this.last = frame.t;
    const slot = Math.floor((frame.t0 + frame.t1) / 2 / seconds);
    const gap = this.sum && frame.t0 - this.sum.t1 > seconds / 2;
    if (!this.sum || slot !== this.sum.slot || gap) {
      // A row alone is what it is: no copy of it is kept.
      this.sum = { ...frame, slot, power: null, weight: frame.t1 - frame.t0 };
      this.rows.push(this.sum);
    } else {
      this.join(frame);
    }
    if (this.rows.length > 5000) this.rows.splice(0, 1000);
  }

  join(frame) {
    const { sum } = this;
    const weight = frame.t1 - frame.t0;
    sum.power ??= Float32Array.from(sum.row, (level) => sum.weight * 10 ** (level / 10));
    for (let i = 0; i < sum.power.length; i++) sum.power[i] += weight * 10 ** (frame.row[i] / 10);
    sum.weight += weight;
    Object.assign(sum, { t1: frame.t1, t: frame.t, row: null, floor: undefined });
  }
}

/** Levels of an integrated row, dB; they are computed when they are asked for. */
export function levelsOf(sum) {
  if (!sum.row) {
    sum.row = new Float32Array(sum.power.length);
    for (let i = 0; i < sum.row.length; i++) sum.row[i] = 10 * Math.log10(sum.power[i] / sum.weight + 1e-30);
  }
  return sum.row;
}

/**
 * Levels over their background, dB: the mean power of a window on either side of each column, what
 * stands out of it clipped away, as the line tracker does it. Beside a strong line the first
 * background is too high to clip all of it: it is done again with the better one.
 */
export function overBackground(row, halfWidth, out) {
  const count = row.length;
  const { power, values, sums, background } = workFor(count);
  for (let i = 0; i < count; i++) power[i] = values[i] = 10 ** (row[i] / 10);
  for (let pass = 0; pass < PASSES; pass++) {
    windowedMeans(values, halfWidth, sums, background);
    for (let i = 0; i < count; i++) values[i] = power[i] > CLIPPING * background[i] ? background[i] : power[i];
  }
  for (let i = 0; i < count; i++) out[i] = 10 * Math.log10((power[i] + 1e-30) / (background[i] + 1e-30));
  return out;
}

let work = null;

/** Room for the numbers in between: made once, as there are many rows. */
function workFor(count) {
  if (work?.power.length !== count) {
    const [power, values, background] = [1, 2, 3].map(() => new Float64Array(count));
    work = { power, values, background, sums: new Float64Array(count + 1) };
  }
  return work;
}

function windowedMeans(values, halfWidth, sums, means) {
  const count = values.length;
  for (let i = 0; i < count; i++) sums[i + 1] = sums[i] + values[i];
  for (let i = 0; i < count; i++) {
    const low = Math.max(0, i - halfWidth);
    const high = Math.min(count, i + halfWidth + 1);
    means[i] = (sums[high] - sums[low]) / (high - low);
  }
}
