// Tables and lists beside the scene. Text of messages becomes text of the page, never markup.
const byId = (id) => document.getElementById(id);
const maxLines = 200, maxGrasps = 8;

function element(name, text, kind = "") {
  const made = document.createElement(name);
  made.textContent = text;
  if (kind) made.className = kind;
  return made;
}

function row(...cells) {
  const made = document.createElement("tr");
  made.append(...cells.map((cell) => (cell instanceof Node ? cell : element("td", cell))));
  return made;
}

const figure = (value, digits) => (Number.isFinite(value) ? value.toFixed(digits) : "–");

export function showStatus({ services, missing, gates }) {
  byId("services").replaceChildren(
    ...services.map((one) => {
      const line = element("li", "");
      const kind = one.state === "running" ? "good" : one.state === "degraded" ? "bad" : "warn";
      line.append(element("strong", one.name), " ", element("span", one.state, kind), " ",
                  element("span", one.host, "quiet"));
      if (one.message) line.append(element("div", one.message, "warn"));
      if (one.dropped) line.append(element("div", `${one.dropped} inputs not used`, "quiet"));
      return line;
    }),
    ...missing.map(({ name, reason }) => {
      const line = element("li", "");
      line.append(element("strong", name), " ", element("span", "missing", "bad"), element("div", reason, "quiet"));
      return line;
    }));
  const stopped = gates.filter((gate) => gate.stopped);
  byId("gate").textContent = stopped
    .map((gate) => `${gate.hand} is stopped by ${gate.stopped_by || "somebody"}: ${gate.reason || "no reason given"}`)
    .join("; ");
}

export function showLatency({ stages }) {
  byId("latency").tBodies[0].replaceChildren(
    ...stages.map((s) => row(`${s.service.split("@")[0]}, ${s.stage}`, figure(s.p50_ms, 1), figure(s.p99_ms, 1))));
}

export function showReport(report) {
  const held = report.held ? "held" : `dropped${report.reason ? ": " + report.reason : ""}`;
  const line = byId("grasp");
  line.textContent = `${report.object}: ε ${figure(report.epsilon, 3)}, ${report.contacts.length} contacts, ${held}`;
  line.className = report.held ? "good" : "bad";
  const body = byId("grasps").tBodies[0];
  body.prepend(row(report.object, figure(report.epsilon, 3), String(report.contacts.length),
                   element("td", report.held ? "yes" : "no", report.held ? "good" : "bad")));
  while (body.rows.length > maxGrasps) body.deleteRow(-1);
}

const phases = {
  TRAINING_SHOWING: ({ step, shown, asked }) => `Show «${step}» (${shown + 1} of ${asked})`,
  TRAINING_COMPUTING: ({ name, share }) => `Training for ${name}: ${(100 * share).toFixed(0)} %`,
  TRAINING_DONE: () => "Done",
  TRAINING_FAILED: () => "Failed",
};

// A teacher that has nothing to do shows nothing.
export function showTraining(told) {
  const words = phases[told.phase];
  byId("training").hidden = !words;
  if (!words) return;
  byId("training-step").textContent = words(told);
  byId("training-step").className = told.phase === "TRAINING_FAILED" ? "bad" : "";
  byId("training-share").value = told.share;
  byId("training-message").textContent = told.message;
}

export function showLog({ timestamp, level, name, message }) {
  const list = byId("log");
  const time = new Date(timestamp.sec * 1000).toLocaleTimeString();
  list.prepend(element("li", `${time} ${name}: ${message}`, level >= 4 ? "bad" : level === 3 ? "warn" : ""));
  while (list.children.length > maxLines) list.lastChild.remove();
}

export function forgetLists() {
  byId("log").replaceChildren();
  byId("grasps").tBodies[0].replaceChildren();
  byId("grasp").textContent = "none yet";
  byId("grasp").className = "";
}

export function showLink(text, good) {
  byId("link").textContent = text;
  byId("link").className = good ? "" : "bad";
}

export function showLag(ms) {
  byId("lag").textContent = ms === undefined ? "" : `hand's state ${Math.max(0, ms).toFixed(0)} ms old`;
}
