// A pointer for who has no mouse: in a picture that has the focus, keys do what a hand would.
//
// Ctrl and the arrows move it, Enter is a click, with Shift a cursor, M opens the menu. The views
// hear the events of a mouse, and know nothing of keys.

const STEP = 8; // CSS pixels
const FAR = 48; // with Shift
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

export function listenToKeys(canvas) {
  canvas.tabIndex = 0;
  let place = null;
  const send = (kind, type, shiftKey = false) => {
    const box = canvas.getBoundingClientRect();
    const [clientX, clientY] = [box.left + place.x, box.top + place.y];
    canvas.dispatchEvent(new kind(type, { clientX, clientY, shiftKey, detail: 1, bubbles: true, cancelable: true }));
  };
  const move = ([dx, dy], step) => {
    const within = (value, size) => Math.min(Math.max(value, 1), size - 1);
    place = { x: within(place.x + dx * step, canvas.clientWidth), y: within(place.y + dy * step, canvas.clientHeight) };
    send(PointerEvent, "pointermove");
  };
  canvas.addEventListener("pointermove", (event) => {
    if (event.isTrusted) place = { x: event.offsetX, y: event.offsetY };
  });
  canvas.addEventListener("keydown", (event) => {
    place ??= { x: canvas.clientWidth / 2, y: canvas.clientHeight / 2 };
    if (event.ctrlKey && ARROWS[event.key]) move(ARROWS[event.key], event.shiftKey ? FAR : STEP);
    else if (event.key === "Enter") send(MouseEvent, "click", event.shiftKey);
    else if (event.key === "ContextMenu" || (event.key.toLowerCase() === "m" && !event.ctrlKey)) send(MouseEvent, "contextmenu");
    else return;
    event.preventDefault();
    event.stopPropagation();
  });
  canvas.addEventListener("blur", () => place && send(PointerEvent, "pointerleave"));
}
