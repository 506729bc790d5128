// The folder: cases with their states, results, records; new cases and comparisons.
import { ask, attempt, button, element, number } from './dom.js';
import { exporting } from './export.js';
import { newDamageCase } from './modes_case.js';
import { get, post } from './server.js';
import { follow, runList, start } from './runs.js';
import { badge, table } from './table.js';

const meanings = {
  'damage beam': 'Damage in a beam', 'damage frame': 'Damage in a frame', 'damage building': 'Damage in a shear building',
  'damage matrices': 'Damage in another program’s matrices', 'sid beam': 'System identification of masses and springs',
  'update beam': 'Parameters of a structure from its modes', 'modal beam': 'Modes from vibration records', 'monitor beam': 'Monitoring of a series',
};

const link = (kind, name, text = name) => element('a', { href: `#/${kind}/${encodeURIComponent(name)}` }, text);

const newCase = (projects) => attempt(async () => {
  const choice = element('select', {}, projects.starters.map((s, i) => element('option', { value: i }, meanings[`${s.kind} ${s.structure}`] ?? `${s.kind}, ${s.structure}`)));
  const folder = element('input', { value: 'my-case', required: true, spellcheck: 'false' });
  const given = await ask('New case', [{ label: 'Kind', control: choice }, { label: 'New folder for the files of the case', control: folder }], 'Create');
  if (!given) return;
  const { kind, structure } = projects.starters[Number(given[0])];
  const { name } = await post('start', { kind, structure, folder: given[1].trim() });
  location.hash = `#/case/${encodeURIComponent(name)}`;
});

export const copyCase = (name) => attempt(async () => {
  const to = element('input', { value: name.replace(/\.json$/, '-copy.json'), required: true, spellcheck: 'false' });
  const given = await ask('Copy the case', [{ label: 'Name of the copy, in the same folder', control: to }], 'Copy');
  if (!given) return;
  const made = await post('copy', { name, to: given[0].trim() });
  location.hash = `#/case/${encodeURIComponent(made.name)}`;
});

// A probability as text; an upper bound if it is below 1e-6.
const share = (p, digits = 3) => (p > 0 && p < 1e-6 ? '< 0.000001' : number(p, digits));

// Model probabilities and parameters of several results, side by side.
const comparison = async (names) => {
  const all = await Promise.all(names.map((name) => get('result', { name })));
  const models = [...new Set(all.flatMap((one) => (one.models ?? []).map((m) => m.name)))];
  const parameters = [...new Set(all.flatMap((one) => Object.entries(one.parameters ?? {}).flatMap(([model, own]) => Object.keys(own).map((p) => `${model}: ${p}`))))];
  const modes = Math.max(...all.map((one) => (one.modes ?? []).length));
  const rows = [
    ...models.map((model) => [`P(${model})`, ...all.map((one) => share(one.models?.find((m) => m.name === model)?.probability))]),
    ...parameters.map((label) => {
      const [model, parameter] = label.split(/: (.*)/s);
      return [label, ...all.map((one) => {
        const p = one.parameters?.[model]?.[parameter];
        return p ? `${number(p.q50)} (${number(p['q2.5'])} to ${number(p['q97.5'])})` : '–';
      })];
    }),
    ...Array.from({ length: modes }, (ignored, i) => [`mode ${i + 1} [Hz]`, ...all.map((one) => {
      const mode = one.modes?.[i];
      return mode ? `${number(mode.frequency_hz, 5)} ± ${number(mode.frequency_sd, 2)}` : '–';
    })]),
    ['converged', ...all.map((one) => (one.diagnostics?.converged === undefined ? '–' : String(one.diagnostics.converged)))],
  ];
  return element('section', {}, element('h2', {}, 'Comparison'), table('Parameters: medians, with 95 % intervals in brackets. Modes: frequencies ± one standard deviation', ['quantity', ...names], rows, rows));
};

