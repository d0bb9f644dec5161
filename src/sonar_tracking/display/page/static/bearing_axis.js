// The axis of a bearing-time record: cone angle, bearing relative to the bow, or true bearing.
//
// A line array hears a cone: in relative and true bearings each of its beams is seen on both sides.
// Positions along the axis are shares from 0 to 1.

import { DEGREE, turn } from "./format.js";

const WHOLE = 2 * Math.PI;

export const AXES = {
  cone: "cone",
  relative: "relative",
  north: "true",
  south: "true, N mid",
};

/** Frames of beam power say how the array lay: everything is seen from there. */
export class BearingAxis {
  constructor(mode) {
    this.mode = mode;
    this.whole = mode !== "cone";
  }

  /** The azimuth in the map at a share of the axis, for one row; NaN where nobody knows. */
  azimuthAt(share, frame) {
    if (this.mode === "cone") return frame.axis_azimuth + Math.PI / 2 - this.coneAt(share, frame);
    if (this.mode === "relative") return frame.heading - (share - 0.5) * WHOLE;
    const compass = this.mode === "north" ? share * WHOLE : (share - 0.5) * WHOLE;
    return Math.PI / 2 - compass;
  }

  coneAt(share, frame) {
    return frame.angles.of === "sine" ? (share - 0.5) * Math.PI : (share - 0.5) * WHOLE;
  }

  /** The share of an azimuth in the map; NaN = unknown. */
  shareOf(azimuth, frame) {
    if (this.mode === "cone") return this.shareOfCone(coneOf(azimuth, frame), frame);
    if (this.mode === "relative") return 0.5 + turn(frame.heading - azimuth) / WHOLE;
    const compass = (((Math.PI / 2 - azimuth) % WHOLE) + WHOLE) % WHOLE;
    return this.mode === "north" ? compass / WHOLE : (compass / WHOLE + 0.5) % 1;
  }

  shareOfCone(angle, frame) {
    return 0.5 + (frame.angles.of === "sine" ? angle / Math.PI : turn(angle) / WHOLE);
  }

  /** Level of a row at every pixel, dB: out is filled. */
  levels(frame, out) {
    const { first, step, of } = frame.angles;
    const { row } = frame;
    const most = row.length - 1;
    for (let x = 0; x < out.length; x++) {
      const share = (x + 0.5) / out.length;
      const cone = this.mode === "cone" ? this.coneAt(share, frame) : coneOf(this.azimuthAt(share, frame), frame);
      let place = ((of === "sine" ? Math.sin(cone) : turn(cone)) - first) / step;
      if (of !== "sine" && place < 0) place += row.length;
      const low = Math.min(Math.max(Math.floor(place), 0), most);
      const next = low < most ? low + 1 : of === "sine" ? most : 0;
      const rest = Math.min(Math.max(place - low, 0), 1);
      out[x] = row[low] + rest * (row[next] - row[low]);
    }
    return out;
  }

  /** Ticks: [share, text]; fewer where there is little room. */
  ticks(width, frame) {
    const room = width / 44;
    if (this.mode === "cone") {
      const widest = frame && frame.angles.of !== "sine" ? 180 : 90;
      const step = [15, 30, 45, 90].find((each) => (2 * widest) / each <= room) ?? 90;
      return ticksOf(-widest, widest, step, (d) => `${d > 0 ? "+" : d < 0 ? "−" : ""}${Math.abs(d)}`);
    }
    const step = [30, 45, 90, 180].find((each) => 360 / each <= room) ?? 180;
    if (this.mode === "relative") {
      return ticksOf(-180, 180, step, (d) => `${d < 0 ? "P" : d > 0 && d < 180 ? "S" : ""}${Math.abs(d)}`);
    }
    const turned = this.mode === "north" ? 0 : 180;
    return ticksOf(0, 360, step, (d) => String((d + turned) % 360).padStart(3, "0"));
  }
}

/** The cone angle of an azimuth for the array of a row, radians from broadside. */
export function coneOf(azimuth, frame) {
  const fromAxis = azimuth - frame.axis_azimuth;
  return frame.angles.of === "sine" ? Math.asin(Math.cos(fromAxis)) : turn(Math.PI / 2 - fromAxis);
}

/** Relative bearing as it is spoken: P045 or S120. */
export function relativeText(azimuth, heading) {
  const degrees = turn(heading - azimuth) / DEGREE;
  if (!Number.isFinite(degrees)) return "–";
  return `${degrees < 0 ? "P" : "S"}${Math.abs(degrees).toFixed(1).padStart(5, "0")}`;
}

function ticksOf(from, to, step, text) {
  const ticks = [];
  for (let value = from; value <= to; value += step) ticks.push([(value - from) / (to - from), text(value)]);
  return ticks;
}
