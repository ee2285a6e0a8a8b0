// live.mjs BIN CHROMIUM SCRATCH: a demonstration is watched, heard and led from the page: it shows the grasp
// that the demonstration tells, sounds while something presses on a finger that leads, and every order is
// answered by who executes it.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { browse, start } from "./chromium.mjs";

const [bin, chromium, scratch] = process.argv.slice(2);
setTimeout(() => { throw new Error("it takes more than three minutes"); }, 180000).unref();

const recording = `${scratch}/lab.mcap`;
const { line, child } = await start(`${bin}/prehend`, ["demo", "--watch", "--json", "--seed", "3", "--record", recording,
  "--set", "console.port=0"], "stderr", /http:[^\s;]+/);
const outcome = new Promise((told) => child.stdout.on("data", (bytes) => {
  const text = String(bytes);
  if (text.startsWith("{")) told(JSON.parse(text));
}));
const page = await browse(chromium, `${scratch}/browser`, line, "1280,800", ["--autoplay-policy=no-user-gesture-required"],
  "window.GainNode = class extends GainNode { constructor(...all) { super(...all); window.volume = this.gain; } }");
await page.until("document.getElementById('link').textContent === 'connected'", "it is connected");
await page.evaluate("document.getElementById('sound').click()");
await page.until("volume.value > 0.001", "what presses on a finger is heard");
const { grasp, object } = await outcome;
const rows = "[...document.querySelectorAll('#grasps tbody tr')].map((row) => row.innerText)";
await page.until(`${rows}.length > 0`, "the grasp is shown");
const [last] = (await page.evaluate(`JSON.stringify(${rows})`).then(JSON.parse)).slice(0, 1);
assert.deepEqual(last.split("\t"), [object.name, grasp.epsilon.toFixed(3), String(grasp.contacts), grasp.held ? "yes" : "no"]);
await page.until("Number(document.getElementById('camera').dataset.pictures) > 3", "pictures come");

const answer = (words) => `document.getElementById("answers").firstChild?.innerText.startsWith(${JSON.stringify(words)})`;
const submit = (form, value) => page.evaluate(`{
  const form = document.getElementById("${form}");
  form.elements.argument.value = "${value}";
  form.requestSubmit();
}`);
await page.evaluate("document.getElementById('stop').click()");
await page.until(answer("stop (by the console): gate"), "the stop is answered");
await page.until("/is stopped by/.test(document.getElementById('gate').innerText)", "the stop is shown");
await submit("release", "nobody is near");
await page.until(answer("release (nobody is near): gate"), "the release is answered");
await page.until("document.getElementById('gate').innerText === ''", "the release is shown");
await submit("mode", "direct");
await page.until(answer("mode (direct): mapping"), "the mode is answered");
await submit("record", "pause");
await page.until(answer("record (pause): recorder"), "the recorder answers");
assert.deepEqual(page.complaints, [], "the browser complains");

const ended = new Promise((done) => child.removeAllListeners("exit").on("exit", done));
child.kill("SIGINT");
await ended;
await page.until("volume.value < 1e-6", "it falls silent");
await page.close();
execFileSync(`${bin}/prehend`, ["recording", "verify", recording]);
console.log(`${last.replaceAll("\t", ", ")}; four orders were answered`);
process.exit(0);
