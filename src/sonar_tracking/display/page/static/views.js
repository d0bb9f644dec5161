// The views, by the cell they are in; the first of a cell is shown first.

import { BearingTime } from "./views/bearing_time.js";
import { Health } from "./views/health.js";
import { Lofar } from "./views/lofar.js";
import { Plan } from "./views/plan.js";
import { RangeBearing } from "./views/range_bearing.js";
import { StackedDots } from "./views/stacked_dots.js";
import { TrackTable } from "./views/track_table.js";

export const cells = [[Plan], [BearingTime, Lofar], [RangeBearing, StackedDots, Health], [TrackTable]];

export const keyTexts = [
  ["Space", "pause, or play"],
  ["← →", "a step back or on; with Shift half a minute; Page Up and Page Down five minutes"],
  ["Home, End", "to the oldest data, to the newest"],
  ["1 … 7", "a view in front"],
  ["F", "the view large, or all again"],
  ["Shift and click", "cursor A, then B: differences in time, bearing and frequency are shown below"],
  ["Ctrl and arrows", "in a picture that has the focus (Tab): the pointer; Enter clicks, with Shift sets a cursor, M opens the menu"],
  ["Escape", "back: closes what is open, takes the cursors and the choice away"],
  ["H, + and −", "in the LOFAR: harmonic cursor, closer and wider; the wheel zooms, dragging moves, a double click shows all"],
  ["T", "colours: light, dark, as the machine"],
  ["⊕", "own ship; in the LOFAR a line that is marked as hers"],
  ["7, b7, e7", "a track of the picture; a track of bearings, or of echoes, that is part of none"],
  ["□ ◇ ○ △", "a track of echoes and bearings, of echoes, of bearings, and something fixed; dashed: tentative; dotted: coasted"],
  ["—", "the line at a symbol is its course, as long as it goes in three minutes"],
];
