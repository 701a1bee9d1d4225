// Draws every chart of the page. One that cannot be drawn says so in its place and spoils no other.
const DRAW = {'xy': drawXy, 'heat-map': drawHeatMap};
const charts = [];
document.querySelectorAll('figure.chart').forEach((figure, i) => {
  const host = figure.querySelector('.plot');
  host.id = 'plot-' + i;
  try {
    const spec = JSON.parse(figure.querySelector('script').textContent);
    charts.push({host, width: host.clientWidth, resize: DRAW[figure.dataset.kind](host, spec)});
    host.style.minHeight = '';
    figure.dataset.drawn = 'yes';
  } catch (error) {
    host.textContent = 'This plot could not be drawn: ' + error.message;
    figure.dataset.drawn = 'no';
    console.error(error);
  }
});

function fit(width) {
  for (const chart of charts) {
    const wanted = width || chart.host.clientWidth;
    if (wanted > 0 && wanted !== chart.width) chart.resize(chart.width = wanted);
  }
}
addEventListener('resize', () => fit());
// A sheet is narrower than most screens: 184 mm at 96 pixels an inch, less the edge of a card.
addEventListener('beforeprint', () => fit(660));
addEventListener('afterprint', () => fit());
