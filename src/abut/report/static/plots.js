"use strict";
// Plots with uPlot: convergence, history over the steps, pressure along lines.

const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
const short = (value, digits = 5) => {
  if (value == null || value === 0) return value === 0 ? "0" : "";
  const size = Math.abs(value);
  return size < 1e-3 || size >= 1e6 ? value.toExponential(Math.max(3, digits - 2)).replace(/\.?0*e/, "e").replace("e+", "e") : String(Number(value.toPrecision(digits)));
};

function plot(parent, title, xLabel, xs, series, options = {}) {
  const box = document.createElement("div");
  box.className = "plot";
  const heading = document.createElement("h3");
  heading.textContent = title;
  box.append(heading);
  parent.append(box);
  const grid = { stroke: colour("line"), width: 1 };
  const axis = (more) => ({ stroke: colour("soft"), grid, ticks: grid, font: "12px system-ui", labelFont: "12px system-ui", ...more });
  const powers = (u, values) => values.map((v) => v == null ? "" : "1e" + Math.round(Math.log10(v)));
  const plain = (u, values) => { // as many digits as tell neighbours apart
    const most = Math.max(...values.map((v) => Math.abs(v || 0))), gap = values.length > 1 ? Math.abs(values[1] - values[0]) : most;
    const digits = gap > 0 ? Math.min(15, Math.max(5, Math.ceil(Math.log10(most / gap)) + 2)) : 5;
    return values.map((v) => short(v, digits));
  };
  const decades = (u, axis, low, high) => { // at most eight powers of ten
    const [a, b] = [Math.ceil(Math.log10(low)), Math.floor(Math.log10(high))], every = Math.max(1, Math.ceil((b - a) / 7));
    return Array.from({ length: Math.floor((b - a) / every) + 1 }, (_, i) => 10 ** (b - i * every)).reverse();
  };
  const right = series.some((s) => s.right);
  const pad = options.whole ? 0.5 : 0;
  const logarithmic = (u, low, high) => low > 0 ? [10 ** Math.floor(Math.log10(low) - 0.2), 10 ** Math.ceil(Math.log10(high) + 0.2)] : [1e-16, 1];
  const linear = (u, low, high) => {
    if (low == null) return [0, 1];
    low = low > -1e-6 * high ? 0 : low; // rounding below zero is none
    if (high <= low) high = low + 1;
    return [low < 0 ? low - 0.05 * (high - low) : 0, high + 0.08 * (high - low)];
  };
  const chart = new uPlot({
    width: box.clientWidth - 20, height: 270,
    scales: {
      x: { time: false, range: (u, low, high) => low === high ? [low - 0.5, high + 0.5] : [low - pad, high + pad] },
      y: options.log ? { distr: 3, range: logarithmic } : { range: linear },
      right: { range: linear },
    },
    axes: [
      axis({ label: xLabel, size: 44, labelSize: 20, values: plain, incrs: options.whole ? [1, 2, 5, 10, 20, 50, 100, 200, 500] : undefined }),
      axis({ size: 72, values: options.log ? powers : plain, splits: options.log ? decades : undefined, filter: (u, s) => s }),
      ...(right ? [axis({ scale: "right", side: 1, size: 72, grid: { show: false }, values: plain, label: "gap", labelSize: 18 })] : []),
    ],
    series: [
      { label: "at", value: (u, v) => short(v) }, // the axis has the words
      ...series.map((s) => ({
        label: s.label, scale: s.right ? "right" : "y", stroke: colour(s.colour), width: s.width || 2, dash: s.dash, spanGaps: Boolean(s.spans),
        points: { show: s.points !== false && xs.length < 60, size: 6, fill: colour("paper"), stroke: colour(s.colour) },
        value: (u, v) => v == null ? "–" : v.toPrecision(5),
      })),
    ],
    hooks: options.marks ? { draw: [(u) => marks(u, options.marks)] } : {},
  }, [xs, ...series.map((s) => s.values)], box);
  saving(box, chart, title, xLabel, series);
  new ResizeObserver(() => {
    if (Math.abs(chart.width - (box.clientWidth - 20)) > 2) chart.setSize({ width: box.clientWidth - 20, height: 270 });
  }).observe(box);
}

// Buttons that save the numbers of a plot as CSV and its drawing as PNG.
function saving(box, chart, title, xLabel, series) {
  const save = (name, address) => Object.assign(document.createElement("a"), { href: address, download: `${title.replace(/[^\w.-]+/g, "_")}.${name}` }).click();
  const cell = (v) => v == null ? "" : typeof v === "number" ? String(v) : `"${v.replace(/"/g, '""')}"`;
  const csv = () => [[xLabel, ...series.map((s) => s.label)], ...chart.data[0].map((_, i) => chart.data.map((column) => column[i]))]
    .map((row) => row.map(cell).join(",")).join("\n") + "\n";
  const png = () => {
    const from = chart.ctx.canvas, ratio = from.width / (chart.width || 1), head = 54 * ratio, canvas = document.createElement("canvas");
    Object.assign(canvas, { width: from.width, height: from.height + head });
    const to = canvas.getContext("2d");
    to.fillStyle = colour("paper");
    to.fillRect(0, 0, canvas.width, canvas.height);
    to.fillStyle = colour("text");
    to.font = `600 ${14 * ratio}px system-ui`;
    to.fillText(title, 10 * ratio, 20 * ratio);
    to.font = `${12 * ratio}px system-ui`;
    series.reduce((x, s) => {
      to.fillStyle = colour(s.colour);
      to.fillText(s.label, x, 42 * ratio);
      return x + to.measureText(s.label).width + 18 * ratio;
    }, 10 * ratio);
    to.drawImage(from, 0, head);
    return canvas.toDataURL("image/png");
  };
  const buttons = Object.assign(document.createElement("div"), { className: "save" });
  for (const [name, address] of [["CSV", () => "data:text/csv;charset=utf-8," + encodeURIComponent(csv())], ["PNG", png]]) {
    buttons.append(Object.assign(document.createElement("button"), { textContent: name, title: `save this plot as ${name}`, onclick: () => save(name.toLowerCase(), address()) }));
  }
  box.append(buttons);
  box.abut = { csv, png };
}

