// browser.mjs CONSOLE SAMPLE CHROMIUM SCRATCH PICTURE: what the page of a recording shows, and that it is
// led. A dump at load would come before the first message, so it is asked until it shows all.
import assert from "node:assert/strict";
import { writeFileSync } from "node:fs";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import protocol from "@foxglove/ws-protocol";
import WebSocket from "ws";
import { accessible } from "./accessible.mjs";
import { browse, start } from "./chromium.mjs";

const [console_, sample, chromium, scratch, picture] = process.argv.slice(2);
setTimeout(() => { throw new Error("it takes more than two minutes"); }, 120000).unref();

const { line: address } =
  await start(console_, ["--recording", sample, "--set", "console.port=0"], "stdout", /http.*/);
const page = await browse(chromium, scratch, address);
const html = "document.documentElement.outerHTML";
for (const wanted of [/<p id="link"[^>]*>connected<\/p>/, /<p id="grasp"[^>]*>[A-Za-z ]+: ε [0-9.]+, [0-9]+ contacts/,
                      /<section id="orders"[^>]* hidden/, /<canvas id="view"[^>]* data-frames="[1-9]/,
                      /<canvas id="view"[^>]* data-links="[1-9]/, /<canvas id="camera"[^>]* data-pictures="[1-9]/,
                      /aria-label="joints of hand[^>]* data-points="[1-9]/,
                      /aria-label="fingertips of[^>]* data-points="[1-9]/])
  await page.until(`${wanted}.test(${html})`, wanted);

// What would be saved, instead of a file.
await page.evaluate(`URL.createObjectURL = (blob) => (blob.text().then((text) => (window.saved = text)), (window.blob = blob), "data:,");`);
await page.evaluate("document.getElementById('csv').click()");
await page.until("/^object,epsilon.*\\n\"[A-Za-z ]+\",[0-9.]+/.test(window.saved)", "the contacts can be saved");
await page.evaluate("document.getElementById('png').click()");
await page.until("window.blob.type === 'image/png'", "the picture can be saved");
assert.equal(await page.evaluate("createImageBitmap(window.blob).then(({ height }) => height - document.getElementById('view').height)"),
             40, "it has a line of figures");

// Held still just after the grasp, wherever it was before.
const time = "Number(document.getElementById('time').value)";
const reports = "document.querySelectorAll('#grasps tbody tr').length";
await page.evaluate("document.getElementById('play').click()");
await page.until("document.getElementById('play').textContent === 'Play'", "it pauses");
const seek = (to) => page.evaluate(`{
  const line = document.getElementById("time");
  line.value = ${to};
  line.dispatchEvent(new Event("input"));
  line.dispatchEvent(new Event("change"));
}`);
await seek("1");
await page.until(`Math.abs(${time} - 1) < 0.01`, "it is at its first second");
await page.evaluate("document.getElementById('step').click()");
await page.until(`Math.abs(${time} - 1 - 1 / 30) < 0.01`, "a step on");
// Slowly: a quarter of the time that passes here.
await page.evaluate(`document.getElementById("speed").value = "0.25"; document.getElementById("play").click()`);
await page.until(`${time} > 1.2`, "it plays slowly");
const [from, since] = await page.evaluate(`[${time}, performance.now()]`);
await new Promise((later) => setTimeout(later, 3000));
const [to, until] = await page.evaluate(`[${time}, performance.now()]`);
const rate = 1000 * (to - from) / (until - since);
assert.ok(Math.abs(rate - 0.25) < 0.1, `a quarter of its speed is ${rate}`);
await page.evaluate("document.getElementById('play').click()");
await seek("0");
await page.until(`${time} < 0.01 && ${reports} === 0`, "at the beginning nothing was grasped yet");
await seek("line.max");
await page.until(`${time} > 1 && ${reports} === 1`, "at the end it was, once");

// Each body is drawn where its own bytes say that it is.
const bodies = await new Promise((done) => {
  const client = new protocol.FoxgloveClient({ ws: new WebSocket(address.replace("http", "ws"), ["foxglove.sdk.v1"]) });
  const found = new Map();
  let reader;
  client.on("advertise", (all) => {
    const channel = all.find(({ topic }) => topic === "object/state");
    reader = new MessageReader(parse(channel.schema, { ros2: true }));
    client.subscribe(channel.id);
    setTimeout(() => (client.close(), done(found)), 1500);
  });
  client.on("message", ({ data }) => {
    const { body, x_wo: { position: p } } = reader.readMessage(data);
    found.set(body, [p.x, p.y, p.z]);
  });
});
assert.ok(bodies.size > 0, "there are no bodies");
for (const [body, place] of bodies) {
  const drawn = await page.evaluate(`document.getElementById("view").where(${JSON.stringify(`object/${body}`)})`)
  .catch(() => undefined);
  assert.ok(drawn && Math.hypot(...place.map((x, k) => x - drawn[k])) < 1e-3, `${body}: ${place}, drawn at ${drawn}`);
}

await page.evaluate("document.getElementById('near').click()");
const frames = "Number(document.getElementById('view').dataset.frames)";
await page.until(`${frames} > ${await page.evaluate(frames)} + 3`, "it is drawn");
const { data } = await page.call("Page.captureScreenshot", { format: "jpeg", quality: 85 });
writeFileSync(picture, Buffer.from(data, "base64"));
assert.ok(data.length > 27000, "the picture is empty");
assert.deepEqual(page.complaints, [], "the browser complains");
const says = await accessible(page, ["play", "step", "speed", "time", "view", "near", "csv", "png"]);
assert.deepEqual(page.complaints, [], "the browser complains");
console.log(`the page shows a grasp and ${bodies.size} bodies where they are; its picture is ${picture}; ${says}`);
await page.close();
process.exit(0);
