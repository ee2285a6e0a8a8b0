// The form of the MCAP conformance tests: their 416 variants are built anew with npm's record
// builder, the way their generator does it (one chunk, CRCs, order of the summary). Our `records`
// must say what npm's stream reader says of them, and our `write` must make the same bytes of that.
import assert from "node:assert/strict";
import { spawn } from "node:child_process";
import { createRequire } from "node:module";
import { readFile, writeFile } from "node:fs/promises";
import os from "node:os";

const require = createRequire(import.meta.url);
const { McapChunkBuilder, McapRecordBuilder, McapStreamReader, Opcode } = require("@mcap/core");
const { crc32 } = require("@foxglove/crc");

const [folder, , tool] = process.argv.slice(2);

const schema = { type: "Schema", id: 1, name: "Example", encoding: "c",
                 data: new Uint8Array([4, 5, 6]) };
const channel = (schemaId) => ({ type: "Channel", id: 1, topic: "example", schemaId,
                                 messageEncoding: "a", metadata: new Map([["foo", "bar"]]) });
const message = (sequence, time) => ({ type: "Message", channelId: 1, sequence, logTime: time,
                                       publishTime: time, data: new Uint8Array([1, 2, 3]) });
const inputs = {
  NoData: [],
  OneMessage: [schema, channel(1), message(10, 2n)],
  OneSchemalessMessage: [channel(0), message(10, 2n)],
  TenMessages: [schema, channel(1),
                ...[0n, 2n, 1n, 3n, 3n, 5n, 4n, 7n, 8n, 9n].map((time, i) => message(i, time))],
  OneAttachment: [{ type: "Attachment", name: "myFile", mediaType: "application/octet-stream",
                    createTime: 1n, logTime: 2n, data: new Uint8Array([1, 2, 255]) }],
  OneMetadata: [{ type: "Metadata", name: "myMetadata", metadata: new Map([["foo", "bar"]]) }],
};

/// The combinations of features that make sense for these records.
function* variants(records) {
  const names = ["ch", "mx", "st", "rsh", "rch", "ax", "mdx", "chx", "sum", "pad"];
  const has = (type) => records.some((record) => record.type === type);
  for (let bits = 0; bits < 1 << names.length; ++bits) {
    const on = new Set(names.filter((_, i) => bits & (1 << i)));
    if (on.has("ax") && !has("Attachment")) continue;
    if (on.has("mdx") && !has("Metadata")) continue;
    if (on.has("rsh") && !has("Schema")) continue;
    if (on.has("rch") && !has("Channel")) continue;
    if (on.has("ch") && !has("Channel")) continue;
    if ((on.has("mx") || on.has("chx")) && !on.has("ch")) continue;
    if (on.has("sum") && !["chx", "rsh", "rch", "mdx", "ax", "st"].some((x) => on.has(x))) continue;
    yield on;
  }
}

