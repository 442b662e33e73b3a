// The page: what the sliders say, the rupture that follows, and how it is shown.

const DATA = JSON.parse(document.getElementById("data").textContent);
const at = (id) => document.getElementById(id);
const NAMES = ["beta", "dx", "left", "right", "width", "gamma"];
const SLIDERS = Object.fromEntries(NAMES.map((name) => [name, at(name)]));
// The map ends at this many times T_trans.
const MULTIPLE = 3;
const RATIO_TICKS = [0, 0.01, 0.1, 1];
// Exact values: a slider has steps between which a preset or a run may lie.
const settings = { release: "total" };
let before = null;

function range(slider) {
  return [Number(slider.dataset.low), Number(slider.dataset.high)];
}

function valueOf(slider) {
  const [low, high] = range(slider);
  const fraction = slider.value / 100;
  if (slider.dataset.kind === "even") return Number((low + (high - low) * fraction).toFixed(3));
  if (slider.dataset.kind.startsWith("zero") && fraction === 0) return 0;
  return Number((low * (high / low) ** fraction).toPrecision(3));
}

function set(name, value) {
  const slider = SLIDERS[name];
  const [low, high] = range(slider);
  const fraction = slider.dataset.kind === "even" ? (value - low) / (high - low) : Math.log(value / low) / Math.log(high / low);
  slider.value = Math.round(100 * Math.max(fraction, 0));
  settings[name] = value;
  note(name);
}

function note(name) {
  at(`${name}-shown`).textContent = format(settings[name]);
  SLIDERS[name].setAttribute("aria-valuetext", format(settings[name]));
}

// The exact numbers of a scene, with rows of what is exact and what the paper's formulas say.
function compared(rupture, { left, right, gamma }) {
  const exact = rupture.transition();
  const pulse = rupture.pulse(MULTIPLE * exact.transitionTime, exact.firstStick);
  const paper = paperPulse(right, gamma);
  const paperLeft = paperPulse(left, gamma);
  const rows = [["front speed v", exact.speed, paper.speed]];
  if (left !== right) rows.push(["front speed v on the left", exact.speedLeft, paperLeft.speed]);
  rows.push(
    ["T_trans", exact.transitionTime, paper.time],
    ["L_trans", exact.transitionLength, paper.time * (paper.speed + paperLeft.speed)],
    ["width of the right pulse at the end", pulse.width, paper.width],
    ["its width once steady", paper.time * Math.sqrt(exact.speed ** 2 - 1), paper.width],
    ["slip behind it at the end", pulse.slip, paper.slip],
  );
  return { exact, pulse, paper, rows };
}

function paperPulse(tau, gamma) {
  const speed = 1 / Math.sqrt(1 - tau * tau);
  const time = Math.PI / Math.sqrt(gamma);
  return { speed, time, width: time * tau * speed, slip: 2 * tau / gamma, peak: 1 / Math.sqrt(gamma) };
}

function drawMap(rupture, scene, { exact, pulse }) {
  const end = pulse.time;
  const found = columns(rupture, end);
  const largest = Math.max(...found.flatMap((column) => column.velocity));
  const [low, high] = rupture.fronts(end);
  const map = new Picture(at("map"), {
    x: [0, end], y: [1.04 * low, 1.04 * high], labels: ["time", "position x"], height: Math.min(520, 80 + 0.62 * innerWidth), top: 26,
  });
  const stuck = found.filter(({ stick }) => stick < end).map(({ y, stick }) => [stick, y]);
  const edge = [...stuck.filter(([, y]) => y < exact.firstStick), [exact.transitionTime, exact.firstStick],
    ...stuck.filter(([, y]) => y > exact.firstStick)];
  map.area([...edge, [end, edge.at(-1)[1]], [end, edge[0][1]]], "stuck");
  map.image(velocityImage(found, end, largest, DATA.colours), [0, end], [low, high],
    [...found.map(({ y, start }) => [start, y]), ...found.map(({ y, stop }) => [stop, y]).reverse()]);
  const undamped = new Rupture({ ...scene, ratio: 0 }, DATA.law);
  map.curve(found.map(({ y, start }) => [start, y]), "front");
  map.curve(found.map(({ y }) => [undamped.arrival(y), y]), "zero");
  map.curve(edge, "edge");
  const ends = rupture.fronts(exact.transitionTime);
  map.curve(ends.map((y) => [exact.transitionTime, y]), "thin");
  map.curve([[0, exact.firstStick], [exact.transitionTime, exact.firstStick]], "thin");
  map.scale(DATA.colours, `slip velocity up to ${format(largest, 3)}`);
  map.write(map.x(exact.transitionTime) + 5, map.y(0.75 * ends[1]), "L_trans");
  map.write(map.x(0.5 * exact.transitionTime), map.y(exact.firstStick) - 5, "T_trans", "middle");
  map.show(`Slip velocity in time and space, at most ${format(largest)}: a crack between two fronts, of speed`
    + ` ${format(exact.speed)} on the right, becomes two pulses at time ${format(exact.transitionTime)}.`);
}

