// client.mjs CONSOLE SAMPLE: each name of the protocol, and what a viewer is given: each link of the
// hand in /tf is where the URDF and the joint angles of robot/state, read from its own bytes, put it.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { createInterface } from "node:readline";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import protocol from "@foxglove/ws-protocol";
import WebSocket from "ws";

// That package is CommonJS whose names Node does not see.
const { FoxgloveClient } = protocol;

const [console_, sample] = process.argv.slice(2);
const server = spawn(console_, ["--recording", sample, "--set", "console.port=0"],
                     { stdio: ["ignore", "pipe", "inherit"] });
process.on("exit", () => server.kill());
const address = await new Promise((found) =>
  createInterface({ input: server.stdout }).once("line", (line) => found(line.replace("http", "ws"))));

// Row-major 4 x 4.
const multiply = (a, b) =>
  a.map((row, i) => row.map((_, j) => [0, 1, 2, 3].reduce((sum, k) => sum + a[i][k] * b[k][j], 0)));
const shift = ([x, y, z]) => [[1, 0, 0, x], [0, 1, 0, y], [0, 0, 1, z], [0, 0, 0, 1]];
function turn([x, y, z], angle) {
  const c = Math.cos(angle), s = Math.sin(angle), t = 1 - c;
  return [[t * x * x + c, t * x * y - s * z, t * x * z + s * y, 0],
          [t * x * y + s * z, t * y * y + c, t * y * z - s * x, 0],
          [t * x * z - s * y, t * y * z + s * x, t * z * z + c, 0], [0, 0, 0, 1]];
}
// Roll, pitch, yaw about fixed axes.
const rpy = ([r, p, y]) => multiply(turn([0, 0, 1], y), multiply(turn([0, 1, 0], p), turn([1, 0, 0], r)));
const fromQuaternion = ({ w, x, y, z }) =>
  [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 0],
   [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x), 0],
   [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y), 0], [0, 0, 0, 1]];
const poseOf = (p, q) => multiply(shift([p.x, p.y, p.z]), fromQuaternion(q));

const numbers = (text, otherwise) => (text ? text.trim().split(/\s+/).map(Number) : otherwise);
const attribute = (text, tag, name) =>
  text.match(new RegExp(`<${tag}\\b[^>]*\\b${name}="([^"]*)"`))?.[1];
function jointsOf(urdf) {
  return [...urdf.replace(/<!--[^]*?-->/g, "").matchAll(/<joint\b([^>]*)>([^]*?)<\/joint>/g)].map(
    ([, head, body]) => ({
      name: head.match(/name="([^"]*)"/)[1],
      type: head.match(/type="([^"]*)"/)[1],
      parent: attribute(body, "parent", "link"),
      child: attribute(body, "child", "link"),
      origin: multiply(shift(numbers(attribute(body, "origin", "xyz"), [0, 0, 0])),
                       rpy(numbers(attribute(body, "origin", "rpy"), [0, 0, 0]))),
      axis: numbers(attribute(body, "axis", "xyz"), [1, 0, 0]),
    }));
}
// Every link of the URDF, from the pose of the first and the values of the joints that move.
function forward(joints, base, values) {
  const children = new Set(joints.map((joint) => joint.child));
  const root = joints.map((joint) => joint.parent).find((link) => !children.has(link));
  const poses = new Map([[root, base]]);
  let next = 0;
  for (const joint of joints) {
    const motion = joint.type === "fixed" ? shift([0, 0, 0])
      : joint.type === "prismatic" ? shift(joint.axis.map((a) => a * values[next++]))
      : turn(joint.axis, values[next++]);
    poses.set(joint.child, multiply(poses.get(joint.parent), multiply(joint.origin, motion)));
  }
  return poses;
}

function refused(names) {
  return new Promise((opened, failed) => new WebSocket(address, names).on("open", opened).on("error", failed));
}

