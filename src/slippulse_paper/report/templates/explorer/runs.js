// Show the simulated run that is nearest to the settings, beside the exact solution of that run.

// A run is shown only if its `distance` is below this.
const MAX_DISTANCE = 1;

// Return a run of the data with its values by name.
function runOf([left, gamma, width, beta, ratio, release, speed, time, length, slip]) {
  return { left, right: left, gamma, width, beta, ratio, release, speed, time, length, slip };
}

// Return how far a run is from a scene. A distance of 1 is a difference of 0.1 in the levels, or a
// factor e in another setting.
function distance(run, scene) {
  return 10 * Math.abs(run.left - scene.left) + 10 * Math.abs(run.left - scene.right)
    + Math.abs(Math.log(run.gamma / scene.gamma)) + Math.abs(Math.log(run.width / scene.width))
    + Math.abs(Math.asinh(run.ratio / 0.02) - Math.asinh(scene.ratio / 0.02))
    + 9 * (run.release !== scene.release) + 9 * (scene.alpha !== 0);
}

function fill(table, rows) {
  table.tBodies[0].innerHTML = rows.map(([name, value, other]) => {
    const ratio = value === null || other === null ? null : value / other;
    const cells = [value, other, ratio].map((number) => `<td class="n">${format(number)}</td>`);
    return `<tr><th scope="row">${name}</th>${cells.join("")}</tr>`;
  }).join("");
}

const EXACT = new Map();

function showNearest(scene) {
  const [run, far] = DATA.runs.map((row) => [row, distance(runOf(row), scene)])
    .reduce((best, found) => (found[1] < best[1] ? found : best), [null, MAX_DISTANCE]);
  const absent = run === null || scene.gamma === 0;
  at("runs").classList.toggle("absent", absent);
  if (absent) return;
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
    ["τ₀", named.left, scene.right],
    ["γ", named.gamma, scene.gamma],
    ["W", named.width, scene.width],
    ["b", named.ratio, scene.ratio],
  ].map(([name, there, here]) => {
    const other = Math.abs(there - here) > 1e-9 ? ` (here ${format(here)})` : "";
    return `${name} = ${format(there)}${other}`;
  });
  const nearness = far < 1e-9 ? "exactly these settings." : "close to these settings.";
  at("nearest").textContent = `${words.join(", ")}, rule “${named.release}”: ${nearness}`;
  at("visit").onclick = () => {
    const dx = named.ratio > 0 ? named.beta / named.ratio : settings.dx;
    choose({ ...named, alpha: 0, held: true, dx });
  };
}
