// A canvas that fills its element sharply, whatever the size and the pixels of the screen.

export class Canvas {
  constructor(parent, label) {
    this.element = document.createElement("canvas");
    this.element.setAttribute("role", "img");
    this.element.setAttribute("aria-label", label);
    parent.append(this.element);
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
