// A recording's time line: where it is, and how it shall go on. All who look see the same.
const byId = (id) => document.getElementById(id);
const seconds = ({ sec, nsec }) => sec + nsec / 1e9;
const step = 1 / 30;  // s

// 71.25 is 1:11.3
const clock = (s) => `${Math.floor(s / 60)}:${(s % 60).toFixed(1).padStart(4, "0")}`;

// The bytes of a request: to play, to pause or only to be told, speed, and where to.
const [play, pause, ask] = [0, 1, 2];
function request(command, speed, seek) {
  const view = new DataView(new ArrayBuffer(19));
  view.setUint8(0, 3);
  view.setUint8(1, command);
  view.setFloat32(2, speed, true);
  view.setUint8(6, seek === undefined ? 0 : 1);
  view.setBigUint64(7, seek ?? 0n, true);
  return view.buffer;
}

export class Playback {
  // anew: what was shown before is of another time.
  constructor(anew) {
    this.anew = anew;
    this.playing = true;
    this.held = false;  // by the slider
    const line = byId("time");
    line.oninput = () => {
      this.held = true;
      this.show(Number(line.value));
      this.lead(this.playing, Number(line.value));
    };
    line.onchange = () => (this.held = false);
    byId("play").onclick = () => this.lead(!this.playing);
    byId("step").onclick = () => this.lead(false, Number(line.value) + step);
    byId("speed").onchange = () => this.lead(this.playing);
  }

  begin(from, to) {
    this.start = BigInt(from.sec) * 1000000000n + BigInt(from.nsec);
    byId("time").max = String(seconds(to) - seconds(from));
    byId("playback").hidden = false;
    this.connection.send(request(ask, 1));
  }

  lead(plays, to) {
    this.playing = plays;  // so that the next order, which may come before the answer, does not end it
    const seek = to === undefined ? undefined : this.start + BigInt(Math.round(to * 1e9));
    this.connection.send(request(plays ? play : pause, Number(byId("speed").value), seek));
  }

  take(view) {
    const status = view.getUint8(1), now = view.getBigUint64(2, true);
    if (view.getUint8(14)) this.anew();
    this.playing = status !== 1;
    byId("play").textContent = this.playing ? "Pause" : "Play";
    // Between two messages it goes on by itself.
    this.base = { at: performance.now(), time: Number(now - this.start) / 1e9,
                  rate: status === 0 ? view.getFloat32(10, true) : 0 };
  }

  draw() {
    if (!this.base || this.held) return;
    const { at, time, rate } = this.base;
    const line = byId("time");
    const now = Math.min(time + rate * (performance.now() - at) / 1000, Number(line.max));
    line.value = String(now);
    this.show(now);
  }

  show(time) {
    const text = `${clock(time)} of ${clock(Number(byId("time").max))}`;
    if (byId("clock").textContent !== text) byId("clock").textContent = text;
    byId("time").setAttribute("aria-valuetext", text);
  }
}
