// drawn.mjs ADDRESS CHROMIUM SCRATCH SECONDS: how old the hand's state is when the page draws it, how
// often it draws, and after what time it can be used. Not a test: it measures.
import { browse } from "./chromium.mjs";

const [address, chromium, scratch, seconds] = process.argv.slice(2);
const page = await browse(chromium, scratch, address, "900,600");
await page.until("document.getElementById('view').dataset.lag", "a hand is drawn");
// The page's script has run by then: its buttons work.
const used = await page.evaluate("performance.getEntriesByType('navigation')[0].domContentLoadedEventEnd");
const { ages, frames } = JSON.parse(await page.evaluate(`new Promise((done) => {
  const view = document.getElementById("view"), ages = [], first = Number(view.dataset.frames);
  const end = performance.now() + 1000 * ${seconds};
  const look = () => {
    if (view.dataset.lag) ages.push(Number(view.dataset.lag));
    if (performance.now() < end) requestAnimationFrame(look);
    else done(JSON.stringify({ ages, frames: Number(view.dataset.frames) - first }));
  };
  look();
})`));
ages.sort((a, b) => a - b);
const quantile = (q) => ages[Math.floor(q * (ages.length - 1))];
const rate = frames / Number(seconds);
console.log(JSON.stringify({ drawn_ms: { p50: quantile(0.5), p99: quantile(0.99) }, frames_per_second: rate,
                             p50_beyond_a_frame_ms: quantile(0.5) - 1000 / rate, interactive_ms: used }));
await page.close();
process.exit(0);
