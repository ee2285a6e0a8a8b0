// What presses on the robot's fingers, told to whoever leads them: the harder, the louder a tone and the stronger
// the vibration of a headset's controllers. Either ends by itself 100 ms after the last word of it.
const fullForce = 20;  // N: louder it does not get
const holds = 0.1;     // s
const loudest = 0.2, pitch = 150, settles = 0.01;  // of full scale, Hz, s

export class Touch {
  constructor(button) {
    this.button = button;
    button.onclick = () => this.sound(!this.level);
  }

  // A browser lets a page sound only once somebody has asked for it.
  sound(on) {
    if (on) {
      this.audio ??= new AudioContext();
      this.audio.resume();
      const tone = new OscillatorNode(this.audio, { type: "triangle", frequency: pitch });
      this.level = new GainNode(this.audio, { gain: 0 });
      tone.connect(this.level).connect(this.audio.destination);
      tone.start();
    } else {
      this.level.disconnect();
      this.level = undefined;
    }
    this.button.setAttribute("aria-pressed", String(on));
  }

  show({ group, values }) {
    if (group !== "touch") return;
    const strength = Math.min(1, Math.max(0, ...values) / fullForce);
    if (this.level) {
      const { gain } = this.level, now = this.audio.currentTime;
      gain.cancelScheduledValues(now);
      gain.setTargetAtTime(loudest * strength, now, settles);
      gain.setTargetAtTime(0, now + holds, settles);
    }
    for (const source of this.sources?.() ?? [])
      if (strength > 0) source.gamepad?.hapticActuators?.[0]?.pulse(strength, 1000 * holds);
  }
}
