// The picture of bodies in three dimensions, seen from where the reader turns it.

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
  const obstacles = content.obstacles.frames[state.frame].map((number) => outlines[number]);
  // Of what is around bodies the far side is shown, which they hide.
  for (const one of obstacles.filter((outline) => outline.isHollow)) drawFaces(one, view, dots);
  drawBalls(view, width, height);
  for (const one of obstacles.filter((outline) => !outline.isHollow)) drawFaces(one, view, dots);
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
