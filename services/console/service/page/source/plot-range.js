// The range of a plot's values. Numbers that differ by rounding alone are a flat line: uPlot would look
// for marks between them without end.
const share = 1e-4;       // of the largest value
const leastRoom = 1e-9;   // of any unit

// Both, or as far apart as a person may want to see, about their middle.
export function apart(least, most) {
  const room = Math.max(leastRoom, share * Math.max(Math.abs(least), Math.abs(most)));
  if (most - least >= room) return [least, most];
  const middle = least + (most - least) / 2;
  return [middle - room, middle + room];
}
