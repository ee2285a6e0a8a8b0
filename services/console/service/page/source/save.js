// The last grasp for other programs: its contacts as CSV, the scene as it is drawn as PNG.
const byId = (id) => document.getElementById(id);
let last;

function save(name, blob) {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
}

// Names are the lab's own words; a quote in one would end its cell.
const quoted = (text) => `"${String(text).replaceAll('"', '""')}"`;

function contactsOf(report) {
  const head = "object,epsilon,volume,held,link,x_m,y_m,z_m,normal_x,normal_y,normal_z,friction,force_N,depth_m";
  const lines = report.contacts.map(({ link, p_OC: p, normal_O: n, friction, force, depth }) =>
    [quoted(report.object), report.epsilon, report.volume, report.held, quoted(link),
     p.x, p.y, p.z, n.x, n.y, n.z, friction, force, depth].join(","));
  return `${[head, ...lines].join("\n")}\n`;
}

export function keepReport(report) {
  last = report;
  byId("csv").disabled = false;
}

// draw: draws the scene at once, for its buffer is empty between two frames.
export function setUpSaving(draw) {
  byId("csv").onclick = () =>
    save(`grasp-of-${last.object.replace(/\W+/g, "-")}.csv`, new Blob([contactsOf(last)], { type: "text/csv" }));
  byId("png").disabled = !draw;
  byId("png").onclick = () => {
    draw();
    byId("view").toBlob((blob) => save("scene.png", blob));
  };
}