async function watch(names, topics, enough) {
  const socket = new WebSocket(address, names);
  const client = new FoxgloveClient({ ws: socket });
  const channels = new Map(), heard = [];
  let urdf;
  client.on("advertise", (all) => {
    for (const channel of all)
      if (topics.includes(channel.topic)) channels.set(client.subscribe(channel.id), channel);
    client.getParameters(["/robot_description"]);
  });
  client.on("parameterValues", ({ parameters }) => (urdf = parameters[0]?.value));
  await new Promise((done, failed) => {
    const limit = setTimeout(() => failed(new Error(`heard only ${heard.length} in 60 s`)), 60000);
    client.on("message", ({ subscriptionId, data, timestamp }) => {
      const channel = channels.get(subscriptionId);
      const message = channel.encoding === "json"
        ? JSON.parse(new TextDecoder().decode(data))
        : new MessageReader(parse(channel.schema, { ros2: true })).readMessage(data);
      heard.push({ channel, message, timestamp });
      if (urdf === undefined || !enough(heard)) return;
      clearTimeout(limit);
      done();
    });
  });
  assert.ok(names.includes(socket.protocol), `answered ${socket.protocol}`);
  client.close();
  return { heard, urdf };
}

const nanoseconds = ({ sec, nsec }) => BigInt(sec) * 1000000000n + BigInt(nsec);
const hands = (heard) => heard.filter(({ channel, message }) =>
  channel.topic === "/tf" && message.transforms.length > 1);

for (const names of [["foxglove.websocket.v1"], ["foxglove.sdk.v1"],
                     ["foxglove.websocket.v1", "foxglove.sdk.v1"]]) {
  const { heard, urdf } = await watch(names, ["/tf", "robot/state"], (all) => hands(all).length > 30);
  const states = new Map(heard.filter(({ channel }) => channel.topic === "robot/state")
    .map(({ message }) => [message.stamp_ns, message]));
  const joints = jointsOf(urdf);
  let compared = 0, worst = 0;
  for (const { message } of hands(heard)) {
    // Beside links it tells of objects.
    for (const t of message.transforms) {
      const state = states.get(nanoseconds(t.timestamp));
      if (!state) continue;
      const { position, orientation } = state.x_wb;
      const expected = forward(joints, poseOf(position, orientation), [...state.joint]);
      if (!expected.has(t.child_frame_id)) continue;
      const said = poseOf(t.translation, t.rotation), wanted = expected.get(t.child_frame_id);
      said.forEach((row, i) => row.forEach((value, j) =>
        (worst = Math.max(worst, Math.abs(value - wanted[i][j])))));
      ++compared;
    }
  }
  assert.ok(compared > 100, `compared ${compared} links`);
  assert.ok(worst < 1e-6, `a link is off by ${worst}`);
  console.log(`${names}: ${compared} links, the worst off by ${worst.toExponential(1)}`);
}

for (const names of [[], ["chat"]])
  await assert.rejects(refused(names), /400/, `opened with [${names}]`);

// Every channel brings what its schema promises, and the lab's own types are read as they are.
const drawn = ["/tf", "/scene", "/camera/image", "/camera/annotations", "/grasp/report", "/log", "/status",
               "/latency", "hand/posture", "scene/state", "grasp/report", "robot/command"];
const resists = ({ channel, message }) => channel.topic === "/scene" &&
  message.entities.some(({ id, triangles }) => id.startsWith("forces/") && triangles[0]?.points.length > 0);
const { heard } = await watch(["foxglove.sdk.v1"], drawn, (all) => all.some(resists) &&
  drawn.every((topic) => all.some(({ channel }) => channel.topic === topic)));
for (const { channel, message } of heard)
  if (channel.encoding === "json")
    for (const name of Object.keys(JSON.parse(channel.schema).properties))
      assert.ok(name in message, `${channel.topic} lacks ${name}`);
console.log(`${heard.length} messages of ${drawn.length} channels`);
process.exit(0);
