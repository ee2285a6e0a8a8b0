// The Foxglove WebSocket, as far as the page needs it: JSON channels, by their topic.
const retryAfter = 1000;
const noticeFor = 3000;

export class Connection {
  // topics: {topic: message => ...}; state: told «connected» or why not, and whether it is a new one;
  // playback: of a recording, {begin, take}.
  constructor(address, topics, state, playback) {
    this.address = address;
    this.topics = topics;
    this.state = state;
    this.playback = playback;
    this.open();
  }

  open() {
    const socket = new WebSocket(this.address, ["foxglove.sdk.v1", "foxglove.websocket.v1"]);
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.byId = new Map();
    socket.onopen = () => this.state("connected", true, true);
    socket.onmessage = (event) =>
      typeof event.data === "string" ? this.hear(socket, JSON.parse(event.data)) : this.take(event.data);
    socket.onclose = () => {
      this.state("not connected; trying again", false);
      setTimeout(() => this.open(), retryAfter);
    };
  }

  hear(socket, message) {
    if (message.op === "serverInfo") {
      // Another console than the one that gave this page: its token is another, too.
      if (this.session !== undefined && this.session !== message.sessionId) return location.reload();
      this.session = message.sessionId;
      if (message.dataStartTime) this.playback.begin(message.dataStartTime, message.dataEndTime);
    }
    if (message.op === "status") this.notice(socket, message.message);
    if (message.op !== "advertise") return;
    const subscriptions = [];
    for (const channel of message.channels) {
      const take = this.topics[channel.topic];
      if (!take || channel.encoding !== "json") continue;
      this.byId.set(channel.id, take);
      subscriptions.push({ id: channel.id, channelId: channel.id });
    }
    socket.send(JSON.stringify({ op: "subscribe", subscriptions }));
  }

  // Shown for a while: what was missed once is over.
  notice(socket, text) {
    this.state(text, true);
    clearTimeout(this.over);
    this.over = setTimeout(() => {
      if (socket.readyState === WebSocket.OPEN) this.state("connected", true);
    }, noticeFor);
  }

  send(bytes) {
    if (this.socket.readyState === WebSocket.OPEN) this.socket.send(bytes);
  }

  take(bytes) {
    const view = new DataView(bytes);
    if (view.getUint8(0) === 5) this.playback.take(view);
    if (view.getUint8(0) !== 1) return;
    const take = this.byId.get(view.getUint32(1, true));
    if (take) take(JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 13))));
  }
}