function build(records, on) {
  const builder = new McapRecordBuilder({ padRecords: on.has("pad") });
  const chunk = on.has("ch") ? new McapChunkBuilder({ useMessageIndex: on.has("mx") }) : undefined;
  const times = records.filter((r) => r.type === "Message").map((r) => r.logTime)
                       .sort((a, b) => Number(a - b));
  const count = (type) => records.filter((record) => record.type === type).length;
  const attachments = [], metadata = [], chunks = [];
  const at = () => BigInt(builder.length);
  builder.writeMagic();
  builder.writeHeader({ profile: "", library: "" });
  for (const record of records) {
    const offset = at();
    if (record.type === "Attachment")
      attachments.push({ ...record, offset, length: builder.writeAttachment(record),
                         dataSize: BigInt(record.data.length) });
    else if (record.type === "Metadata")
      metadata.push({ name: record.name, offset, length: builder.writeMetadata(record) });
    else if (chunk) chunk[`add${record.type}`](record);
    else builder[`write${record.type}`](record);
  }
  if (chunk) {
    const size = BigInt(chunk.buffer.byteLength), chunkStartOffset = at();
    const entry = { compression: "", messageStartTime: chunk.messageStartTime,
                    messageEndTime: chunk.messageEndTime, uncompressedSize: size,
                    compressedSize: size, chunkStartOffset, messageIndexLength: 0n,
                    messageIndexOffsets: new Map() };
    entry.chunkLength = builder.writeChunk({ ...entry, uncompressedCrc: crc32(chunk.buffer),
                                             records: chunk.buffer });
    for (const index of chunk.indices) {
      entry.messageIndexOffsets.set(index.channelId, at());
      entry.messageIndexLength += builder.writeMessageIndex(index);
    }
    chunks.push(entry);
  }
  builder.writeDataEnd({ dataSectionCrc: crc32(builder.buffer) });
  const start = at(), groups = [];
  const group = (wanted, opcode, write) => {
    if (!wanted) return;
    const groupStart = at();
    write();
    if (at() > groupStart) groups.push({ groupOpcode: opcode, groupStart, groupLength: at() - groupStart });
  };
  const repeat = (type) => () => records.filter((r) => r.type === type)
                                        .forEach((r) => builder[`write${type}`](r));
  group(on.has("rsh"), Opcode.SCHEMA, repeat("Schema"));
  group(on.has("rch"), Opcode.CHANNEL, repeat("Channel"));
  group(on.has("st"), Opcode.STATISTICS, () => builder.writeStatistics({
    messageCount: BigInt(times.length), channelCount: count("Channel"),
    schemaCount: count("Schema"), attachmentCount: count("Attachment"),
    metadataCount: count("Metadata"), chunkCount: chunk ? 1 : 0,
    messageStartTime: times[0] ?? 0n, messageEndTime: times.at(-1) ?? 0n,
    channelMessageCounts: new Map(times.length ? [[1, BigInt(times.length)]] : []) }));
  group(on.has("mdx"), Opcode.METADATA_INDEX,
        () => metadata.forEach((each) => builder.writeMetadataIndex(each)));
  group(on.has("ax"), Opcode.ATTACHMENT_INDEX,
        () => attachments.forEach((each) => builder.writeAttachmentIndex(each)));
  group(on.has("chx"), Opcode.CHUNK_INDEX,
        () => chunks.forEach((each) => builder.writeChunkIndex(each)));
  const footer = { summaryStart: groups.length ? start : 0n, summaryOffsetStart: 0n, summaryCrc: 0 };
  if (on.has("sum")) {
    footer.summaryOffsetStart = at();
    groups.forEach((each) => builder.writeSummaryOffset(each));
  }
  // The CRC runs from the summary to the footer's own field for it.
  const whole = new McapRecordBuilder();
  whole.writeFooter(footer);
  footer.summaryCrc = crc32(Buffer.concat([builder.buffer.subarray(Number(start)),
                                           whole.buffer.subarray(0, 25)]));
  builder.writeFooter(footer);
  builder.writeMagic();
  return Buffer.from(builder.buffer);
}

const snake = (name) => name.replace(/[A-Z]/g, (letter) => `_${letter.toLowerCase()}`);
function plain(value) {
  if (value instanceof Uint8Array) return [...value].map(String);
  if (value instanceof Map)
    return Object.fromEntries([...value].map(([k, v]) => [String(k), plain(v)]));
  return typeof value === "bigint" || typeof value === "number" ? String(value) : value;
}
function described(bytes) {
  const reader = new McapStreamReader({ validateCrcs: true });
  reader.append(bytes);
  const records = [];
  for (let record; (record = reader.nextRecord());) {
    if (record.type === "MessageIndex") continue;
    const fields = Object.entries(record).filter(([name]) => name !== "type")
                         .map(([name, value]) => [snake(name), plain(value)]);
    fields.sort((a, b) => (a[0] < b[0] ? -1 : 1));
    records.push({ type: record.type, fields });
  }
  return records;
}

function ask(...words) {
  return new Promise((resolve, reject) => {
    const child = spawn(tool, words);
    let out = "", err = "";
    child.stdout.on("data", (data) => (out += data));
    child.stderr.on("data", (data) => (err += data));
    child.on("close", (code) => (code === 0 ? resolve(out) : reject(new Error(err))));
  });
}

async function check(name, bytes, on) {
  const base = `${folder}/${name}`;
  await writeFile(`${base}.mcap`, bytes);
  const records = described(bytes);
  assert.deepEqual(JSON.parse(await ask("records", `${base}.mcap`)).records, records, name);
  await writeFile(`${base}.json`, JSON.stringify({ records, meta: { variant: { features: [...on] } } }));
  await ask("write", `${base}.json`, "-o", `${base}.ours.mcap`);
  assert.equal(Buffer.compare(await readFile(`${base}.ours.mcap`), bytes), 0, name);
  await ask("verify", `${base}.mcap`);
}

const tasks = [];
for (const [name, records] of Object.entries(inputs))
  for (const on of variants(records))
    tasks.push(() => check([name, ...[...on].sort()].join("-"), build(records, on), on));
assert.equal(tasks.length, 416);
let next = 0;
const worker = async () => { while (next < tasks.length) await tasks[next++](); };
await Promise.all(Array.from({ length: os.cpus().length }, worker));
console.log(`${tasks.length} conformance variants`);
