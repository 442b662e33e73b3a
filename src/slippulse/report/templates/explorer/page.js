// The page: what the sliders and the address say, the rupture that follows, and how it is shown.

const DATA = JSON.parse(document.getElementById("data").textContent);
const COLOURS = smoothed(DATA.colours);
const at = (id) => document.getElementById(id);
const NAMES = ["beta", "dx", "left", "right", "width", "gamma", "alpha", "end"];
const SLIDERS = Object.fromEntries(NAMES.map((name) => [name, at(name)]));
const RATIO_TICKS = [0, 0.1, 1];
// A simulated run is near at less than this `distance`; a pulse is steady within this of its limit.
const [NEAR, STEADY] = [1, 0.01];
// Exact values: a slider has steps between which a preset, a typed number or a run may lie.
const settings = { release: "total", held: true };
// What the axes and colours reach, which only `fit` changes; the fronts before the last move; what was shown last.
let view = null;
let ghost = null;
let shown = null;
let moving = false;
let compared = null;

function ends(slider) {
  return [Number(slider.dataset.low), Number(slider.dataset.high)];
}

function valueOf(slider) {
  const [low, high] = ends(slider);
  const fraction = slider.value / 200;
  if (slider.dataset.kind === "even") return Number((low + (high - low) * fraction).toFixed(3));
  if (slider.dataset.kind.startsWith("zero") && fraction === 0) return 0;
  return Number((low * (high / low) ** fraction).toPrecision(3));
}

function set(name, value) {
  const slider = SLIDERS[name];
  const [low, high] = ends(slider);
  const fraction = slider.dataset.kind === "even" ? (value - low) / (high - low) : Math.log(value / low) / Math.log(high / low);
  slider.value = Math.round(200 * Math.max(fraction, 0));
  settings[name] = value;
  note(name);
}

function note(name) {
  at(`${name}-typed`).value = String(Number(settings[name].toPrecision(4)));
  SLIDERS[name].setAttribute("aria-valuetext", format(settings[name]));
}

// The scene that the settings describe.
function sceneOf({ left, right, gamma, width, release, beta, dx, alpha, end, held }) {
  const ratio = Math.min(beta / dx, DATA.largest_ratio);
  return { left, right, gamma: held ? gamma : 0, width, release, beta, ratio, alpha, end };
}

function paperPulse(tau, gamma) {
  const speed = 1 / Math.sqrt(1 - tau * tau);
  const time = Math.PI / Math.sqrt(gamma);
  return { speed, time, width: time * tau * speed, slip: 2 * tau / gamma, peak: 1 / Math.sqrt(gamma) };
}

// Int tau dx from a position on to the right, as far as the Gaussian reaches, and where it vanishes: x_minus.
function balance({ left, right, width }) {
  const tau = (x) => (x < 0 ? left : right) + (1 - (x < 0 ? left : right)) * Math.exp(-0.5 * (x / width) ** 2);
  const zero = -width * Math.sqrt(2 * Math.log((1 - left) / -left));
  const over = (low, high) => Array.from({ length: 8 }, (_, k) => (
    integral(tau, low + (high - low) * k / 8, low + (high - low) * (k + 1) / 8))).reduce((sum, part) => sum + part);
  const ahead = over(zero, 0) + over(0, 10 * width);
  return { x: rootBetween((x) => over(x, zero) + ahead, 20 * ahead / left + zero, zero), peak: 0.5 * ahead };
}

