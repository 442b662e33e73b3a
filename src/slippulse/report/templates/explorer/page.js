// The page: what the sliders and the address say, the rupture that follows, and how it is shown.

const DATA = JSON.parse(document.getElementById("data").textContent);
const COLOURS = smoothed(DATA.colours);
const at = (id) => document.getElementById(id);
const NAMES = ["beta", "dx", "left", "right", "width", "gamma", "alpha", "end"];
const SLIDERS = Object.fromEntries(NAMES.map((name) => [name, at(name)]));
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

function report(found, reference) {
  const [ratio, speed] = [found.scene.ratio, found.exact.speed];
  const alike = reference && reference.scene.right === found.scene.right;
  const before = alike && { ratio: reference.scene.ratio, speed: reference.exact.speed };
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
    at("held").classList.toggle("absent", !settings.held);
    drawPrestress(found);
    drawMap(found);
    drawFrameOfBlocks(found);
    drawPulse(found);
    drawSpeeds(found);
    fill(at("exact"), rowsOf(found));
    showNearest(found.scene);
    report(found, reference);
    shown = { ...found, fronts: frontsOf(found.map) };
    drawMoment();
    if (!moving) keepAddress();
    document.body.dataset.milliseconds = (performance.now() - begun).toFixed(1);
  });
}

// A browser refuses an address that changes with every picture of a drag.
function keepAddress() {
  const words = [...NAMES, "release", "held"].map((name) => `${name}=${settings[name]}`);
  history.replaceState(null, "", `#${words.join("&")}`);
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
  slider.addEventListener("change", () => {
    moving = false;
    keepAddress();
  });
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
makeDraggable(at("prestress"));
makePlayable();
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
