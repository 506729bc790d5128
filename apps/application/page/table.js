// Tables of the page.
import { element } from './dom.js';
import { exporting } from './export.js';

// A table with its caption; if `raw` is given, its button saves these rows as CSV.
export const table = (caption, heads, rows, raw) => {
  const shown = element('div', { class: 'scroll', tabindex: 0, role: 'region', 'aria-label': caption },
    element('table', {}, element('caption', {}, caption),
      element('thead', {}, element('tr', {}, heads.map((head) => element('th', { scope: 'col' }, head)))),
      element('tbody', {}, rows.map((cells) => element('tr', {}, cells.map((cell, i) =>
        (i ? element('td', {}, cell) : element('th', { scope: 'row' }, cell))))))));
  return raw ? element('div', {}, shown, element('p', { class: 'tools' }, exporting.csvButton(caption, () => [heads, ...raw]))) : shown;
};

// A figure with buttons that save it.
export const figure = (caption, picture, title = caption) => element('figure', {}, element('figcaption', {}, caption), picture,
  element('p', { class: 'tools' }, exporting.figureButtons(title, () => exporting.svgOf(picture))));

export const states = {
  draft: ['Draft', 'its keys are not valid yet'], ready: ['Ready', 'not run yet'], running: ['Running', ''],
  interrupted: ['Interrupted', 'a checkpoint exists: the run can continue'], converged: ['Converged', ''],
  'not-converged': ['Not converged', 'the run needs more draws'], done: ['Done', ''], alarm: ['Alarm', ''],
  changed: ['Changed', 'edited since its last run'], queued: ['Waiting', ''], stopping: ['Stopping', ''], stopped: ['Stopped', ''], failed: ['Failed', ''],
};

export const badge = (state) => element('span', { class: `badge ${state}`, title: states[state]?.[1] ?? '' }, states[state]?.[0] ?? state);