// The exact rupture and everything that is said of it; `steady` is null where no pulse is, and `known` tells where the
// construction holds: nothing is said of the future of a trailing edge that is slower than the waves.
function solve(scene) {
  const rupture = new Rupture(scene, DATA.law);
  const map = columns(rupture, scene.end);
  const exact = rupture.transition(map);
  const limits = map.flatMap((column, k) => [1, -1].map((sign) => [column, map[k + sign], sign]))
    .filter(([{ y, stick }, next, sign]) => next && Number.isFinite(stick) && sign * (y - exact.firstStick) >= 0
      && Math.min(next.stick, scene.end) - stick > 1.02 * Math.abs(next.y - y) && next.start < next.stop)
    .map(([{ y, stick }]) => ({ x: y, time: stick }));
  const known = (x, time) => limits.every((limit) => time < limit.time + Math.abs(x - limit.x));
  const [, front] = rupture.fronts(scene.end);
  const running = !rupture.right.slow;
  const sought = exact.transitionTime < scene.end && running && !limits.some((limit) => limit.x > exact.firstStick)
    ? rupture.pulse(scene.end, exact.firstStick) : null;
  const pulse = sought && known(sought.edge, scene.end) ? sought : null;
  const held = scene.gamma > 0 && scene.right > 0;
  return {
    scene, rupture, exact, map, limits, known, front, pulse, paper: held ? paperPulse(scene.right, scene.gamma) : null,
    steady: held ? steadyPulse(scene, exact.speed) : null,
  };
}

function deviates(pulse, steady) {
  return Math.max(Math.abs(pulse.width / steady.width - 1), Math.abs(pulse.slip / steady.slip - 1)) > STEADY;
}

// Rows of what is exact and what the paper's formulas say.
function rowsOf({ scene, rupture, exact, pulse, paper, steady }) {
  const { left, right, gamma, alpha, end } = scene;
  const rows = [];
  for (const [side, level, speed] of [["right", right, exact.speed], ["left", left, exact.speedLeft]]) {
    if (level > 0 && (side === "right" || left !== right)) {
      rows.push([`front speed <i>v</i>, ${side}`, speed, 1 / Math.sqrt(1 - level * level)]);
    }
  }
  if (Number.isFinite(exact.transitionTime) && gamma > 0) {
    const length = left > 0 && right > 0
      ? Math.PI / Math.sqrt(gamma) * (1 / Math.sqrt(1 - left * left) + 1 / Math.sqrt(1 - right * right)) : null;
    rows.push(["<i>T</i><sub>trans</sub>", exact.transitionTime, Math.PI / Math.sqrt(gamma)]);
    rows.push(["<i>L</i><sub>trans</sub>", exact.transitionLength, length]);
  }
  for (const [side, front, sign] of [["left", rupture.left, -1], ["right", rupture.right, 1]]) {
    if (!front.slow) continue;
    const [x, time] = [sign * front.slow.x.at(-1), front.slow.time.at(-1)];
    rows.push([front.slow.stopped ? `${side} front stops at <i>x</i>` : `${side} front at <i>t</i> = ${format(end)}`, x,
      gamma === 0 && right === 0 && side === "left" ? balance(scene).x : null]);
    if (front.slow.stopped) rows.push([`${side} front stops at <i>t</i>`, time, null]);
  }
  if (gamma === 0 && left < 0 && right === 0 && alpha === 0) {
    rows.push(["largest slip velocity, far away", balance(scene).peak, null]);
  }
  if (pulse && paper) {
    const late = steady && deviates(pulse, steady) ? " (not yet steady)" : "";
    rows.push([`width of the right pulse at the end${late}`, pulse.width, paper.width]);
    if (steady) rows.push(["its width once steady", steady.width, paper.width]);
    rows.push([`slip behind it at the end${late}`, pulse.slip, paper.slip]);
    if (steady) rows.push(["that slip once steady", steady.slip, paper.slip]);
  }
  if (paper) rows.push(["pulses end at <i>α</i><sub>c</sub>", criticalRate(gamma, exact.speed), null]);
  return rows;
}

// Axes for a rupture: as far as it gets until the end of the map.
function fit({ scene, rupture, front, paper, steady, map: found }) {
  const peak = Math.max(...found.flatMap(({ values }) => values), 1e-9);
  const span = scene.gamma > 0 ? 1.5 * Math.max(steady ? steady.width : 0, paper ? paper.width : front) : front - rupture.fronts(scene.end)[0];
  const slip = Math.max(...found.map((column) => slipOf(column)));
  return {
    reach: rupture.fronts(scene.end).map((x) => 1.15 * x), largest: peak, span: Math.min(span, 1.2 * (front - rupture.fronts(scene.end)[0])),
    velocity: 1.1 * Math.max(peak, paper ? paper.peak : 0), slip: 1.1 * Math.max(slip, paper ? paper.slip : 0),
  };
}

