// Prehend's console: what the lab says, drawn from the newest message at each frame.
import { Connection } from "./connection.js";
import { showConsent } from "./consent.js";
import { setUpOrders, showObject, showReply, showWhoObeys } from "./orders.js";
import { setUpHand } from "./hand.js";
import { forgetLists, showLag, showLatency, showLink, showLog, showReport, showStatus, showTraining } from "./panels.js";
import { Picture } from "./picture.js";
import { Playback } from "./playback.js";
import { Plots } from "./plots.js";
import { keepReport, setUpSaving } from "./save.js";
import { Touch } from "./touch.js";
import { World } from "./world.js";

let world;
try {
  world = new World(document.getElementById("view"));
  world.canvas.where = (name) => world.where(name);
} catch {
  // Without WebGL the rest is still worth looking at.
  document.getElementById("legend").textContent = "This browser draws nothing in three dimensions (WebGL).";
}
const picture = new Picture(document.getElementById("camera"));
const plots = new Plots(document.getElementById("plots"));
const touch = new Touch(document.getElementById("sound"));

// Kept until the page is drawn, which a hidden one is not: the newest of each frame and entity.
const transforms = new Map();
const updates = new Map();
let handStamp;
let lag;
const isLink = ({ id, frame_id }) => !id.startsWith("object/") && id.endsWith(`/${frame_id}`);

function draw() {
  if (world) {
    if (transforms.size) world.transforms({ transforms: [...transforms.values()] });
    for (const update of updates.values()) world.update(update);
    transforms.clear();
    updates.clear();
    world.draw();
    if (handStamp !== undefined) {
      lag = Date.now() - handStamp;
      world.canvas.dataset.lag = lag.toFixed(1);
    }
    handStamp = undefined;
  }
  picture.draw();
  playback.draw();
  requestAnimationFrame(draw);
}

const playback = new Playback(() => {
  forgetLists();
  transforms.clear();
  updates.clear();
  world?.clear();
});

const topics = {
  "/tf": (message) => {
    for (const t of message.transforms) {
      transforms.set(t.child_frame_id, t);
      if (t.child_frame_id === world?.hand) handStamp = t.timestamp.sec * 1000 + t.timestamp.nsec / 1e6;
    }
  },
  "/scene": ({ deletions, entities }) => {
    for (const gone of deletions) updates.set(gone.id, { deletions: [gone], entities: [] });
    for (const entity of entities) {
      updates.set(entity.id, { deletions: [], entities: [entity] });
      // The first link that is told of is a hand's base: HAND/LINK in the frame LINK.
      if (world && !world.hand && isLink(entity)) world.hand = entity.frame_id;
      if (entity.id.startsWith("object/")) showObject(entity.id.slice("object/".length));
    }
  },
  "/camera/image": (message) => picture.show(message),
  "/camera/annotations": (message) => picture.annotate(message),
  "/grasp/report": (report) => {
    showReport(report);
    keepReport(report);
  },
  "/status": (status) => {
    showStatus(status);
    showWhoObeys(status);
    showConsent(status);
  },
  "/latency": (message) => {
    showLatency(message);
    plots.latency(message);
  },
  "/signals": (message) => {
    plots.show(message);
    touch.show(message);
  },
  "/training": showTraining,
  "/log": showLog,
  "/operator/reply": showReply,
};

const scheme = location.protocol === "https:" ? "wss:" : "ws:";
playback.connection = new Connection(`${scheme}//${location.host}/`, topics, (text, good, opened) => {
  if (opened) forgetLists();
  showLink(text, good);
}, playback);
// Where the clocks of lab and browser differ by hours, as in a recording, an age says nothing.
setInterval(() => showLag(lag !== undefined && Math.abs(lag) < 60000 ? lag : undefined), 250);
setUpOrders();
setUpSaving(world && (() => world.draw()));
for (const [id, look] of [["near", "lookNear"], ["all", "lookAtAll"]])
  document.getElementById(id).onclick = () => world?.[look]();
setUpHand(() => world?.anObject(), touch);
requestAnimationFrame(draw);
