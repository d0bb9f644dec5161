// The connection to the server: decodes frames, comes back by itself, sends commands.

const FIRST_PAUSE = 250; // ms
const LONGEST_PAUSE = 1000;
export const PROTOCOL = 1;

/** The frames of one message: text is one or a list; binary a length, a JSON header, a row of float32. */
export function decode(data) {
  if (typeof data === "string") return [JSON.parse(data)].flat();
  const length = new DataView(data).getUint32(0, true);
  const frame = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, length)));
  frame.row = new Float32Array(data, 4 + length);
  return [frame];
}

export class Socket {
  constructor(take, tell) {
    this.take = take;
    this.tell = tell;
    this.pause = FIRST_PAUSE;
    this.open = false;
    this.token = readToken();
    this.connect();
  }

  connect() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const path = location.pathname.replace(/[^/]*$/, "socket");
    this.link = new WebSocket(`${scheme}://${location.host}${path}`);
    this.link.binaryType = "arraybuffer";
    this.link.onopen = () => {
      this.open = true;
      this.pause = FIRST_PAUSE;
      this.tell("connected");
    };
    this.link.onmessage = (event) => decode(event.data).forEach((frame) => this.take(frame));
    this.link.onclose = (event) => {
      this.open = false;
      this.tell("gone", event.reason);
      setTimeout(() => this.connect(), this.pause);
      this.pause = Math.min(2 * this.pause, LONGEST_PAUSE);
    };
  }

  send(message) {
    if (!this.open) return false;
    this.link.send(JSON.stringify(message));
    return true;
  }

  command(fields) {
    return this.send({ ...fields, kind: "command", token: this.token });
  }
}

/** The token stands behind # in the address that was printed; it is kept for this tab. */
function readToken() {
  const given = /token=([\w-]+)/.exec(location.hash)?.[1];
  if (given) sessionStorage.setItem("token", given);
  if (given) window.history.replaceState(null, "", location.pathname + location.search);
  return given ?? sessionStorage.getItem("token") ?? "";
}
