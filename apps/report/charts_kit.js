// Shared parts of all charts: themes, formats of numbers, frames, scales and axes.
const kit = (() => {
  // Okabe & Ito's colours, which colour-blind readers can distinguish.
  const themes = {
    light: {
      ink: '#17212b', soft: '#56636f', grid: '#e4e8ec', paper: '#ffffff', main: '#0072b2', other: '#d55e00',
      series: ['#0072b2', '#d55e00', '#009e73', '#cc79a7', '#e69f00', '#56b4e9', '#7a6a00', '#000000'],
      heat: ['#dbe9f5', '#08306b'], diverging: ['#b2182b', '#d0d0d0', '#2166ac'],
    },
    dark: {
      ink: '#e6ecf1', soft: '#a3b1bd', grid: '#2a3540', paper: '#11181f', main: '#56b4e9', other: '#ff9b52',
      series: ['#56b4e9', '#ff9b52', '#2fc79a', '#e79ac4', '#f0e442', '#0a86cf', '#c9b458', '#ffffff'],
      heat: ['#17364c', '#c8ecff'], diverging: ['#ff8a76', '#4a545e', '#6cbcf5'],
    },
  };

  // The same style in all charts: plain notation from 1e-4 to a million, "5.37e-6" outside this range.
  const number = (x, digits = 4) => {
    if (typeof x !== 'number' || !isFinite(x)) return '–';
    const rounded = +x.toPrecision(digits), size = Math.abs(rounded);
    return size === 0 || (size >= 1e-4 && size < 1e6) ? String(rounded) : rounded.toExponential().replace('e+', 'e');
  };
  const percent = (p) => (p > 0.999 ? '> 99.9 %' : p >= 0 && p < 0.001 ? '< 0.1 %' : `${+(100 * p).toPrecision(3)} %`);
  // "P = 75 %", "P > 99.9 %".
  const probability = (p) => 'P ' + (/^[<>]/.test(percent(p)) ? '' : '= ') + percent(p);
  // Never "0": "< 1e-15".
  const pValue = (p) => (typeof p !== 'number' ? '–' : p < 1e-15 ? '< 1e-15' : number(p, 2));
  // R² below 1 must not appear as 1: as many digits as distinguish it from 1, at most nine.
  const r2 = (x) => {
    if (typeof x !== 'number' || !isFinite(x)) return '–';
    for (let digits = 4; digits <= 9; ++digits) if (x === 1 || +x.toFixed(digits) < 1) return String(+x.toFixed(digits));
    return '> 0.999999999';
  };
  const slug = (text) => text.toLowerCase().replace(/[^a-z0-9]+/g, '-').replace(/^-|-$/g, '').slice(0, 60) || 'figure';
  // "m²" for "m^2"; nothing for "1".
  const written = (unit) => (unit && unit !== '1' ? unit.replace(/\^2/g, '²').replace(/\^3/g, '³') : '');
  const bracketed = (unit) => (written(unit) ? ` [${written(unit)}]` : '');
  const unit = (name, known) => (/(^|\s)location(\[|$)/.test(name) ? ' [m]' : bracketed(known));
  // The units of force and length of a chain's coefficients; {} if they are not known.
  const unitSystem = (run) => run.summary.data?.units || (run.summary.data?.units === null ? {} : { force: 'N', length: 'm' });
  const short = (text, n) => ([...text].length > n ? [...text].slice(0, n - 1).join('') + '…' : text);
  // Returns true for labels of parameters that are fractions, shown in percent: the severities of kinds with `share`.
  // If there are several kinds, the label begins with the name of the kind.
  const shares = (run) => {
    const kinds = run.summary.kinds || [];
    const names = kinds.filter((k) => k.share ?? k.severity === 'reduction').map((k) => (kinds.length > 1 ? k.name + ' ' : '') + k.severity);
    return (label) => names.some((name) => label === name || (label.startsWith(name + '[') && label.endsWith(']')));
  };

  function frame(width, height, theme, body) {
    return {
      width, height, background: null, padding: 2,
      autosize: { type: 'fit-x', contains: 'padding', resize: false },
      config: {
        font: 'system-ui, "Segoe UI", "Noto Sans", sans-serif',
        axis: {
          labelColor: theme.soft, titleColor: theme.soft, titleFontWeight: 400, domainColor: theme.soft,
          tickColor: theme.soft, gridColor: theme.grid, labelFontSize: 11, titleFontSize: 12, labelOverlap: true, labelSeparation: 5,
          titlePadding: 6, tickSize: 4, labelFlush: true,
        },
        legend: { labelColor: theme.soft, titleColor: theme.soft, labelFontSize: 11, titleFontSize: 11, titleFontWeight: 400,
          orient: 'top', direction: 'horizontal', labelLimit: width - 40 },
        text: { fill: theme.ink, fontSize: 11 },
      },
      ...body,
    };
  }
  const linear = (name, domain, range, more) => ({ name, type: 'linear', domain, range, zero: false, nice: false, ...more });
  // The decades of the measured values, at most `most`: predictions without noise can be far smaller.
  const decades = (measured, all, most) => {
    const top = Math.max(...all), low = measured.length ? Math.min(...measured) : Math.min(...all);
    return [Math.max(low / 4, top * 10 ** -most), top * 2];
  };
  // Ticks of a logarithmic axis: about five powers of ten within the values. If there are fewer than two, 1, 2 and 5
  // times the powers of ten.
  const powersOfTen = (values) => {
    const low = Math.min(...values), high = Math.max(...values), within = (v) => v >= low * 0.999 && v <= high * 1.001;
    const [a, b] = [low, high].map((v) => Math.floor(Math.log10(v)));
    const powers = Array.from({ length: b - a + 1 }, (_, i) => a + i);
    const whole = powers.map((p) => +`1e${p}`).filter(within), step = Math.max(1, Math.ceil(whole.length / 5));
    if (whole.length > 1) return whole.filter((_, i) => i % step === 0);
    const finer = powers.flatMap((p) => [1, 2, 5].map((n) => +`${n}e${p}`)).filter(within);
    return finer.length > 1 ? finer : [low, high].map((v) => +v.toPrecision(2));
  };
  // A legend with complete names, in as many columns as the width allows.
  const legend = (width, names, more) => {
    const longest = 6.2 * Math.max(...names.map((n) => [...String(n)].length)) + 26;
    return { columns: Math.max(1, Math.min(names.length, Math.floor(width / longest))), ...more };
  };
  const strokes = (width, names, scale = 'who') => legend(width, names, { stroke: scale, symbolType: 'stroke', symbolStrokeWidth: 3 });
  const circles = (width, names, scale) => legend(width, names, { fill: scale, symbolType: 'circle' });
  // Ticks in the style of `number`, "10000" and not "10,000", with only as many digits as distinguish the ticks.
  const plainFormat = '.12~g';
  const tickFormat = (low, high) => {
    const size = Math.max(Math.abs(low), Math.abs(high));
    if (!(size > 0) || (size >= 1e-3 && size < 1e6)) return plainFormat;
    return '.12~e';
  };
  // Many dots as one path: zero-length strokes with round ends, between undefined points.
  const dots = (values) => values.flatMap((v) => [{ ...v, ok: true }, { ok: false }]);
  const dotMark = (data, x, y, color, size, opacity = 0.6) => ({ type: 'line', clip: true, from: { data }, encode: { enter: { x: { scale: 'x', field: x }, y: { scale: 'y', field: y },
    defined: { field: 'ok' }, stroke: { value: color }, strokeWidth: { value: size }, strokeCap: { value: 'round' }, strokeOpacity: { value: opacity } } } });
  // Frequency axis: logarithmic if the spectrum is mostly in the lowest tenth of the axis.
  const frequencyScale = (rows, weight) => {
    const last = rows[rows.length - 1][0];
    const total = rows.reduce((sum, r) => sum + weight(r), 0);
    const low = rows.filter((r) => r[0] < 0.1 * last).reduce((sum, r) => sum + weight(r), 0);
    if (rows.length > 40 && low > 0.98 * total) return { name: 'x', type: 'log', domain: [rows[0][0], last], range: 'width' };
    return linear('x', [rows[0][0] < 0.2 * last ? 0 : rows[0][0], last], 'width');
  };
  const frequencyAxis = (scale) => axisX('frequency [Hz]', scale.type === 'log' ? { format: '~r', tickCount: 5, labelOverlap: 'greedy' } : {});
  // The same for powers of ten: "0.1", "1", "10", or "1e-6".
  const powerFormat = (values) => (Math.min(...values) >= 1e-3 && Math.max(...values) < 1e5 ? '~r' : '.0e');
  // Converts "1e-06" in a sentence to the style of `number`.
  // Numbers with more than eight digits are computed, not typed: they are shown with five digits.
  const restyled = (text) => text.replace(/\d+\.\d+/g, (x) => (x.replace(/^0\.0*|\./g, '').length > 8 ? String(Number(Number(x).toPrecision(5))) : x))
    .replace(/e([+-])0*(\d+)/g, (_, sign, power) => 'e' + (sign === '-' ? '-' : '') + power);
  // Exponents as `number` writes them, and a zero as "0".
  const styled = (axis) => (/e$/.test(axis.format || '') ? { ...axis, encode: { labels: { update: { text: { signal: `datum.value === 0 ? '0' : replace(format(datum.value, '${axis.format}'), 'e+', 'e')` } } } } } : axis);
  const defined = (more) => Object.fromEntries(Object.entries(more || {}).filter(([, value]) => value !== undefined));
  const axisX = (title, more) => styled({ orient: 'bottom', scale: 'x', title, tickCount: { signal: 'max(4, width / 80)' }, format: plainFormat, ...defined(more) });
  const axisY = (title, more) => styled({ orient: 'left', scale: 'y', title, grid: true, domain: false, ticks: false, tickCount: 4, format: plainFormat, ...defined(more) });

  // Names beside bars, on two lines if one is too short.
  const nameRoom = (width) => Math.max(80, width * 0.36);
  function inLines(name, room) {
    const most = Math.floor(room / 6.8), words = name.split(' ');
    if ([...name].length <= most) return [name];
    let first = words.shift();
    while (words.length && [...first].length + 1 + [...words[0]].length <= most) first += ' ' + words.shift();
    return [first, words.join(' ')].filter(Boolean).map((line) => short(line, most));
  }
  const namesInLines = { labels: { update: { text: { signal: "scale('names', datum.value)" }, lineHeight: { value: 13 }, dy: { signal: "-6.5 * (length(scale('names', datum.value)) - 1)" } } } };
  // Names of the models by index; for many models, the seven most probable and "others".
  function fewNames(models) {
    if (models.length <= 14) return models.map((m) => m.name);
    const top = [...models].sort((a, b) => b.probability - a.probability).slice(0, 7);
    return models.map((m) => (top.includes(m) ? m.name : 'others'));
  }

  // A two-dimensional histogram, densities as shades; empty cells show the paper.
  function heat(width, height, theme, { x, y, xTitle, yTitle, xDomain, yDomain, xFormat, yFormat, cells, legend, root }) {
    const values = cells.map(([i, j, d]) => ({ x0: x.from + i * x.width, x1: x.from + (i + 1) * x.width,
      y0: y.from + j * y.width, y1: y.from + (j + 1) * y.width, d }));
    const top = Math.max(...values.map((v) => v.d));
    return frame(width, height, theme, {
      data: [{ name: 'c', values }],
      scales: [linear('x', xDomain || [x.from, x.from + x.n * x.width], 'width'), linear('y', yDomain || [y.from, y.from + y.n * y.width], 'height'),
        { name: 'heat', type: root ? 'sqrt' : 'linear', domain: [0, top], range: theme.heat, interpolate: 'lab', zero: true }],
      axes: [axisX(xTitle, { format: xFormat || tickFormat(x.from, x.from + x.n * x.width), grid: true }), axisY(yTitle, { format: yFormat || tickFormat(y.from, y.from + y.n * y.width) })],
      legends: legend ? [{ fill: 'heat', type: 'gradient', title: legend, gradientLength: Math.min(220, width * 0.5), values: [0, top / (root ? 4 : 2), top], format: '.2~r' }] : [],
      marks: [{ type: 'rect', from: { data: 'c' }, encode: { enter: { x: { scale: 'x', field: 'x0' }, x2: { signal: "scale('x', datum.x1) + 0.4" },
        y: { scale: 'y', field: 'y1' }, y2: { signal: "scale('y', datum.y0) + 0.4" }, fill: { scale: 'heat', field: 'd' } } } }],
    });
  }
  const cellTable = (xName, yName, bx, by, cells) => ({
    head: [xName, yName, 'density'],
    rows: cells.map(([i, j, d]) => [bx.from + (i + 0.5) * bx.width, by.from + (j + 0.5) * by.width, d]),
  });

  return { inLines, nameRoom, namesInLines, fewNames, themes, number, restyled, percent, probability, pValue, r2, slug, shares, written, bracketed, unit, unitSystem, short, frame, linear, decades, powersOfTen, powerFormat,
    legend, strokes, circles, tickFormat, dots, dotMark, frequencyScale, frequencyAxis, axisX, axisY, heat, cellTable };
})();
