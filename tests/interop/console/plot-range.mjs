// plot-range.mjs SOURCE: ranges of plots. Guards: a joint that stood still but for the rounding of its
// numbers froze the page, since the marks of its axis had no end.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";

// The page's modules are bundled, so Node does not know them as such.
const file = new URL("./plot-range-module.mjs", import.meta.url);
writeFileSync(file, readFileSync(`${process.argv[2]}/plot-range.js`));
const { apart } = await import(file);

assert.deepEqual(apart(-1, 2), [-1, 2], "what differs stays as it is");
assert.deepEqual(apart(0.1, 0.101), [0.1, 0.101]);
for (const [least, most] of [[0.99999976, 1.00000024], [2, 2.000000000000001], [0, 0], [-3, -3], [0, 1e-300],
                             [99999999.99999996, 100000000.00000004], [-1e14, -1e14], [1e-12, 1.0000001e-12]]) {
  const [from, to] = apart(least, most);
  assert.ok(from < least && to > most, `${least} to ${most} lie within`);
  const largest = Math.max(Math.abs(least), Math.abs(most));
  assert.ok(to - from >= 1e-4 * largest, `${least} to ${most}: marks find room between ${from} and ${to}`);
}
