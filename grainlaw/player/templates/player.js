"use strict";
const find = (id) => document.getElementById(id);
window.addEventListener("error", (event) => {
  find("fault").hidden = false;
  find("fault").textContent = `The page does not work here: ${event.message}`;
});

const content = JSON.parse(find("content").textContent);
const canvas = find("picture");
const context = canvas.getContext("2d");
const layer = document.createElement("canvas");
const is3d = content.axes === 3;
const steps = 65535, noValue = 255, noColor = [150, 170, 190];
const obstacleFill = "#b8b8b8", obstacleEdge = "#595959";
const state = { frame: 0, field: 0, isPlaying: false, clock: 0, azimuth: 0, elevation: 0 };

function decoded(text, Numbers) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i += 1) bytes[i] = raw.charCodeAt(i);
  return new Numbers(bytes.buffer);
}

const places = decoded(content.places, Uint16Array);
const colors = decoded(content.colors, Uint8Array);
const values = content.fields.map((field) => decoded(field.values, Uint8Array));
const starts = [0];
for (const count of content.counts) starts.push(starts[starts.length - 1] + count);
const solids = content.obstacles.solids.map((one) => ({
  faces: decoded(one.faces, Uint32Array),
  edges: decoded(one.edges, Uint32Array),
}));
const outlines = content.obstacles.outlines.map((one) =>
  is3d ? { ...one, points: decoded(one.points, Float32Array) } : one);

// The red, green and blue of a value's number.
function colorOf(level) {
  return level === noValue ? noColor : [colors[3 * level], colors[3 * level + 1], colors[3 * level + 2]];
}

function pixelOf(level, light) {
  const [red, green, blue] = colorOf(level);
  const lit = (part) => Math.min(255, Math.round(light * part));
  return ((255 << 24) | (lit(blue) << 16) | (lit(green) << 8) | lit(red)) >>> 0;
}

// Coordinate number `axis` of point `point`, counted over all frames [m].
function coordinate(point, axis) {
  const share = places[content.axes * point + axis] / steps;
  return content.lower[axis] + share * (content.upper[axis] - content.lower[axis]);
}

// A step of 1, 2 or 5 times a power of ten that divides a length into some parts.
function roundStep(length, parts) {
  const rough = length / parts;
  const power = 10 ** Math.floor(Math.log10(rough));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= rough * 0.999);
}

const shown = (number) => String(Number(number.toPrecision(3)));

// ---- in a plane

function planeView(width, height, dots) {
  const [left, right, bottom, top] = content.box;
  const margin = { left: 52 * dots, right: 12 * dots, bottom: 42 * dots, top: 8 * dots };
  const across = width - margin.left - margin.right, up = height - margin.top - margin.bottom;
  const scale = Math.min(across / (right - left), up / (top - bottom));
  // Whole pixels, so that nothing is blurred.
  const [drawnWidth, drawnHeight] = [right - left, top - bottom].map((length) => Math.round(scale * length));
  const x = Math.round(margin.left + 0.5 * (across - drawnWidth));
  const area = { x, y: Math.round(margin.top), width: drawnWidth, height: drawnHeight };
  return { scale, area, x: (x) => area.x + scale * (x - left), y: (y) => area.y + area.height - scale * (y - bottom) };
}

function drawPlane(width, height, dots) {
  const view = planeView(width, height, dots);
  const { area } = view;
  context.save();
  context.beginPath();
  context.rect(area.x, area.y, area.width, area.height);
  context.clip();
  for (const number of content.obstacles.frames[state.frame]) drawLoops(outlines[number], view, dots);
  drawBody(view);
  context.restore();
  drawAxes(view, dots);
}

function drawLoops(outline, view, dots) {
  const { area } = view;
  context.beginPath();
  if (outline.isHollow) context.rect(area.x - 9, area.y - 9, area.width + 18, area.height + 18);
  for (const sign of content.isMirrored ? [1, -1] : [1]) {
    for (const loop of outline.loops) {
      for (let i = 0; i < loop.length; i += 2) {
        const at = [view.x(sign * loop[i]), view.y(loop[i + 1])];
        if (i === 0) context.moveTo(...at); else context.lineTo(...at);
      }
      context.closePath();
    }
  }
  context.fillStyle = obstacleFill;
  context.strokeStyle = obstacleEdge;
  context.lineWidth = dots;
  context.fill(outline.isHollow ? "evenodd" : "nonzero");
  context.stroke();
}