function drawPulse(rupture, { pulse, paper }) {
  const points = Array.from({ length: 81 }, (_, k) => pulse.width * k / 80);
  const wave = Array.from({ length: 81 }, (_, k) => Math.PI * k / 80);
  const behind = (values) => points.map((distance, k) => [distance, values[k]]);
  const position = (distance) => pulse.front - distance;
  const panels = {
    velocity: {
      label: "slip velocity",
      exact: points.map((x) => (x === 0 ? 0 : Math.max(rupture.velocity(position(x), pulse.time), 0))),
      cosine: (phase) => paper.peak * Math.sin(phase),
    },
    slip: {
      label: "slip",
      exact: points.map((x) => rupture.slip(position(x), pulse.time)),
      cosine: (phase) => 0.5 * paper.slip * (1 - Math.cos(phase)),
    },
  };
  for (const [name, { label, exact, cosine }] of Object.entries(panels)) {
    const highest = Math.max(...exact, ...wave.map(cosine));
    const picture = new Picture(at(name), {
      x: [0, Math.max(pulse.width, paper.width)], y: [0, 1.08 * highest],
      labels: ["distance behind the front", label], height: 260,
    });
    picture.curve(wave.map((phase) => [paper.width * phase / Math.PI, cosine(phase)]), "paper");
    picture.curve(behind(exact), "exact");
    picture.show(`${label} of the right pulse: exact, ${format(pulse.width)} wide and at most`
      + ` ${format(Math.max(...exact))}; the paper's, ${format(paper.width)} wide and at most`
      + ` ${format(Math.max(...wave.map(cosine)))}.`);
  }
}

function drawSpeeds(scene, exact, paper) {
  const position = (b) => Math.asinh(b / 0.02);
  const ratios = Array.from({ length: 61 }, (_, k) => 0.02 * Math.sinh(position(DATA.largest_ratio) * k / 60));
  const speeds = (tau, release) => ratios.map((b) => [b, 1 / frontLaw(DATA.law, b, release)(1 - tau)]);
  const other = scene.release === "total" ? "elastic" : "total";
  const runs = DATA.runs.map(runOf).filter((run) => run.release === scene.release && run.speed !== null);
  const near = runs.filter(({ left }) => new Set(runs.filter((run) => run.left === left).map((run) => run.ratio)).size > 2)
    .reduce((best, { left }) => (
      best === null || Math.abs(left - scene.right) < Math.abs(best - scene.right) ? left : best), null);
  const curve = speeds(scene.right, scene.release);
  // As high as b = 1 reaches, or this b.
  const highest = Math.max(curve.findLast(([b]) => b <= 1)[1], exact.speed);
  const picture = new Picture(at("speeds"), {
    x: [0, DATA.largest_ratio], y: [1, 1 + 1.1 * (highest - 1)], xTicks: RATIO_TICKS, position,
    labels: ["b = β/dx", "front speed v"], height: 260,
  });
  picture.curve([[0, paper.speed], [DATA.largest_ratio, paper.speed]], "paper");
  picture.curve(speeds(scene.right, other), "thin");
  if (near !== null) {
    picture.curve(speeds(near, scene.release), "grey");
    for (const run of runs.filter((found) => found.left === near)) picture.dot(run.ratio, run.speed);
  }
  picture.curve(curve, "exact");
  picture.dot(scene.ratio, exact.speed, "here");
  picture.show(`Front speed against b: ${format(exact.speed)} at b = ${format(scene.ratio)},`
    + ` where the paper's formula says ${format(paper.speed)}.`);
}

// A run of the data by names.
function runOf([left, gamma, width, beta, ratio, release, speed, time, length, slip]) {
  return { left, right: left, gamma, width, beta, ratio, release, speed, time, length, slip };
}

