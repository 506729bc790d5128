// The list of runs, which the page updates from the server while a case runs.
import { attempt, button, element, number, seconds } from './dom.js';
import { get, post } from './server.js';
import { badge } from './table.js';
import { stagesOf, traceView } from './trace.js';

const listeners = new Set();
let list = [], timer, known = new Map();
const traced = new Map(); // the last trace of each run; the server has it only during the run

const busy = (run) => ['queued', 'running', 'stopping'].includes(run.state);

const poll = async () => {
  clearTimeout(timer);
  try {
    list = (await get('runs')).runs;
    for (const run of list) {
      if (run.trace) traced.set(run.number, run);
      else if (traced.has(run.number)) run.trace = traced.get(run.number).trace;
    }
    const ended = list.filter((run) => known.has(run.number) && !busy(run) && known.get(run.number));
    known = new Map(list.map((run) => [run.number, busy(run)]));
    document.getElementById('activity').textContent = list.some(busy)
      ? list.filter((run) => run.state === 'running').map((run) => `${run.case}: ${run.stage || 'starting'} ${Math.round(100 * run.fraction)} %`).join('; ') : '';
    for (const listener of listeners) listener(list, ended);
  } catch (error) {
    document.getElementById('activity').textContent = error.message;
  }
  timer = setTimeout(poll, list.some(busy) ? 700 : 5000);
};

// Calls `listener(runs, ended)` after each change; returns a function that ends these calls.
export const follow = (listener) => {
  listeners.add(listener);
  poll();
  return () => listeners.delete(listener);
};

export const start = async (name, options = {}) => {
  await post('run', { name, ...options });
  await poll();
};

const words = (run) => {
  if (run.state === 'running' || run.state === 'stopping') {
    const left = run.seconds_left !== undefined ? `, about ${seconds(run.seconds_left)} left` : '';
    return `${run.stage || 'starting'}: ${Math.round(100 * run.fraction)} %, ${seconds(run.seconds ?? 0)} so far${left}${run.detail && !run.trace ? `. ${run.detail}` : ''}`;
  }
  if (run.state === 'failed') return run.message;
  return run.seconds !== undefined ? `${number(run.seconds, 3)} s` : '';
};

// The list of runs; `name` limits it to one case.
export const runList = (name) => {
  const place = element('ul', { class: 'runs' });
  const show = (runs) => {
    const shown = runs.filter((run) => !name || run.case === name).reverse();
    place.replaceChildren(...(shown.length ? shown.slice(0, 30).map((run) => element('li', {},
      element('div', { class: 'row' }, badge(run.state), element('a', { href: `#/case/${encodeURIComponent(run.case)}` }, run.case),
        busy(run) && run.state !== 'stopping' && button('Stop', () => attempt(async () => { await post('stop', { number: run.number }); await poll(); }), { 'aria-label': `Stop ${run.case}` }),
        ['done', 'stopped'].includes(run.state) && element('a', { href: `#/result/${encodeURIComponent(run.output)}` }, 'Results')),
      run.state === 'running' && element('progress', { max: 1, value: run.fraction, 'aria-label': `${run.case}: ${run.stage}` }),
      element('p', { class: run.state === 'failed' ? 'fault' : 'quiet' }, words(run)),
      run.stages?.length > 1 && element('p', { class: 'quiet' }, `Stages: ${stagesOf(run)}`),
      run.trace?.seconds.length > 1 && (busy(run) || run === shown[0]) && traceView(run)))
      : [element('li', { class: 'quiet' }, 'No runs since the application was started.')]));
  };
  return { place, close: follow(show) };
};
