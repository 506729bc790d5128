// The data viewer: channels of a measured file, zoomed in on the server, with spectra; and the roles of the channels in
// a case.
import { ChannelPanel, columnsOf } from './channels.js';
import { ask, attempt, background, button, element, number, painted, say, svg } from './dom.js';
import { folderOf } from './modes_case.js';
import { plot } from './plot.js';
import { at, written } from './schema.js';
import { channelLists, columnOf, fileOf, resolved, sourceOf } from './sensors.js';
import { figure } from './table.js';
import { get, post } from './server.js';

const width = 900, points = 900;

export const recordView = async (place, name) => {
  const contents = await get('record', { name });
  let table = 0, begin = 0, end = 0, band = null, turn = 0, isTyped = false; // isTyped: the sampling rate was typed
  const back = [];
  const plots = element('div', { class: 'strips' }), spectra = element('div'), info = element('p', { class: 'status', role: 'status' }), channels = element('div');
  const current = () => contents.tables[table];
  const shown = new Set([0]);
  let panel = null, open = true;

  // The sampling rate of the file, or the one that was typed.
  const stated = () => { const x = Number(rate.value.replace(',', '.')); return x > 0 && Number.isFinite(x) ? x : null; };
  const rateOf = () => current().sample_rate_hz ?? stated();
  const seconds = (row) => row / (rateOf() ?? 1);
  const redraw = () => background(async () => {
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
  const draw = () => { // after an action of the user
    say('');
    return redraw();
  };

  const zoom = (from, to) => {
    const rows = current().rows;
    back.push([begin, end]);
    [begin, end] = [Math.max(0, Math.round(from)), Math.min(rows, Math.round(to))];
    if (end - begin < 8) end = Math.min(rows, begin + 8);
    if (end - begin < 8) begin = Math.max(0, end - 8);
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
    const [from, to] = (band ?? [0, 0]).map((v) => drawn.x(Math.min(v, f.at(-1))));
    if (to > from) drawn.picture.append(svg('rect', { class: 'band', x: from, width: to - from, y: drawn.top, height: drawn.bottom - drawn.top }));
    drawn.picture.append(svg('path', { class: 'trace', d: db.map(([v, l], i) => `${i ? 'L' : 'M'}${drawn.x(v).toFixed(1)} ${drawn.y(l).toFixed(1)}`).join('') }));
    dragged(drawn, (low, high) => { setBand([Number(Math.max(0, low).toPrecision(3)), Number(high.toPrecision(3))]); draw(); });
    return figure(`Spectrum of ${channel.name} in this window. Drag across the spectrum to choose the band of the modes.`, drawn.picture, `${name} spectrum of ${channel.name}`);
  };

  const lowest = element('input', { class: 'number', inputmode: 'decimal', 'aria-label': 'Lowest frequency of the band in Hz' });
  const highest = element('input', { class: 'number', inputmode: 'decimal', 'aria-label': 'Highest frequency of the band in Hz' });
  const rate = element('input', { class: 'number', inputmode: 'decimal', 'aria-label': 'Sampling rate in Hz', onchange: () => {
    isTyped = true;
    rate.toggleAttribute('aria-invalid', rate.value.trim() !== '' && !stated());
    draw();
    if (rate.hasAttribute('aria-invalid')) say(`The sampling rate must be a positive number in Hz, not ${rate.value}.`, true);
  } });
  const bands = element('label', { class: 'inline' }, 'Band ', lowest, ' to ', highest, ' Hz');
  const stating = element('label', { class: 'inline' }, 'Sampling rate ', rate, ' Hz');
  const setBand = (pair) => {
    band = [...pair];
    [lowest.value, highest.value] = band.map(String);
    for (const one of [lowest, highest]) one.removeAttribute('aria-invalid');
  };
  for (const input of [lowest, highest]) input.addEventListener('change', () => {
    const pair = [lowest, highest].map((one) => Number(one.value.replace(',', '.'))), isGiven = lowest.value.trim() !== '' && highest.value.trim() !== '';
    band = isGiven && pair[0] >= 0 && pair[1] > pair[0] ? pair : null;
    for (const one of [lowest, highest]) one.toggleAttribute('aria-invalid', isGiven && !band);
    draw();
    if (isGiven && !band) say(`The band must be two frequencies in Hz, the lower one first, not ${lowest.value} to ${highest.value}: it is not used.`, true);
  });

  // Shows the quality of the channels after the server has determined it.
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
    if (!current().sample_rate_hz && stated() && (isTyped || record.sample_rate === undefined)) record.sample_rate = stated();
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

  // The roles of the channels, in a case that uses this record or in a new case.
  const roles = element('div'), selection = element('label', { class: 'inline' }), edit = element('a', {}, 'Edit the case'), make = button('New modal case from this record …', makeCase, { class: 'main' });
  // The window counts samples of the viewed table: a case that reads other samples cannot take it.
  const requireViewed = async (one, list) => {
    const block = at(one.doc, list.path), stated = fileOf(one.doc, list), source = sourceOf(name, block);
    if (resolved(folderOf(one.name), stated) !== name)
      throw new Error(`The channels below are those of ${stated}, but the window is a window of ${file}. Select the set-up of ${file}, or open ${stated} in the data viewer.`);
    const view = current(), words = (read) => `${read.rows} samples${read.sample_rate_hz ? ` at ${number(read.sample_rate_hz, 6)} Hz` : ''}`;
    const read = (await get('record', source)).tables[0];
    const namesOf = (one) => JSON.stringify(one.channels.map((channel) => [channel.name, channel.unit, channel.number]));
    const isSame = read && read.rows === view.rows && read.sample_rate_hz === view.sample_rate_hz && namesOf(read) === namesOf(view);
    if (isSame) return;
    const keys = source.layout ? Object.keys(JSON.parse(source.layout)).map((key) => `"${key}"`).join(', ') : '';
    throw new Error(`The case reads ${read ? words(read) : 'no table'} from ${file}${keys ? ` with its keys ${keys}` : contents.tables.length > 1 ? ' (table 1)' : ''}, but the window is a window of ${words(view)}${table ? ` (table ${table + 1})` : ''}. ${
      table && !keys ? 'Select table 1 and choose the window there.' : keys ? 'State the window with the key "samples" in the case.' : 'Open the record again: the file has changed since.'}`);
  };
  const take = button('', () => attempt(async () => {
    const one = panel, list = one.list();
    await requireViewed(one, list);
    if (one === panel && list.label === one.list().label) one.edit(() => complete(one.doc, list.path));
  }));
  const cases = [];
  const choice = element('select', { 'aria-label': 'Case', onchange: () => attempt(async () => {
    const wanted = choice.selectedIndex;
    if (panel?.unsaved() && !confirm('Leave without saving the case?')) { showChoice(); return; }
    await openPanel(cases[wanted]);
  }) });
  selection.append('Case ', choice);
  // The list of cases selects the case of the panel.
  const showChoice = () => {
    choice.replaceChildren(...cases.map((each) => element('option', {}, each.name)), element('option', {}, 'A new modal case'));
    const entry = cases.findIndex((each) => each.name === panel?.name);
    choice.selectedIndex = panel && (panel.draft || entry < 0) ? cases.length : entry;
  };
  const filesOf = (caseName, doc) => channelLists(doc).filter((list) => list.kind !== 'modes').map((list) => resolved(folderOf(caseName), fileOf(doc, list)));
  const readCase = async (caseName) => {
    const opened = await get('case', { name: caseName });
    try {
      return { doc: JSON.parse(opened.text), version: opened.version };
    } catch (error) {
      throw new Error(`${caseName} is not valid JSON: ${error.message}`);
    }
  };
  const preparePanel = async (one) => {
    if (!one) {
      return new ChannelPanel({ name: `${stem}-modal.json`, draft: true, known: () => columnsOf(current()), complete,
        doc: { kind: 'modal', title: `Modes of ${file}`, record: { file, channels: current().channels.map((channel) => ({ column: columnOf(channel, current().channels), role: 'response' })) } } });
    }
    const { doc, version } = await readCase(one.name), index = filesOf(one.name, doc).indexOf(name);
    if (index < 0) throw new Error(`${one.name} has changed: it no longer names the record ${file}.`);
    const made = new ChannelPanel({ name: one.name, doc, version });
    made.listIndex = index;
    return made;
  };
  const showPanel = (next) => {
    const { doc } = next, saved = !next.draft;
    panel?.close();
    panel = next;
    make.hidden = saved;
    take.hidden = !saved || doc.kind === 'monitor';
    bands.hidden = doc.kind !== 'modal';
    take.textContent = bands.hidden ? 'Use this window in the case' : 'Use this window and band in the case';
    showChoice();
    edit.hidden = !saved;
    edit.setAttribute('href', `#/case/${encodeURIComponent(saved ? next.name : '')}`);
    roles.replaceChildren(next.node);
    const own = saved && at(doc, next.list().path);
    if (own?.sample_rate > 0 && !isTyped) rate.value = String(own.sample_rate);
    if (saved && Array.isArray(doc.band)) setBand(doc.band);
    if (saved && (Array.isArray(doc.band) || own?.sample_rate)) redraw();
  };
  // Opens a case, or the draft of a new one. If this fails, the panel and the list keep the present case.
  let openings = 0;
  const openPanel = async (one) => {
    openings += 1;
    const mine = openings, before = panel;
    let next;
    if (before) before.node.inert = true; // an edit meanwhile would be lost
    try {
      next = await preparePanel(one);
      await next.load();
      if (mine === openings && open) showPanel(next); else next.close();
    } catch (error) {
      if (next !== panel) next?.close();
      if (mine !== openings) return;
      showChoice();
      const kept = !before ? '' : before.draft ? ' The page still shows the new modal case.' : ` The page still shows ${before.name}.`;
      throw new Error(`${/[.!?]$/.test(error.message) ? error.message : `${error.message}.`}${kept}`);
    } finally {
      if (before && mine === openings) before.node.inert = false;
    }
  };
  const findCases = async () => {
    const { cases: all } = await get('projects');
    for (const one of all.filter((each) => ['modal', 'sid', 'monitor'].includes(each.kind)).slice(0, 100)) {
      const found = await readCase(one.name).catch(() => null);
      if (found && filesOf(one.name, found.doc).includes(name)) cases.push({ name: one.name });
    }
  };

  const tables = contents.tables.length > 1 ? element('label', { class: 'inline' }, 'Table ', element('select', { onchange: (event) => {
    if (panel?.draft && panel.unsaved() && !confirm('Discard the roles and positions of the new modal case?')) { event.target.selectedIndex = table; return; }
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
    element('p', { class: 'quiet' }, [`${contents.format}, ${first.rows} samples`, first.sample_rate_hz ? `${number(first.sample_rate_hz, 6)} Hz` : 'The file does not state its sampling rate', ...first.reading, first.fault].filter(Boolean).map((text) => text.replace(/\.$/, '')).join('. '), '.'),
    element('div', { class: 'buttons' }, button('Whole record', () => { back.push([begin, end]); [begin, end] = [0, 0]; draw(); }),
      button('Zoom in', () => { const wide = (end || current().rows) - begin; zoom(begin + wide / 4, begin + 3 * wide / 4); }),
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
  if (!panel && open) await background(() => openPanel());
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