function emptyLayer(width, height) {
  layer.width = Math.max(1, Math.ceil(width));
  layer.height = Math.max(1, Math.ceil(height));
  return layer.getContext("2d").createImageData(layer.width, layer.height);
}

function putLayer(image, x, y) {
  layer.getContext("2d").putImageData(image, 0, 0);
  context.drawImage(layer, x, y);
}

// Points as the solid body that they stand for: grown by their reach, then shrunk back to their outline, so that gaps
// close which stretching opens; a pixel has the colour of the nearest point.
function drawBody(view) {
  const { area, scale } = view;
  const image = emptyLayer(area.width, area.height);
  const spacing = scale * content.spacing;
  const near = { reach: Math.max(2 * spacing, 2), width: image.width, height: image.height };
  near.distances = new Float32Array(image.width * image.height).fill(Infinity);
  near.levels = new Uint8Array(image.width * image.height);
  const levels = values[state.field];
  for (let point = starts[state.frame]; point < starts[state.frame + 1]; point += 1) {
    const x = coordinate(point, 0), row = view.y(coordinate(point, 1)) - area.y;
    claim(near, view.x(x) - area.x, row, levels[point]);
    if (content.isMirrored) claim(near, view.x(-x) - area.x, row, levels[point]);
  }
  const inside = depths(near);
  const least = near.reach - Math.max(0.75 * spacing, 1);
  const palette = Array.from({ length: 256 }, (_, level) => pixelOf(level, 1));
  const pixels = new Uint32Array(image.data.buffer);
  for (let at = 0; at < pixels.length; at += 1) {
    if (inside[at] > least) pixels[at] = palette[near.levels[at]];
  }
  putLayer(image, area.x, area.y);
}

// A point takes the pixels within its reach to which no other one is nearer.
function claim({ reach, width, height, distances, levels }, x, y, level) {
  const last = Math.min(height - 1, Math.floor(y + reach));
  for (let row = Math.max(0, Math.ceil(y - reach)); row <= last; row += 1) {
    const up = (row - y) * (row - y), half = Math.sqrt(Math.max(0, reach * reach - up));
    const end = Math.min(width - 1, Math.floor(x + half));
    for (let column = Math.max(0, Math.ceil(x - half)); column <= end; column += 1) {
      const square = up + (column - x) * (column - x), at = row * width + column;
      if (square < distances[at]) {
        distances[at] = square;
        levels[at] = level;
      }
    }
  }
}

// How far each pixel that a point has taken is from those that none has, by steps along and across [pixels].
function depths({ width, height, distances }) {
  const found = new Float32Array(distances.length);
  const far = width + height, slant = Math.SQRT2;
  const relax = (row, column, step) => {
    const at = row * width + column;
    if (distances[at] === Infinity) return;
    let depth = step > 0 ? far : found[at];
    const before = row - step;
    if (column - step >= 0 && column - step < width) depth = Math.min(depth, found[at - step] + 1);
    if (before >= 0 && before < height) {
      const next = before * width + column;
      depth = Math.min(depth, found[next] + 1);
      if (column > 0) depth = Math.min(depth, found[next - 1] + slant);
      if (column < width - 1) depth = Math.min(depth, found[next + 1] + slant);
    }
    found[at] = depth;
  };
  for (let row = 0; row < height; row += 1) for (let column = 0; column < width; column += 1) relax(row, column, 1);
  for (let row = height - 1; row >= 0; row -= 1) for (let column = width - 1; column >= 0; column -= 1) relax(row, column, -1);
  return found;
}

