// Four cells with views behind tabs; any view can be shown large; on a phone one at a time.

import { element, icon } from "./canvas.js";

export class Layout {
  /** cells: lists of view classes; make(viewClass, body, tools) returns the view. */
  constructor(parent, tabs, cells, make) {
    this.parent = parent;
    this.views = new Map(); // id to {cell, view, body, tools, tab, phoneTab}
    this.large = null;
    this.cells = cells.map((classes) => this.makeCell(classes, make));
    for (const [id, entry] of this.views) {
      entry.phoneTab = element("button", { role: "tab", onclick: () => this.select(id, true) }, entry.title);
      tabs.append(entry.phoneTab);
    }
    tabs.setAttribute("role", "tablist");
    for (const cell of this.cells) this.select(cell.ids[0]);
    this.markShown(this.cells[0]);
    this.phone = matchMedia("(max-width: 760px)");
    this.phone.addEventListener("change", () => this.refresh());
    this.refresh();
  }

  makeCell(classes, make) {
    const strip = element("div", { class: "strip", role: "tablist" });
    const tools = element("div", { class: "tools" });
    const enlarge = element("button", { class: "enlarge", title: "Show large, or all again (F)", "aria-label": "Show large" }, icon("large"));
    const body = element("div", { class: "body" });
    const root = element("section", { class: "cell" }, element("header", {}, strip, tools, enlarge), body);
    const cell = { root, ids: [], current: null };
    enlarge.addEventListener("click", () => this.enlarge(this.large ? null : cell.current));
    root.addEventListener("pointerdown", () => (this.focused = cell), true);
    root.addEventListener("focusin", () => (this.focused = cell));
    this.parent.append(root);
    for (const one of classes) {
      const viewBody = element("div", { class: "view", id: `view-${one.id}`, hidden: true });
      const viewTools = element("span", { hidden: true });
      body.append(viewBody);
      tools.append(viewTools);
      const tab = element("button", { role: "tab", "aria-controls": viewBody.id, onclick: () => this.select(one.id) }, one.title);
      strip.append(tab);
      const view = make(one, viewBody, viewTools);
      this.views.set(one.id, { cell, view, body: viewBody, tools: viewTools, tab, title: one.title });
      cell.ids.push(one.id);
    }
    return cell;
  }

  /** Show a view in its cell; on a phone, or if asked for, in front. */
  select(id, front = false) {
    const entry = this.views.get(id);
    if (!entry) return;
    entry.cell.current = id;
    if (front || this.phone?.matches) this.markShown(entry.cell);
    if (this.large && front) this.enlarge(id);
    this.focused = entry.cell;
    this.refresh();
  }

  markShown(cell) {
    for (const each of this.cells) each.root.classList.toggle("shown", each === cell);
  }

  enlarge(id) {
    this.large = id;
    this.parent.classList.toggle("large", id !== null);
    if (id !== null) {
      const entry = this.views.get(id);
      entry.cell.current = id;
      this.markShown(entry.cell);
    }
    this.refresh();
  }

  refresh() {
    for (const [id, entry] of this.views) {
      const current = entry.cell.current === id;
      entry.body.hidden = entry.tools.hidden = !current;
      entry.tab.setAttribute("aria-selected", current);
      const front = current && entry.cell.root.classList.contains("shown");
      entry.phoneTab?.setAttribute("aria-selected", front);
      if (front && this.phone?.matches) entry.phoneTab?.scrollIntoView({ inline: "nearest", block: "nearest" });
    }
    this.parent.dispatchEvent(new Event("redraw", { bubbles: true }));
  }

  /** The views that can be seen now. */
  *visible() {
    for (const [id, entry] of this.views) {
      if (entry.cell.current === id && entry.body.offsetParent !== null) yield entry.view;
    }
  }
}
