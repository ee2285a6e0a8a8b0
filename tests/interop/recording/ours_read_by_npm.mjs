// Every field of every topic type as npm's readers see it in our recordings: by index and as a
// stream, with each schema encoding and each compression. Compared exactly.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { createRequire } from "node:module";
import { open, readFile } from "node:fs/promises";

const require = createRequire(import.meta.url);
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { loadDecompressHandlers } = require("@mcap/support");
const { parse: parseRos } = require("@foxglove/rosmsg");
const { MessageReader: RosReader } = require("@foxglove/rosmsg2-serialization");
const { parseIDL } = require("@foxglove/omgidl-parser");
const { MessageReader: IdlReader } = require("@foxglove/omgidl-serialization");

const [folder, samples] = process.argv.slice(2);
const decompressHandlers = await loadDecompressHandlers();

function decoder(schema) {
  const text = new TextDecoder().decode(schema.data);
  return schema.encoding === "ros2msg"
    ? new RosReader(parseRos(text, { ros2: true }))
    : new IdlReader(schema.name, parseIDL(text));
}

// ROS 2 has no capitals in field names.
let lower = false;
const named = (name) => (lower ? name.toLowerCase() : name);

let fields = 0;
function compare(actual, expected, where) {
  if (Array.isArray(expected)) {
    assert.equal(actual.length, expected.length, where);
    expected.forEach((each, i) => compare(actual[i], each, `${where}[${i}]`));
  } else if (typeof expected === "object") {
    assert.deepEqual(Object.keys(actual), Object.keys(expected).map(named), where);
    for (const [name, each] of Object.entries(expected))
      compare(actual[named(name)], each, `${where}.${name}`);
  } else {
    ++fields;
    if (typeof expected === "boolean") assert.equal(actual, expected, where);
    else if (expected[0] === "s") assert.equal(actual, expected.slice(1), where);
    else if (expected[0] === "d") assert.equal(actual, Number(expected.slice(1)), where);
    else assert.equal(String(actual), expected.slice(1), where);
  }
}

async function* byIndex(path) {
  const file = await open(path);
  const readable = {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, length) => {
      const bytes = new Uint8Array(Number(length));
      await file.read(bytes, 0, bytes.length, Number(offset));
      return bytes;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  assert(reader.chunkIndexes.length > 1 && reader.statistics);
  for await (const message of reader.readMessages()) {
    const channel = reader.channelsById.get(message.channelId);
    yield { channel, schema: reader.schemasById.get(channel.schemaId), message };
  }
  await file.close();
}

async function* asStream(path) {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(await readFile(path));
  const schemas = new Map(), channels = new Map();
  for (let record; (record = reader.nextRecord());) {
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type === "Message") {
      const channel = channels.get(record.channelId);
      yield { channel, schema: schemas.get(channel.schemaId), message: record };
    }
  }
  assert(reader.done());
}

for (const encoding of ["ros2msg", "omgidl"]) {
  lower = encoding === "ros2msg";
  for (const compression of ["", "lz4", "zstd"]) {
    execFileSync(samples, [folder, encoding, compression]);
    const expected = JSON.parse(await readFile(`${folder}/expected.json`)).messages;
    for (const read of [byIndex, asStream]) {
      const decoders = new Map(), seen = new Map();
      for await (const { channel, schema, message } of read(`${folder}/samples.mcap`)) {
        assert.equal(schema.encoding, encoding);
        if (!decoders.has(schema.id)) decoders.set(schema.id, decoder(schema));
        const index = seen.get(channel.topic) ?? 0;
        seen.set(channel.topic, index + 1);
        assert.equal(message.sequence, index);
        compare(decoders.get(schema.id).readMessage(message.data), expected[channel.topic][index],
                `${encoding} ${channel.topic}`);
      }
      for (const [topic, list] of Object.entries(expected))
        assert.equal(seen.get(topic), list.length, topic);
      assert.equal(seen.size, Object.keys(expected).length);
    }
  }
}
console.log(`${fields} fields compared`);
