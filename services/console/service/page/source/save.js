// The last grasp for other programs: its contacts as CSV, and the scene with its figures as PNG.
const byId = (id) => document.getElementById(id);
let last;

function save(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

const nameOf = ({ object }) => object.replace(/\W+/g, "-");
// Names are the lab's own words; a quote in one would end its cell.
const quoted = (text) => `"${String(text).replaceAll('"', '""')}"`;

function contactsOf(report) {
  const head = "object,epsilon,volume,held,link,x_m,y_m,z_m,normal_x,normal_y,normal_z,friction,force_N,depth_m";
  const lines = report.contacts.map(({ link, p_OC: p, normal_O: n, friction, force, depth }) =>
    [quoted(report.object), report.epsilon, report.volume, report.held, quoted(link),
     p.x, p.y, p.z, n.x, n.y, n.z, friction, force, depth].join(","));
  return `${[head, ...lines].join("\n")}\n`;
}

function figuresOf({ object, epsilon, volume, contacts, held, reason }) {
  const figure = (value, digits) => (Number.isFinite(value) ? value.toFixed(digits) : "–");
  return `${object}: ε ${figure(epsilon, 3)}, volume ${figure(volume, 3)}, ${contacts.length} contacts, ` +
    (held ? "held" : `dropped${reason ? `: ${reason}` : ""}`);
}

// The scene, and below it a line of figures.
function pictureOf(view) {
  const line = 40, made = document.createElement("canvas");
  made.width = view.width;
  made.height = view.height + line;
  const context = made.getContext("2d");
  context.fillStyle = "#fff";
  context.fillRect(0, 0, made.width, made.height);
  context.drawImage(view, 0, 0);
  context.fillStyle = "#1b2430";
  context.font = "20px sans-serif";
  if (last) context.fillText(figuresOf(last), 12, view.height + 27, made.width - 24);
  return made;
}

export function keepReport(report) {
  last = report;
  byId("csv").disabled = false;
}

// draw: draws the scene at once, for its buffer is empty between two frames.
export function setUpSaving(draw) {
  byId("csv").onclick = () =>
    save(`grasp-of-${nameOf(last)}.csv`, new Blob([contactsOf(last)], { type: "text/csv" }));
  byId("png").disabled = !draw;
  byId("png").onclick = () => {
    draw();
    pictureOf(byId("view")).toBlob((blob) => save(last ? `grasp-of-${nameOf(last)}.png` : "scene.png", blob));
  };
}
