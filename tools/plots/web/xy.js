// Curves with bands: what chart.cpp calls XyChart. One colour and one dash for each role, in every chart; the colours
// are told apart by every kind of colour vision, and the dashes on grey paper.
const ROLES = {
  measured: {stroke: '#a3aab5', width: 3, dash: []},
  before: {stroke: '#d55e00', width: 1.5, dash: []},
  after: {stroke: '#0072b2', width: 1.5, dash: []},
  effect: {stroke: '#111827', width: 2, dash: [7, 4]},
  other: {stroke: '#8a5a83', width: 1.5, dash: [2, 3]},
};
const INK = '#4b5563', GRID = '#e7e9ec', FONT = '12px ' + getComputedStyle(document.body).fontFamily;

// A number as people write it: a real minus, a power of ten where zeros would have to be counted.
function numberText(value, digits) {
  if (value == null || !isFinite(value)) return '';
  const size = Math.abs(value);
  let text = String(+value.toPrecision(digits));
  if (size !== 0 && (size >= 1e6 || size < 1e-4)) {
    const [mantissa, exponent] = value.toExponential(Math.min(digits - 1, 2)).split('e');
    const power = String(+exponent).replace('-', '⁻').replace(/\d/g, (d) => '⁰¹²³⁴⁵⁶⁷⁸⁹'[d]);
    text = (+mantissa === 1 ? '' : +mantissa === -1 ? '-' : +mantissa + '×') + '10' + power;
  }
  return text.replace('-', '−');
}

function withAlpha(hex, alpha) {
  const part = (i) => parseInt(hex.slice(i, i + 2), 16);
  return `rgba(${part(1)},${part(3)},${part(5)},${alpha})`;
}

function swatch(role, band) {
  return `<svg width="26" height="10" aria-hidden="true">` +
    (band ? `<rect x="0" y="0" width="26" height="10" fill="${withAlpha(role.stroke, 0.18)}"/>` : '') +
    `<line x1="0" x2="26" y1="5" y2="5" stroke="${role.stroke}" stroke-width="2.5"` +
    ` stroke-dasharray="${role.dash.join(' ')}"/></svg><span></span><output></output>`;
}

// The legend above a chart: shows the values under the cursor, a click hides and shows a curve.
function makeLegend(spec, series) {
  const legend = document.createElement('div');
  legend.className = 'legend';
  const values = series.map((s, i) => {
    const item = document.createElement('button');
    item.type = 'button';
    item.title = 'click to hide or show';
    item.innerHTML = swatch(ROLES[s.role], s.low);
    item.querySelector('span').textContent = s.label;
    item.onclick = () => {
      const shown = item.classList.toggle('off') === false;
      s.columns.forEach((column) => legend.chart.setSeries(column, {show: shown}));
    };
    legend.append(item);
    return item.querySelector('output');
  });
  for (const rule of spec.rules) {
    const item = document.createElement('span');
    item.innerHTML = swatch({stroke: INK, dash: [5, 3]}, false);
    item.querySelector('span').textContent = rule.label;
    legend.append(item);
  }
  legend.update = (u) => series.forEach((s, i) => {
    const index = u.cursor.idxs[s.columns[0]];
    const value = index == null ? null : u.data[s.columns[0]][index];
    values[i].textContent = value == null ? '' : numberText(value, 4);
  });
  return legend;
}

function roundTo(u, value, scale) { return Math.round(u.valToPos(value, scale, true)); }

function drawShades(u, shades) {
  const {ctx, bbox} = u;
  ctx.save();
  for (const shade of shades) {
    const left = Math.max(bbox.left, roundTo(u, shade.from, 'x'));
    const right = Math.min(bbox.left + bbox.width, roundTo(u, shade.to, 'x'));
    if (right <= left) continue;
    ctx.fillStyle = '#eaeef3';
    ctx.fillRect(left, bbox.top, right - left, bbox.height);
    ctx.strokeStyle = '#9ca3af';
    ctx.lineWidth = uPlot.pxRatio;
    ctx.setLineDash([3 * uPlot.pxRatio, 3 * uPlot.pxRatio]);
    ctx.beginPath();
    ctx.moveTo(left, bbox.top);
    ctx.lineTo(left, bbox.top + bbox.height);
    ctx.stroke();
  }
  ctx.restore();
}

function scaledFont() { return FONT.replace(/^\d+/, (size) => Math.round(0.92 * size * uPlot.pxRatio)); }

