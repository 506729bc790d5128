// The columns of a monitor case's table: role, range, missing values and a small plot of each column.
import { element, number, svg } from './dom.js';
import { plot } from './plot.js';
import { get } from './server.js';

export const seriesRoles = { feature: 'feature', covariate: 'covariate', time: 'time', ignore: 'ignored' };
const points = 240; // intervals of a plot
const atOnce = 100; // channels of a request
const modesOf = (doc) => doc.explanation?.modes;
const hasStructure = (doc) => Boolean(doc.beam || doc.structure);
const listOf = (value) => (Array.isArray(value) ? value : []);
const bare = (text) => String(text).replace(/\s*(\[[^\]]*\]|\([^)]*\))$/, '');

// All columns of a table in the order of the file. `columnOf(column, all)` is the name of a column in a case. `plotted`
// is the index of the column among the channels that the server draws.
export const seriesColumns = (table, columnOf) => {
  if (!table) return [];
  const all = [...table.channels.map((channel, i) => ({ ...channel, plotted: i })),
    ...(table.left_out ?? []).map((column) => ({ ...column, unit: '', isNumeric: false, isDate: column.is_time_stamp }))];
  if (table.time_column) {
    const taken = new Set(all.map((column) => column.number)), dated = Boolean(table.times?.start) && !(table.left_out ?? []).some((column) => column.is_time_stamp);
    const free = Array.from({ length: all.length + 1 }, (ignored, i) => i + 1).find((n) => !taken.has(n));
    all.push({ name: table.time_column, unit: dated ? '' : table.times?.unit ?? '', number: taken.has(0) ? 0 : free, isNumeric: false, isAbscissa: true, isDate: dated, isUniform: Boolean(table.sample_rate_hz), rows: table.rows, times: table.times });
  }
  all.sort((a, b) => a.number - b.number);
  for (const column of all) {
    column.isNumeric ??= true;
    column.label = all.filter((one) => one.name === column.name).length > 1 ? `${column.name} (column ${column.number})` : column.name;
    column.text = columnOf(column, all);
  }
  return all;
};

// The column that a text or number of a case names.
const columnNamed = (known, wanted) => {
  const text = String(wanted ?? '');
  return known.find((one) => [`${one.name} [${one.unit}]`, `${one.name} (${one.unit})`].includes(text)) ?? known.find((one) => one.name === text)
    ?? known.find((one) => String(one.number) === text) ?? known.find((one) => one.unit && one.name === bare(text));
};

// A row for each column of the table, then for each name of the case that is not a column of the table.
export const seriesRows = (doc, list, known) => {
  const series = doc.series ?? {}, named = [];
  const add = (role, names, key) => listOf(names).forEach((text, index) => { if (text !== '') named.push({ role, index, text, pointer: `/series/${key}/${index}` }); });
  if (list.key === 'file') add('feature', series.features, 'features');
  add('covariate', series.covariates, 'covariates');
  add('sd', series.sd, 'sd');
  const time = series.time ?? (list.key === 'times' ? 'time' : undefined);
  if (time !== undefined) named.push({ role: 'time', index: 0, text: time, pointer: '/series/time' });
  for (const one of named) one.column = columnNamed(known, one.text);
  const row = (one, column, i) => ({ i, column, channel: {}, role: one?.role ?? (list.key === 'times' && column.name === 'file' ? 'file' : 'ignore'), index: one?.index, text: one?.text,
    name: column?.label ?? (String(one.text) || '(no name)'), unit: column?.unit ?? '', pointer: one?.pointer ?? '' });
  return [...known.flatMap((column, i) => {
    const own = named.filter((one) => one.column === column);
    if (own.length) column.text = own[0].text; // the case keeps its name of the column
    return own.length ? own.map((one) => row(one, column, i)) : [row(null, column, i)];
  }), ...named.filter((one) => !one.column).map((one) => row(one, undefined, `${one.role} ${one.text}`))];
};

// The index of a column in a list of the case that has the order of the file.
const placeIn = (list, column, known) => {
  const order = (text) => { const found = known.indexOf(columnNamed(known, text)); return found < 0 ? -1 : found; };
  const after = list.findIndex((text) => order(text) > known.indexOf(column));
  return after < 0 ? list.length : after;
};

