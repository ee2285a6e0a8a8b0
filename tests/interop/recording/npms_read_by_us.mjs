// Files of npm's writer with every optional part on and off, and with Zstandard,
// read by our tool: sound, all messages in order, attachments and metadata there.
import assert from "node:assert/strict";
import { spawnSync } from "node:child_process";
import { createRequire } from "node:module";
import { writeFile } from "node:fs/promises";

const require = createRequire(import.meta.url);
const { McapWriter } = require("@mcap/core");
const Zstd = require("@foxglove/wasm-zstd");
await Zstd.isLoaded;

const [folder, , tool] = process.argv.slice(2);
const path = `${folder}/theirs.mcap`;
const parts = ["useStatistics", "useSummaryOffsets", "useChunks", "repeatSchemas", "repeatChannels",
               "useAttachmentIndex", "useMetadataIndex", "useMessageIndex", "useChunkIndex"];
async function write(options) {
  const pieces = [];
  let length = 0;
  const writable = {
    position: () => BigInt(length),
    write: async (bytes) => {
      pieces.push(Uint8Array.from(bytes));
      length += bytes.length;
    },
  };
  const writer = new McapWriter({ writable, chunkSize: 200, ...options });
  await writer.start({ profile: "p", library: "l" });
  const schemaId = await writer.registerSchema({
    name: "std_msgs/msg/String", encoding: "ros2msg", data: new TextEncoder().encode("string data\n"),
  });
  const channels = [];
  for (const topic of ["a", "b"])
    channels.push(await writer.registerChannel(
        { schemaId, topic, messageEncoding: "cdr", metadata: new Map([["k", "v"]]) }));
  for (let i = 0; i < 40; ++i) {
    const text = `message ${i}\0`;
    const data = new Uint8Array(8 + text.length);
    data.set([0, 1, 0, 0, text.length]);
    data.set(new TextEncoder().encode(text), 8);
    await writer.addMessage({ channelId: channels[i % 2], sequence: i, logTime: BigInt(i ^ 3),
                              publishTime: BigInt(i), data });
    if (i === 20) {
      await writer.addAttachment({ name: "note", logTime: 1n, createTime: 2n,
                                   mediaType: "text/plain", data: new Uint8Array([104, 105]) });
      await writer.addMetadata({ name: "run", metadata: new Map([["user", "x"]]) });
    }
  }
  await writer.end();
  await writeFile(path, Buffer.concat(pieces));
}

const ask = (...words) => spawnSync(tool, words, { encoding: "utf8" }).stdout;
let files = 0;
async function check(options, title) {
  await write(options);
  // Without chunks npm's writer 2.2.2 gives an attachment the place of the messages that it has not
  // written yet. We must see that, and read the file all the same.
  const misplaced = !options.useChunks && options.useAttachmentIndex;
  const verdict = JSON.parse(ask("verify", "--json", path));
  const wrong = verdict.findings.filter(({ what }) => !/^an attachment index/.test(what));
  assert.deepEqual(wrong, [], title);
  assert.equal(verdict.sound, !misplaced, title);
  const info = JSON.parse(ask("info", "--json", path));
  assert.equal(info.damage.length > 0, misplaced, `${title} ${info.damage}`);
  assert.deepEqual(info.topics.map((t) => [t.name, t.count]), [["a", 20], ["b", 20]], title);
  assert.deepEqual([info.attachments, info.metadata], [["note"], ["run"]], title);
  const lines = ask("export", path, "--format", "jsonl").trim().split("\n").map(JSON.parse);
  assert.deepEqual(lines.map((line) => line.log_time_ns), [...Array(40).keys()], title);
  for (const line of lines) assert.equal(line.message.data, `message ${line.sequence}`, title);
  ++files;
}

// All on, all off, each one alone off, each one alone on, and pairs of those that lean on another.
const all = (value) => Object.fromEntries(parts.map((part) => [part, value]));
await check(all(true), "all");
await check(all(false), "none");
for (const part of parts) {
  await check({ ...all(true), [part]: false }, `without ${part}`);
  await check({ ...all(false), [part]: true }, `only ${part}`);
  await check({ ...all(false), useChunks: true, [part]: true }, `chunks and ${part}`);
  await check({ ...all(false), useChunks: true, useChunkIndex: true, [part]: true },
              `chunk index and ${part}`);
}
// The lz4 package of npm only decompresses.
const compressChunk = (data) => ({ compression: "zstd", compressedData: Zstd.compress(data, 1) });
await check({ ...all(true), compressChunk }, "zstd");
await check({ ...all(false), useChunks: true, compressChunk }, "zstd without index");
console.log(`${files} files of npm's writer read`);
