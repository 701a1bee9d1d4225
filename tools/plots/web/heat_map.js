// Coloured cells: what chart.cpp calls HeatMap, as SVG. Light to dark in every kind of colour vision and on grey paper.
const HEAT = ['#fff7e0', '#fde0a0', '#f8b562', '#e8803a', '#c24e1b', '#862e0d', '#471505'];

function heatColour(share) {
  const place = Math.min(1, Math.max(0, share)) * (HEAT.length - 1), i = Math.min(HEAT.length - 2, Math.floor(place));
  const mix = (k) => Math.round(parseInt(HEAT[i].slice(k, k + 2), 16) * (1 - place + i) +
    parseInt(HEAT[i + 1].slice(k, k + 2), 16) * (place - i));
  return `rgb(${mix(1)},${mix(3)},${mix(5)})`;
}

// Round numbers that divide a range into about `count` parts.
function roundTicks(low, high, count) {
  const rough = (high - low) / count, unit = 10 ** Math.floor(Math.log10(rough));
  const step = unit * [1, 2, 5, 10].find((m) => m * unit >= rough);
  const ticks = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) ticks.push(i * step);
  return ticks;
}

function svgElement(parent, name, attributes, text) {
  const element = document.createElementNS('http://www.w3.org/2000/svg', name);
  for (const key in attributes) element.setAttribute(key, attributes[key]);
  if (text !== undefined) element.textContent = text;
  parent.append(element);
  return element;
}

// One wild cell must not make all others pale: the scale then ends before it, and says so.
function scaleOf(values) {
  const sorted = values.filter((v) => v !== null).sort((a, b) => a - b);
  const highest = sorted[sorted.length - 1], usual = sorted[Math.floor(0.98 * (sorted.length - 1))];
  const cut = usual > 0 && highest > 2.5 * usual;
  const low = Math.min(0, sorted[0]);
  const high = cut ? usual : highest;
  return {low, high: high > low ? high : low + 1, cut};
}

function drawHeatMap(host, spec) {
  const scale = scaleOf(spec.value), columns = spec.x_edges.length - 1;
  const draw = (width) => {
    const box = {left: 74, top: 30, right: width - 92, bottom: spec.height - 48};
    const x0 = spec.x_edges[0], x1 = spec.x_edges[columns];
    const y0 = spec.y_edges[0], y1 = spec.y_edges[spec.y_edges.length - 1];
    const px = (x) => box.left + (x - x0) / (x1 - x0) * (box.right - box.left);
    const py = (y) => box.bottom - (y - y0) / (y1 - y0) * (box.bottom - box.top);
    const svg = document.createElementNS('http://www.w3.org/2000/svg', 'svg');
    const set = (attributes) => { for (const key in attributes) svg.setAttribute(key, attributes[key]); };
    set({width, height: spec.height, viewBox: `0 0 ${width} ${spec.height}`, role: 'img', class: 'heat-map'});
    const hatch = svgElement(svgElement(svg, 'defs', {}), 'pattern',
      {id: host.id + '-hatch', width: 6, height: 6, patternUnits: 'userSpaceOnUse', patternTransform: 'rotate(45)'});
    svgElement(hatch, 'rect', {width: 6, height: 6, fill: '#f6f7f9'});
    svgElement(hatch, 'line', {x1: 0, y1: 0, x2: 0, y2: 6, stroke: '#e2e5e9', 'stroke-width': 2});
    svgElement(svg, 'rect', {x: box.left, y: box.top, width: box.right - box.left, height: box.bottom - box.top,
      fill: `url(#${host.id}-hatch)`});
    const readout = svgElement(svg, 'text', {x: box.left, y: 18, class: 'readout'}, '');
    spec.value.forEach((value, index) => {
      if (value === null) return;
      const i = index % columns, j = Math.floor(index / columns);
      const [xa, xb, ya, yb] = [spec.x_edges[i], spec.x_edges[i + 1], spec.y_edges[j], spec.y_edges[j + 1]];
      const cell = svgElement(svg, 'rect', {x: px(xa), y: py(yb), width: Math.max(0.5, px(xb) - px(xa) - 0.6),
        height: Math.max(0.5, py(ya) - py(yb) - 0.6), fill: heatColour((value - scale.low) / (scale.high - scale.low)),
        class: 'cell'});
      const words = `${spec.value_title}: ${numberText(value, 3)}   at ${spec.x_title} ${numberText(xa, 3)} to ` +
        `${numberText(xb, 3)}, ${spec.y_title} ${numberText(ya, 3)} to ${numberText(yb, 3)}`;
      cell.addEventListener('pointerenter', () => { readout.textContent = words; });
      cell.addEventListener('pointerleave', () => { readout.textContent = ''; });
    });
    let path = '';
    (spec.line_y || []).forEach((y, i) => {
      if (y === null) return;
      path += (i > 0 && spec.line_y[i - 1] !== null ? 'L' : 'M') + px(spec.line_x[i]).toFixed(1) + ' ' + py(y).toFixed(1);
    });
    if (path) svgElement(svg, 'path', {d: path, fill: 'none', stroke: '#111827', 'stroke-width': 1.5,
      'stroke-dasharray': '7 4', 'pointer-events': 'none'});
    for (const tick of roundTicks(x0, x1, Math.max(3, (box.right - box.left) / 110))) {
      svgElement(svg, 'line', {x1: px(tick), x2: px(tick), y1: box.bottom, y2: box.bottom + 5, stroke: '#c4c8ce'});
      svgElement(svg, 'text', {x: px(tick), y: box.bottom + 18, 'text-anchor': 'middle'}, numberText(tick, 4));
    }
    for (const tick of roundTicks(y0, y1, 6)) {
      svgElement(svg, 'line', {x1: box.left - 5, x2: box.left, y1: py(tick), y2: py(tick), stroke: '#c4c8ce'});
      svgElement(svg, 'text', {x: box.left - 9, y: py(tick) + 4, 'text-anchor': 'end'}, numberText(tick, 4));
    }
    svgElement(svg, 'text', {x: (box.left + box.right) / 2, y: spec.height - 8, 'text-anchor': 'middle'}, spec.x_title);
    svgElement(svg, 'text', {transform: `translate(14 ${(box.top + box.bottom) / 2}) rotate(-90)`,
      'text-anchor': 'middle'}, spec.y_title);
    drawScale(svg, scale, spec.value_title, {left: width - 76, top: box.top, bottom: box.bottom});
    host.replaceChildren(svg);
  };
  draw(host.clientWidth);
  return draw;
}

function drawScale(svg, scale, title, box) {
  const height = box.bottom - box.top, steps = 60;
  for (let i = 0; i < steps; ++i)
    svgElement(svg, 'rect', {x: box.left, y: box.bottom - (i + 1) * height / steps, width: 14, height: height / steps + 0.5,
      fill: heatColour((i + 0.5) / steps), class: 'scale'});
  const place = (value) => box.bottom - (value - scale.low) / (scale.high - scale.low) * height;
  for (const tick of roundTicks(scale.low, scale.high, 5))
    svgElement(svg, 'text', {x: box.left + 19, y: place(tick) + 4}, numberText(tick, 3));
  svgElement(svg, 'text', {x: box.left + 62, y: box.top - 12, 'text-anchor': 'end'}, title + (scale.cut ? ' (darkest: more)' : ''));
}

