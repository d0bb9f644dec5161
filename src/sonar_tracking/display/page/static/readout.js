// Values under the pointer, as one line at the bottom of a canvas.

import { palette } from "./palette.js";

/** One line of values at the bottom of a canvas. */
export function readout(pen, canvas, text) {
  pen.save();
  pen.font = "12px system-ui, sans-serif";
  const width = Math.min(pen.measureText(text).width + 12, canvas.width);
  pen.fillStyle = palette.panel;
  pen.globalAlpha = 0.88;
  pen.fillRect(canvas.width - width, canvas.height - 20, width, 20);
  pen.globalAlpha = 1;
  pen.fillStyle = palette.text;
  pen.textAlign = "right";
  pen.fillText(text, canvas.width - 6, canvas.height - 10, canvas.width - 8);
  pen.restore();
}
