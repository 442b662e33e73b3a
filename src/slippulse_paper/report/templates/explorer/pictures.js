// Draw the map of slip velocity, the pulse behind the right front, and the front speed as a
// function of b.

const RATIO_TICKS = [0, 0.1, 1];

function frontsOf(found) {
  return found.map(({ y, start }) => [start, y]);
}

// Return the height of map, pre-stress and blocks, which leaves the settings in view.
function mapHeight() {
  return Math.max(220, Math.min(innerWidth < 960 ? 0.34 * innerHeight : 0.62 * innerHeight, 560));
}

function drawMap({ scene, rupture, exact, map: found, limits, known, pulse, steady }) {
  const { end } = scene;
  const [low, high] = rupture.fronts(end);
  const map = new Picture(at("map"), {
    x: [0, view.end],
    y: view.reach,
    labels: ["time t", ""],
    shown: () => "",
    height: mapHeight(),
    top: 26,
    before: 6,
  });
  const edge = found
    .filter(({ y, stick }) => stick <= end && known(y, stick - 1e-9))
    .map(({ y, stick }) => [stick, y]);
  const sticks = Number.isFinite(exact.transitionTime);
  if (sticks) {
    const k = edge.findIndex(([, y]) => y > exact.firstStick);
    edge.splice(k < 0 ? edge.length : k, 0, [exact.transitionTime, exact.firstStick]);
    map.area([...edge, [end, edge.at(-1)[1]], [end, edge[0][1]]], "stuck");
  }
  map.image(velocityImage(found, end, view.largest, COLOURS), [0, end], [low, high],
    [...frontsOf(found), ...found.map(({ y, stop }) => [stop, y]).reverse()]);
  for (const { x, time } of limits) {
    map.area([[time, x], [end, x + end - time], [end, x - end + time]], "unknown");
  }
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
  const ending = sticks ? `first sticks at time ${format(exact.transitionTime)}` : "does not stick";
  const state = [`The rupture ${ending}${sticks ? "" : ` until t = ${format(end)}`}.`];
  if (pulse && steady && deviates(pulse, steady)) {
    state.push("The pulse is not yet steady at the end of the map.");
  } else if (scene.gamma > 0 && scene.right > 0 && !steady) {
    state.push("α is above its critical value αc. No pulse is steady,"
      + " and the sliding part becomes ever wider.");
  }
  if (limits.length) {
    state.push("In the blank wedges the solution is unknown,"
      + " since the trailing edge is slower than the waves.");
  }
  at("state").textContent = state.join(" ");
  const speeds = `${format(exact.speed)} on the right and ${format(exact.speedLeft)} on the left`;
  map.show(`Slip velocity in time and space: a rupture with fronts of speed ${speeds} ${ending}.`);
}

function drawPulse({ scene, rupture, known, front, pulse, paper, steady }) {
  const { end } = scene;
  const back = rupture.fronts(end)[0];
  const length = Math.min(pulse ? pulse.width : front - back, view.span);
  const points = Array.from({ length: 41 }, (_, k) => length * k / 40)
    .filter((x) => known(front - x, end));
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
      x: [0, view.span],
      y: [0, top],
      labels: ["distance behind the right front", label],
      height: 260,
    });
    const most = [`at most ${format(Math.max(...exact, 0))}`];
    if (paper) {
      const cosines = along.map((part) => cosine(Math.PI * part));
      picture.curve(along.map((part, k) => [paper.width * part, cosines[k]]), "paper");
      most.push(`the paper's, at most ${format(Math.max(...cosines))}`);
    }
    if (limit) {
      const distances = along.map((part) => steady.width * part);
      picture.curve(distances.map((x) => [x, limit(x)]), "steady");
    }
    picture.curve(points.map((x, k) => [x, exact[k]]), "exact");
    picture.show(`${label} behind the right front at the end of the map, ${most.join("; ")}.`);
  }
}

function drawSpeeds({ scene, exact }) {
  const position = (b) => Math.asinh(b / 0.02);
  const last = position(DATA.largest_ratio);
  const ratios = Array.from({ length: 61 }, (_, k) => 0.02 * Math.sinh(last * k / 60));
  const tau = scene.right > 0 ? scene.right : scene.left;
  at("speeds").parentElement.classList.toggle("absent", !(tau > 0));
  if (!(tau > 0)) return;
  const paper = paperSpeed(tau);
  const runs = DATA.runs.map(runOf).filter((run) => run.release === scene.release
    && run.speed !== null && Math.abs(run.left - tau) < 0.02);
  // The logarithmic axis always ends at 5, so that it does not move.
  const picture = new Picture(at("speeds"), {
    x: [0, DATA.largest_ratio],
    y: [0, Math.log(5)],
    xTicks: RATIO_TICKS,
    yTicks: [1, 1.5, 2, 3, 5].map(Math.log),
    position,
    shown: (value) => format(Math.exp(value)),
    labels: ["b = β/dx", "front speed v"],
    height: 260,
  });
  const speeds = (release) => ratios.map((b) => [b, 1 / frontLaw(DATA.law, b, release)(1 - tau)]);
  const logs = (points) => points.map(([b, v]) => [b, Math.log(v)]);
  picture.curve(logs([[0, paper], [DATA.largest_ratio, paper]]), "paper");
  picture.curve(logs(speeds(scene.release === "total" ? "elastic" : "total")), "thin");
  for (const run of runs) picture.dot(run.ratio, Math.log(run.speed));
  picture.curve(logs(speeds(scene.release)), "exact");
  const speed = scene.right > 0 ? exact.speed : exact.speedLeft;
  picture.dot(scene.ratio, Math.log(speed), "here");
  picture.show(`Front speed as a function of b: ${format(speed)} at b = ${format(scene.ratio)},`
    + ` where the paper's formula gives ${format(paper)}.`);
}
