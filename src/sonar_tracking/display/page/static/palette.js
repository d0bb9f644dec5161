// Colours of the page, for canvases: those of style.css, which follow light and dark.
//
// Tracks have the colours of Okabe and Ito, which the colour-blind can tell apart; a status is never
// told by colour alone.

const NAMES = [
  "back", "panel", "text", "faint", "line", "accent", "own", "warn", "bad", "good", "truth",
  "active", "passive", "fused", "fixed", "contact", "ray", "legs", "a", "b",
];

const DARK_TRACKS = ["#56b4e9", "#e69f00", "#009e73", "#f0e442", "#cc79a7", "#d55e00", "#7fa8ff", "#c8c8c8"];
const LIGHT_TRACKS = ["#0072b2", "#b35f00", "#007a59", "#7a6a00", "#a8447f", "#c43c00", "#3d3dbb", "#555555"];

class Palette extends EventTarget {
  constructor() {
    super();
    this.theme = localStorage.getItem("theme") ?? "auto";
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => this.read());
    this.read();
  }

  get dark() {
    if (this.theme !== "auto") return this.theme === "dark";
    return matchMedia("(prefers-color-scheme: dark)").matches;
  }

  next() {
    const order = ["auto", "light", "dark"];
    this.theme = order[(order.indexOf(this.theme) + 1) % order.length];
    localStorage.setItem("theme", this.theme);
    this.read();
    return this.theme;
  }

  read() {
    document.documentElement.dataset.theme = this.dark ? "dark" : "light";
    const style = getComputedStyle(document.documentElement);
    for (const name of NAMES) this[name] = style.getPropertyValue(`--${name}`).trim();
    this.dispatchEvent(new Event("change"));
  }

  /** The colour of a track, by its number; the same in every view. */
  track(identifier) {
    const colours = this.dark ? DARK_TRACKS : LIGHT_TRACKS;
    return colours[(Number(identifier) - 1 + 8e15) % colours.length];
  }

  /** 256 colours from quiet to loud, as RGBA numbers for an ImageData. */
  ramp() {
    return this.dark ? DARK_RAMP : LIGHT_RAMP;
  }
}

// From the page's ground to the loudest, of steadily changing lightness (in print and for the
// colour-blind the order stays): dark is near black over blue and green to pale yellow.
const DARK_RAMP = ramp([[8, 14, 24], [22, 42, 82], [24, 92, 122], [40, 146, 120], [140, 196, 82], [252, 240, 160]]);
const LIGHT_RAMP = ramp([[252, 252, 250], [208, 224, 232], [130, 178, 206], [62, 122, 168], [30, 66, 120], [12, 18, 48]]);

function ramp(stops) {
  const colours = new Uint32Array(256);
  for (let i = 0; i < 256; i++) {
    const place = (i / 255) * (stops.length - 1);
    const low = Math.min(Math.floor(place), stops.length - 2);
    const [r, g, b] = stops[low].map((v, k) => Math.round(v + (place - low) * (stops[low + 1][k] - v)));
    colours[i] = (255 << 24) | (b << 16) | (g << 8) | r;
  }
  return colours;
}

export const palette = new Palette();
