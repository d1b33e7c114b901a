// The WebSocket to the server: hello, numbered messages, frames, and a new try when it is lost.

const PROTOCOL = 1;
const FIRST_WAIT_MS = 300, MOST_WAIT_MS = 3000;

/** Splits a binary frame into its JSON header and the bytes behind it. */
export function splitFrame(buffer) {
  const size = new DataView(buffer).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 4, size)));
  return { header, bytes: new Uint8Array(buffer, 4 + size) };
}

export class Connection {
  /** @param handlers  {message(object), frame(header, bytes), open(), lost()} */
  constructor(handlers) {
    this.handlers = handlers;
    this.wait = FIRST_WAIT_MS;
    this.number = 0;
    this.open();
  }

  open() {
    const scheme = location.protocol === "https:" ? "wss:" : "ws:";
    this.socket = new WebSocket(`${scheme}//${location.host}/socket${location.search}`);
    this.socket.binaryType = "arraybuffer";
    this.number = 0;
    this.socket.onopen = () => {
      this.wait = FIRST_WAIT_MS;
      this.send({ type: "hello", protocol: PROTOCOL });
      this.handlers.open();
    };
    this.socket.onmessage = ({ data }) => {
      if (typeof data === "string") return this.handlers.message(JSON.parse(data));
      const { header, bytes } = splitFrame(data);
      this.handlers.frame(header, bytes);
    };
    this.socket.onclose = () => {
      this.handlers.lost();
      setTimeout(() => this.open(), this.wait);
      this.wait = Math.min(MOST_WAIT_MS, 1.6 * this.wait);
    };
  }

  /** Sends a message and returns its number; 0 if there is no connection. */
  send(message) {
    if (this.socket.readyState !== WebSocket.OPEN) return 0;
    this.socket.send(JSON.stringify({ ...message, n: ++this.number }));
    return this.number;
  }
}
