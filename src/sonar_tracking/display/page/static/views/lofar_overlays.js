// What lies over the rows of the LOFAR: axes, lines that are followed, own ship's, cursors, harmonics.

import { label } from "../canvas.js";
import { clock, niceStep } from "../format.js";
import { palette } from "../palette.js";

const MOST_HARMONICS = 40;
const NARROWEST_BAND = 3; // CSS pixels, of a line of own ship

/** Frequencies above the rows, times beside them. */
export function drawAxes(pen, view) {
  const [low, high] = view.shownBand;
  const step = niceStep(((high - low) / view.canvas.width) * 64);
  pen.save();
  pen.font = "11px system-ui, sans-serif";
  pen.textAlign = "center";
  for (let f = Math.ceil(low / step) * step; f <= high; f += step) {
    const x = view.xOf(f);
    pen.strokeStyle = palette.faint;
    pen.globalAlpha = 0.3;
    pen.beginPath();
    pen.moveTo(x, view.top);
    pen.lineTo(x, view.canvas.height);
    pen.stroke();
    pen.globalAlpha = 1;
    pen.fillStyle = palette.faint;
    if (x > 14 && x < view.canvas.width - 44) pen.fillText(String(Number(f.toFixed(3))), x, view.top / 2);
  }
  pen.textAlign = "right";
  pen.fillStyle = palette.faint;
  pen.fillText("Hz", view.canvas.width - 4, view.top / 2);
  pen.textAlign = "left";
  const { ring, box } = view;
  const pixels = box.height / (ring.height * ring.span); // a second
  const every = [10, 30, 60, 120, 300, 600, 1200, 3600].find((s) => s * pixels >= 42) ?? 7200;
  const oldest = Math.max((ring.last - ring.height + 1) * ring.span, view.page.history.oldest);
  for (let time = Math.ceil(oldest / every) * every; time <= ring.last * ring.span; time += every) {
    const y = box.y + ring.yOf(time, box, false);
    if (y > box.y + 7 && y < box.y + box.height - 22) label(pen, every % 60 ? clock(time) : clock(time).slice(0, 5), 3, y, palette.text, palette.panel);
  }
  pen.restore();
}

/** Lines that are followed in the beam, a tick on either side of each, and their frequencies. */
export function drawLines(pen, view, beam, t) {
  const { history } = view.page;
  const { ring, box } = view;
  pen.save();
  for (const topic of history.topics("lines")) {
    const frames = history.between(`lines ${topic}`, t - ring.height * ring.span, t);
    if (!frames.length || frames[0].sensor.id !== beam.sensor) continue;
    const newest = new Map();
    for (const frame of frames) {
      for (let i = 0; i < frame.line_id.length; i++) {
        if (frame.track_id[i] !== beam.track) continue;
        const x = view.xOf(frame.frequency[i]);
        const y = box.y + ring.yOf(frame.t, box, false);
        if (!Number.isFinite(y) || x < 0 || x > box.width) continue;
        pen.fillStyle = palette.track(frame.line_id[i]);
        pen.fillRect(x - 4.5, y - 0.5, 2, 1.5);
        pen.fillRect(x + 2.5, y - 0.5, 2, 1.5);
        newest.set(frame.line_id[i], { x, t: frame.t, f: frame.frequency[i] });
      }
    }
    pen.font = "11px system-ui, sans-serif";
    pen.textAlign = "center";
    let right = -Infinity;
    for (const [id, { x, t: heard, f }] of [...newest].sort((a, b) => a[1].x - b[1].x)) {
      if (t - heard > 15 || x < right + 46) continue;
      label(pen, f.toFixed(1), Math.min(Math.max(x, 20), box.width - 20), box.y + 8, palette.track(id), palette.panel);
      right = x;
    }
  }
  pen.restore();
}

/** The cursors A and B. */
export function drawMarks(pen, view) {
  for (const [name, mark] of Object.entries(view.page.time.marks)) {
    if (!mark) continue;
    const y = view.box.y + view.ring.yOf(mark.t, view.box, false);
    const x = Number.isFinite(mark.frequency) ? view.xOf(mark.frequency) : NaN;
    pen.strokeStyle = palette[name.toLowerCase()];
    pen.lineWidth = 1.5;
    pen.beginPath();
    if (Number.isFinite(y)) {
      pen.moveTo(0, y);
      pen.lineTo(view.box.width, y);
    }
    if (Number.isFinite(x)) {
      pen.moveTo(x, view.top);
      pen.lineTo(x, view.canvas.height);
    }
    pen.stroke();
    if (Number.isFinite(y)) label(pen, name, Number.isFinite(x) ? x + 4 : 4, y - 8, pen.strokeStyle, palette.panel);
  }
  pen.lineWidth = 1;
}

/** Multiples of the frequency of which the one under the cursor is the chosen one. */
export function drawHarmonics(pen, view, cursor) {
  const fundamental = cursor / Number(view.order.value);
  const [, high] = view.shownBand;
  pen.save();
  pen.font = "11px system-ui, sans-serif";
  pen.textAlign = "center";
  let right = -Infinity;
  for (let k = 1; k <= MOST_HARMONICS && k * fundamental <= high; k++) {
    const x = view.xOf(k * fundamental);
    if (x < 0) continue;
    pen.strokeStyle = palette.warn;
    pen.setLineDash(k === Number(view.order.value) ? [] : [5, 4]);
    pen.beginPath();
    pen.moveTo(x, view.top);
    pen.lineTo(x, view.canvas.height);
    pen.stroke();
    if (x > right + 20) {
      label(pen, String(k), x, view.box.y + 38, palette.warn, palette.panel);
      right = x;
    }
  }
  pen.restore();
}

/** Bands that an operator has marked as lines of own ship, which no target has. */
export function drawOwnShipLines(pen, view, marks) {
  pen.save();
  pen.font = "12px system-ui, sans-serif";
  pen.textAlign = "center";
  for (const { frequency, bandwidth } of marks) {
    const [low, high] = [view.xOf(frequency - bandwidth / 2), view.xOf(frequency + bandwidth / 2)];
    const width = Math.max(high - low, NARROWEST_BAND);
    const x = (low + high) / 2;
    if (x < 0 || x > view.box.width) continue;
    pen.fillStyle = palette.own;
    pen.globalAlpha = 0.3;
    pen.fillRect(x - width / 2, view.box.y, width, view.box.height);
    pen.globalAlpha = 1;
    label(pen, "⊕", Math.min(Math.max(x, 8), view.box.width - 8), view.box.y + 22, palette.own, palette.panel);
  }
  pen.restore();
}
