// headset.mjs BIN SAMPLE CHROMIUM SCRATCH: an emulated headset moves and closes its hand; hand/posture, which the glove
// makes of it, follows. What the robot felt in a recording shakes its controllers.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import protocol from "@foxglove/ws-protocol";
import WebSocket from "ws";
import { browse, start } from "./chromium.mjs";

const [bin, sample, chromium, scratch] = process.argv.slice(2);
setTimeout(() => { throw new Error("it takes more than five minutes"); }, 300000).unref();

const lab = ["--set", `lab.rig=headset-${process.pid}`, "--set", "glove.device=landmarks", "--set", `glove.port=127.0.0.1:${process.env.LEASED_PORT}`];
await start(`${bin}/prehend-glove`, lab, "stderr", /./);
const { line: address } = await start(`${bin}/prehend-console`, [...lab, "--set", "console.port=0"], "stdout", /http:[^\s;]+/);
const emulator = readFileSync(join(dirname(createRequire(import.meta.url).resolve("iwer")), "../build/iwer.min.js"), "utf8");
const page = await browse(chromium, `${scratch}/browser`, address, "1000,700", [], `${emulator};
  window.headset = new IWER.XRDevice(IWER.metaQuest3);
  headset.installRuntime({ forceInstall: true });
  headset.primaryInputMode = "hand";
  const request = navigator.xr.requestSession.bind(navigator.xr);
  navigator.xr.requestSession = async (...all) => (window.session = await request(...all));`);
await page.until("document.getElementById('link').textContent === 'connected'", "it is connected");
await page.until("!document.getElementById('headset').hidden", "the headset is seen");

// The newest posture in which the hand is known: fingertips on the table, m.
let tips, heard = 0;
const client = new protocol.FoxgloveClient({ ws: new WebSocket(address.replace("http", "ws"), ["foxglove.sdk.v1"]) });
let reader;
client.on("advertise", (all) => {
  const channel = all.find(({ topic }) => topic === "hand/posture");
  reader = new MessageReader(parse(channel.schema, { ros2: true }));
  client.subscribe(channel.id);
});
function rotate({ w, x, y, z }, p) {
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const t = cross([x, y, z], p).map((c) => 2 * c), u = cross([x, y, z], t);
  return p.map((c, k) => c + w * t[k] + u[k]);
}
client.on("message", ({ data }) => {
  const { x_wh: { position: o, orientation }, fingertips } = reader.readMessage(data);
  if (!fingertips.every(({ valid }) => valid)) return;
  ++heard;
  tips = fingertips.map(({ p_hf: { x, y, z } }) => rotate(orientation, [x, y, z]).map((c, k) => c + [o.x, o.y, o.z][k]));
});
const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));
// Filters have settled: three times in a row nothing has moved for half a second, or, where pictures come
// slowly, for two postures.
async function settled() {
  const end = Date.now() + 90_000;
  for (let before, had = 0, still = 0; Date.now() < end;) {
    do await new Promise((later) => setTimeout(later, 500));
    while (heard < had + 2 && Date.now() < end);
    const rests = before && tips.every((tip, f) => distance(tip, before[f]) < 5e-4);
    still = rests ? still + 1 : 0;
    if (still === 3) return tips;
    [before, had] = [tips, heard];
  }
  throw new Error(`the posture does not come to rest, ${heard} heard: ${JSON.stringify(tips)}, ${await page.evaluate("document.getElementById('hand-state').textContent")}`);
}

await page.evaluate("document.getElementById('headset-switch').click()");
await page.until("Number(document.getElementById('hand').dataset.sent) > 5", "hands are sent");
const move = (x, y, z) => page.evaluate(`(async () => {
  // As a hand moves, not as one jumps.
  const { position } = headset.hands.right, from = [position.x, position.y, position.z];
  for (let i = 1; i <= 20; ++i) {
    position.set(...from.map((value, k) => value + [${x}, ${y}, ${z}][k] * i / 20));
    await new Promise((later) => setTimeout(later, 100));
  }
})()`);
const pinch = (hand, value) => page.evaluate(`headset.hands.${hand}.updatePinchValue(bent.${hand} = ${value})`);
// Living fingers tremble; a hand that is perfectly still is no hand.
await page.evaluate(`window.bent = { left: 0, right: 0 };
  window.trembles = setInterval(() => headset.hands.right.updatePinchValue(Math.abs(bent.right - 0.004 * Math.random())), 20)`);

