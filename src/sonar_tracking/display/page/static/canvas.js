// A canvas that fills its element sharply, whatever the size and the pixels of the screen.

import { listenToKeys } from "./keyboard_pointer.js";

export class Canvas {
  constructor(parent, label) {
    this.element = document.createElement("canvas");
    this.element.setAttribute("role", "img");
    this.element.setAttribute("aria-label", label);
    parent.append(this.element);
    listenToKeys(this.element);
    this.pen = this.element.getContext("2d");
    this.width = 0;
    this.height = 0;
    this.resized = true;
    new ResizeObserver(() => {
      this.resized = true;
      parent.dispatchEvent(new Event("redraw", { bubbles: true }));
    }).observe(parent);
    this.parent = parent;
  }

  /** Clear, and return the pen in units of CSS pixels; null while there is no room. */
  begin(ground) {
    const ratio = window.devicePixelRatio || 1;
    if (this.resized || ratio !== this.ratio) {
      this.resized = false;
      this.ratio = ratio;
      this.width = this.parent.clientWidth;
      this.height = this.parent.clientHeight;
      this.element.width = Math.max(1, Math.round(this.width * ratio));
      this.element.height = Math.max(1, Math.round(this.height * ratio));
    }
    if (this.width < 20 || this.height < 20) return null;
    this.pen.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.pen.fillStyle = ground;
    this.pen.fillRect(0, 0, this.width, this.height);
    this.pen.font = "12px system-ui, sans-serif";
    this.pen.textBaseline = "middle";
    this.pen.textAlign = "left";
    this.pen.setLineDash([]);
    this.pen.lineWidth = 1;
    this.pen.globalAlpha = 1;
    return this.pen;
  }
}

/** Text that can be read over anything: with a rim of the ground. */
export function label(pen, text, x, y, colour, ground) {
  pen.lineWidth = 3;
  pen.lineJoin = "round";
  pen.strokeStyle = ground;
  pen.strokeText(text, x, y);
  pen.fillStyle = colour;
  pen.fillText(text, x, y);
  pen.lineWidth = 1;
}

/** Names beside symbols, placed so that they cover neither one another nor a symbol. */
export class Labels {
  constructor() {
    this.taken = [];
  }

  keepFree({ x, y }, size = 8) {
    if (Number.isFinite(x)) this.taken.push([x - size, y - size, x + size, y + size]);
  }

  put(pen, text, x, y, colour, ground) {
    const width = pen.measureText(text).width;
    const places = [[9, -9], [9, 9], [-9 - width, -9], [-9 - width, 9], [9, -22], [9, 22], [-9 - width, -22], [-width / 2, 18], [22, 0], [9, 36]];
    const boxes = places.map(([dx, dy]) => [x + dx, y + dy - 6, x + dx + width, y + dy + 6]);
    const free = boxes.findIndex((box) => !this.taken.some((other) => overlap(box, other)));
    const [dx, dy] = places[Math.max(free, 0)];
    this.taken.push(boxes[Math.max(free, 0)]);
    label(pen, text, x + dx, y + dy, colour, ground);
  }
}

function overlap(a, b) {
  return a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3];
}

/** An element with attributes and children. */
export function element(name, attributes = {}, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key.startsWith("on")) made.addEventListener(key.slice(2), value);
    else if (value !== false && value !== undefined) made.setAttribute(key, value === true ? "" : value);
  }
  made.append(...children);
  return made;
}

const ICONS = {
  pause: "M4 3h3v10H4zM9 3h3v10H9z",
  play: "M4 2.5v11l9-5.5z",
  back: "M3 3h2v10H3zM13 3v10L6 8z",
  on: "M11 3h2v10h-2zM3 3v10l7-5z",
  large: "M2 2h5v2H5.4L8 6.6 6.6 8 4 5.4V7H2zM14 14H9v-2h1.6L8 9.4 9.4 8l2.6 2.6V9h2z",
  shade: "M8 1a7 7 0 1 0 0 14A7 7 0 0 0 8 1zm0 2v10A5 5 0 0 1 8 3z",
  home: "M7 0h2v3.1A5 5 0 0 1 12.9 7H16v2h-3.1A5 5 0 0 1 9 12.9V16H7v-3.1A5 5 0 0 1 3.1 9H0V7h3.1A5 5 0 0 1 7 3.1zM8 5a3 3 0 1 0 0 6 3 3 0 0 0 0-6z",
  nearer: "M7 3h2v4h4v2H9v4H7V9H3V7h4z",
  farther: "M3 7h10v2H3z",
};

/** A small picture for a button: fonts of other machines may not have it. */
export function icon(name) {
  const space = "http://www.w3.org/2000/svg";
  const made = document.createElementNS(space, "svg");
  made.setAttribute("viewBox", "0 0 16 16");
  made.setAttribute("aria-hidden", "true");
  made.setAttribute("class", "icon");
  const path = document.createElementNS(space, "path");
  path.setAttribute("d", ICONS[name]);
  path.setAttribute("fill-rule", "evenodd");
  made.append(path);
  return made;
}
