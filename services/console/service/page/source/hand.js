// A hand before the webcam as glove: tracked in the browser, sent to the console, which hands it on.
// Pictures never leave the browser.
import { calibrated, calibrationOf, Clutch, placeOf, pointsAt } from "./hand-math.js";
import { hasHeadset, startHeadset } from "./headset.js";

const byId = (id) => document.getElementById(id);
const token = document.querySelector('meta[name="prehend-token"]').content;
const refusal = document.querySelector('meta[name="prehend-no-hand"]').content;
const lostAfter = 300;  // ms
const minScore = 0.6;
const kept = "prehend-hand";
const postures = [["open", "Hold your hand open"], ["fist", "Make a fist"], ["pinch", "Put thumb and index together"]];
const bones = [[0, 1, 2, 3, 4], [0, 5, 6, 7, 8], [5, 9, 10, 11, 12], [9, 13, 14, 15, 16], [13, 17, 18, 19, 20], [0, 17]];

class Tracker {
  // start: where the hand is first, m on the table.
  constructor(start) {
    this.clutch = new Clutch(start);
    this.calibration = JSON.parse(localStorage.getItem(kept) ?? "{}");
    this.seen = this.sent = 0;
    this.sending = false;
    this.heard = -Infinity;
    setInterval(() => this.watch(), 100);
  }

  say(text, bad = false) {
    const line = byId("hand-state");
    if (line.textContent !== text) line.textContent = text;
    line.className = bad ? "bad" : "";
  }

  // One hand: picture {x, y} from 0 to 1 and metres [x, y, z] of 21 points; when in performance.now(). Who
  // knows real metres says the place himself.
  take({ picture, metres, place: known, left, score, ratio, at }) {
    if (!(score >= minScore)) return this.lose("the hand is not seen clearly");
    const place = known ?? placeOf(picture, metres, ratio);
    if (!place) return this.lose("the hand is not seen whole");
    this.heard = at;
    ++this.seen;
    this.collecting?.(metres);
    const room = byId("hand-place").value === "room";
    const points = known ? metres : calibrated(metres, this.calibration);
    this.send({ hand: left ? "left" : "right", origin: room ? "room" : "hand",
                points_m: room ? pointsAt(points, this.clutch.follow(place)) : points }, at);
  }

  // Not told: the glove then says that it is not heard, and the robot's hand stays where it is.
  lose(why) {
    this.clutch.lose();
    this.say(why, true);
  }

  watch() {
    if (!this.running) return;
    const silence = performance.now() - this.heard;
    if (silence > lostAfter) this.lose("no hand is seen: show one");
  }

  // One at a time: a slow lab gets the newest, not a queue.
  async send(hand, at) {
    if (this.sending) return;
    this.sending = true;
    try {
      const age_s = Math.min(0.3, Math.max(0, (performance.now() - at) / 1000));
      const points_m = hand.points_m.map((p) => p.map((x) => Number(x.toFixed(5))));
      const response = await fetch("/hand", {
        method: "POST",
        headers: { "X-Prehend-Token": token, "Content-Type": "application/json" },
        body: JSON.stringify({ ...hand, points_m, age_s }),
      });
      if (!response.ok) throw new Error((await response.text()).trim());
      byId("hand").dataset.sent = String(++this.sent);
      if (!this.collecting) this.say(`${hand.hand} hand, ${this.rate()} pictures a second`);
    } catch (error) {
      this.say(error.message, true);
    }
    this.sending = false;
  }

  rate() {
    const now = performance.now();
    this.times = [...(this.times ?? []).filter((time) => now - time < 2000), now];
    return ((this.times.length - 1) / Math.max(0.2, (now - this.times[0]) / 1000)).toFixed(0);
  }

  // Three postures, each held for a while.
  async calibrate() {
    const measured = {};
    for (const [name, words] of postures) {
      this.say(`${words}, and hold it`);
      await new Promise((later) => setTimeout(later, 2000));
      const all = [];
      await new Promise((done) => (this.collecting = (metres) => all.push(metres) >= 15 && done()));
      measured[name] = all[0].map((_, i) => [0, 1, 2].map((k) =>
        all.map((points) => points[i][k]).sort((a, b) => a - b)[all.length >> 1]));
    }
    this.collecting = undefined;
    const found = calibrationOf(measured);
    if (found.refused) return this.say(`not calibrated: ${found.refused}`, true);
    this.calibration = found;
    localStorage.setItem(kept, JSON.stringify(found));
    this.say(`calibrated: your hand is ${(100 / found.scale).toFixed(0)} % of the usual size`);
  }