// Straight lines, and words at the top of tinted parts.
function drawNotes(u, spec) {
  const {ctx, bbox} = u, px = uPlot.pxRatio;
  ctx.save();
  ctx.font = scaledFont();
  ctx.textBaseline = 'top';
  ctx.textAlign = 'left';
  ctx.lineJoin = 'round';
  for (const shade of spec.shades) {
    const left = Math.max(bbox.left, roundTo(u, shade.from, 'x'));
    const right = Math.min(bbox.left + bbox.width, roundTo(u, shade.to, 'x'));
    if (right - left < ctx.measureText(shade.label).width + 12 * px) continue;
    // White behind the words keeps them readable on a curve.
    ctx.lineWidth = 4 * px;
    ctx.strokeStyle = 'rgba(255,255,255,0.85)';
    ctx.strokeText(shade.label, left + 7 * px, bbox.top + 5 * px);
    ctx.fillStyle = INK;
    ctx.fillText(shade.label, left + 7 * px, bbox.top + 5 * px);
  }
  for (const rule of spec.rules) {
    const y = roundTo(u, rule.y, 'y');
    if (y < bbox.top || y > bbox.top + bbox.height) continue;
    ctx.strokeStyle = INK;
    ctx.lineWidth = px;
    ctx.setLineDash([6 * px, 3 * px]);
    ctx.beginPath();
    ctx.moveTo(bbox.left, y);
    ctx.lineTo(bbox.left + bbox.width, y);
    ctx.stroke();
  }
  ctx.restore();
}

function axis(title, vertical) {
  return {
    label: title, labelFont: FONT, font: FONT, stroke: INK, labelSize: 22, gap: 5,
    // The same for all usual numbers, so that charts above each other share their place.
    size: vertical ? (u, values) => 14 + 7 * Math.max(6, ...(values || []).map((v) => (v || '').length)) : 34,
    grid: {stroke: GRID, width: 1}, ticks: {stroke: '#c4c8ce', width: 1, size: 5}, border: {show: true, stroke: '#c4c8ce', width: 1},
    values: (u, ticks) => ticks.map((tick) => tick == null ? '' : numberText(tick, 6)),
  };
}

// Room above and below the curves; a flat curve gets a scale of its own size.
function paddedRange(u, low, high) {
  if (low == null) return [0, 1];
  const room = 0.06 * (high - low) || 0.1 * Math.abs(high) || 1;
  return [low - room, high + room];
}

function drawXy(host, spec) {
  const tables = spec.series.map((s) => s.low ? [s.x, s.y, s.low, s.high] : [s.x, s.y]);
  const data = tables.length > 1 ? uPlot.join(tables) : tables[0];
  const options = [{}], bands = [], series = [];
  for (const s of spec.series) {
    const role = ROLES[s.role], column = options.length;
    const busy = s.role !== 'measured' && s.x.length > 1500;  // thick noise hides what lies behind it
    options.push({stroke: busy ? withAlpha(role.stroke, 0.8) : role.stroke, width: busy ? 1 : role.width, dash: role.dash,
      points: {show: s.x.length <= 60 && s.role !== 'effect', size: 5, fill: role.stroke}});
    if (s.low) {
      options.push({width: 0, points: {show: false}}, {width: 0, points: {show: false}});
      bands.push({series: [column + 2, column + 1], fill: withAlpha(role.stroke, 0.16)});
    }
    series.push({...s, columns: s.low ? [column, column + 1, column + 2] : [column]});
  }
  const legend = makeLegend(spec, series);
  host.replaceChildren(legend);
  const chart = new uPlot({
    width: host.clientWidth, height: spec.height, series: options, bands, legend: {show: false},
    padding: [8, 22, 0, 0],
    axes: [axis(spec.x_title, false), axis(spec.y_title, true)],
    scales: {x: {time: false, distr: spec.log_x ? 3 : 1},
      y: spec.log_y ? {distr: 3} : {range: paddedRange}},
    cursor: {drag: {x: true, y: false, setScale: true}, points: {size: 6},
      ...(spec.sync ? {sync: {key: spec.sync, setSeries: false, scales: ['x', null]}} : {})},
    hooks: {
      drawClear: [(u) => drawShades(u, spec.shades)],
      draw: [(u) => drawNotes(u, spec)],
      setCursor: [(u) => legend.update(u)],
    },
  }, data, host);
  legend.chart = chart;
  return (width) => chart.setSize({width, height: spec.height});
}

