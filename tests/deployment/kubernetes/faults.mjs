// What a cluster does to a lab, as far as one machine can be one: while a glove plays and all is recorded,
// each deployment is restarted by its manifest's strategy, at another address, and nodes are lost with what
// runs on them. Who is missing is named, what remains goes on, the lab is whole again in time, the
// recording is whole, and the hand has never moved without a command that the gate obeyed.
// Exit code 77: skipped. Needs PREHEND_LONG: it takes minutes.
import { setTimeout as sleep } from "node:timers/promises";
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { Lab, begin, clean, docker, ends, images, skip } from "./lab.mjs";

const whole_within = 20; // s, from its node's word that a pod runs
const named_within = 10; // s, from the loss of a node; silence counts as loss after 3

if (!process.env.PREHEND_LONG) skip("PREHEND_LONG=1 restarts pods and loses nodes (minutes)");
const folder = begin();
const lab = new Lab("demo", folder);
lab.pods = lab.pods.filter((pod) => pod.kind === "Deployment");
const services = lab.pods.filter((pod) => pod.name !== "discovery");
const named = (name) => lab.pods.find((pod) => pod.name === name);
const seconds = (since) => (Date.now() - since) / 1000;

/** Who records: a pod of the lab like mapping's. */
function recorder() {
  const pod = structuredClone(named("mapping"));
  const { startupProbe, readinessProbe, livenessProbe, ...container } = pod.spec.containers[0];
  const command = ["enter-container", "prehend-record", "--quiet", "--output", "/tmp/lab.mcap"];
  const labels = { ...pod.labels, "app.kubernetes.io/name": "recorder" };
  pod.spec.containers = [{ ...container, name: "recorder", command }];
  return { ...pod, name: "recorder", labels };
}
const witness = recorder();
const beside = (...command) => ends("exec", witness.spec.containers[0].id, ...command);
const status = () => JSON.parse(beside("prehend", "status", "--once", "--json").stdout || "{}");

/** Asks until `holds` does; how long it took. */
async function until(holds, limit, what) {
  for (const since = Date.now(); ; await sleep(200)) {
    if (holds()) return seconds(since);
    assert.ok(seconds(since) < limit, `${what}: not within ${limit} s: ${JSON.stringify(status())}`);
  }
}
const whole = (limit, what) => until(() => beside("prehend", "status",
  ...services.flatMap((pod) => ["--wait", pod.name]), "--timeout", "5").status === 0, limit, `${what}: a whole lab`);
const obeyed = () => status().hands?.[0]?.obeyed ?? 0;
async function handIsLed(what) {
  const before = obeyed();
  await until(() => obeyed() !== before && obeyed() > 0, 20, `${what}: a hand that is led`);
}

const network = `${lab.name}-net`;
let next = 10;
const address = () => `10.97.0.${next++}`;

/** At another address, as a pod that comes anew: running, ready, and the lab as it was. */
async function comes(pod, what) {
  const since = Date.now();
  lab.place(pod, network, address());
  for (const container of pod.spec.containers) {
    await lab.probe(pod, container, "startupProbe");
    await lab.probe(pod, container, "readinessProbe");
  }
  await whole(whole_within, what);
  console.log(`${what}: the lab is whole ${seconds(since).toFixed(1)} s after the new pod was made`);
  await handIsLed(what);
}

async function restart(pod) {
  const strategy = lab.objects.find((o) => o.kind === "Deployment" && o.metadata.name === pod.name).spec.strategy.type;
  assert.equal(strategy, "Recreate", `${pod.name}: this test knows one strategy`);
  lab.remove(pod, false); // the old one has ended before the new one is made
  await comes(pod, `${pod.name} restarted`);
}

async function loseNode(pod) {
  const others = services.filter((one) => one !== pod).map((one) => one.name);
  lab.remove(pod, true);
  if (pod.name === "discovery") {
    // Nobody can ask through it: who tries is told its name, as soon as the engine knows that it has none.
    const told = () => /discovery:11811/.test(beside("prehend", "status", "--once", "--timeout", "2").stderr);
    console.log(`${pod.name} lost: named after ${(await until(told, 2 * named_within, "discovery is missed")).toFixed(1)} s`);
  } else {
    const took = await until(() => status().missing?.includes(pod.name), named_within, `${pod.name} is missed`);
    console.log(`${pod.name} lost: named after ${took.toFixed(1)} s`);
    assert.deepEqual(status().missing, [pod.name]);
    assert.deepEqual(status().services.map((one) => one.name).filter((one) => others.includes(one)).sort(), others.sort());
    if (pod.name === "recognition") await handIsLed("without recognition");
  }
  await comes(pod, `${pod.name} on another node`);
}

