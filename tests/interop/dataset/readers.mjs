// Parquet as two readers that know nothing of each other see it: hyparquet, in JavaScript, and
// parquet-wasm, which is that of Apache Arrow in Rust. Columns by name; whole numbers as numbers.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { tableFromIPC } from "apache-arrow";
import { parquetMetadata, parquetReadObjects } from "hyparquet";
import { readParquet } from "parquet-wasm/node";

function plain(value) {
  if (typeof value === "bigint") return Number(value);
  if (value === null || typeof value !== "object") return value;
  return Array.from(value, plain);
}

async function byHyparquet(bytes) {
  const file = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length);
  const rows = await parquetReadObjects({ file });
  const columns = {};
  for (const name of Object.keys(rows[0])) columns[name] = rows.map((row) => plain(row[name]));
  const metadata = parquetMetadata(file).key_value_metadata ?? [];
  return { columns, metadata: Object.fromEntries(metadata.map(({ key, value }) => [key, value])) };
}

function byArrow(bytes) {
  const table = tableFromIPC(readParquet(new Uint8Array(bytes)).intoIPCStream());
  const columns = {};
  const types = {};
  table.schema.fields.forEach((field, i) => {
    columns[field.name] = Array.from(table.getChildAt(i), plain);
    types[field.name] = String(field.type);
  });
  return { columns, types, metadata: Object.fromEntries(table.schema.metadata) };
}

/// What both say, which must be the same.
export async function read(path) {
  const bytes = readFileSync(path);
  const one = await byHyparquet(bytes);
  const other = byArrow(bytes);
  assert.deepEqual(one.columns, other.columns, `${path}: two readers do not see the same`);
  return { columns: one.columns, types: other.types, metadata: one.metadata };
}