function marks(u, places) { // vertical lines where a new load step begins
  u.ctx.save();
  u.ctx.strokeStyle = colour("soft");
  u.ctx.setLineDash([4, 4]);
  for (const place of places) {
    const x = u.valToPos(place, "x", true);
    u.ctx.beginPath();
    u.ctx.moveTo(x, u.bbox.top);
    u.ctx.lineTo(x, u.bbox.top + u.bbox.height);
    u.ctx.stroke();
  }
  u.ctx.restore();
}

function drawPlots(data) {
  const at = (id) => { const e = document.getElementById(id); e.replaceChildren(); return e; };
  const lines = at("lines");
  lines.closest("section").hidden = !data.lines.length;
  if (data.probes.length) at("probes");
  for (const line of data.lines) {
    const series = [{ label: "pressure", values: line.pressure, colour: "accent", points: false }];
    if (line.traction) series.push({ label: "tangential traction", values: line.traction, colour: "good", points: false });
    if (line.limit) series.push({ label: "its limit", values: line.limit, colour: "good", dash: [3, 4], width: 1.2, points: false });
    if (line.theory) series.push({ label: "theory", values: line.theory, colour: "second", dash: [6, 5], points: false });
    if (line.gap.some((v) => v != null)) series.push({ label: "gap", values: line.gap, colour: "third", right: true, width: 1.2, points: false });
    plot(lines, `${line.contact}: pressure ${line.label}`, `distance from ${line.zero}`, line.distance, series);
  }
  const colours = ["accent", "second", "third", "good", "bad", "soft"];
  for (const chart of data.probes) {
    const series = chart.series.map((s, i) => ({
      ...s, colour: colours[i % colours.length], dash: i < colours.length ? undefined : [6, 5],
      right: s.label === "gap" && chart.series.length > 1, points: chart.x.length < 30,
    }));
    plot(document.getElementById("probes"), chart.title, chart.label, chart.x, series);
  }
  if (data.beside.length) at("beside");
  for (const chart of data.beside) {
    plot(document.getElementById("beside"), chart.title, chart.label, chart.x, chart.series.map((s, i) => ({ ...s, colour: colours[i], dash: i ? [6, 5] : undefined, spans: true, points: false })));
  }
  const paths = at("paths");
  paths.closest("section").hidden = !data.paths.length;
  for (const path of data.paths) {
    plot(paths, path.title, path.label, path.x, path.series.map((s, i) => ({ ...s, colour: colours[i % colours.length], spans: true })));
  }
  const run = data.convergence;
  const count = run.step.map((_, i) => i + 1);
  const borders = run.step.flatMap((s, i) => i && s !== run.step[i - 1] ? [i + 0.5] : []);
  const whole = { whole: true, marks: borders };
  const positive = (values) => values.map((v) => v == null ? null : Math.max(v, 1e-17));
  const convergence = at("convergence");
  plot(convergence, "Residuals", "iteration", count, [
    { label: "equilibrium, over the reference force", values: positive(run.residual), colour: "accent" },
    { label: "contact law, over the reference pressure", values: positive(run.contact), colour: "second" },
  ], { ...whole, log: true });
  plot(convergence, "Active set", "iteration", count, [
    { label: "in contact", values: run.active, colour: "accent" },
    { label: "changed", values: run.changed, colour: "second" },
    ...(run.slipping.length ? [{ label: "slipping", values: run.slipping, colour: "third" }] : []),
  ], whole);
  const history = at("history");
  if (data.history.time.length > 1) {
    for (const [key, title] of [["force", "Contact force (resultant)"], ["by_area", "Contact force by area"], ["area", "Contact area"], ["pressure", "Largest pressure"]]) {
      if (!data.history.contacts.length) break;
      plot(history, title, data.history.label, data.history.time,
        data.history.contacts.map((c, i) => ({ label: c.name, values: c[key], colour: colours[i % colours.length] })));
    }
    for (const c of data.history.contacts.filter((own) => own.friction)) drawFriction(history, data.history.label, data.history.time, c);
  }
}

// Over the steps: force of friction by area with what it can be at most, and its work with the slipping area.
function drawFriction(parent, label, times, contact) {
  const own = contact.friction;
  const limit = own.limit.some((v) => v != null) ? [{ label: "at most", values: own.limit, colour: "second", dash: [6, 5] }] : [];
  plot(parent, `${contact.name}: friction force by area`, label, times, [{ label: "friction force", values: own.force, colour: "accent" }, ...limit]);
  plot(parent, `${contact.name}: work of friction`, label, times, [{ label: "work in all", values: own.work, colour: "accent" }]);
  plot(parent, `${contact.name}: area`, label, times, [
    { label: "sticking", values: own.sticking, colour: "accent" },
    { label: "slipping", values: own.slipping, colour: "second" },
  ]);
}
