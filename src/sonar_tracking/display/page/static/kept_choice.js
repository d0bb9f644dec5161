// Choices of a view that are kept from one visit to the next.

import { element } from "./canvas.js";

/** A select whose choice is kept; options: {value: words}. */
export function keptSelect(name, title, options, fallback, act) {
  const select = element("select", { title, "aria-label": title });
  for (const [value, words] of Object.entries(options)) select.append(element("option", { value }, words));
  const kept = localStorage.getItem(name);
  select.value = kept !== null && kept in options ? kept : fallback;
  select.addEventListener("change", () => {
    localStorage.setItem(name, select.value);
    act();
  });
  return select;
}

/** A button that is on or off, which is kept; without a text it says which. */
export function keptToggle(name, text, title, fallback, act) {
  const button = element("button", { title, "aria-label": title }, text);
  const show = () => {
    button.classList.toggle("on", button.isOn);
    button.setAttribute("aria-pressed", button.isOn);
    if (text === "") button.textContent = button.isOn ? "on" : "off";
  };
  button.isOn = (localStorage.getItem(name) ?? String(fallback)) === "true";
  button.addEventListener("click", () => {
    button.isOn = !button.isOn;
    localStorage.setItem(name, String(button.isOn));
    show();
    act();
  });
  show();
  return button;
}

/** Keep the options of a select to what there is now: [value, words] each. */
export function offer(select, entries) {
  const key = JSON.stringify(entries);
  if (select.offered === key) return;
  select.offered = key;
  const before = select.value;
  select.replaceChildren(...entries.map(([value, words]) => element("option", { value }, words)));
  if (entries.some(([value]) => value === before)) select.value = before;
}

/** A button that opens a list of further choices: [words, control] each. */
export function moreChoices(...rows) {
  const list = element("div", { class: "menu more", popover: "auto" });
  for (const [words, control] of rows) list.append(element("label", {}, element("span", {}, words), control));
  const button = element("button", { title: "More choices", "aria-label": "More choices" }, "…");
  button.addEventListener("click", () => {
    list.togglePopover();
    const [box, own] = [button.getBoundingClientRect(), list.getBoundingClientRect()];
    list.style.left = `${Math.max(4, Math.min(box.right - own.width, innerWidth - own.width - 4))}px`;
    list.style.top = `${Math.min(box.bottom + 4, innerHeight - own.height - 4)}px`;
  });
  document.body.append(list);
  return button;
}
