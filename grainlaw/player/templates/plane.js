// The picture of bodies in a plane, and of a section mirrored at its axis.

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
