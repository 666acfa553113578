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
