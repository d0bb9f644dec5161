// Lines that an operator takes for own ship's: what holds of all that was said up to a time.
//
// The same rules as in tma_tracker: a mark is a band of one sensor or of all, and is taken back by a
// frequency within it.

/** Marks under which lines of a sensor fall at a time: [{frequency, bandwidth, sensor}]. */
export function ownShipLines(history, t, sensor) {
  const said = history.names("command").flatMap((name) => history.between(name, -Infinity, t));
  said.sort((a, b) => a.t - b.t);
  let marks = [];
  for (const one of said) {
    if (one.command === "mark_own_ship_line") marks.push(one);
    else if (one.command === "unmark_own_ship_line") {
      marks = marks.filter((mark) => !isUnder(mark, one.frequency, one.sensor || mark.sensor));
    }
  }
  return marks.filter((mark) => mark.sensor === "" || mark.sensor === sensor);
}

/** Whether a frequency that a sensor hears, Hz, falls under a mark. */
export function isUnder(mark, frequency, sensor) {
  const near = 2 * Math.abs(frequency - mark.frequency) <= mark.bandwidth;
  return near && (mark.sensor === "" || mark.sensor === sensor);
}
