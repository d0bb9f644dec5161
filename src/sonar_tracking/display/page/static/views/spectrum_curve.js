// The mean spectrum above a LOFAR: a curve of uPlot whose frequencies stand above those of the rows.

import { element } from "../canvas.js";
import { fixed } from "../format.js";
import { palette } from "../palette.js";

const QUIETEST = -3; // dB over the background at the foot of the curve
const LOWEST_TOP = 10; // dB over the background at its head, at least

export class SpectrumCurve {
  constructor(parent) {
    this.holder = element("div", { class: "curve" });
    parent.append(this.holder);
    this.plot = null;
  }

  hide() {
    this.holder.hidden = true;
  }

  /** Show levels, dB, at frequencies; box in CSS pixels, band: the frequencies that are shown. */
  show(box, band, frequencies, levels, overBackground) {
    this.holder.hidden = false;
    this.holder.style.top = `${box.y}px`;
    const key = `${box.width} ${box.height} ${palette.dark}`;
    const shown = `${band} ${overBackground}`;
    if (levels === this.levels && shown === this.shown && key === this.key) return;
    Object.assign(this, { levels, shown, band, overBackground });
    if (key !== this.key) {
      this.key = key;
      this.plot?.destroy();
      this.plot = this.make(box);
    }
    this.plot.setData([frequencies, levels]);
  }

  make({ width, height }) {
    return new window.uPlot({
      width,
      height,
      padding: [2, 0, 2, 0],
      legend: { show: false },
      cursor: { show: false },
      select: { show: false },
      axes: [{ show: false }, { show: false }],
      scales: {
        x: { time: false, range: () => this.band },
        y: { range: (plot, least, most) => this.rangeOf(least, most) },
      },
      series: [{}, { stroke: palette.accent, width: 1.2, points: { show: false } }],
      hooks: { draw: [(plot) => this.drawScale(plot)] },
    }, [[], []], this.holder);
  }

  rangeOf(least, most) {
    if (this.overBackground) return [QUIETEST, Math.max(most ?? LOWEST_TOP, LOWEST_TOP)];
    return Number.isFinite(least) ? [least, Math.max(most, least + 1)] : [0, 1];
  }

  /** The level at the head of the curve: an axis beside it would shift the frequencies. */
  drawScale({ ctx, scales }) {
    const ratio = window.devicePixelRatio || 1;
    ctx.save();
    ctx.font = `${11 * ratio}px system-ui, sans-serif`;
    ctx.textBaseline = "top";
    ctx.lineWidth = 3 * ratio;
    ctx.strokeStyle = palette.panel;
    ctx.fillStyle = palette.faint;
    const text = `${fixed(scales.y.max, 0)} dB`;
    ctx.strokeText(text, 3 * ratio, 2 * ratio);
    ctx.fillText(text, 3 * ratio, 2 * ratio);
    ctx.restore();
  }
}