const first = await settled();
await move(0.05, 0, 0);
const second = await settled();
assert.ok(second.every((tip, f) => distance(tip, first[f]) < 5e-3), `without the other hand's pinch it stays: ${JSON.stringify([first, second])}`);
await pinch("left", 1);
await page.until("document.getElementById('clutch').getAttribute('aria-pressed') === 'true'", "the pinch is seen");
// Right, up and forward before the user are -y, z and x of the table.
const step = [0.08, 0.06, -0.1], wanted = [0.1, -0.08, 0.06];
// Where pictures come slowly the page loses the hand, says so, and takes hold of it anew: then once more.
await page.evaluate(`{
  const line = document.getElementById("hand-state");
  new MutationObserver(() => (window.lost ||= line.className === "bad")).observe(line, { attributes: true });
}`);
let before, after;
for (let tries = 5; tries > 0; --tries) {
  before = await settled();
  await page.evaluate("window.lost = false");
  await move(...step);
  after = await settled();
  if (!(await page.evaluate("window.lost"))) break;
  await move(...step.map((x) => -x));
}
const worst = Math.max(...after.map((tip, f) => distance(tip.map((x, k) => x - before[f][k]), wanted)));
assert.ok(worst < 5e-3, `a fingertip is off by ${1000 * worst} mm`);
await pinch("left", 0);
await page.until("document.getElementById('clutch').getAttribute('aria-pressed') === 'false'", "the other hand lets go");

// Thumb and index meet as the headset's own joints do.
await pinch("right", 1);
const closed = await settled(), open = distance(after[0], after[1]), gap = distance(closed[0], closed[1]);
const own = await page.evaluate(`new Promise((told) => {
  const section = document.getElementById("hand"), take = section.take;
  section.take = (seen) => {
    section.take = take;
    take(seen);
    told(Math.hypot(...seen.metres[4].map((x, k) => x - seen.metres[8][k])));
  };
})`);
assert.ok(Math.abs(gap - own) < 5e-3 && gap < open - 0.02, `thumb and index: ${gap} m apart, in the headset ${own} m, open ${open} m`);
// Controllers in place of hands.
await page.evaluate(`headset.primaryInputMode = "controller"`);
await page.until("[...session.inputSources].some(({ gamepad }) => gamepad.hapticActuators.length)", "controllers are seen");
await page.evaluate(`{
  window.pulses = [];
  const source = [...session.inputSources].find(({ gamepad }) => gamepad.hapticActuators.length);
  const actuator = Object.getPrototypeOf(source.gamepad.hapticActuators[0]), { pulse } = actuator;
  actuator.pulse = function (...all) { return pulses.push(all), pulse.apply(this, all); };
}`);
await start(`${bin}/prehend-replay`, [sample, "--topics", "glove/feedback", "--loop", ...lab.slice(0, 2)], "stderr", /./);
await page.until("pulses.length > 10", "what presses on the robot's fingers is felt");
for (const [strength, ms] of JSON.parse(await page.evaluate("JSON.stringify(pulses)")))
  assert.ok(strength > 0 && strength <= 1 && ms === 100, `${strength} for ${ms} ms`);
assert.deepEqual(page.complaints, [], "the browser complains");
await page.evaluate("document.getElementById('headset-switch').click()");
await page.until("document.getElementById('headset-switch').textContent === 'Start the headset'", "it has ended");
client.close();
await page.close();
console.log(`fingertips of the headset were followed, the worst off by ${(1000 * worst).toFixed(1)} mm; a pinch is ${(1000 * gap).toFixed(1)} mm, in the headset ${(1000 * own).toFixed(1)} mm`);
process.exit(0);
