// Draw the layer at one time, as blocks and springs at the positions of the map. Blocks that slide
// have the colour of their slip velocity.

// Distance between blocks, and size of a block, in pixels.
const SPACING = 18;
const BLOCK = { height: 9, width: 18 };
const WAITS = { slip: 0, velocity: 0, state: "waits" };

// Return slip, slip velocity and state of one column of the map at a time.
function columnAt({ start, stick, stop, times, values, slips }, time) {
  if (time <= start) return WAITS;
  if (time >= stick) return { slip: slips.at(-1), velocity: 0, state: "stuck" };
  if (time >= stop) return { slip: slips.at(-1), velocity: values.at(-1), state: "slides" };
  const k = cell(times, time);
  const part = (time - times[k]) / (times[k + 1] - times[k]);
  const mean = (numbers) => numbers[k] + part * (numbers[k + 1] - numbers[k]);
  return { slip: mean(slips), velocity: mean(values), state: "slides" };
}

// Return the same for a block between two columns: interpolated numbers, and the nearer state.
function blockAt(found, x, time) {
  const position = (x - found[0].y) / (found[1].y - found[0].y);
  if (position < 0 || position > found.length - 1) return WAITS;
  const k = Math.min(Math.floor(position), found.length - 2);
  const [before, after] = [columnAt(found[k], time), columnAt(found[k + 1], time)];
  const part = position - k;
  const mean = (name) => before[name] + part * (after[name] - before[name]);
  const { state } = part < 0.5 ? before : after;
  return { slip: mean("slip"), velocity: mean("velocity"), state };
}

function drawFrameOfBlocks({ scene }) {
  const picture = new Picture(at("blocks"), {
    x: [0, 1], y: view.reach, xTicks: [], yTicks: [], labels: ["blocks", ""],
    height: mapHeight(), top: 26, before: 6,
  });
  const above = scene.gamma > 0 ? "with leaf springs to a top that is held" : "with a free top";
  picture.show(`The layer as blocks and springs at the time of the line in the map, ${above}.`);
}

function drawBlocks({ scene, map: found }, time) {
  const { picture } = at("blocks");
  const { left, right, top, bottom } = picture.box;
  const [low, high] = view.reach;
  const middle = 0.5 * (left + right) - (scene.gamma > 0 ? 8 : 0);
  // The largest strain is about the largest slip velocity, so that with this scale no blocks
  // overlap.
  const scale = 0.4 / view.largest;
  const count = Math.floor((bottom - top) / SPACING);
  const blocks = Array.from({ length: count }, (_, k) => {
    const x = low + (high - low) * (k + 0.5) / count;
    const block = blockAt(found, x, time);
    return { ...block, rest: picture.y(x), y: picture.y(x + scale * block.slip) };
  });
  const parts = blocks.map(({ rest, y, state, velocity }, k) => {
    const fill = state === "slides" ? ` style="fill:rgb(${shadeOf(velocity)})"` : "";
    const half = 0.5 * BLOCK.height;
    const spring = k > 0 ? coil(middle, blocks[k - 1].y - half, y + half) : "";
    const up = `M${middle} ${y.toFixed(1)}L${right - 4} ${rest.toFixed(1)}`;
    const leaf = `<path class="grey" d="${up}"/>`;
    const block = `<rect class="block ${state}"${fill} x="${middle - 0.5 * BLOCK.width}"`
      + ` y="${(y - half).toFixed(1)}" width="${BLOCK.width}" height="${BLOCK.height}"/>`;
    return (scene.gamma > 0 ? leaf : "") + spring + block;
  });
  const plate = scene.gamma > 0 ? `<path d="M${right - 4} ${top}V${bottom}"/>` : "";
  picture.element.querySelector(".moment").innerHTML = plate + parts.join("");
}

function shadeOf(velocity) {
  const k = Math.floor(COLOURS.length * Math.max(velocity, 0) / view.largest);
  return COLOURS[Math.min(k, COLOURS.length - 1)];
}

// Return a zigzag line with four turns between two heights.
function coil(x, from, to) {
  const height = (part) => (from + part * (to - from)).toFixed(1);
  const sides = [4, -4, 4, -4];
  const turns = sides.map((side, n) => `L${x + side} ${height(0.15 + 0.23 * n)}`);
  return `<path class="thin" d="M${x} ${height(0)}${turns.join("")}L${x} ${height(1)}"/>`;
}
