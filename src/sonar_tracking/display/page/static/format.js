// Numbers and times as a person reads them. Angles come in radians; what is unknown is shown as –.

export const UNKNOWN = "–";
export const DEGREE = Math.PI / 180;

/** Compass degrees [0, 360) of an azimuth, radians anticlockwise from east. */
export function compass(azimuth) {
  const degrees = 90 - azimuth / DEGREE;
  return ((degrees % 360) + 360) % 360;
}

/** The difference of two angles, radians in [-pi, pi). */
export function turn(angle) {
  const whole = 2 * Math.PI;
  return ((((angle + Math.PI) % whole) + whole) % whole) - Math.PI;
}

export function fixed(value, digits) {
  return Number.isFinite(value) ? value.toFixed(digits) : UNKNOWN;
}

/** A compass direction, e.g. 045.0; 359.96 is 000.0. */
export function bearing(azimuth, digits = 1) {
  if (!Number.isFinite(azimuth)) return UNKNOWN;
  let text = compass(azimuth).toFixed(digits);
  if (Number(text) >= 360) text = (0).toFixed(digits);
  return text.padStart(digits ? 4 + digits : 3, "0");
}

export function degrees(angle, digits = 1) {
  return fixed(angle / DEGREE, digits);
}

export function signed(value, digits) {
  if (!Number.isFinite(value)) return UNKNOWN;
  return (value < 0 ? "−" : "+") + Math.abs(value).toFixed(digits);
}

/** Metres below ten thousand, then kilometres. */
export function distance(metres) {
  if (!Number.isFinite(metres)) return UNKNOWN;
  return metres < 9999.5 ? `${metres.toFixed(0)} m` : `${(metres / 1000).toFixed(1)} km`;
}

/** A distance along an axis: one unit for all of it, by how far it goes. */
export function axisDistance(metres, farthest) {
  return farthest < 9999.5 ? `${metres.toFixed(0)} m` : `${Number((metres / 1000).toFixed(3))} km`;
}

/** Degrees and minutes to 2 m of a position in the map, by the polynomials of the datum. */
export function place(x, y, datum) {
  const [u, v] = datum ? [x / datum.reach, y / datum.reach] : [NaN, NaN];
  if (!(Math.abs(u) <= 1 && Math.abs(v) <= 1)) return UNKNOWN;
  const sum = (terms) => datum.powers.reduce((total, [i, j], n) => total + terms[n] * u ** i * v ** j, 0);
  const longitude = ((((sum(datum.longitude) + 180) % 360) + 360) % 360) - 180;
  return `${minutes(sum(datum.latitude), 2, "NS")} ${minutes(longitude, 3, "EW")}`;
}

function minutes(angle, digits, sides) {
  const thousandths = Math.round(Math.abs(angle) * 60000);
  const whole = String(Math.floor(thousandths / 60000)).padStart(digits, "0");
  return `${whole}°${((thousandths % 60000) / 1000).toFixed(3).padStart(6, "0")}'${sides[angle < 0 ? 1 : 0]}`;
}

/** Time of day of data, UTC; data that began at 0 are shown as the time since. */
export function clock(seconds, digits = 0) {
  if (!Number.isFinite(seconds)) return "--:--:--";
  const day = ((seconds % 86400) + 86400) % 86400;
  const unit = 10 ** digits;
  const whole = Math.floor(day * unit + 1e-6) / unit;
  const two = (value) => String(Math.floor(value)).padStart(2, "0");
  const rest = (whole % 60).toFixed(digits).padStart(digits ? 3 + digits : 2, "0");
  return `${two(whole / 3600)}:${two((whole / 60) % 60)}:${rest}`;
}

/** A duration, e.g. 7 s, 12:05, 1:02:05. */
export function duration(seconds) {
  if (!Number.isFinite(seconds)) return UNKNOWN;
  const sign = seconds < 0 ? "−" : "";
  const s = Math.round(Math.abs(seconds));
  if (s < 60) return `${sign}${s} s`;
  const two = (value) => String(value).padStart(2, "0");
  const minutes = Math.floor(s / 60);
  if (minutes < 60) return `${sign}${minutes}:${two(s % 60)}`;
  return `${sign}${Math.floor(minutes / 60)}:${two(minutes % 60)}:${two(s % 60)}`;
}

/** Steps of a scale: 1, 2 or 5 times a power of ten, at least the given size. */
export function niceStep(size) {
  const power = 10 ** Math.floor(Math.log10(size));
  for (const factor of [1, 2, 5, 10]) if (factor * power >= size) return factor * power;
  return 10 * power;
}
