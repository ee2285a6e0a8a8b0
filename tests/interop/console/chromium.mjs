// A headless Chromium, told by its debugging protocol.
import { spawn } from "node:child_process";
import { createInterface } from "node:readline";
import WebSocket from "ws";

const children = [];
process.on("exit", () => children.forEach((child) => child.kill("SIGKILL")));

// Starts a program; the first line of its stream in which the pattern is found, and its end.
export function start(program, args, stream, pattern) {
  const child = spawn(program, args, { stdio: ["ignore", "pipe", "pipe"] });
  children.push(child);
  child.stdout.resume();
  child.stderr.resume();
  return new Promise((found, failed) => {
    const ended = (code) => failed(new Error(`${program} ended with ${code}`));
    child.on("exit", ended);
    createInterface({ input: child[stream] }).on("line", (text) => {
      const match = text.match(pattern);
      if (match) found({ line: match[0], child });
    });
  });
}

// A page at this address. Its complaints are errors, also what the content security policy refuses. first: a script
// that runs before its own.
export async function browse(chromium, scratch, address, size = "1280,800", flags = [], first = "") {
  const { line, child } = await start(chromium, ["--headless", "--no-sandbox", "--disable-dev-shm-usage",
    "--hide-scrollbars", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    `--window-size=${size}`, `--user-data-dir=${scratch}`, "--remote-debugging-port=0", ...flags], "stderr", /ws:\/\/.*/);
  const socket = new WebSocket(line, { perMessageDeflate: false });
  await new Promise((opened, failed) => socket.on("open", opened).on("error", failed));
  const waiting = new Map(), complaints = [];
  let calls = 0, sessionId;
  function call(method, params = {}) {
    const id = ++calls;
    socket.send(JSON.stringify({ id, method, params, sessionId }));
    return new Promise((done, failed) => waiting.set(id, { done, failed }));
  }
  socket.on("message", (bytes) => {
    const { id, result, error, method, params } = JSON.parse(bytes);
    if (id) error ? waiting.get(id).failed(new Error(error.message)) : waiting.get(id).done(result);
    if (method === "Runtime.exceptionThrown") complaints.push(params.exceptionDetails.exception?.description);
    // Not of the page: somebody on this machine, a test of containers, has made a network.
    if (method === "Log.entryAdded" && params.entry.level === "error" && !/ERR_NETWORK_CHANGED/.test(params.entry.text))
      complaints.push(params.entry.text);
  });
  const { targetId } = await call("Target.createTarget", { url: "about:blank" });
  ({ sessionId } = await call("Target.attachToTarget", { targetId, flatten: true }));
  for (const domain of ["Runtime", "Log", "Page"]) await call(`${domain}.enable`);
  if (first) await call("Page.addScriptToEvaluateOnNewDocument", { source: first });
  await call("Page.navigate", { url: address });

  const evaluate = async (expression) => {
    const { result, exceptionDetails } = await call("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  };
  // Until the expression holds.
  const until = async (expression, what, seconds = 60) => {
    for (const end = Date.now() + 1000 * seconds; Date.now() < end;) {
      // Until the page is there, what is asked for is not.
      if (await evaluate(expression).catch(() => false)) return;
      await new Promise((later) => setTimeout(later, 100));
    }
    throw new Error(`it does not come to that: ${what}\n${await evaluate("document.body.innerText")}`);
  };
  // It still writes into its folder until it has ended.
  const close = async () => {
    const ended = new Promise((done) => child.removeAllListeners("exit").on("exit", done));
    await Promise.all([call("Browser.close").catch(() => {}), ended]);
  };
  return { call, evaluate, until, close, complaints };
}