// The lists that have one entry for each feature follow a change of the features.
const followFeatures = (doc, change) => {
  const { series } = doc, count = listOf(series.features).length;
  if (hasStructure(doc) && !Array.isArray(modesOf(doc))) {
    doc.explanation = { ...doc.explanation, modes: Array.from({ length: count }, (ignored, i) => i + 1) };
  }
  change();
  const modes = modesOf(doc);
  if (Array.isArray(modes) && modes.every((mode, i) => mode === i + 1)) {
    delete doc.explanation.modes;
    if (!Object.keys(doc.explanation).length) delete doc.explanation;
  }
  if (Array.isArray(series.sd) && series.sd.every((text) => text === '')) delete series.sd;
};

const release = (doc, row) => {
  const { series } = doc;
  if (row.role === 'time') delete series.time;
  if (row.role === 'covariate') series.covariates.splice(row.index, 1);
  if (row.role === 'sd') {
    series.sd[row.index] = '';
    if (series.sd.every((text) => text === '')) delete series.sd;
  }
  if (row.role === 'feature') {
    followFeatures(doc, () => {
      series.features.splice(row.index, 1);
      if (Array.isArray(series.sd)) series.sd.splice(row.index, 1);
      if (Array.isArray(modesOf(doc))) doc.explanation.modes.splice(row.index, 1);
    });
  }
  for (const key of ['features', 'covariates']) if (Array.isArray(series[key]) && !series[key].length) delete series[key];
};

// Gives a column another role.
export const setSeriesRole = (doc, row, role, known) => {
  if (role === row.role) return;
  const text = row.text ?? row.column.text;
  release(doc, row);
  const { series } = doc;
  const insert = (key) => {
    if (!Array.isArray(series[key])) series[key] = [];
    const place = row.column ? placeIn(series[key], row.column, known) : series[key].length;
    series[key].splice(place, 0, text);
    return place;
  };
  if (role === 'covariate') insert('covariates');
  if (role === 'feature') {
    followFeatures(doc, () => {
      const place = insert('features'), modes = modesOf(doc);
      if (Array.isArray(series.sd)) series.sd.splice(place, 0, '');
      if (!Array.isArray(modes)) return;
      let next = place ? Number(modes[place - 1]) + 1 : 1;
      while (modes.includes(next)) next += 1;
      modes.splice(place, 0, next);
    });
  }
  if (role === 'time') {
    series.time = text;
    if (row.column?.isDate) delete series.time_unit;
  }
};

// Names the column of standard deviations of a feature; null for none.
export const setDeviation = (doc, row, text) => {
  const { series } = doc, count = listOf(series.features).length;
  const sd = Array.from({ length: count }, (ignored, i) => series.sd?.[i] ?? '');
  sd[row.index] = text ?? '';
  if (sd.every((one) => one === '')) delete series.sd;
  else series.sd = sd;
};

export const setMode = (doc, row, text) => {
  const x = Number(text), count = listOf(doc.series.features).length;
  const modes = Array.from({ length: count }, (ignored, i) => modesOf(doc)?.[i] ?? i + 1);
  modes[row.index] = text.trim() !== '' && Number.isInteger(x) ? x : text;
  doc.explanation = { ...doc.explanation, modes };
};

export const modeOf = (doc, row) => modesOf(doc)?.[row.index] ?? row.index + 1;
export { hasStructure };

// Reads extremes, range and fraction of missing values of the columns, and calls `shown()` after each answer.
export const readViews = async (source, known, shown) => {
  const plotted = known.filter((column) => column.plotted !== undefined);
  for (let from = 0; from < plotted.length; from += atOnce) {
    const some = plotted.slice(from, from + atOnce);
    const window = await get('window', { ...source, points, channels: some.map((column) => column.plotted).join(',') });
    some.forEach((column, k) => { column.view = { ...window.channels[k], step: window.step, end: window.end }; });
    shown();
  }
  const { tables } = await get('checks', source);
  for (const column of plotted) Object.assign(column, tables[0]?.[column.plotted]);
  shown();
};

export const missingOf = (column) => {
  if (!column || column.plotted === undefined) return '';
  if (column.missing === undefined) return '…';
  return column.missing === 0 ? '0 %' : column.missing < 0.001 ? '< 0.1 %' : `${number(100 * column.missing, 3)} %`;
};

