// Read the settings from sliders and address, compute the rupture, and update the page.

const DATA = JSON.parse(document.getElementById("data").textContent);
const COLOURS = smoothed(DATA.colours);
const at = (id) => document.getElementById(id);
const NAMES = ["beta", "dx", "left", "right", "width", "gamma", "alpha", "end"];
const SLIDERS = Object.fromEntries(NAMES.map((name) => [name, at(name)]));
// The exact values. A preset, a typed number or a run may lie between two steps of a slider.
const settings = { release: "total", held: true };
// The ranges of axes and colours, which only `fit` changes.
let view = null;
// The fronts before the last change.
let ghost = null;
// The rupture that is shown.
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
  const fraction = slider.dataset.kind === "even"
    ? (value - low) / (high - low)
    : Math.log(value / low) / Math.log(high / low);
  slider.value = Math.round(200 * Math.max(fraction, 0));
  settings[name] = value;
  note(name);
}

function note(name) {
  at(`${name}-typed`).value = String(Number(settings[name].toPrecision(4)));
  SLIDERS[name].setAttribute("aria-valuetext", format(settings[name]));
}

// Describe how b and the front speed have changed from a reference with equal pre-stress on the
// right.
function changeSince(reference, { scene, exact }) {
  const [ratio, speed] = [format(scene.ratio), format(exact.speed)];
  if (Math.abs(exact.speed / reference.exact.speed - 1) <= 5e-5) {
    return `b is still ${ratio}, so the front speed is unchanged: v = ${speed}.`;
  }
  const [ratioThen, speedThen] = [format(reference.scene.ratio), format(reference.exact.speed)];
  return `b went from ${ratioThen} to ${ratio}, and v from ${speedThen} to ${speed}.`;
}

// Describe the right front by its speed, and the left one by its position if it is slower than
// waves.
function aboutFronts({ scene, exact, rupture }) {
  const sentences = [];
  if (scene.right > 0) {
    const [speed, paper] = [format(exact.speed), format(paperSpeed(scene.right))];
    sentences.push(`At b = ${format(scene.ratio)} the right front runs at v = ${speed},`
      + ` where the paper’s formula, for b = 0, gives ${paper}.`);
  }
  const { slow } = rupture.left;
  if (slow) {
    const [x, time] = [format(-slow.x.at(-1)), format(slow.time.at(-1))];
    sentences.push(slow.stopped
      ? `The left front stops at x = ${x} at t = ${time}.`
      : `The left front is at x = ${x} at the end of the map.`);
  }
  return sentences.join(" ");
}

function report(found, reference) {
  const alike = reference && reference.scene.right === found.scene.right;
  at("finding").textContent = alike ? changeSince(reference, found) : aboutFronts(found);
}

let waiting = 0;

// Draw the rupture at the next frame, with axes fitted to it if wanted, and compare it with a
// reference if there is one.
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

// Called at the end of a drag, because browsers limit how often the address may change.
function keepAddress() {
  const words = [...NAMES, "release", "held"].map((name) => `${name}=${settings[name]}`);
  history.replaceState(null, "", `#${words.join("&")}`);
}

// Keep the fronts that are shown, to draw them behind the next rupture.
function keepFronts() {
  ghost = shown && shown.fronts;
}

// Change several settings at once.
function choose(values, options = {}) {
  keepFronts();
  for (const name of NAMES) {
    if (Number.isFinite(values[name])) set(name, values[name]);
  }
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
    if (!moving) keepFronts();
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
    keepFronts();
    set(name, Number.isFinite(value) ? value : settings[name]);
    change(name, settings[name]);
  });
}
at("alike").addEventListener("change", () => {
  if (at("alike").checked) choose({ left: settings.right });
});
for (const input of document.querySelectorAll("[name=release], [name=held]")) {
  input.addEventListener("change", () => {
    const held = input.name === "held";
    choose({ [input.name]: held ? input.value === "true" : input.value }, { fitted: held });
  });
}
for (const preset of document.querySelectorAll("[data-scene]")) {
  preset.addEventListener("click", () => {
    const values = JSON.parse(preset.dataset.scene);
    // Steps of the tour are compared with the rupture before. Other scenes get fitted axes.
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
  const pairs = location.hash.slice(1).split("&").map((word) => word.split("="));
  const words = Object.fromEntries(pairs);
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
