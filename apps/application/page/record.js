// The data viewer: channels of a measured file, zoomed in on the server, with spectra; and what becomes of the channels in
// a modal case.
import { ChannelPanel, columnsOf } from './channels.js';
import { ask, attempt, background, button, element, number, painted, svg } from './dom.js';
import { folderOf } from './modes_case.js';
import { plot } from './plot.js';
import { written } from './schema.js';
import { channelLists, columnOf, resolved } from './sensors.js';
import { figure } from './table.js';
import { get, post } from './server.js';

const width = 900, points = 900;

export const recordView = async (place, name) => {
  const contents = await get('record', { name });
  let table = 0, begin = 0, end = 0, band = null, turn = 0;
  const back = [];
  const plots = element('div', { class: 'strips' }), spectra = element('div'), info = element('p', { class: 'status', role: 'status' }), channels = element('div');
  const current = () => contents.tables[table];
  const shown = new Set([0]);
  let panel = null, open = true;

  // The sampling rate of the file, or the one that was typed.
  const stated = () => { const x = Number(rate.value.replace(',', '.')); return x > 0 && Number.isFinite(x) ? x : null; };
  const rateOf = () => current().sample_rate_hz ?? stated();
  const seconds = (row) => row / (rateOf() ?? 1);
  const draw = () => attempt(async () => {
    turn += 1;
    const mine = turn, list = [...shown].sort((a, b) => a - b);
    if (!list.length) { plots.replaceChildren(); spectra.replaceChildren(); return; }
    const window = await get('window', { name, table, begin, end, channels: list.join(','), points });
    if (mine !== turn) return;
    info.textContent = `Samples ${window.begin} to ${window.end} of ${current().rows}${window.exact ? ', each drawn' : `, extremes of ${window.step} samples each`}. Drag across a plot to zoom in.`;
    plots.replaceChildren(...list.map((c, k) => strip(current().channels[c], window, window.channels[k])));
    const spectrum = await get('spectrum', { name, table, begin, end, channels: list[0], ...(rateOf() ? { rate: rateOf() } : {}) });
    if (mine === turn) spectra.replaceChildren(spectrumPlot(current().channels[list[0]], spectrum));
  });

  const zoom = (from, to) => {
    const rows = current().rows;
    back.push([begin, end]);
    [begin, end] = [Math.max(0, Math.round(from)), Math.min(rows, Math.round(to))];
    if (end - begin < 8) end = Math.min(rows, begin + 8);
    draw();
  };

  // Selects an interval of the horizontal axis by dragging.
  const dragged = (drawn, use) => {
    let from = null, frame;
    drawn.picture.addEventListener('pointerdown', (event) => { from = drawn.inside(event); drawn.picture.setPointerCapture(event.pointerId); });
    drawn.picture.addEventListener('pointermove', (event) => {
      if (!from) return;
      const now = drawn.inside(event);
      if (!frame) drawn.picture.append(frame = svg('rect', { class: 'box', y: drawn.top, height: drawn.bottom - drawn.top }));
      frame.setAttribute('x', Math.min(from.px, now.px));
      frame.setAttribute('width', Math.abs(now.px - from.px));
    });
    drawn.picture.addEventListener('pointerup', (event) => {
      const to = drawn.inside(event), wide = from && Math.abs(to.px - from.px) > 5;
      frame?.remove();
      frame = undefined;
      if (wide) use(Math.min(from.x, to.x), Math.max(from.x, to.x));
      from = null;
    });
  };

  const strip = (channel, window, { low, high }) => {
    const tops = (high ?? low).filter((v) => v !== null), bottoms = low.filter((v) => v !== null);
    const ys = tops.length ? [Math.min(...bottoms), Math.max(...tops)] : [0, 1];
    if (ys[0] === ys[1]) ys[1] = ys[0] + (Math.abs(ys[0]) || 1);
    const xs = [seconds(window.begin), seconds(window.end)];
    const drawn = plot({ width, height: 190, xs, ys, xLabel: rateOf() ? 'time [s]' : 'sample', yLabel: channel.unit || 'value', label: `${channel.name} over time` });
    const at = (i) => drawn.x(seconds(window.begin + (i + (high ? 0.5 : 0)) * window.step)).toFixed(1);
    let d = '', pen = 'M';
    low.forEach((v, i) => {
      if (v === null) { pen = 'M'; return; }
      d += `${pen}${at(i)} ${drawn.y(v).toFixed(1)}`;
      if (high) d += `L${at(i)} ${drawn.y(high[i]).toFixed(1)}`;
      pen = 'L';
    });
    drawn.picture.append(svg('path', { class: 'trace', d }));
    dragged(drawn, (from, to) => zoom(from * (rateOf() ?? 1), to * (rateOf() ?? 1)));
    return figure(channel.name, drawn.picture, `${name} ${channel.name}`);
  };

  const spectrumPlot = (channel, { frequencies_hz: f, density }) => {
    const good = f.map((v, i) => [v, density[i]]).filter(([v, s]) => v > 0 && s > 0);
    if (good.length < 2) return element('p', { class: 'quiet' }, rateOf() ? 'No spectrum: values are missing in this window.' : 'No spectrum: the file does not state its sampling rate. Type the sampling rate above.');
    const db = good.map(([v, s]) => [v, 10 * Math.log10(s)]);
    const drawn = plot({ width, height: 240, xs: [0, f.at(-1)], ys: [Math.min(...db.map((p) => p[1])), Math.max(...db.map((p) => p[1]))], xLabel: 'frequency [Hz]', yLabel: 'density [dB]', label: `Spectrum of ${channel.name}` });
    if (band) drawn.picture.append(svg('rect', { class: 'band', x: drawn.x(band[0]), width: drawn.x(band[1]) - drawn.x(band[0]), y: drawn.top, height: drawn.bottom - drawn.top }));
    drawn.picture.append(svg('path', { class: 'trace', d: db.map(([v, l], i) => `${i ? 'L' : 'M'}${drawn.x(v).toFixed(1)} ${drawn.y(l).toFixed(1)}`).join('') }));
    dragged(drawn, (from, to) => setBand([Number(Math.max(0, from).toPrecision(3)), Number(to.toPrecision(3))]));
    return figure(`Spectrum of ${channel.name} in this window. Drag across the spectrum to choose the band of the modes.`, drawn.picture, `${name} spectrum of ${channel.name}`);
  };

  const lowest = element('input', { class: 'number', inputmode: 'decimal', 'aria-label': 'Lowest frequency of the band in Hz' });
  const highest = element('input', { class: 'number', inputmode: 'decimal', 'aria-label': 'Highest frequency of the band in Hz' });
  const rate = element('input', { class: 'number', inputmode: 'decimal', 'aria-label': 'Sampling rate in Hz', onchange: () => draw() });
  const bands = element('label', { class: 'inline' }, 'Band ', lowest, ' to ', highest, ' Hz');
  const stating = element('label', { class: 'inline' }, 'Sampling rate ', rate, ' Hz');
  const setBand = (pair) => {
    band = [...pair];
    [lowest.value, highest.value] = band.map(String);
    draw();
  };
  for (const input of [lowest, highest]) input.addEventListener('change', () => {
    const pair = [lowest, highest].map((one) => Number(one.value.replace(',', '.')));
    band = pair[0] >= 0 && pair[1] > pair[0] ? pair : null;
    draw();
  });

  // The quality of the channels, when it is known.
  const showChecks = () => current().channels.forEach((channel, c) => {
    if (!channel.faults) return;
    const row = channels.querySelectorAll('tbody tr')[c];
    row.classList.toggle('faulty', channel.faults.length > 0);
    row.querySelector('.rms').textContent = number(channel.rms, 3);
    row.querySelector('.long').textContent = channel.faults.join('; ');
  });
  const listChannels = () => {
    stating.hidden = Boolean(current().sample_rate_hz);
    channels.replaceChildren(element('div', { class: 'scroll' }, element('table', {}, element('caption', {}, 'Channels'),
      element('thead', {}, element('tr', {}, ['show', 'channel', 'unit', 'rms', 'faults'].map((head) => element('th', { scope: 'col' }, head)))),
      element('tbody', {}, current().channels.map((channel, c) => {
        return element('tr', {},
          element('td', {}, element('input', { type: 'checkbox', 'aria-label': `Show ${channel.name}`, checked: shown.has(c), onchange: (event) => { if (event.target.checked) shown.add(c); else shown.delete(c); draw(); } })),
          element('th', { scope: 'row' }, channel.name), element('td', {}, channel.unit), element('td', { class: 'rms' }, '…'),
          element('td', { class: 'long' }, 'checking …'));
      })))));
    showChecks();
  };

  // The window, band and sampling rate of the view, as keys of a case.
  const file = name.slice(name.lastIndexOf('/') + 1), stem = name.replace(/\.[^./]*$/, '');
  const complete = (doc, path = ['record']) => {
    const record = path.reduce((node, key) => node[key], doc);
    if (begin > 0 || (end > 0 && end < current().rows)) record.samples = [begin, end || current().rows];
    else delete record.samples;
    if (!current().sample_rate_hz && stated()) record.sample_rate = stated();
    if (band && doc.kind === 'modal') doc.band = [...band];
    return doc;
  };
  const makeCase = () => attempt(async () => {
    const control = element('input', { value: `${stem}-modal.json`, required: true, spellcheck: 'false' });
    const given = await ask('New modal case', [{ label: 'Name of the case, in the folder of the record', control }], 'Create');
    if (!given) return;
    const source = panel, drafted = written(panel.doc);
    const { record, ...rest } = complete(structuredClone(panel.doc));
    const { samples, sample_rate, channels: list, ...named } = record;
    const made = { ...rest, record: { ...named, ...(samples ? { samples } : {}), ...(sample_rate ? { sample_rate } : {}), channels: list } };
    await post('save', { name: given[0].trim(), text: `${written(made)}\n`, before: null });
    source.saved = drafted;
    location.hash = `#/case/${encodeURIComponent(given[0].trim())}`;
  });

  // What becomes of the channels: in a case that uses this record, or in a new one.
  const roles = element('div'), selection = element('label', { class: 'inline' }), edit = element('a', {}, 'Edit the case'), make = button('New modal case from this record …', makeCase, { class: 'main' });
  const take = button('', () => panel.edit(() => complete(panel.doc, panel.list().path)));
  const cases = [];
  const showPanel = async (one) => {
    panel?.close();
    // A saved case refers to the first table of its file; a draft takes the viewed table.
    const known = (list) => (list.path.length === 1 || one.files?.[list.path[1]] === name ? columnsOf(one.doc ? contents.tables[0] : current()) : undefined);
    panel = one.doc ? new ChannelPanel({ name: one.name, doc: one.doc, version: one.version, known: one.files.length === 1 ? known : undefined })
      : new ChannelPanel({ name: `${stem}-modal.json`, draft: true, known, complete,
        doc: { kind: 'modal', title: `Modes of ${file}`, record: { file, channels: current().channels.map((channel) => ({ column: columnOf(channel, current().channels), role: 'response' })) } } });
    make.hidden = Boolean(one.doc);
    take.hidden = !one.doc;
    bands.hidden = panel.doc.kind !== 'modal';
    take.textContent = bands.hidden ? 'Use this window in the case' : 'Use this window and band in the case';
    if (one.doc) panel.listIndex = Math.max(0, one.files.indexOf(name));
    const choice = element('select', { 'aria-label': 'Case', onchange: () => {
      const entry = cases.findIndex((each) => each.name === one.name);
      if (panel.unsaved() && !confirm('Leave without saving the case?')) { choice.selectedIndex = entry >= 0 ? entry : cases.length; return; }
      attempt(() => openPanel(cases[choice.selectedIndex]));
    } }, cases.map((each) => element('option', { selected: each.name === one.name }, each.name)), element('option', { selected: !one.doc }, 'A new modal case'));
    selection.replaceChildren('Case ', choice);
    edit.hidden = !one.doc;
    edit.setAttribute('href', `#/case/${encodeURIComponent(one.name ?? '')}`);
    roles.replaceChildren(panel.node);
    const own = one.doc && panel.list().path.reduce((node, key) => node[key], one.doc);
    if (own?.sample_rate > 0 && !rate.value) rate.value = String(own.sample_rate);
    if (Array.isArray(one.doc?.band)) setBand(one.doc.band);
    else if (own?.sample_rate) draw();
    await panel.load();
  };
  const openPanel = async (one) => {
    if (!one) return showPanel({});
    const opened = await get('case', { name: one.name });
    return showPanel({ ...one, doc: JSON.parse(opened.text), version: opened.version });
  };
  const findCases = async () => {
    const { cases: all } = await get('projects');
    for (const one of all.filter((each) => ['modal', 'sid'].includes(each.kind)).slice(0, 100)) {
      const doc = await get('case', { name: one.name }).then((opened) => JSON.parse(opened.text)).catch(() => null);
      const files = channelLists(doc).map((list) => resolved(folderOf(one.name), list.path.reduce((node, key) => node?.[key], doc)?.file ?? ''));
      if (files.includes(name)) cases.push({ name: one.name, files });
    }
  };

  const tables = contents.tables.length > 1 ? element('label', { class: 'inline' }, 'Table ', element('select', { onchange: (event) => {
    if (panel?.draft && panel.unsaved() && !confirm('Discard the roles and places of the new modal case?')) { event.target.selectedIndex = table; return; }
    table = event.target.selectedIndex;
    [begin, end] = [0, 0];
    shown.clear();
    shown.add(0);
    listChannels();
    draw();
    if (panel?.draft) attempt(() => openPanel());
  } }, contents.tables.map((one, i) => element('option', {}, `${i + 1}: ${one.rows} rows`)))) : null;
  if (!contents.tables.length) {
    place.replaceChildren(element('h1', {}, name), element('p', {}, `This file (${contents.format}) holds no table of numbers. ${contents.others.join(' ')}`));
    return undefined;
  }
  const first = current();
  place.replaceChildren(element('h1', {}, name),
    element('p', { class: 'quiet' }, [`${contents.format}, ${first.rows} samples`, first.sample_rate_hz ? `${number(first.sample_rate_hz, 6)} Hz` : 'The file does not state its sampling rate', ...first.reading, first.fault].filter(Boolean).join('. ')),
    element('div', { class: 'buttons' }, button('Whole record', () => { back.push([begin, end]); [begin, end] = [0, 0]; draw(); }),
      button('Zoom out', () => { const wide = (end || current().rows) - begin; zoom(begin - wide / 2, (end || current().rows) + wide / 2); }),
      button('Earlier', () => { const wide = (end || current().rows) - begin; zoom(Math.max(0, begin - wide / 2), Math.max(0, begin - wide / 2) + wide); }),
      button('Later', () => { const wide = (end || current().rows) - begin, from = Math.min(current().rows - wide, begin + wide / 2); zoom(from, from + wide); }),
      button('Back', () => { if (back.length) { [begin, end] = back.pop(); draw(); } }), tables, stating),
    info, plots, spectra,
    element('h2', {}, 'Channels'), channels,
    element('h2', {}, 'Roles of the channels in a case'),
    element('p', { class: 'buttons' }, selection, bands, take, edit),
    roles, element('p', { class: 'buttons' }, make));
  listChannels();
  await draw();
  await background(findCases);
  await background(() => openPanel(cases[0]));
  // The quality of all channels can take longer than reading and drawing, and uses all cores: the browser draws first.
  background(async () => {
    await painted();
    const { tables: checks } = await get('checks', { name });
    contents.tables.forEach((one, i) => one.channels.forEach((channel, c) => Object.assign(channel, checks[i][c])));
    if (open) showChecks();
  });
  const close = () => {
    open = false;
    panel?.close();
  };
  close.unsaved = () => panel?.unsaved() ?? false;
  return close;
};
