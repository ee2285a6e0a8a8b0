// hand.mjs SOURCE: the page's own mathematics of a hand before a webcam, on hands that are made here: the
// place from picture and metres, the clutch, the calibration.
import assert from "node:assert/strict";
import { readFileSync, writeFileSync } from "node:fs";

// The page's modules are bundled, so Node does not know them as such.
const file = new URL("./hand-math.mjs", import.meta.url);
writeFileSync(file, readFileSync(`${process.argv[2]}/hand-math.js`));
const { calibrated, calibrationOf, Clutch, distance, middleOfPalm, ofHeadset, onTable, placeOf, pointsAt, usualPalm } =
  await import(file);

// A flat right hand, m, about its middle; x right, y down, z away from the camera.
function handOf(bend = 0, size = 1) {
  const points = [[0, 0.05, 0]];
  for (let finger = 0; finger < 5; ++finger)
    for (let joint = 0; joint < 4; ++joint) {
      const along = finger ? 0.095 + 0.03 * joint * (1 - bend) : 0.03 + 0.03 * joint;
      points.push([0.03 - 0.018 * finger, 0.05 - along * (finger ? 1 : 0.8), finger ? -0.03 * joint * bend : -0.01]);
    }
  return points.map((p) => p.map((x) => x * size));
}
const turned = (points, angle) => points.map(([x, y, z]) =>
  [Math.cos(angle) * x + Math.sin(angle) * z, y, Math.cos(angle) * z - Math.sin(angle) * x]);
// What a camera of 60 degrees sees of it there, x and y from 0 to 1; ratio: of width to height.
const seen = (points, [x, y, z], ratio) => points.map((p) => {
  const far = p[2] + z;
  return { x: 0.5 + 0.87 * (p[0] + x) / far, y: 0.5 + ratio * 0.87 * (p[1] + y) / far };
});

const palmOf = (points) => [0, 1, 2].map((k) => [0, 5, 9, 13, 17].reduce((sum, i) => sum + points[i][k] / 5, 0));
for (const angle of [0, 0.6, -0.9])
  for (const there of [[0, 0, 0.5], [0.1, -0.05, 0.4], [-0.12, 0.06, 0.7]]) {
    const hand = turned(handOf(), angle), palm = palmOf(hand);
    const place = placeOf(seen(hand, there, 16 / 9), hand, 16 / 9);
    const error = distance(place.slice(0, 2), [palm[0] + there[0], palm[1] + there[1]]);
    assert.ok(error < 0.02, `at ${there}, turned by ${angle}: ${place}`);
    assert.ok(Math.abs(place[2] - there[2]) < 0.05, `at ${there}, turned by ${angle}: ${place}`);
  }
assert.equal(placeOf(seen(handOf(), [0, 0, 0.5], 1).map(() => ({ x: 0.5, y: 0.5 })), handOf(), 1), undefined);

// It leads while the clutch is on, and only by what moves then.
const clutch = new Clutch([1, 2, 3]);
clutch.follow([0, 0, 0.5]);
assert.deepEqual(clutch.follow([0.1, 0, 0.5]), [1, 2, 3], "not on");
clutch.on = true;
const close = (a, b, what) => assert.ok(distance(a, b) < 1e-9, `${what}: ${a}`);
close(clutch.follow([0.1, 0, 0.45]), [1.05, 2, 3], "towards the camera is forward");
close(clutch.follow([0.15, 0, 0.45]), [1.05, 2.05, 3], "right in the picture is left");
close(clutch.follow([0.15, -0.05, 0.45]), [1.05, 2.05, 3.05], "up");
clutch.lose();
close(clutch.follow([0.5, 0.5, 0.9]), [1.05, 2.05, 3.05], "what comes back takes hold anew");
close(clutch.follow([0.5, 0.9, 0.9]), [1.05, 2.05, 3.05], "a jump is none of the hand");
const placed = pointsAt(handOf(), [1, 2, 3]);
close(palmOf(placed), [1, 2, 3], "the palm is there");
assert.ok(Math.abs(distance(placed[0], placed[9]) - 0.095) < 1e-3);

// A headset's joints: without the bones of the palm; before the user is x of the table, to the right -y, up z.
const joints = Array.from({ length: 25 }, (_, i) => [i, 0, 0]);
assert.deepEqual(ofHeadset(joints).map(([x]) => -x),
                 [0, 1, 2, 3, 4, 6, 7, 8, 9, 11, 12, 13, 14, 16, 17, 18, 19, 21, 22, 23, 24]);
const placedBy = (p) => onTable(ofHeadset([p])[0]);
close(placedBy([0, 0, -1]), [1, 0, 0], "forward");
close(placedBy([1, 0, 0]), [0, -1, 0], "right");
close(placedBy([0, 1, 0]), [0, 0, 1], "up");
close(middleOfPalm(placed), [1, 2, 3], "the palm's middle");

// Postures: what they are, and what they are not.
const pinch = handOf();
pinch[8] = pinch[4].map((x, k) => x + (k === 0 ? 0.02 : 0));
const size = 1.1, large = (points) => points.map((p) => p.map((x) => size * x));
const found = calibrationOf({ open: large(handOf()), fist: large(handOf(0.95)), pinch: large(pinch) });
assert.ok(Math.abs(found.scale - usualPalm / (size * distance(handOf()[9], handOf()[0]))) < 1e-9);
const after = calibrated(large(pinch), found);
assert.ok(distance(after[4], after[8]) < 1e-9, "a pinch closes");
assert.ok(Math.abs(distance(after[9], after[0]) - usualPalm) < 1e-9);
const open = calibrated(large(handOf()), found);
assert.ok(Math.abs(distance(open[4], open[8]) - found.scale * size * distance(handOf()[4], handOf()[8])) < 1e-9);
assert.match(calibrationOf({ open: handOf(), fist: handOf(), pinch }).refused, /fist/);
assert.match(calibrationOf({ open: handOf(), fist: handOf(0.95), pinch: handOf() }).refused, /touch/);
assert.match(calibrationOf({ open: handOf(0, 0.3), fist: handOf(0.95), pinch }).refused, /open/);
console.log("a hand before a webcam is placed, led and calibrated");
