// The time and position at which the page reads off numbers and draws blocks. Sliders and a click
// on the map set them, and the play button advances the time.

// Seconds that playing the whole map takes, and seconds for which each picture stays if the reader
// has asked for reduced motion.
const [WHOLE, STILL] = [8, 0.5];
const LITTLE_MOTION = matchMedia("(prefers-reduced-motion: reduce)");
// Time and position as fractions of the map. Playing starts again from the beginning at its end.
const moment = { time: 1, place: 0.5 };
// Return time and position under the pointer.
let pointed = null;
let playing = false;

function momentOf(scene) {
  const [low, high] = view.reach;
  return { time: moment.time * scene.end, x: low + (high - low) * moment.place };
}

// Describe a point of the map in words.
function reading({ scene, rupture, known }, time, x) {
  const start = `t = ${format(time, 3)}, x = ${format(x, 3)}: `;
  const stress = `Pre-stress ${format(Number(prestressAt(scene, x).toFixed(3)))}.`;
  if (!(time > rupture.arrival(x))) return `${start}not yet released. ${stress}`;
  if (!known(x, time)) return `${start}unknown; the text below the map has the reason.`;
  const { times, values, stick } = rupture.history(x, time);
  const slip = format(sums(times, values).at(-1), 3);
  const state = stick <= time ? `stuck again since t = ${format(stick, 3)}`
    : `slides, slip velocity ${format(values.at(-1), 3)}`;
  return `${start}${state}, slip ${slip}. ${stress}`;
}

function drawMoment() {
  if (!shown) return;
  const { picture } = at("map");
  const now = momentOf(shown.scene);
  const { time, x } = pointed || now;
  const { top, bottom } = picture.box;
  const line = `<path class="now" d="M${picture.x(now.time)} ${top}V${bottom}"/>`;
  const probe = `<circle class="probe" cx="${picture.x(time)}" cy="${picture.y(x)}" r="6"/>`;
  picture.element.querySelector(".moment").innerHTML = line + probe;
  drawBlocks(shown, now.time);
  const output = at("reading");
  // A screen reader announces what was set, but not what changes while it plays.
  output.setAttribute("aria-live", playing || pointed ? "off" : "polite");
  output.textContent = reading(shown, time, x);
  for (const [name, value] of [["time", now.time], ["place", now.x]]) {
    at(name).value = Math.round(1000 * moment[name]);
    at(name).setAttribute("aria-valuetext", format(value, 3));
  }
}

// Advance the time by the seconds since the last picture.
function play(before, now) {
  if (!playing) return;
  const seconds = (now - before) / 1000;
  if (LITTLE_MOTION.matches && seconds < STILL) {
    requestAnimationFrame((next) => play(before, next));
    return;
  }
  moment.time = Math.min(moment.time + Math.min(seconds, STILL) / WHOLE, 1);
  if (moment.time === 1) pause();
  drawMoment();
  if (playing) requestAnimationFrame((next) => play(now, next));
}

function pause() {
  playing = false;
  at("play").textContent = "Play";
}

function makePlayable() {
  at("play").addEventListener("click", () => {
    if (playing) {
      pause();
      return;
    }
    playing = true;
    at("play").textContent = "Pause";
    if (moment.time === 1) moment.time = 0;
    requestAnimationFrame((now) => play(now, now));
  });
  for (const name of ["time", "place"]) {
    at(name).addEventListener("input", () => {
      if (name === "time") pause();
      moment[name] = at(name).value / 1000;
      drawMoment();
    });
  }
  const map = at("map");
  const point = (event) => {
    const [time, x] = map.picture.valuesAt(event);
    pointed = { time: Math.min(time, shown.scene.end), x };
    drawMoment();
  };
  map.addEventListener("pointermove", point);
  map.addEventListener("pointerleave", () => {
    pointed = null;
    drawMoment();
  });
  map.addEventListener("click", (event) => {
    point(event);
    const [low, high] = view.reach;
    moment.time = pointed.time / shown.scene.end;
    moment.place = (pointed.x - low) / (high - low);
    pause();
    drawMoment();
  });
}