// Slip at the end of a column, by its samples.
function slipOf({ times, values }) {
  return times.reduce((sum, time, k) => (k ? sum + 0.5 * (values[k] + values[k - 1]) * (time - times[k - 1]) : 0), 0);
}

function frontsOf(found) {
  return found.map(({ y, start }) => [start, y]);
}

function drawMap({ scene, rupture, exact, map: found, limits, known, pulse, steady }) {
  const { end } = scene;
  const [low, high] = rupture.fronts(end);
  const map = new Picture(at("map"), {
    x: [0, view.end], y: view.reach, labels: ["time", "position x"],
    height: Math.max(240, Math.min(innerWidth < 700 ? 0.45 * innerHeight : 520, 80 + 0.62 * innerWidth)), top: 26,
  });
  const edge = found.filter(({ y, stick }) => stick <= end && known(y, stick - 1e-9)).map(({ y, stick }) => [stick, y]);
  const sticks = Number.isFinite(exact.transitionTime);
  if (sticks) {
    const k = edge.findIndex(([, y]) => y > exact.firstStick);
    edge.splice(k < 0 ? edge.length : k, 0, [exact.transitionTime, exact.firstStick]);
    map.area([...edge, [end, edge.at(-1)[1]], [end, edge[0][1]]], "stuck");
  }
  map.image(velocityImage(found, end, view.largest, COLOURS), [0, end], [low, high],
    [...frontsOf(found), ...found.map(({ y, stop }) => [stop, y]).reverse()]);
  for (const { x, time } of limits) map.area([[time, x], [end, x + end - time], [end, x - end + time]], "unknown");
  for (const kind of ghost ? ["ghost", "ghostly"] : []) map.curve(ghost, kind);
  map.curve(frontsOf(found), "front");
  if (scene.left > 0 && scene.right > 0) {
    const undamped = new Rupture({ ...scene, ratio: 0 }, DATA.law);
    map.curve(found.map(({ y }) => [undamped.arrival(y), y]), "zero");
  }
  map.curve(edge, "edge");
  if (sticks && scene.gamma > 0) {
    const apart = rupture.fronts(exact.transitionTime);
    map.curve(apart.map((y) => [exact.transitionTime, y]), "thin");
    map.curve([[0, exact.firstStick], [exact.transitionTime, exact.firstStick]], "thin");
    map.write(map.x(exact.transitionTime) + 5, map.y(0.75 * apart[1]), "L_trans");
    map.write(map.x(0.5 * exact.transitionTime), map.y(exact.firstStick) - 5, "T_trans", "middle");
  }
  for (const [front, sign] of [[rupture.left, -1], [rupture.right, 1]]) {
    if (!front.slow || !front.slow.stopped) continue;
    const [x, time] = [sign * front.slow.x.at(-1), front.slow.time.at(-1)];
    map.dot(time, x, "here");
    map.write(map.x(time) + 9, map.y(x) + (sign > 0 ? 14 : -6), `stops at x = ${format(x)}`);
  }
  map.scale(COLOURS, `slip velocity, 0 to ${format(view.largest, 3)}`);
  const ending = sticks ? `first sticks at time ${format(exact.transitionTime)}` : "sticks nowhere";
  const late = pulse && steady && deviates(pulse, steady) ? " The pulse is not yet steady at the end of the map."
    : scene.gamma > 0 && scene.right > 0 && !steady ? " α is beyond αc: no pulse is steady, and the part that slides becomes ever wider." : "";
  at("state").textContent = `The rupture ${ending}${sticks ? "" : ` until t = ${format(end)}`}.${late}`;
  if (limits.length) at("state").textContent += " Blank wedges: not known, since the trailing edge there becomes slower than the waves.";
  map.show(`Slip velocity in time and space: a rupture with fronts of speed ${format(exact.speed)} on the right and`
    + ` ${format(exact.speedLeft)} on the left ${ending}.`);
}