export const projectsView = async (place) => {
  const compared = new Set();
  let projects;
  const below = element('div');
  const list = runList();
  const draw = async () => {
    projects = await get('projects');
    const { cases, results, records } = projects;
    const sections = [
      element('h1', {}, 'Cases'),
      element('p', { class: 'quiet' }, `Folder ${projects.folder}`, projects.truncated && ': it has too many files to list all of them'),
      element('p', {}, button('New case …', () => newCase(projects), { class: 'main' })),
      cases.length ? table('Cases of the folder', ['case', 'title', 'kind', 'state', 'actions'], cases.map((one) => [
        link('case', one.name), one.title, one.kind, badge(one.state),
        element('span', { class: 'actions' },
          one.result && link('result', one.result, 'results'),
          one.state === 'interrupted' ? button('continue', () => attempt(() => start(one.name, { resume: true }).then(draw)), { 'aria-label': `Continue ${one.name}` })
            : ['ready', 'changed', 'not-converged'].includes(one.state) && button('run', () => attempt(() => start(one.name).then(draw)), { 'aria-label': `Run ${one.name}` }),
          button('copy', () => copyCase(one.name), { 'aria-label': `Copy ${one.name}` }))]))
        : element('p', { class: 'empty' }, 'There is no case in this folder yet. Choose New case to begin with an example, or open a record below.'),
      element('h2', {}, 'Runs'), list.place,
      element('h2', {}, 'Results'),
      results.length ? table('Results of the folder', ['compare', 'results', 'kind', 'state', 'answer'], results.map((one) => [
        element('input', { type: 'checkbox', 'aria-label': `Compare ${one.name}`, checked: compared.has(one.name), onchange: (event) => {
          if (event.target.checked) compared.add(one.name); else compared.delete(one.name);
          compare.disabled = compared.size < 2;
        } }), link('result', one.name), one.command, badge(one.state), element('span', { class: 'long' }, one.answer || one.title)]))
        : element('p', { class: 'quiet' }, 'No results yet.'),
    ];
    const compare = button('Compare the marked results', () => attempt(async () => {
      below.replaceChildren(await comparison([...compared]));
      below.scrollIntoView();
    }), { disabled: compared.size < 2 });
    if (results.length > 1) sections.push(element('p', {}, compare));
    sections.push(below, element('h2', {}, 'Records'), records.length
      ? table('Measured files of the folder', ['file', 'size'], records.map((one) => [link('record', one.name), one.bytes < 1e6 ? `${number(one.bytes / 1e3, 3)} kB` : `${number(one.bytes / 1e6, 3)} MB`]))
      : element('p', { class: 'quiet' }, 'No measured files: copy a text, MATLAB, HDF5 or universal file into the folder.'));
    place.replaceChildren(...sections);
  };
  await draw();
  const stop = follow((ignored, ended) => { if (ended.length) attempt(draw); });
  return () => { stop(); list.close(); };
};

export const resultView = async (place, name) => {
  const [summary, projects] = await Promise.all([get('result', { name }), get('projects')]);
  const kept = projects.results.find((one) => one.name === name);
  const own = projects.cases.find((one) => one.result === name);
  const title = summary.title ?? own?.title ?? name;
  const answer = Array.isArray(summary.answer) ? summary.answer : [summary.answer?.headline, summary.answer?.detail, summary.answer?.caution].filter(Boolean);
  const tables = [];
  const add = (caption, heads, rows, raw) => tables.push(table(caption, heads, rows, raw));
  if (summary.models?.length > 1)
    add('Models', ['model', 'prior', 'probability', 'Monte Carlo error'], summary.models.map((m) => [m.name, number(m.prior, 3), share(m.probability), share(m.mcse, 1)]),
      summary.models.map((m) => [m.name, m.prior, m.probability, m.mcse]));
  for (const [model, own_] of Object.entries(summary.parameters ?? {})) {
    const rows = Object.entries(own_);
    if (rows.length) add(`Parameters of ${model}`, ['parameter', 'mean', 'sd', '2.5 %', '50 %', '97.5 %'], rows.map(([p, v]) => [p, number(v.mean), number(v.sd, 2), number(v['q2.5']), number(v.q50), number(v['q97.5'])]),
      rows.map(([p, v]) => [p, v.mean, v.sd, v['q2.5'], v.q50, v['q97.5']]));
  }
  if (Array.isArray(summary.modes))
    add('Modes', ['mode', 'f [Hz]', 'sd [Hz]', 'damping [%]', 'sd [%]'], summary.modes.map((m, i) => [String(i + 1), number(m.frequency_hz, 6), number(m.frequency_sd, 2), number(100 * m.damping, 3), number(100 * m.damping_sd, 2)]),
      summary.modes.map((m, i) => [i + 1, m.frequency_hz, m.frequency_sd, 100 * m.damping, 100 * m.damping_sd]));
  if (summary.monitor?.alarms?.length)
    add('Alarms', ['time', 'onset from', 'to'], summary.monitor.alarms.map((a) => [String(a.time), String(a.onset?.['q2.5'] ?? '–'), String(a.onset?.['q97.5'] ?? '–')]),
      summary.monitor.alarms.map((a) => [a.time, a.onset?.['q2.5'], a.onset?.['q97.5']]));
  place.replaceChildren(
    element('h1', {}, title), element('p', {}, badge(kept?.state ?? 'done'), ` ${name}`),
    answer.length ? element('section', { class: 'answer' }, answer.map((text, i) => element('p', { class: i ? '' : 'headline' }, text))) : '',
    element('p', { class: 'actions' },
      kept?.report && element('a', { class: 'main', href: projects.reports + name.split('/').map(encodeURIComponent).join('/') + '/report.html', target: '_blank', rel: 'noopener noreferrer' }, 'Open the report'),
      own && link('case', own.name, 'Edit the case'),
      own && kept?.command === 'modal' && link('poles', own.name, 'Choose poles'),
      summary.modes?.length && button('New damage case from these modes …', () => newDamageCase(name)),
      exporting.pageButtons(title, () => [place])),
    ...(summary.diagnostics?.warnings ?? []).map((text) => element('p', { class: 'caution' }, text)), ...tables);
  return undefined;
};
