// The deadman: where a hand asks for consent, it moves only while its button is held here.
const token = document.querySelector('meta[name="prehend-token"]').content;
const byId = (id) => document.getElementById(id);
const period = 30;  // ms; the gate waits for 100
const patience = 250;  // ms
const pause = (ms) => new Promise((over) => setTimeout(over, ms));
const holders = new Map();  // by hand

class Holder {
  constructor(hand) {
    this.hand = hand;
    this.pressed = this.busy = false;
    const button = (this.button = document.createElement("button"));
    button.textContent = `Hold: ${hand} may move`;
    button.setAttribute("aria-pressed", "false");
    button.onpointerdown = (event) => {
      button.setPointerCapture(event.pointerId);
      this.press();
    };
    button.onkeydown = (event) => {
      if (event.key !== " " && event.key !== "Enter") return;
      event.preventDefault();
      this.press();
    };
    for (const over of ["pointerup", "pointercancel", "lostpointercapture", "keyup", "blur"])
      button.addEventListener(over, () => this.letGo());
    button.oncontextmenu = (event) => event.preventDefault();
    byId("deadmen").append(button);
  }

  letGo() {
    this.pressed = false;
  }

  // One word after the other, so that the last one is that it was let go. What the console told last
  // goes back with each: so one that is long on its way is not taken for now.
  async press() {
    this.pressed = true;
    if (this.busy) return;
    this.busy = true;
    for (let now; this.pressed;) {
      const begun = performance.now();
      try {
        now = await this.say(now !== undefined, now);
        byId("consent-state").textContent = "";
      } catch (error) {
        now = undefined;
        byId("consent-state").textContent = error.message;
      }
      await pause(Math.max(0, period - (performance.now() - begun)));
    }
    await this.say(false).catch(() => {});
    this.busy = false;
    if (this.pressed) this.press();
  }

  async say(held, now_ms) {
    const response = await fetch("/consent", {
      method: "POST", signal: AbortSignal.timeout(patience),
      headers: { "X-Prehend-Token": token, "Content-Type": "application/json" },
      body: JSON.stringify({ hand: this.hand, held, now_ms }),
    });
    if (!response.ok) throw new Error((await response.text()).trim());
    return (await response.json()).now_ms;
  }
}

const letGoOfAll = () => holders.forEach((one) => one.letGo());
window.addEventListener("blur", letGoOfAll);
document.addEventListener("visibilitychange", letGoOfAll);

// A button for each hand that asks for it; pressed as the gate says, not as we hope.
export function showConsent({ gates }) {
  const asking = token ? gates.filter((gate) => gate.deadman) : [];
  byId("consent").hidden = !asking.length;
  for (const [hand, { button }] of holders) button.hidden = !asking.some((gate) => gate.hand === hand);
  for (const { hand, consent } of asking) {
    if (!holders.has(hand)) holders.set(hand, new Holder(hand));
    holders.get(hand).button.setAttribute("aria-pressed", String(consent));
  }
}