/** What was recorded of a topic. */
function recorded(topic) {
  ends("run", "--rm", "--user", "0", "-v", `${lab.folder}/recorder-tmp:/made`, "--entrypoint", "prehend", images[0],
    "recording", "export", "/made/lab.mcap", "--format", "jsonl", "--topic", topic, "-o", "/made/tables");
  return readFileSync(`${lab.folder}/recorder-tmp/tables/${topic.replace("/", "-")}.jsonl`, "utf8")
    .trim().split("\n").map((line) => JSON.parse(line));
}

/** Once the last command that the gate obeyed is a second old, fingers and base stand still. */
function stoodStill() {
  let anchor = null, last = null, still = 0, moved = 0;
  for (const { log_time_ns: at, message: one } of recorded("robot/state")) {
    const where = [...one.dof, ...Object.values(one.X_WB.position)];
    if (!last || one.sequence_number < last.sequence_number || one.origin_ns !== anchor.origin) {
      anchor = { origin: one.origin_ns, at, where: null };
      ++moved;
    }
    last = one;
    if (at - anchor.at < 1e9) continue;
    anchor.where ??= where;
    ++still;
    const by = Math.max(...where.map((value, i) => Math.abs(value - anchor.where[i])));
    assert.ok(by < 0.02, `the hand moves by ${by} without a command, ${(at - anchor.at) / 1e9} s after the last`);
  }
  assert.ok(still > 100 && moved > 1000, `${still} states without a command, ${moved} commands: too few`);
  console.log(`the hand stood still in ${still} states without a command, and followed ${moved}`);
}

/** Mapping answered while discovery was away: nobody whom it had brought together was parted. */
function longestPause(from, to) {
  const times = recorded("robot/command").map((one) => one.log_time_ns / 1e6).filter((at) => at > from && at < to);
  return Math.max(...[from, ...times, to].slice(1).map((at, i) => at - [from, ...times][i]));
}

docker("network", "create", "--subnet", "10.97.0.0/24", network);
try {
  lab.pods.push(witness);
  for (const pod of lab.pods) lab.hold(pod, network, address());
  for (const pod of lab.pods) lab.shut(pod);
  for (const pod of lab.pods) lab.start(pod);
  await whole(60, "the start");
  await handIsLed("the start");

  for (const pod of [named("discovery"), ...services]) await restart(pod);
  for (const name of ["recognition", "mapping"]) await loseNode(named(name));
  const from = Date.now();
  await loseNode(named("discovery"));
  const to = Date.now();

  assert.equal(ends("stop", witness.spec.containers[0].id).status, 0);
  const verified = ends("run", "--rm", "-v", `${lab.folder}/recorder-tmp:/made`, "--entrypoint", "prehend", images[0],
    "recording", "verify", "/made/lab.mcap");
  assert.equal(verified.status, 0, `the recording is not whole: ${verified.stdout}${verified.stderr}`);
  const info = JSON.parse(docker("run", "--rm", "-v", `${lab.folder}/recorder-tmp:/made`, "--entrypoint", "prehend", images[0],
    "recording", "info", "--json", "/made/lab.mcap"));
  assert.ok(info.closed && info.damage.length === 0, "the recording is not whole");
  console.log(`recorded: ${info.messages} messages in ${info.duration_s.toFixed(0)} s, ${info.lost} lost`);
  assert.ok(info.lost * 1000 < info.messages, `${info.lost} messages of ${info.messages} are lost`);
  const pause = longestPause(from, to);
  console.log(`without discovery, commands paused for ${(pause / 1000).toFixed(2)} s at most`);
  assert.ok(pause < 1000, "commands stopped with the discovery server");
  stoodStill();
} finally {
  clean();
  docker("network", "rm", network);
}
console.log("the lab outlives restarts and lost nodes");
