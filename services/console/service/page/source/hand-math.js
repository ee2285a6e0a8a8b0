// A tracked hand, from a webcam's points to places on the table. Pure.
//
// MediaPipe gives each of the 21 points twice: in the picture (0 to 1, x right, y down) and in metres
// about the hand's middle (the same axes, z away from the camera). A webcam knows no metres of the
// room, so the hand is moved relatively, while a clutch is on.
const palm = [0, 5, 9, 13, 17];
const tips = [4, 8, 12, 16, 20];
// As a webcam of 60 degrees has it: focal length in widths of the picture.
const focal = 0.87;
export const usualPalm = 0.095;  // m, wrist to the middle knuckle, of the glove's hand of scale 1

const minus = (a, b) => a.map((x, i) => x - b[i]);
const length = (a) => Math.hypot(...a);
const mean = (points) => points[0].map((_, k) => points.reduce((sum, p) => sum + p[k], 0) / points.length);
export const distance = (a, b) => length(minus(a, b));

// The user looks along x of the table at the lab, z is up: right in the picture, which is not
// mirrored, is the user's left.
export const onTable = ([x, y, z]) => [-z, x, -y];

// Where the middle of the palm is before the camera, m: the scale at which its points in metres
// become those of the picture tells how far it is, however it is turned.
export function placeOf(picture, metres, ratio) {
  const flat = picture.map(({ x, y }) => [x - 0.5, (y - 0.5) / ratio]);  // in widths
  const seen = mean(flat), real = mean(metres.map((p) => p.slice(0, 2)));
  let product = 0, square = 0;
  flat.forEach((p, i) => {
    const a = minus(p, seen), b = minus(metres[i].slice(0, 2), real);
    product += a[0] * b[0] + a[1] * b[1];
    square += b[0] * b[0] + b[1] * b[1];
  });
  const scale = product / square;  // widths a metre
  if (!(scale > 0.05 && scale < 20)) return undefined;
  const centre = mean(palm.map((i) => flat[i]));
  return [centre[0] / scale, centre[1] / scale, focal / scale];
}

// A headset's 25 joints (x right, y up, -z forward) as the 21 points of a webcam that stands before the user:
// without the bones of the palm, and in its axes.
export const ofHeadset = (joints) =>
  joints.filter((_, i) => ![5, 10, 15, 20].includes(i)).map(([x, y, z]) => [-x, -y, z]);

export const middleOfPalm = (points) => mean(palm.map((i) => points[i]));

const curl = (points) => mean(tips.slice(1).map((i) => [distance(points[i], points[0])]))[0];

// What three postures tell of the user's hand; or why not.
export function calibrationOf({ open, fist, pinch }) {
  const measured = distance(open[9], open[0]);
  if (!(measured > 0.05 && measured < 0.16)) return { refused: "the open hand is not seen whole" };
  if (curl(fist) > 0.75 * curl(open)) return { refused: "the fist was not closed" };
  const gap = distance(pinch[4], pinch[8]);
  if (gap > 0.06) return { refused: "thumb and index did not touch" };
  return { scale: usualPalm / measured, gap };
}

// In the size of the glove's hand, and with a pinch that closes: what is left of the gap between thumb
// and index then is taken out, the nearer they are the more of it.
export function calibrated(points, { scale = 1, gap = 0 } = {}) {
  const apart = distance(points[4], points[8]);
  const share = gap > 0 && apart > 1e-4 ? Math.min(1, Math.max(0, (3 * gap - apart) / (2 * gap))) : 0;
  const step = share * Math.min(gap, apart) / 2 / (apart || 1);
  const made = points.map((p) => [...p]);
  for (let k = 0; k < 3; ++k) {
    const across = points[8][k] - points[4][k];
    made[4][k] += step * across;
    made[8][k] -= step * across;
  }
  return made.map((p) => p.map((x) => scale * x));
}

// Follows a hand by what it moves while the clutch is on. What was lost, or jumped, takes hold anew.
export class Clutch {
  constructor(start) {
    this.at = [...start];  // on the table, m
    this.on = false;
    this.last = undefined;
  }
  lose() {
    this.last = undefined;
  }
  // place: before the camera, m.
  follow(place) {
    const now = onTable(place);
    const step = this.last && minus(now, this.last);
    this.last = now;
    if (this.on && step && length(step) < 0.15) this.at = this.at.map((x, k) => x + step[k]);
    return this.at;
  }
}

// Points on the table: the palm's middle is at `at`.
export function pointsAt(metres, at) {
  const turned = metres.map(onTable), centre = middleOfPalm(turned);
  return turned.map((p) => p.map((x, k) => x - centre[k] + at[k]));
}
