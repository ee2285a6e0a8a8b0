// webcam.mjs BIN CHROMIUM SCRATCH DATA: the page's hand tracking on the recorded video of a right hand as
// camera; then the points of that recording take the page's own way and close a robot hand.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";
import { browse, start } from "./chromium.mjs";

const [bin, chromium, scratch, data] = process.argv.slice(2);
setTimeout(() => { throw new Error("it takes more than five minutes"); }, 300000).unref();
const rate = 30;  // Hz, of the video and its points
const address = `127.0.0.1:${process.env.LEASED_PORT}`;  // where it hears the page

const rows = readFileSync(`${data}/human_joint_right.csv`, "utf8").trim().split("\n").slice(1)
  .map((line) => line.split(",").slice(1).map(Number))
  .map((n) => Array.from({ length: 21 }, (_, i) => n.slice(3 * i, 3 * i + 3)));

// Pictures of the video, each for some seconds, as a camera that Chromium plays over and over.
const shown = [60, 150, 240, 330, 420, 510];
async function makeCamera() {
  const page = await browse(chromium, `${scratch}/player`, "about:blank");
  const video = readFileSync(`${data}/human_hand_video.mp4`, "base64");
  await page.evaluate(`(async () => {
    window.video = document.createElement("video");
    video.src = "data:video/mp4;base64,${video}";
    await new Promise((done, failed) => { video.onloadeddata = done; video.onerror = () => failed(video.error); });
  })()`);
  const pictures = [];
  for (const row of shown)
    pictures.push(Buffer.from(await page.evaluate(`new Promise((done) => {
      video.onseeked = () => {
        const canvas = Object.assign(document.createElement("canvas"), { width: 640, height: 360 });
        canvas.getContext("2d").drawImage(video, 0, 0, 640, 360);
        done(canvas.toDataURL("image/jpeg", 0.9).split(",")[1]);
      };
      video.currentTime = ${(row + 0.5) / rate};
    })`), "base64"));
  await page.close();
  const file = `${scratch}/camera.mjpeg`;
  writeFileSync(file, Buffer.concat(pictures.flatMap((picture) => Array(4 * rate).fill(picture))));
  return file;
}

// In the frame of wrist, middle knuckle, index and little knuckle; as the glove has it.
const minus = (a, b) => a.map((x, k) => x - b[k]);
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const unit = (a) => a.map((x) => x / Math.hypot(...a));
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
function inHand(points) {
  const x = unit(minus(points[9], points[0])), z = unit(cross(x, minus(points[5], points[17]))), y = cross(z, x);
  return points.map((p) => [x, y, z].map((axis) => dot(axis, minus(p, points[0]))));
}
const median = (all) => [...all].sort((a, b) => a - b)[all.length >> 1];
const errorOf = (seen, row) => {
  const a = inHand(seen), b = inHand(row);
  return median(a.map((p, i) => Math.hypot(...minus(p, b[i]))));
};

async function track() {
  const camera = await makeCamera();
  const { line, child } = await start(`${bin}/prehend-console`,
    ["--set", "console.port=0", "--set", "glove.device=landmarks", "--set", `glove.port=${address}`,
      "--set", `lab.rig=webcam-${process.pid}`], "stdout", /http:[^\s;]+/);
  const page = await browse(chromium, `${scratch}/browser`, line, "1280,800",
    ["--use-fake-ui-for-media-stream", "--use-fake-device-for-media-stream", `--use-file-for-fake-video-capture=${camera}`]);
  await page.until("document.getElementById('link').textContent === 'connected'", "it is connected");
  await page.evaluate(`{
    const section = document.getElementById("hand"), take = section.take;
    window.seen = [];
    section.take = (one) => { seen.push(one); take(one); };
    document.getElementById("webcam-switch").click();
  }`);
  await page.until("window.seen.length >= 12 || document.getElementById('hand-state').className === 'bad' && !window.Hands",
                   "twelve pictures are tracked", 200);
  const seen = JSON.parse(await page.evaluate("JSON.stringify(seen)"));
  assert.ok(seen.length >= 12, await page.evaluate("document.getElementById('hand-state').textContent"));
  assert.ok(Number(await page.evaluate("document.getElementById('hand').dataset.sent")) > 0, "nothing was sent");
  assert.deepEqual(page.complaints, [], "the browser complains");
  await page.close();
  child.removeAllListeners("exit");
  child.kill();
  for (const { left } of seen) assert.equal(left, false, "it is a right hand");
  const errors = seen.map(({ metres }) => Math.min(...shown.map((row) => errorOf(metres, rows[row]))));
  const worst = 1000 * median(errors);
  assert.ok(worst < 6, `joints are off by ${worst} mm`);
  return `${seen.length} pictures tracked, joints off by ${worst.toFixed(1)} mm (median)`;
}

// The recording's hand, which is open and closes to a fist, as if tracked: open for 4 s, closed for 5 s. The lab
// holds it where its scene has it. It is never quite still, as no tracked one is.
const open = 285, fist = 270;
async function grasp() {
  const { line, child } = await start(`${bin}/prehend`, ["demo", "--watch", "--json", "--seed", "3", "--timeout", "150",
    "--glove", `landmarks:${address}`, "--set", "console.port=0"], "stderr", /http:[^\s;]+/);
  const outcome = new Promise((told) => child.stdout.on("data", (bytes) => {
    const text = String(bytes);
    if (text.startsWith("{")) told(JSON.parse(text));
  }));
  const page = await browse(chromium, `${scratch}/lab`, line, "900,600");
  await page.until("/glove/.test(document.getElementById('services').innerText)", "the glove is there");
  await page.evaluate(`{
    document.getElementById("hand-place").value = "hand";
    const rows = ${JSON.stringify(rows.map((row) => row.map((p) => p.map((x) => Number(x.toFixed(5))))))};
    const section = document.getElementById("hand"), begin = performance.now();
    const play = () => {
      const time = (performance.now() - begin) / 1000 % 10, closed = Math.min(1, Math.max(0, time - 4));
      const metres = rows[Math.round(${open} + closed * ${fist - open})].map((p) => p.map((x) => x + 6e-4 * (Math.random() - 0.5)));
      const picture = metres.map(([x, y, z]) => ({ x: 0.5 + 0.87 * x / (0.5 + z), y: 0.5 + 0.87 * y / (0.5 + z) * 16 / 9 }));
      section.take({ picture, metres, left: false, score: 1, ratio: 16 / 9, at: performance.now() });
    };
    setInterval(play, 1000 / ${rate});
  }`);
  const { grasp, glove } = await outcome;
  await page.close();
  const ended = new Promise((done) => child.removeAllListeners("exit").on("exit", done));
  child.kill("SIGINT");
  await ended;
  assert.equal(glove.device, "landmarks");
  assert.ok(grasp.contacts > 0, `nothing was touched: ${JSON.stringify(grasp)}`);
  return `the hand of the recording closed on an object: ${grasp.contacts} contacts, held: ${grasp.held}`;
}

console.log(await track());
console.log(await grasp());
process.exit(0);
