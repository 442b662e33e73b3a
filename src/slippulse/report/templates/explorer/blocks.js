// The layer at a time: blocks and springs at the positions of the map, the colour of those that slide their slip velocity.

// Pixels from block to block, of a block and of a spring.
const SPACING = 18;
const BLOCK = { height: 9, width: 18 };

// Slip, slip velocity and state at a time of one column of the map.
function columnAt({ start, stick, stop, times, values, slips }, time) {
  if (time <= start) return { slip: 0, velocity: 0, state: "waits" };
  if (time >= stop) return { slip: slips.at(-1), velocity: time < stick ? values.at(-1) : 0, state: time < stick ? "slides" : "stuck" };
  const k = cell(times, time);
  const part = (time - times[k]) / (times[k + 1] - times[k]);
  const mean = (numbers) => numbers[k] + part * (numbers[k + 1] - numbers[k]);
  return { slip: mean(slips), velocity: mean(values), state: "slides" };
}

// The same between two columns, as the nearer one has it in its state.
function blockAt(found, x, time) {
  const position = (x - found[0].y) / (found[1].y - found[0].y);
  if (position < 0 || position > found.length - 1) return { slip: 0, velocity: 0, state: "waits" };
  const k = Math.min(Math.floor(position), found.length - 2);
  const [before, after] = [columnAt(found[k], time), columnAt(found[k + 1], time)];
  const part = position - k;
  const mean = (name) => before[name] + part * (after[name] - before[name]);
  return { slip: mean("slip"), velocity: mean("velocity"), state: (part < 0.5 ? before : after).state };
}

function drawFrameOfBlocks({ scene }) {
  const picture = new Picture(at("blocks"), {
    x: [0, 1], y: view.reach, xTicks: [], yTicks: [], labels: ["blocks", ""], height: mapHeight(), top: 26, before: 6,
  });
  picture.show(`The layer as blocks and springs at the time of the line in the map, ${scene.gamma > 0 ? "with leaf springs to a top that is held" : "with a free top"}.`);
}

function drawBlocks({ scene, map: found }, time) {
  const { picture } = at("blocks");
  const { left, right, top, bottom } = picture.box;
  const [low, high] = view.reach;
  const middle = 0.5 * (left + right) - (scene.gamma > 0 ? 8 : 0);
  // Strains are up to about the largest slip velocity, so that no block meets another.
  const scale = 0.4 / view.largest;
  const count = Math.floor((bottom - top) / SPACING);
  const blocks = Array.from({ length: count }, (_, k) => {
    const x = low + (high - low) * (k + 0.5) / count;
    const block = blockAt(found, x, time);
    return { ...block, rest: picture.y(x), y: picture.y(x + scale * block.slip) };
  });
  const parts = blocks.map(({ rest, y, state, velocity }, k) => {
    const shade = COLOURS[Math.min(Math.floor(COLOURS.length * Math.max(velocity, 0) / view.largest), COLOURS.length - 1)];
    const fill = state === "slides" ? ` style="fill:rgb(${shade})"` : "";
    const leaf = scene.gamma > 0 ? `<path class="grey" d="M${middle} ${y.toFixed(1)}L${right - 4} ${rest.toFixed(1)}"/>` : "";
    const spring = k > 0 ? coil(middle, blocks[k - 1].y - 0.5 * BLOCK.height, y + 0.5 * BLOCK.height) : "";
    return `${leaf}${spring}<rect class="block ${state}"${fill} x="${middle - 0.5 * BLOCK.width}" y="${(y - 0.5 * BLOCK.height).toFixed(1)}"`
      + ` width="${BLOCK.width}" height="${BLOCK.height}"/>`;
  });
  const plate = scene.gamma > 0 ? `<path d="M${right - 4} ${top}V${bottom}"/>` : "";
  picture.element.querySelector(".moment").innerHTML = plate + parts.join("");
}

// A zigzag of four turns between two heights.
function coil(x, from, to) {
  const turns = [0.15, 0.38, 0.62, 0.85].map((part, n) => `${x + (n % 2 ? -4 : 4)} ${(from + part * (to - from)).toFixed(1)}`);
  return `<path class="thin" d="M${x} ${from.toFixed(1)}L${turns.join("L")}L${x} ${to.toFixed(1)}"/>`;
}