function distance(run, scene) {
  return 10 * Math.abs(run.left - scene.left) + 10 * Math.abs(run.left - scene.right)
    + Math.abs(Math.log(run.gamma / scene.gamma)) + Math.abs(Math.log(run.width / scene.width))
    + Math.abs(Math.asinh(run.ratio / 0.02) - Math.asinh(scene.ratio / 0.02)) + 9 * (run.release !== scene.release);
}

function fill(table, rows) {
  table.tBodies[0].innerHTML = rows.map(([name, value, other]) => `<tr><th scope="row">${name}</th>`
    + `<td class="n">${format(value)}</td><td class="n">${format(other)}</td>`
    + `<td class="n">${value === null ? "–" : format(value / other)}</td></tr>`).join("");
}

function showNearest(scene) {
  const run = DATA.runs.map(runOf).reduce((best, found) => (distance(found, scene) < distance(best, scene) ? found : best));
  const exact = new Rupture(run, DATA.law).transition();
  fill(at("simulated"), [
    ["front speed v", run.speed, exact.speed],
    ["T_trans", run.time, exact.transitionTime],
    ["L_trans", run.length, exact.transitionLength],
    ["slip of the steady pulse", run.slip, steadySlip(run, exact.speed)],
  ]);
  at("nearest").textContent = `τ₀ = ${format(run.left)} on both sides, γ = ${format(run.gamma)},`
    + ` W = ${format(run.width)}, b = ${format(run.ratio)}, rule “${run.release}”.`;
  at("visit").onclick = () => {
    choose({ ...run, dx: run.ratio > 0 ? run.beta / run.ratio : settings.dx });
  };
}

function report(ratio, speed, paper) {
  const change = before && Math.abs(speed / before.speed - 1) > 5e-5
    ? `b went from ${format(before.ratio)} to ${format(ratio)}, and v from ${format(before.speed)} to ${format(speed)}.`
    : before && `b is still ${format(ratio)}, and nothing has changed: v = ${format(speed)}.`;
  at("finding").textContent = change
    || `At b = ${format(ratio)} ${settings.left === settings.right ? "fronts run" : "the right front runs"} at v = ${format(speed)}, where the paper’s formula, b = 0, says ${format(paper)}.`;
}

function draw() {
  const { left, right, gamma, width, release, beta, dx } = settings;
  const ratio = Math.min(beta / dx, DATA.largest_ratio);
  const scene = { left, right, gamma, width, release, ratio };
  const rupture = new Rupture(scene, DATA.law);
  const found = compared(rupture, scene);
  at("ratio").textContent = format(ratio, 3);
  drawMap(rupture, scene, found);
  drawPulse(rupture, found);
  drawSpeeds(scene, found.exact, found.paper);
  fill(at("exact"), found.rows);
  at("runs").hidden = !DATA.runs.length;
  if (DATA.runs.length) showNearest(scene);
  report(ratio, found.exact.speed, found.paper.speed);
  return { ratio, speed: found.exact.speed };
}

let waiting = 0;

function redraw(reference = null) {
  before = reference;
  cancelAnimationFrame(waiting);
  waiting = requestAnimationFrame(() => { shown = draw(); });
}

// Set some settings at once.
function choose(values, reference = null) {
  for (const name of NAMES) if (name in values) set(name, values[name]);
  at("alike").checked = settings.left === settings.right;
  if (values.release) {
    settings.release = values.release;
    document.querySelector(`[name=release][value=${values.release}]`).checked = true;
  }
  redraw(reference);
}

let shown = null;
for (const name of NAMES) {
  set(name, Number(SLIDERS[name].dataset.start));
  SLIDERS[name].addEventListener("input", () => {
    settings[name] = valueOf(SLIDERS[name]);
    note(name);
    const other = { left: "right", right: "left" }[name];
    if (other && at("alike").checked) set(other, settings[name]);
    redraw();
  });
}
at("alike").addEventListener("change", () => {
  if (at("alike").checked) set("left", settings.right);
  redraw();
});
for (const rule of document.querySelectorAll("[name=release]")) {
  rule.addEventListener("change", () => choose({ release: rule.value }));
}
for (const preset of document.querySelectorAll("[data-beta]")) {
  preset.addEventListener("click", () => choose(
    { beta: Number(preset.dataset.beta), dx: Number(preset.dataset.dx) }, shown,
  ));
}
document.querySelector("form").addEventListener("submit", (event) => event.preventDefault());
addEventListener("resize", () => redraw(before));
redraw();