function drawPulse({ scene, rupture, known, front, pulse, paper, steady }) {
  const { end } = scene;
  const back = rupture.fronts(end)[0];
  const length = Math.min(pulse ? pulse.width : front - back, view.span);
  const points = Array.from({ length: 41 }, (_, k) => length * k / 40).filter((x) => known(front - x, end));
  const along = Array.from({ length: 61 }, (_, k) => k / 60);
  const panels = {
    velocity: {
      label: "slip velocity", top: view.velocity,
      exact: points.map((x) => (x === 0 ? 0 : Math.max(rupture.velocity(front - x, end), 0))),
      cosine: (phase) => paper.peak * Math.sin(phase), limit: steady && steady.velocityAt,
    },
    slip: {
      label: "slip", top: view.slip,
      exact: points.map((x) => rupture.slip(front - x, end, NODES)),
      cosine: (phase) => 0.5 * paper.slip * (1 - Math.cos(phase)), limit: steady && steady.slipAt,
    },
  };
  for (const [name, { label, top, exact, cosine, limit }] of Object.entries(panels)) {
    const picture = new Picture(at(name), {
      x: [0, view.span], y: [0, top], labels: ["distance behind the right front", label], height: 260,
    });
    if (paper) picture.curve(along.map((part) => [paper.width * part, cosine(Math.PI * part)]), "paper");
    if (limit) picture.curve(along.map((part) => [steady.width * part, limit(steady.width * part)]), "steady");
    picture.curve(points.map((x, k) => [x, exact[k]]), "exact");
    picture.show(`${label} behind the right front at the end of the map, at most ${format(Math.max(...exact, 0))}`
      + `${paper ? `; the paper's, at most ${format(Math.max(...along.map((part) => cosine(Math.PI * part))))}` : ""}.`);
  }
}

function drawSpeeds({ scene, exact }) {
  const position = (b) => Math.asinh(b / 0.02);
  const ratios = Array.from({ length: 61 }, (_, k) => 0.02 * Math.sinh(position(DATA.largest_ratio) * k / 60));
  const speeds = (tau, release) => ratios.map((b) => [b, 1 / frontLaw(DATA.law, b, release)(1 - tau)]);
  const tau = scene.right > 0 ? scene.right : scene.left;
  at("speeds").parentElement.hidden = !(tau > 0);
  if (!(tau > 0)) return;
  const paper = 1 / Math.sqrt(1 - tau * tau);
  const runs = DATA.runs.map(runOf).filter((run) => run.release === scene.release && run.speed !== null && Math.abs(run.left - tau) < 0.02);
  // Always as high as 5, on a logarithmic axis, so that it stands still.
  const picture = new Picture(at("speeds"), {
    x: [0, DATA.largest_ratio], y: [0, Math.log(5)], xTicks: RATIO_TICKS, yTicks: [1, 1.5, 2, 3, 5].map(Math.log), position,
    shown: (value) => format(Math.exp(value)), labels: ["b = β/dx", "front speed v"], height: 260,
  });
  const logs = (points) => points.map(([b, v]) => [b, Math.log(v)]);
  picture.curve(logs([[0, paper], [DATA.largest_ratio, paper]]), "paper");
  picture.curve(logs(speeds(tau, scene.release === "total" ? "elastic" : "total")), "thin");
  for (const run of runs) picture.dot(run.ratio, Math.log(run.speed));
  picture.curve(logs(speeds(tau, scene.release)), "exact");
  const speed = scene.right > 0 ? exact.speed : exact.speedLeft;
  picture.dot(scene.ratio, Math.log(speed), "here");
  picture.show(`Front speed against b: ${format(speed)} at b = ${format(scene.ratio)}, where the paper's formula says ${format(paper)}.`);
}

// A run of the data by names.
function runOf([left, gamma, width, beta, ratio, release, speed, time, length, slip]) {
  return { left, right: left, gamma, width, beta, ratio, release, speed, time, length, slip };
}

// How far a run is from a scene: 1 is a tenth in the levels, or a factor e in another setting.
function distance(run, scene) {
  return 10 * Math.abs(run.left - scene.left) + 10 * Math.abs(run.left - scene.right)
    + Math.abs(Math.log(run.gamma / scene.gamma)) + Math.abs(Math.log(run.width / scene.width))
    + Math.abs(Math.asinh(run.ratio / 0.02) - Math.asinh(scene.ratio / 0.02))
    + 9 * (run.release !== scene.release) + 9 * (scene.alpha !== 0);
}

function fill(table, rows) {
  table.tBodies[0].innerHTML = rows.map(([name, value, other]) => `<tr><th scope="row">${name}</th>`
    + `<td class="n">${format(value)}</td><td class="n">${format(other)}</td>`
    + `<td class="n">${value === null || other === null ? "–" : format(value / other)}</td></tr>`).join("");
}

const EXACT = new Map();

function showNearest(scene) {
  const [run, far] = DATA.runs.map((row) => [row, distance(runOf(row), scene)])
    .reduce((best, found) => (found[1] < best[1] ? found : best), [null, NEAR]);
  at("runs").hidden = run === null || scene.gamma === 0;
  if (at("runs").hidden) return;
  const named = runOf(run);
  if (!EXACT.has(run)) EXACT.set(run, new Rupture(named, DATA.law).transition());
  const exact = EXACT.get(run);
  fill(at("simulated"), [
    ["front speed <i>v</i>", named.speed, exact.speed],
    ["<i>T</i><sub>trans</sub>", named.time, exact.transitionTime],
    ["<i>L</i><sub>trans</sub>", named.length, exact.transitionLength],
    ["slip of the steady pulse", named.slip, steadyPulse(named, exact.speed)?.slip ?? null],
  ]);
  const words = [
    ["τ₀", named.left, scene.right], ["γ", named.gamma, scene.gamma], ["W", named.width, scene.width], ["b", named.ratio, scene.ratio],
  ].map(([name, there, here]) => `${name} = ${format(there)}${Math.abs(there - here) > 1e-9 ? ` (here ${format(here)})` : ""}`);
  at("nearest").textContent = `${words.join(", ")}, rule “${named.release}”: ${far < 1e-9 ? "these very settings." : `not these settings, but near.`}`;
  at("visit").onclick = () => {
    choose({ ...named, alpha: 0, held: true, dx: named.ratio > 0 ? named.beta / named.ratio : settings.dx });
  };
}

function report(found, reference) {
  const [ratio, speed] = [found.scene.ratio, found.exact.speed];
  const before = reference && { ratio: reference.scene.ratio, speed: reference.exact.speed };
  const change = before && Math.abs(speed / before.speed - 1) > 5e-5
    ? `b went from ${format(before.ratio)} to ${format(ratio)}, and v from ${format(before.speed)} to ${format(speed)}.`
    : before && `b is still ${format(ratio)}, and nothing has changed: v = ${format(speed)}.`;
  const { left } = found.rupture;
  const [x, time] = left.slow ? [-left.slow.x.at(-1), left.slow.time.at(-1)] : [];
  at("finding").textContent = change || [
    found.scene.right > 0 && `At b = ${format(ratio)} the right front runs at v = ${format(speed)}, where the paper’s formula, b = 0, says ${format(1 / Math.sqrt(1 - found.scene.right ** 2))}.`,
    left.slow && (left.slow.stopped ? `The left front stops at x = ${format(x)} at t = ${format(time)}.` : `The left front is at x = ${format(x)} at the end of the map.`),
  ].filter(Boolean).join(" ");
}

let waiting = 0;

// Draw what is set at the next frame, with new axes if they shall fit it, compared with a reference.
function redraw({ fitted = false, reference = null } = {}) {
  cancelAnimationFrame(waiting);
  compared = reference;
  if (fitted) view = null;
  waiting = requestAnimationFrame(() => {
    const begun = performance.now();
    const found = solve(sceneOf(settings));
    if (!view) view = { ...fit(found), end: found.scene.end };
    at("ratio").textContent = format(found.scene.ratio, 3);
    at("held").hidden = !settings.held;
    drawMap(found);
    drawPulse(found);
    drawSpeeds(found);
    fill(at("exact"), rowsOf(found));
    showNearest(found.scene);
    report(found, reference);
    shown = { ...found, fronts: frontsOf(found.map) };
    const words = [...NAMES, "release", "held"].map((name) => `${name}=${settings[name]}`);
    history.replaceState(null, "", `#${words.join("&")}`);
    document.body.dataset.milliseconds = (performance.now() - begun).toFixed(1);
  });
}

// Keep the fronts that are shown as the ghost of what follows.
function haunt() {
  ghost = shown && shown.fronts;
}

// Set some settings at once.
function choose(values, options = {}) {
  haunt();
  for (const name of NAMES) if (name in values && Number.isFinite(values[name])) set(name, values[name]);
  at("alike").checked = settings.left === settings.right;
  for (const name of ["release", "held"]) {
    if (name in values) settings[name] = values[name];
    document.querySelector(`[name=${name}][value=${settings[name]}]`).checked = true;
  }
  redraw(options);
}

function change(name, value) {
  settings[name] = value;
  const other = { left: "right", right: "left" }[name];
  if (other && at("alike").checked) set(other, value);
  redraw({ fitted: name === "end" });
}

for (const name of NAMES) {
  const [slider, typed] = [SLIDERS[name], at(`${name}-typed`)];
  set(name, Number(slider.dataset.start));
  slider.addEventListener("input", () => {
    if (!moving) haunt();
    moving = true;
    change(name, valueOf(slider));
    note(name);
  });
  slider.addEventListener("change", () => { moving = false; });
  typed.addEventListener("change", () => {
    const [low, high] = ends(slider);
    const value = Math.min(Math.max(Number(typed.value), name === "beta" ? 0 : low), high);
    haunt();
    set(name, Number.isFinite(value) ? value : settings[name]);
    change(name, settings[name]);
  });
}
at("alike").addEventListener("change", () => {
  if (at("alike").checked) choose({ left: settings.right });
});
for (const input of document.querySelectorAll("[name=release], [name=held]")) {
  input.addEventListener("change", () => choose({ [input.name]: input.name === "held" ? input.value === "true" : input.value }, { fitted: input.name === "held" }));
}
for (const preset of document.querySelectorAll("[data-scene]")) {
  preset.addEventListener("click", () => {
    const values = JSON.parse(preset.dataset.scene);
    // The story compares with what was shown, other scenes have axes of their own.
    choose(values, preset.dataset.story ? { reference: shown } : { fitted: true });
    if (!preset.dataset.story) ghost = null;
  });
}
at("fit").addEventListener("click", () => redraw({ fitted: true }));
document.querySelector("form").addEventListener("submit", (event) => event.preventDefault());
addEventListener("resize", () => {
  for (const picture of document.querySelectorAll("svg")) picture.room = 0;
  redraw({ reference: compared });
});
function visit() {
  const words = Object.fromEntries(location.hash.slice(1).split("&").map((word) => word.split("=")));
  const values = Object.fromEntries(NAMES.filter((name) => name in words).map((name) => {
    const [low, high] = ends(SLIDERS[name]);
    return [name, Math.min(Math.max(Number(words[name]), name === "beta" ? 0 : low), high)];
  }));
  if (["total", "elastic"].includes(words.release)) values.release = words.release;
  if ("held" in words) values.held = words.held !== "false";
  choose(values, { fitted: true });
}
addEventListener("hashchange", visit);
visit();
