// The connection to the server: messages out, messages in, and again when it breaks.

import { decode } from "./message.js";

/** Number of the protocol that these files speak. */
const PROTOCOL = 1;
/** First and longest wait before the next attempt in ms. */
const WAITS = [500, 5000];

/**
 * Connects for good. `on.scene(message)`, `on.frame(message)`, `on.error(text)`, `on.welcome(number)`,
 * `on.state(connected, text)`. Returns `send(command)`, which is silent while there is no connection.
 */
export function connect(on) {
  let socket = null;
  let wait = WAITS[0];

  async function reason() {
    try {
      const { clients, limit } = await (await fetch("/status")).json();
      return clients >= limit ? `${limit} others look already; waiting for a place …` : "connection lost, trying again …";
    } catch {
      return "connection lost, trying again …";
    }
  }

  function open() {
    const address = new URL("/socket", location.href);
    address.protocol = address.protocol.replace("http", "ws");
    socket = new WebSocket(address);
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      wait = WAITS[0];
      on.state(true, "connected");
    };
    socket.onmessage = ({ data }) => {
      if (typeof data === "string") {
        const message = JSON.parse(data);
        if (message.kind === "welcome") on.welcome(message.you);
        else on.error(message.message);
        return;
      }
      const message = decode(data);
      if (message.header.kind === "frame") {
        on.frame(message);
      } else if (message.header.protocol === PROTOCOL) {
        on.scene(message);
      } else {
        // The server is another one than the page came from.
        location.reload();
      }
    };
    socket.onclose = async () => {
      on.state(false, await reason());
      setTimeout(open, wait);
      wait = Math.min(2 * wait, WAITS[1]);
    };
  }

  open();
  return (command) => {
    if (socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify(command));
  };
}
