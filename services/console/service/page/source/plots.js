// Numbers over the last seconds: joints, fingertips, weight, latency. Each group is a plot, each
// name a line.
import uPlot from "uplot";
import { apart } from "./plot-range.js";

const span = 20;  // s
const redrawEvery = 200;  // ms
const maxPoints = 3000;
// Told apart by people with any eyes, and against light and dark.
const colours = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#b8860b", "#56b4e9", "#8a63d2", "#808080"];

class Plot {
  constructor(place, title) {
    this.place = place;
    this.title = title;
    this.times = [];
    this.rows = [];  // values by name, one for each time
    this.names = [];
  }

  add(time, names, values) {
    // A recording begins anew, or is wound back.
    if (time < this.times[this.times.length - 1]) [this.times, this.rows] = [[], []];
    if (time === this.times[this.times.length - 1]) return;
    this.times.push(time);
    this.rows.push(new Map(names.map((name, i) => [name, values[i]])));
    let old = this.times.length > maxPoints ? this.times.length - maxPoints : 0;
    while (this.times[old] < time - span) ++old;
    this.times.splice(0, old);
    this.rows.splice(0, old);
    if (names.some((name) => !this.names.includes(name))) {
      this.names = [...new Set([...this.names, ...names])];
      this.plot?.destroy();
      this.plot = undefined;
    }
    this.stale = true;
  }

  draw() {
    const width = this.place.clientWidth;
    if (!this.stale || !width) return;
    this.stale = false;
    const now = this.times[this.times.length - 1];
    const data = [this.times.map((time) => time - now),
                  ...this.names.map((name) => this.rows.map((row) => row.get(name) ?? null))];
    const ink = getComputedStyle(this.place).color;
    const axis = { stroke: ink, grid: { stroke: "#8886", width: 1 }, ticks: { show: false }, font: "11px sans-serif" };
    this.plot ??= new uPlot({
      title: this.title, width, height: 130, legend: { live: false }, cursor: { show: false },
      scales: {
        x: { time: false, range: [-span, 0] },
        y: { range: (_, least, most) => least == null ? [null, null] : uPlot.rangeNum(...apart(least, most), 0.1, true) },
      },
      axes: [{ ...axis, size: 24 }, { ...axis, size: 44 }],
      series: [{}, ...this.names.map((label, i) =>
        ({ label, stroke: colours[i % colours.length], width: 1.2, points: { show: false } }))],
    }, data, this.place);
    if (this.plot.width !== width) this.plot.setSize({ width, height: 130 });
    this.plot.setData(data);
    this.place.dataset.points = String(this.times.length);
  }
}

export class Plots {
  constructor(place) {
    this.place = place;
    this.plots = new Map();
    setInterval(() => this.draw(), redrawEvery);
  }

  plot(id, title) {
    let plot = this.plots.get(id);
    if (!plot) {
      const place = document.createElement("div");
      place.setAttribute("role", "img");
      place.setAttribute("aria-label", `${title} over the last ${span} seconds`);
      this.place.append(place);
      this.plots.set(id, (plot = new Plot(place, title)));
    }
    return plot;
  }

  show({ timestamp, group, source, unit, names, values }) {
    this.plot(`${group}/${source}`, `${group} of ${source}${unit ? `, ${unit}` : ""}`)
      .add(timestamp.sec + timestamp.nsec / 1e9, names, values);
  }

  latency({ stages }) {
    if (!stages.length) return;
    this.plot("latency", "latency, ms (median)").add(
      Date.now() / 1000, stages.map((s) => `${s.service.split("@")[0]}, ${s.stage}`), stages.map((s) => s.p50_ms));
  }

  draw() {
    if (document.hidden || !this.place.closest("details").open) return;
    for (const plot of this.plots.values()) plot.draw();
  }
}