function drawAxes(view, dots) {
  const { area } = view;
  const [left, right, bottom, top] = content.box;
  context.strokeStyle = context.fillStyle = "#1a1a1a";
  context.lineWidth = dots;
  context.font = `${12 * dots}px system-ui, sans-serif`;
  const edge = 0.5 * (Math.round(dots) % 2);
  context.strokeRect(area.x - edge, area.y - edge, area.width + 2 * edge, area.height + 2 * edge);
  const marks = (low, high, length) => {
    const step = roundStep(high - low, Math.max(1, length / (70 * dots)));
    const first = Math.ceil(low / step - 1e-9);
    return Array.from({ length: Math.floor(high / step + 1e-9) - first + 1 }, (_, i) => step * (first + i));
  };
  context.textAlign = "center";
  context.textBaseline = "top";
  for (const x of marks(left, right, area.width)) {
    line(view.x(x), area.y + area.height, view.x(x), area.y + area.height + 4 * dots);
    context.fillText(shown(x), view.x(x), area.y + area.height + 6 * dots);
  }
  context.fillText(content.labels[0], area.x + area.width / 2, area.y + area.height + 23 * dots);
  context.textAlign = "right";
  context.textBaseline = "middle";
  for (const y of marks(bottom, top, 1.7 * area.height)) {
    line(area.x - 4 * dots, view.y(y), area.x, view.y(y));
    context.fillText(shown(y), area.x - 6 * dots, view.y(y));
  }
  context.save();
  context.translate(area.x - 42 * dots, area.y + area.height / 2);
  context.rotate(-Math.PI / 2);
  context.textAlign = "center";
  context.fillText(content.labels[1], 0, 0);
  context.restore();
}

function line(fromX, fromY, toX, toY) {
  context.beginPath();
  context.moveTo(fromX, fromY);
  context.lineTo(toX, toY);
  context.stroke();
}

// ---- in three dimensions

const corners = [0, 1, 2, 3, 4, 5, 6, 7].map((n) =>
  [0, 1, 2].map((axis) => ((n >> axis) & 1 ? content.upper : content.lower)[axis]));

function solidView(width, height, dots) {
  const { azimuth, elevation } = state;
  const [sinA, cosA, sinE, cosE] = [Math.sin(azimuth), Math.cos(azimuth), Math.sin(elevation), Math.cos(elevation)];
  const right = [-sinA, cosA, 0], up = [-cosA * sinE, -sinA * sinE, cosE], towards = [cosA * cosE, sinA * cosE, sinE];
  const along = (place, way) => place[0] * way[0] + place[1] * way[1] + place[2] * way[2];
  const ends = (way) => {
    const found = [...corners, ...floorCorners()].map((corner) => along(corner, way));
    return [Math.min(...found), Math.max(...found)];
  };
  const [left, rightmost] = ends(right), [bottom, top] = ends(up);
  const air = 18 * dots;
  const scale = Math.min((width - 2 * air) / (rightmost - left), (height - 4 * air) / (top - bottom));
  const x = (place) => 0.5 * width + scale * (along(place, right) - 0.5 * (left + rightmost));
  const y = (place) => 0.5 * height - scale * (along(place, up) - 0.5 * (bottom + top));
  return { scale, x, y, right, up, towards, depth: (place) => scale * along(place, towards) };
}

// The corners of the floor around what is shown; none where it stands on nothing.
function floorCorners() {
  const [[, , floor]] = content.domain;
  if (content.lower[2] - floor > 2 * content.spacing) return [];
  const margin = 0.1 * Math.max(content.upper[0] - content.lower[0], content.upper[1] - content.lower[1]);
  const low = [0, 1].map((axis) => Math.max(content.lower[axis] - margin, content.domain[0][axis]));
  const high = [0, 1].map((axis) => Math.min(content.upper[axis] + margin, content.domain[1][axis]));
  return [[low[0], low[1], floor], [high[0], low[1], floor], [high[0], high[1], floor], [low[0], high[1], floor]];
}

function drawSolid(width, height, dots) {
  const view = solidView(width, height, dots);
  const around = floorCorners();
  if (around.length) {
    context.fillStyle = "#e2e2e2";
    context.beginPath();
    around.forEach((corner, i) => context[i ? "lineTo" : "moveTo"](view.x(corner), view.y(corner)));
    context.fill();
  }
  drawBalls(view, width, height);
  for (const number of content.obstacles.frames[state.frame]) drawFaces(outlines[number], view, dots);
  drawDirections(view, height, dots);
  drawLength(view, width, height, dots);
}

