// When which picture is drawn, and the controls.

function fitCanvas() {
  const width = canvas.clientWidth, dots = window.devicePixelRatio || 1;
  const [left, right, bottom, top] = content.box;
  const ratio = is3d ? (width < 500 ? 0.9 : 0.6) : (top - bottom) / (right - left);
  const tallest = Math.max(180, 0.62 * window.innerHeight);
  const height = Math.min(tallest, is3d ? ratio * width : ratio * (width - 64) + 50);
  canvas.style.height = `${Math.round(height)}px`;
  canvas.width = Math.round(width * dots);
  canvas.height = Math.round(height * dots);
}

function draw() {
  const { width, height } = canvas, dots = window.devicePixelRatio || 1;
  context.fillStyle = "white";
  context.fillRect(0, 0, width, height);
  (is3d ? drawSolid : drawPlane)(width, height, dots);
  const time = `t = ${content.times[state.frame].toFixed(content.decimals)} s`;
  find("time").textContent = time;
  find("slider").value = state.frame;
  find("slider").setAttribute("aria-valuetext", time);
  canvas.setAttribute("aria-label", `The points of ${content.run} at ${time}, coloured by ${content.fields[state.field].label}`);
  document.documentElement.dataset.frame = state.frame;
}

function showScale() {
  const { label, lower, upper } = content.fields[state.field];
  find("quantity").textContent = label;
  const stops = Array.from({ length: 32 }, (_, i) => `rgb(${colorOf(Math.round((254 * i) / 31)).join(" ")})`);
  find("colors").style.background = `linear-gradient(to right, ${stops.join(", ")})`;
  const ticks = [0, 1, 2, 3, 4].map((i) => shown(lower + (i / 4) * (upper - lower)));
  if (lower !== 0) ticks[0] = `≤ ${ticks[0]}`;
  ticks[4] = `≥ ${ticks[4]}`;
  find("ticks").replaceChildren(...ticks.map((text) => {
    const tick = document.createElement("span");
    tick.textContent = text;
    return tick;
  }));
}

function chooseFrame(number) {
  const last = content.times.length - 1;
  state.frame = Math.min(last, Math.max(0, Math.round(number) || 0));
  draw();
}

function chooseField(number) {
  state.field = number;
  find("field").value = number;
  showScale();
  draw();
}

function play(isPlaying) {
  const last = content.times.length - 1;
  clearInterval(state.clock);
  find("play").textContent = isPlaying ? "Pause" : "Play";
  state.isPlaying = isPlaying;
  if (!isPlaying) return;
  if (state.frame === last) chooseFrame(0);
  state.clock = setInterval(() => {
    chooseFrame(state.frame + 1);
    if (state.frame === last) play(false);
  }, 1000 / content.rate);
}

function look(azimuth, elevation) {
  state.azimuth = azimuth;
  state.elevation = Math.min(Math.PI / 2, Math.max(0, elevation));
  draw();
}

const [towardsX, towardsY, towardsZ] = content.direction;
const views = {
  corner: [Math.atan2(towardsY, towardsX), Math.atan2(towardsZ, Math.hypot(towardsX, towardsY))],
  front: [-Math.PI / 2, 0],
  right: [0, 0],
  top: [-Math.PI / 2, Math.PI / 2],
};

function letTurn() {
  let last = null;
  canvas.addEventListener("pointerdown", (event) => {
    last = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!last) return;
    look(state.azimuth - 0.008 * (event.clientX - last[0]), state.elevation + 0.008 * (event.clientY - last[1]));
    last = [event.clientX, event.clientY];
  });
  for (const name of ["pointerup", "pointercancel"]) canvas.addEventListener(name, () => { last = null; });
  canvas.addEventListener("keydown", (event) => {
    const turns = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] };
    if (!(event.key in turns)) return;
    event.preventDefault();
    const [across, up] = turns[event.key];
    look(state.azimuth + across, state.elevation + up);
  });
  for (const button of find("views").children) {
    button.addEventListener("click", () => look(...views[button.dataset.view]));
  }
}

// An address may end in #frame=12&field=pressure&play.
function obeyAddress() {
  const asked = new URLSearchParams(location.hash.slice(1));
  const field = content.fields.findIndex((one) => one.name === asked.get("field"));
  chooseField(field < 0 ? state.field : field);
  if (asked.has("frame")) chooseFrame(Number(asked.get("frame")));
  if (asked.has("play")) play(true);
}

find("play").addEventListener("click", () => play(!state.isPlaying));
find("slider").addEventListener("input", (event) => { play(false); chooseFrame(Number(event.target.value)); });
find("field").addEventListener("change", (event) => chooseField(Number(event.target.value)));
window.addEventListener("hashchange", obeyAddress);
window.addEventListener("resize", () => { fitCanvas(); draw(); });
[state.azimuth, state.elevation] = views.corner;
fitCanvas();
if (is3d) letTurn();
obeyAddress();
