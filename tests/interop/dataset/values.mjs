// values.mjs FOLDER: every type and shape comes back as it was written.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { read } from "./readers.mjs";

const folder = process.argv[2];
const expected = JSON.parse(readFileSync(`${folder}/values.json`, "utf8"));
const { columns, types, metadata } = await read(`${folder}/values.parquet`);
assert.deepEqual(Object.keys(columns), Object.keys(expected));
for (const name of Object.keys(expected)) assert.deepEqual(columns[name], expected[name], name);
assert.equal(metadata.who, "we");
assert.equal(types.truth, "Bool");
assert.equal(types.whole, "Int64");
assert.equal(types.single, "Float32");
assert.equal(types.double, "Float64");
assert.equal(types.words, "Utf8");
assert.equal(types.list, "List<Float32>");
assert.equal(types.colours, "List<List<List<Float64>>>");
console.log(`${Object.keys(expected).length} columns of ${columns.whole.length} rows are the same`);