// What a point looks like: the pixels of a ball of a radius, how near each is, and how bright.
function ball(radius) {
  const found = [];
  const light = [-0.35, 0.45, 0.82];
  const reach = Math.ceil(radius);
  for (let y = -reach; y <= reach; y += 1) {
    for (let x = -reach; x <= reach; x += 1) {
      const square = (x * x + y * y) / (radius * radius);
      if (square > 1 && (x || y)) continue;
      const near = Math.sqrt(Math.max(0, 1 - square));
      const facing = (light[0] * x - light[1] * y) / radius + light[2] * near;
      found.push({ x, y, near: near * radius, shade: Math.round(15 * Math.min(1, Math.max(0, facing))) });
    }
  }
  return found;
}

function drawBalls(view, width, height) {
  const image = emptyLayer(width, height);
  const pixels = new Uint32Array(image.data.buffer);
  const nearest = new Float32Array(pixels.length).fill(-Infinity);
  const parts = ball(Math.max(1, 0.85 * view.scale * content.spacing));
  const palette = Array.from({ length: 16 }, (_, shade) =>
    Array.from({ length: 256 }, (__, level) => pixelOf(level, 0.5 + shade / 30)));
  const levels = values[state.field];
  const place = [0, 0, 0];
  for (let point = starts[state.frame]; point < starts[state.frame + 1]; point += 1) {
    for (let axis = 0; axis < 3; axis += 1) place[axis] = coordinate(point, axis);
    const column = Math.round(view.x(place)), row = Math.round(view.y(place)), depth = view.depth(place);
    for (const part of parts) {
      const x = column + part.x, y = row + part.y;
      if (x < 0 || y < 0 || x >= image.width || y >= image.height) continue;
      const at = y * image.width + x;
      if (depth + part.near > nearest[at]) {
        nearest[at] = depth + part.near;
        pixels[at] = palette[part.shade][levels[point]];
      }
    }
  }
  putLayer(image, 0, 0);
}

// The faces in front, of a hollow obstacle those behind, seen through; and its sharp edges.
function drawFaces(outline, view, dots) {
  const { faces, edges } = solids[outline.solid];
  const count = outline.points.length / 3;
  const seen = Array.from({ length: count }, (_, i) => {
    const place = outline.points.subarray(3 * i, 3 * i + 3);
    return [view.x(place), view.y(place)];
  });
  context.beginPath();
  for (let i = 0; i < faces.length; i += 3) {
    const [a, b, c] = [seen[faces[i]], seen[faces[i + 1]], seen[faces[i + 2]]];
    const turn = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    // Down is positive on a canvas: what faces us turns the negative way.
    if (turn < 0 === outline.isHollow) continue;
    context.moveTo(...a);
    context.lineTo(...b);
    context.lineTo(...c);
    context.closePath();
  }
  context.fillStyle = "#8c8c8c59";
  context.fill();
  context.beginPath();
  for (let i = 0; i < edges.length; i += 2) {
    context.moveTo(...seen[edges[i]]);
    context.lineTo(...seen[edges[i + 1]]);
  }
  context.strokeStyle = obstacleEdge;
  context.lineWidth = 0.8 * dots;
  context.stroke();
}

function drawDirections(view, height, dots) {
  const size = 26 * dots, x = 36 * dots, y = height - 30 * dots;
  context.font = `${12 * dots}px system-ui, sans-serif`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  ["x", "y", "z"].forEach((name, axis) => {
    const [across, up] = [size * view.right[axis], -size * view.up[axis]];
    context.strokeStyle = context.fillStyle = ["#b03a2e", "#1e8449", "#1f5fa8"][axis];
    context.lineWidth = 2 * dots;
    line(x, y, x + across, y + up);
    context.fillText(name, x + 1.35 * across, y + 1.35 * up);
  });
}

function drawLength(view, width, height, dots) {
  const length = roundStep((0.2 * width) / view.scale, 1.6);
  const x = width - 14 * dots, y = height - 14 * dots;
  context.strokeStyle = context.fillStyle = "#1a1a1a";
  context.lineWidth = 2 * dots;
  line(x - view.scale * length, y, x, y);
  context.textAlign = "right";
  context.textBaseline = "bottom";
  context.fillText(`${shown(length)} m`, x, y - 4 * dots);
}

// ---- what is drawn, and the controls

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
