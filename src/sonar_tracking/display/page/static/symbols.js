// Symbols of the plan, in the style of naval displays: own ship a circle with a cross, tracks an
// outline round a dot whose form tells what hears them.

/** Form by what contributes: echoes and bearings a square, echoes a diamond, bearings a circle. */
export function formOf(row) {
  if (row.source === 4) return "triangle";
  const sources = new Set(row.contributors.map((entry) => entry[1]));
  if (!row.contributors.length) sources.add(row.source === 1 ? 1 : 0);
  if (sources.has(4)) return "triangle";
  if (sources.has(1)) return sources.has(0) ? "square" : "circle";
  return "diamond";
}

export function trackSymbol(pen, x, y, row, colour, ground, halo) {
  const r = 6;
  outline(pen, x, y, r, formOf(row));
  pen.fillStyle = ground;
  pen.globalAlpha = 0.75;
  pen.fill();
  pen.globalAlpha = 1;
  pen.setLineDash(row.status === 0 ? [3, 2] : row.status === 2 ? [1, 2] : []);
  pen.lineWidth = 2;
  pen.strokeStyle = colour;
  pen.stroke();
  pen.setLineDash([]);
  pen.fillStyle = colour;
  pen.fillRect(x - 1, y - 1, 2, 2);
  if (halo) {
    pen.strokeStyle = halo;
    pen.lineWidth = 1.5;
    pen.beginPath();
    pen.arc(x, y, r + 5, 0, 2 * Math.PI);
    pen.stroke();
  }
  pen.lineWidth = 1;
}

function outline(pen, x, y, r, form) {
  pen.beginPath();
  if (form === "circle") {
    pen.arc(x, y, r, 0, 2 * Math.PI);
  } else if (form === "square") {
    pen.rect(x - r + 0.5, y - r + 0.5, 2 * r - 1, 2 * r - 1);
  } else if (form === "diamond") {
    pen.moveTo(x, y - r - 1.5); pen.lineTo(x + r + 1.5, y); pen.lineTo(x, y + r + 1.5); pen.lineTo(x - r - 1.5, y);
    pen.closePath();
  } else {
    pen.moveTo(x, y - r - 1); pen.lineTo(x + r + 1, y + r - 1); pen.lineTo(x - r - 1, y + r - 1);
    pen.closePath();
  }
}

/** Own ship: circle, cross, and where it goes. */
export function ownShipSymbol(pen, place, ship, up, leader, colour) {
  const { x, y } = place;
  const r = 8;
  pen.strokeStyle = colour;
  pen.lineWidth = 1.8;
  pen.beginPath();
  pen.arc(x, y, r, 0, 2 * Math.PI);
  pen.moveTo(x - r, y); pen.lineTo(x + r, y);
  pen.moveTo(x, y - r); pen.lineTo(x, y + r);
  const azimuth = Math.atan2(ship.vy, ship.vx) - up;
  const length = Math.hypot(ship.vx, ship.vy) * leader;
  if (length > r) {
    pen.moveTo(x + r * Math.cos(azimuth), y - r * Math.sin(azimuth));
    pen.lineTo(x + length * Math.cos(azimuth), y - length * Math.sin(azimuth));
  }
  pen.stroke();
  pen.lineWidth = 1;
}
