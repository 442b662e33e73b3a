// Draw the pre-stress beside the map, as in the figures of the paper, and let the pointer drag it.

// The range of levels, which is that of the sliders.
const LEVELS = { low: -0.95, high: 0.95 };

function prestressAt({ left, right, width }, x) {
  const level = x < 0 ? left : right;
  return level + (1 - level) * Math.exp(-0.5 * (x / width) ** 2);
}

function drawPrestress({ scene }) {
  const [low, high] = view.reach;
  const picture = new Picture(at("prestress"), {
    x: [-1.1, 1.1], y: view.reach, xTicks: [-1, 0, 1], labels: ["pre-stress τ", "position x"],
    height: mapHeight(), top: 26, before: 50,
  });
  const positions = Array.from({ length: 201 }, (_, k) => low + (high - low) * k / 200);
  picture.curve([[0, low], [0, high]], "grey");
  picture.curve(positions.map((x) => [prestressAt(scene, x), x]), "exact");
  picture.dot(scene.left, 0.75 * low, "handle", 8);
  picture.dot(scene.right, 0.75 * high, "handle", 8);
  picture.write(0.5 * (picture.box.left + picture.box.right), 15, "◂ drag ▸", "middle");
  const levels = `${format(scene.left)} on the left and ${format(scene.right)} on the right`;
  picture.show(`Pre-stress, ${levels}, 1 at x = 0. The sliders of the pre-stress move it too.`);
}

// Let the pointer drag the level on the side where it was pressed.
function makeDraggable(element) {
  let name = null;
  const drag = (event) => {
    const [level] = element.picture.valuesAt(event);
    const value = Number(Math.min(Math.max(level, LEVELS.low), LEVELS.high).toFixed(2));
    if (value === settings[name]) return;
    set(name, value);
    change(name, value);
  };
  const release = () => {
    if (!name) return;
    name = null;
    moving = false;
    keepAddress();
  };
  element.addEventListener("pointerdown", (event) => {
    event.preventDefault();
    element.setPointerCapture(event.pointerId);
    name = element.picture.valuesAt(event)[1] < 0 ? "left" : "right";
    keepFronts();
    moving = true;
    drag(event);
  });
  element.addEventListener("pointermove", (event) => {
    if (name) drag(event);
  });
  for (const kind of ["pointerup", "pointercancel"]) element.addEventListener(kind, release);
}
