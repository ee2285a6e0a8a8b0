// Buttons. Each order shows what was answered, by whom, or that nobody did.
const patience = 3000;
const token = document.querySelector('meta[name="prehend-token"]').content;
const waiting = new Map();  // lines by the order's id

function answerLine(text) {
  const line = document.createElement("li");
  line.textContent = text;
  const list = document.getElementById("answers");
  list.prepend(line);
  while (list.children.length > 8) list.lastChild.remove();
  return line;
}

// more: beside the argument, as where an object is placed.
async function give(action, argument, more = {}) {
  const words = argument ? `${action} (${argument})` : action;
  const line = answerLine(`${words}: sent`);
  try {
    const response = await fetch("/order", {
      method: "POST",
      headers: { "X-Prehend-Token": token, "Content-Type": "application/json" },
      body: JSON.stringify({ action, argument, ...more }),
    });
    if (!response.ok) throw new Error((await response.text()).trim());
    const { id } = await response.json();
    waiting.set(id, { line, words, answers: [] });
    for (const reply of early.splice(0)) showReply(reply);
    setTimeout(() => {
      const one = waiting.get(id);
      if (one && !one.answers.length) {
        one.line.textContent = `${words}: nobody answered`;
        one.line.className = "bad";
      }
    }, patience);
  } catch (error) {
    line.textContent = `${words}: ${error.message}`;
    line.className = "bad";
  }
}

const early = [];  // replies that came before the order's id

export function showReply(reply) {
  const one = waiting.get(reply.id);
  if (!one) {
    early.push(reply);
    if (early.length > 20) early.shift();
    return;
  }
  one.answers.push(`${reply.service}: ${reply.message || (reply.done ? "done" : "not done")}`);
  one.line.textContent = `${one.words}: ${one.answers.join("; ")}`;
  one.line.className = reply.done ? "good" : "bad";
}

// An order that nobody would obey is greyed, and says why. A stop is always given.
const obeyedBy = { record: "recorder", replay: "replayer", mode: "mapping", place: "simulation", show: "demonstration",
                   teach: "teacher" };
export function showWhoObeys({ services }) {
  for (const [action, name] of Object.entries(obeyedBy)) {
    const there = services.some((one) => one.name === name);
    for (const control of document.getElementById(action).elements) {
      control.disabled = !there;
      control.title = there ? "" : `${name} is not there`;
    }
  }
}

export function setUpOrders() {
  if (!token) return;
  document.getElementById("orders").hidden = false;
  document.getElementById("stop").onclick = () => give("stop", "by the console");
  document.getElementById("shown").onclick = () => give("shown", "");
  document.getElementById("orders-address").textContent =
    `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/?orders=${token}`;
  document.getElementById("teach").onsubmit = (event) => {
    event.preventDefault();
    const { verb, name } = Object.fromEntries(new FormData(event.target));
    give("teach", verb === "show" || verb === "train" ? `${verb} ${name}` : verb);
  };
  for (const action of ["release", "record", "replay", "mode", "place", "show", "lead"])
    document.getElementById(action).onsubmit = (event) => {
      event.preventDefault();
      const { argument, ...rest } = Object.fromEntries(new FormData(event.target));
      give(action, argument, Object.fromEntries(Object.entries(rest).map(([name, value]) => [name, Number(value)])));
    };
}

// What stands there already is offered to be placed elsewhere.
export function showObject(name) {
  const list = document.getElementById("objects");
  if ([...list.options].some((one) => one.value === name)) return;
  const option = document.createElement("option");
  option.value = name;
  list.append(option);
}