  lead(on) {
    this.clutch.on = on;
    this.clutch.lose();
    byId("clutch").setAttribute("aria-pressed", String(on));
    byId("clutch").textContent = on ? "Leading" : "Lead";
  }
}

function draw(canvas, video, points) {
  const context = canvas.getContext("2d");
  [canvas.width, canvas.height] = [320, Math.round(320 * video.videoHeight / video.videoWidth)];
  context.drawImage(video, 0, 0, canvas.width, canvas.height);
  context.strokeStyle = "#39d";
  context.lineWidth = 2;
  for (const bone of points ? bones : []) {
    context.beginPath();
    for (const i of bone) context.lineTo(points[i].x * canvas.width, points[i].y * canvas.height);
    context.stroke();
  }
}

function load(address) {
  return new Promise((done, failed) => {
    const script = document.createElement("script");
    script.src = address;
    script.onload = done;
    script.onerror = async () => failed(new Error(`hand tracking ${(await (await fetch(address)).text()).trim()}`));
    document.head.append(script);
  });
}

async function startWebcam(tracker) {
  tracker.say("starting; the first time takes a while");
  if (!window.Hands) await load("/hands/hands.js");
  const stream = await navigator.mediaDevices.getUserMedia({ video: { width: 640, height: 360 } });
  const video = Object.assign(document.createElement("video"), { srcObject: stream, muted: true, playsInline: true });
  await video.play();
  const hands = new window.Hands({ locateFile: (name) => `/hands/${name}` });
  hands.setOptions({ maxNumHands: 1, modelComplexity: 1, minDetectionConfidence: 0.6, minTrackingConfidence: 0.6 });
  let taken = 0;  // when the picture was
  hands.onResults(({ multiHandLandmarks: [picture], multiHandWorldLandmarks: [world], multiHandedness: [side] }) => {
    draw(byId("webcam"), video, picture);
    if (!picture) return;
    // Its label is meant for mirrored pictures: what it calls left is a right hand.
    byId("hand").take({ picture, metres: world.map(({ x, y, z }) => [x, y, z]), left: side.label === "Right",
                        score: side.score, ratio: video.videoWidth / video.videoHeight, at: taken });
  });
  const next = async () => {
    if (!tracker.running) return;
    taken = performance.now();
    await hands.send({ image: video });
    video.requestVideoFrameCallback ? video.requestVideoFrameCallback(next) : requestAnimationFrame(next);
  };
  tracker.running = true;
  tracker.stop = () => {
    tracker.running = false;
    for (const track of stream.getTracks()) track.stop();
    hands.close();
  };
  next();
}

// where: asked for the place of a frame of the scene. touch: shakes a headset's controllers.
export function setUpHand(where, touch) {
  if (!token) return;
  const section = byId("hand");
  section.hidden = false;
  const start = () => {
    const object = where();
    return object ? [object[0] - 0.2, object[1], object[2] + 0.05] : [-0.2, 0, 0.15];
  };
  const tracker = new Tracker(start());
  // Tests listen here, and play recorded points.
  section.take = (seen) => tracker.take(seen);
  const buttons = ["webcam", "headset"].map((source) => byId(`${source}-switch`));
  // source: which of the two runs; nothing: none.
  const set = (source) => {
    byId("clutch").disabled = !source;
    byId("calibrate").disabled = byId("webcam").hidden = source !== "webcam";
    for (const button of buttons) {
      const own = button.id === `${source}-switch`;
      button.disabled = Boolean(source && !own);
      button.textContent = `${own ? "Stop" : "Start"} the ${button.id.split("-")[0]}`;
    }
  };
  hasHeadset().then((there) => (byId("headset").hidden = !there));
  if (refusal) {
    for (const button of buttons) button.disabled = true;
    return tracker.say(refusal);
  }
  const over = () => {
    tracker.running = false;
    tracker.lead(false);
    set();
    tracker.say("");
  };
  const startBy = {
    webcam: () => startWebcam(tracker),
    headset: () => startHeadset(tracker, (seen) => section.take(seen), over, touch),
  };
  for (const [source, begin] of Object.entries(startBy))
    byId(`${source}-switch`).onclick = async ({ target }) => {
      if (tracker.running) {
        tracker.stop();
        return over();
      }
      target.disabled = true;
      try {
        tracker.clutch.at = start();
        await begin();
        set(source);
      } catch (error) {
        tracker.say(error.message, true);
      }
      target.disabled = false;
    };
  byId("clutch").onclick = () => tracker.lead(!tracker.clutch.on);
  byId("webcam").tabIndex = 0;
  byId("webcam").onkeydown = (event) => {
    if (event.key === " ") tracker.lead(!tracker.clutch.on), event.preventDefault();
  };
  byId("calibrate").onclick = () => tracker.calibrate();
}
