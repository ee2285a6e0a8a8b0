// orders.mjs BIN CHROMIUM SCRATCH: what the page orders happens in the simulation, and it shows the answer or
// why there is none.
import assert from "node:assert/strict";
import { accessible } from "./accessible.mjs";
import { browse, start } from "./chromium.mjs";

const [bin, chromium, scratch] = process.argv.slice(2);
setTimeout(() => { throw new Error("it takes more than two minutes"); }, 120000).unref();

const lab = ["--set", `lab.rig=orders-${process.pid}`, "--set", `safety.state=${scratch}/state`];
const { line } = await start(`${bin}/prehend-console`, [...lab, "--set", "console.port=0"], "stdout", /http:[^\s;]+/);
const page = await browse(chromium, `${scratch}/browser`, line);
const disabled = (form) => `document.querySelector("#${form} button").disabled`;
await page.until(`${disabled("place")} && document.querySelector("#place button").title === "simulation is not there"`,
                 "nobody would place an object, and that is said");
const simulation = await start(`${bin}/prehend-simulation`, [...lab, "--set", "safety.deadman=true"], "stderr", /./);
await page.until(`!${disabled("place")}`, "the simulation is there");

// An object.
const answer = "document.getElementById('answers').firstChild?.innerText ?? ''";
const place = (name, x, y) => page.evaluate(`{
  const form = document.getElementById("place");
  Object.entries({ argument: "${name}", x: "${x}", y: "${y}" }).forEach(([key, value]) => (form.elements[key].value = value));
  form.requestSubmit();
}`);
const until = async (what, give, shown) => {
  // Who has just come does not know yet who gives orders here, and refuses them.
  for (let i = 0; i < 10; ++i) {
    await give();
    await page.until(`!/: sent$/.test(${answer})`, `${what} is answered`);
    if (await page.evaluate(`${shown}.test(${answer})`)) return;
    await new Promise((later) => setTimeout(later, 1000));
  }
  throw new Error(`${what}: ${await page.evaluate(answer)}`);
};
await until("an object", () => place("Talc", 0.2, -0.1), "/simulation: Talc stands there/");
const where = "document.getElementById('view').where('object/Talc')";
await page.until(`${where} && Math.hypot(${where}[0] - 0.2, ${where}[1] + 0.1) < 1e-3`, "it is drawn there");
await page.until("[...document.getElementById('objects').options].some(({ value }) => value === 'Talc')", "it is offered");
await place("no such thing", 0, 0);
await page.until(`/simulation: .*not in the catalogue/.test(${answer})`, "what is unknown is refused, with the reason");

// Consent, by pointer and by space bar: as the gate of the simulation says.
const button = "document.querySelector('#deadmen button')";
await page.until(`${button} && !document.getElementById('consent').hidden`, "the hand asks for consent");
const held = (yes) => `${button}.getAttribute("aria-pressed") === "${yes}"`;
// What stands above it comes and goes, so it is looked for each time.
const mouse = async (type) => {
  const [x, y] = await page.evaluate(`(() => {
    ${button}.scrollIntoView({ block: "center" });
    const { left, top, width, height } = ${button}.getBoundingClientRect();
    return [left + width / 2, top + height / 2];
  })()`);
  await page.call("Input.dispatchMouseEvent", { type, x, y, button: "left", clickCount: 1 });
};
const key = (type) => page.call("Input.dispatchKeyEvent", { type, key: " ", code: "Space", windowsVirtualKeyCode: 32 });
for (const [press, letGo] of [[() => mouse("mousePressed"), () => mouse("mouseReleased")],
                              [() => key("rawKeyDown"), () => key("keyUp")],
                              [() => mouse("mousePressed"), () => page.evaluate("window.dispatchEvent(new Event('blur'))")]]) {
  await page.until(held(false), "nobody consents");
  await press();
  await page.until(held(true), `it is held; the page says: ${await page.evaluate("document.getElementById('consent-state').textContent")}`);
  await letGo();
  await page.until(held(false), "it is let go");
}
await mouse("mouseReleased");
// Who holds it and is gone consents no more.
await mouse("mousePressed");
await page.until(held(true), "it is held again");
const other = await browse(chromium, `${scratch}/other`, line);
await page.close();
await other.until(`${button} && ${held(false)}`, "the page that held it is gone");

const says = await accessible(other, ["view", "stop", "argument", "x", "y"]);
// On a loaded machine a word of consent may be late; then it is refused, as it should be.
assert.deepEqual([...page.complaints, ...other.complaints].filter((text) => !/status of 400/.test(text)), [], "the browser complains");
await other.close();
simulation.child.removeAllListeners("exit");
simulation.child.kill();
console.log(`an object was placed, consent was held three ways; ${says}`);
process.exit(0);
