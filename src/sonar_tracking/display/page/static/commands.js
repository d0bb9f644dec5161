// What an operator commands: sent with the token of the page, answered by a sentence.

import { element } from "./canvas.js";

export class Commands {
  constructor(socket, toast) {
    this.socket = socket;
    this.toast = toast;
    this.allowed = false;
  }

  /** Whether this page may command: only with the token of the printed address. */
  get possible() {
    return this.allowed && this.socket.token !== "";
  }

  explain() {
    this.toast("Read only: open the page by the address that was printed, with its token, to command.");
  }

  send(fields) {
    if (!this.possible) {
      this.explain();
    } else if (!this.socket.command(fields)) {
      this.toast("Not sent: there is no connection.");
    }
  }
}

/** A menu at a place: a list of [words, act]. */
export function openMenu(x, y, title, entries) {
  closeMenu();
  const menu = element("div", { class: "menu", role: "menu" }, element("strong", {}, title));
  for (const [words, act] of entries) {
    const button = element("button", { role: "menuitem", onclick: () => { closeMenu(); act(); } }, words);
    menu.append(button);
  }
  document.body.append(menu);
  const box = menu.getBoundingClientRect();
  menu.style.left = `${Math.max(4, Math.min(x, innerWidth - box.width - 4))}px`;
  menu.style.top = `${Math.max(4, Math.min(y, innerHeight - box.height - 4))}px`;
  menu.querySelector("button")?.focus();
  menu.addEventListener("keydown", (event) => {
    const buttons = [...menu.querySelectorAll("button")];
    const place = buttons.indexOf(document.activeElement);
    if (event.key === "ArrowDown") buttons[(place + 1) % buttons.length].focus();
    else if (event.key === "ArrowUp") buttons[(place + buttons.length - 1) % buttons.length].focus();
    else if (event.key === "Escape") closeMenu();
    else return;
    event.stopPropagation();
    event.preventDefault();
  });
  setTimeout(() => addEventListener("pointerdown", outside, true));
}

function outside(event) {
  if (!event.target.closest?.("[role=menu]")) closeMenu();
}

export function closeMenu() {
  removeEventListener("pointerdown", outside, true);
  document.querySelector("[role=menu]")?.remove(); // lists of choices look alike
}
