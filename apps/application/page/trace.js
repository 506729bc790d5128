// The probabilities of the models during a run: a line for each model over the time of the run, with the stages.
import { element, seconds, svg } from './dom.js';
import { plot } from './plot.js';

const width = 560, height = 190, most = 6; // models with a line

// The stages so far with the time of each.
export const stagesOf = (run) => (run.stages ?? []).map((stage, i, all) => {
  const end = all[i + 1]?.begin ?? run.seconds;
  return `${stage.name} ${seconds(Math.max(0, end - stage.begin))}`;
}).join(', ');

export const traceView = (run) => {
  const { seconds: times, models } = run.trace, shown = models.slice(0, most);
  const now = shown.map((model) => `${model.name} ${model.probability.at(-1)?.toFixed(2) ?? '–'}`).join(', ');
  const drawn = plot({ width, height, xs: [times[0], Math.max(times.at(-1), times[0] + 1)], ys: [0, 1], xLabel: 'elapsed time [s]', yLabel: 'probability',
    label: `Probability of each model by the draws so far: ${now}` });
  for (const { name, begin } of run.stages ?? []) {
    if (begin <= times[0] || begin > times.at(-1)) continue;
    drawn.picture.append(svg('line', { class: 'stage', x1: drawn.x(begin), x2: drawn.x(begin), y1: drawn.top, y2: drawn.bottom }, svg('title', {}, name)));
  }
  shown.forEach(({ probability }, k) => {
    let d = '', pen = 'M';
    probability.forEach((p, i) => {
      if (p === null) { pen = 'M'; return; }
      d += `${pen}${drawn.x(times[i]).toFixed(1)} ${drawn.y(p).toFixed(1)}`;
      pen = 'L';
    });
    drawn.picture.append(svg('path', { class: `series s${k}`, d }));
  });
  return element('figure', { class: 'trace' }, drawn.picture, element('ul', { class: 'legend' }, shown.map((model, k) =>
    element('li', {}, svg('svg', { class: 'key', viewBox: '0 0 24 8', 'aria-hidden': 'true' }, svg('path', { class: `series s${k}`, d: 'M0 4H24' })), ` ${model.name}: ${model.probability.at(-1)?.toFixed(2) ?? '–'}`))));
};
