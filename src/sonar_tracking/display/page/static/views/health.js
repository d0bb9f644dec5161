// The state of the graph: every node with rate, backlog and what it says; every topic.

import { element } from "../canvas.js";
import { UNKNOWN, duration, fixed } from "../format.js";

const LEVEL = { ok: ["●", "good", "ok"], warning: ["▲", "warn", "warning"], error: ["■", "bad", "error"], stale: ["■", "bad", "stale"] };

export class Health {
  static id = "health";
  static title = "Health";

  constructor(body, tools, page) {
    this.page = page;
    body.classList.add("scrolls");
    const head = (...words) => element("thead", {}, element("tr", {}, ...words.map((w) => element("th", { scope: "col", class: w.endsWith(" ") ? "n" : "" }, w))));
    this.nodes = element("tbody");
    this.topics = element("tbody");
    this.nodeTable = element("table", {}, head("node", "state", "handled ", "backlog ", "behind ", "refused ", "what it says"), this.nodes);
    this.topicTable = element("table", {}, head("topic", "state", "messages ", "a second ", "silent ", "unread ", "why"), this.topics);
    this.empty = element("div", { class: "empty" }, "No node has reported yet.");
    body.append(this.nodeTable, this.topicTable, this.empty);
    this.words = element("span", { class: "figures" });
    tools.append(this.words);
  }

  draw() {
    const state = this.page.health;
    const known = state && (state.nodes.length || state.topics.length);
    this.empty.hidden = Boolean(known);
    this.nodeTable.hidden = !state?.nodes.length;
    this.topicTable.hidden = !state?.topics.length;
    if (!known) return;
    this.words.textContent = state.missed ? `${state.missed} messages came too fast for this page` : "";
    const past = Boolean(this.page.time.recording);
    fillTable(this.nodes, state.nodes.map((node) => nodeCells(node, past)));
    fillTable(this.topics, state.topics.map((topic) => topicCells(topic, past)));
  }
}

function nodeCells(node, past) {
  const gone = !node.alive && !past;
  const [sign, kind, words] = gone ? ["✕", "bad", `gone for ${duration(node.silent)}`] : (LEVEL[node.level] ?? LEVEL.error);
  const heard = node.received > 0;
  return [
    [node.name], [`${sign} ${words}`, kind],
    [heard ? String(node.received - node.backlog) : UNKNOWN, "n"],
    [heard ? String(node.backlog) : UNKNOWN, node.backlog > 20 ? "n warn" : "n"],
    [Number.isFinite(node.lag) ? `${fixed(Math.max(0, node.lag), 1)} s` : UNKNOWN, "n"],
    [heard ? String(node.rejected) : UNKNOWN, node.rejected ? "n warn" : "n"],
    [node.message, "sentence"],
  ];
}

function topicCells(topic, past) {
  const quiet = !past && topic.quiet > Math.max(5, 4 / Math.max(topic.rate, 0.02));
  const [sign, kind, words] = quiet ? ["▲", "warn", "silent"] : topic.rejected ? ["▲", "warn", "unread"] : ["●", "good", "ok"];
  return [
    [topic.name], [`${sign} ${words}`, kind], [String(topic.count), "n"],
    [past ? UNKNOWN : fixed(topic.rate, 1), "n"], [past ? UNKNOWN : duration(topic.quiet), "n"],
    [String(topic.rejected), topic.rejected ? "n warn" : "n"], [topic.reason, "sentence"],
  ];
}

function fillTable(body, rows) {
  while (body.children.length > rows.length) body.lastChild.remove();
  rows.forEach((cells, place) => {
    let line = body.children[place];
    if (!line) body.append((line = element("tr", {}, ...cells.map(() => element("td")))));
    cells.forEach(([text, kind = ""], column) => {
      const cell = line.cells[column];
      if (cell.textContent !== text) cell.textContent = text;
      if (cell.className !== kind) cell.className = kind;
    });
  });
}