export const rangeOf = (column) => {
  if (!column) return 'not a column of the table';
  const { times } = column;
  if (column.isAbscissa && times) return column.isDate ? `dates from ${times.start}` : `${number(times.from, 6)} to ${number(times.to, 6)}`;
  if (!column.isNumeric) return column.isDate ? 'dates' : 'no numbers';
  if (column.missing === undefined) return '…';
  return column.missing === 1 ? 'no values' : column.lowest === column.highest ? `constant at ${number(column.lowest)}` : `${number(column.lowest)} to ${number(column.highest)}`;
};

const limits = ({ low, high }) => {
  const values = [...low, ...(high ?? [])].filter((v) => v !== null);
  if (!values.length) return null;
  const [least, most] = [Math.min(...values), Math.max(...values)];
  return least === most ? [least - (Math.abs(least) || 1) / 2, most + (Math.abs(most) || 1) / 2] : [least, most];
};

// The line through the extremes of each interval, interrupted at missing values.
const line = ({ low, high }, x, y) => {
  let d = '', pen = 'M';
  low.forEach((v, i) => {
    if (v === null) { pen = 'M'; return; }
    const alone = pen === 'M' && !high && (low[i + 1] ?? null) === null;
    d += `${pen}${x(i).toFixed(1)} ${y(v).toFixed(1)}${high ? `L${x(i).toFixed(1)} ${y(high[i]).toFixed(1)}` : alone ? 'h0.5' : ''}`;
    pen = 'L';
  });
  return d;
};

export const smallPlot = (column) => {
  if (!column?.view) return null;
  const ys = limits(column.view), [width, height] = [150, 28];
  if (!ys) return null;
  const last = Math.max(1, column.view.low.length - 1);
  return svg('svg', { class: 'small', viewBox: `0 0 ${width} ${height}`, 'aria-hidden': 'true' },
    svg('path', { class: 'trace', d: line(column.view, (i) => 1 + (width - 2) * i / last, (v) => height - 2 - (height - 4) * (v - ys[0]) / (ys[1] - ys[0])) }));
};

// A placeholder of the size of a plot, so that the list does not move under a click.
export const noPlot = (column) => element('p', { class: 'empty noplot' }, column?.plotted !== undefined && !column.view ? 'Reading …' : 'There is no plot of this column.');

// The selected column over time, or over the rows if the times are not a column of numbers. The end of the training
// period is a line.
export const largePlot = (doc, list, known, column) => {
  if (!column?.view) return null;
  const ys = limits(column.view);
  if (!ys) return null;
  const { view } = column, time = columnNamed(known, doc.series?.time), axis = time !== column && time?.view?.low.length === view.low.length && !time.view.low.includes(null) ? time.view : null;
  const unit = { s: 's', min: 'min', d: 'd', row: '' }[doc.series?.time_unit] ?? 'h';
  const isEven = time?.isUniform && !time.isDate && time.rows > 1, row = (i) => Math.min(view.end - 1, i * view.step), last = view.low.length - 1;
  const evenTime = (k) => time.times.from + (time.times.to - time.times.from) * k / (time.rows - 1);
  const at = (i) => (axis ? axis.low[i] : isEven ? evenTime(row(i)) : row(i) + 1);
  const xs = [at(0), axis ? (axis.high ?? axis.low)[last] : isEven ? evenTime(view.end - 1) : view.end];
  if (!(xs[1] > xs[0])) return null;
  const drawn = plot({ width: 560, height: 230, xs, ys, left: 64, xLabel: axis || isEven ? `${time.name}${unit ? ` [${unit}]` : ''}` : 'row', yLabel: column.unit || 'value', label: `${column.label} over ${axis || isEven ? time.name : 'the rows'}` });
  drawn.picture.append(svg('path', { class: 'trace', d: line(view, (i) => drawn.x(at(i)), drawn.y) }));
  const until = doc.learning?.until;
  if ((axis || isEven) && typeof until === 'number' && until > xs[0] && until < xs[1])
    drawn.picture.append(svg('line', { class: 'stage', x1: drawn.x(until), x2: drawn.x(until), y1: drawn.top, y2: drawn.bottom }, svg('title', {}, `end of the training period, ${until}`)),
      svg('text', { x: drawn.x(until) + 4, y: drawn.top + 10 }, 'end of training'));
  return drawn.picture;
};
