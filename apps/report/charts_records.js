// Charts of records and predictions: time histories, spectra, frequency responses, residuals.
const recordCharts = (({ slug, frame, linear, decades, powersOfTen, powerFormat, strokes, tickFormat, frequencyScale, frequencyAxis, axisX, axisY }) => {
  // |H1| of data and model over the coherence of the data, one frequency axis.
  function transfer(r, t) {
    const positive = t.rows.flatMap((row) => [row[1], row[2]]).filter((v) => v > 0);
    const shown = decades(t.rows.map((row) => row[1]).filter((v) => v > 0), positive, 6);
    const unit = t.unit.replace(/\^2/g, '²');
    const along = frequencyScale(t.rows, (row) => row[1] * row[1]);
    return {
      id: `frequency-response-${slug(r.name)}-${slug(t.name)}`, section: 'fit', title: `Frequency response: ${r.name} to ${t.name}`,
      caption: `H1 estimates with respect to the ${t.role}, of the data and of the prediction${r.noise_free ? ' without noise' : ''} (${t.segments} averages). Below: the coherence of the data.`,
      table: () => ({ head: ['frequency [Hz]', `|H1| data [${unit}]`, `|H1| model [${unit}]`, 'phase data [rad]', 'phase model [rad]', 'coherence'], rows: t.rows }),
      spec: (width, theme) => frame(width, 230, theme, {
        data: [{ name: 'h', values: ['data', 'predicted'].flatMap((who, k) => t.rows.filter((row) => row[k + 1] > 0).map((row) => ({ f: row[0], v: row[k + 1], who }))) },
          { name: 'c', values: t.rows.map((row) => ({ f: row[0], v: row[5] })) }],
        scales: [along,
          { name: 'y', type: 'log', domain: shown, range: [150, 0] }, linear('c', [0, 1], [230, 178]),
          { name: 'who', type: 'ordinal', domain: ['data', 'predicted'], range: [theme.ink, theme.other] }],
        axes: [frequencyAxis(along), axisY(unit, { format: powerFormat(powersOfTen(shown)), values: powersOfTen(shown), titleAnchor: 'end', titleAlign: 'right' }),
          axisY('coherence', { scale: 'c', values: [0, 0.5, 1], titleAnchor: 'start', titleAlign: 'left' })],
        legends: [strokes(width, ['data', 'predicted'])],
        marks: [
          { type: 'group', clip: true, encode: { enter: { width: { signal: 'width' }, height: { value: 150 } } }, from: { facet: { name: 'one', data: 'h', groupby: 'who' } }, marks: [{ type: 'line', from: { data: 'one' }, encode: { enter: { x: { scale: 'x', field: 'f' }, y: { scale: 'y', field: 'v' }, stroke: { scale: 'who', field: 'who' }, strokeWidth: { value: 1.4 } } } }] },
          { type: 'area', from: { data: 'c' }, encode: { enter: { x: { scale: 'x', field: 'f' }, y: { scale: 'c', field: 'v' }, y2: { scale: 'c', value: 0 }, fill: { value: theme.main }, fillOpacity: { value: 0.5 } } } },
        ],
      }),
    };
  }

  function responses(run) {
    return (run.draws.responses || []).flatMap((r) => {
      const label = `${r.name}${r.unit ? ` [${r.unit.replace('^2', '²')}]` : ''}`;
      // `low` and `high`: replicates with noise; `a`, `m`, `b`: without noise, the band only if the run
      // stored it.
      const values = r.history.map(([t, y, low, a, m, b, high, rest]) => ({ t, y, low, a, m, b, high, rest }));
      const span = [values[0].t, values[values.length - 1].t];
      const y = [Math.min(...values.map((v) => Math.min(v.y, v.low))), Math.max(...values.map((v) => Math.max(v.y, v.high)))];
      const line = (field, color, width, dash) => ({ type: 'line', clip: true, from: { data: 'd' }, encode: { update: { x: { scale: 'x', field: 't' }, y: { scale: 'y', field },
        stroke: { value: color }, strokeWidth: { value: width }, strokeDash: { value: dash || [] } } } });
      const band = (from, to, color, opacity) => ({ type: 'area', clip: true, from: { data: 'd' }, encode: { update: { x: { scale: 'x', field: 't' }, y: { scale: 'y', field: from }, y2: { scale: 'y', field: to }, fill: { value: color }, fillOpacity: { value: opacity } } } });
      // Dragging over a time chart zooms to that interval.
      const zoomed = {
        signals: [
          { name: 'shown', value: span, on: [
            { events: 'window:mouseup', update: "drag && abs(drag[1] - drag[0]) > 4 ? [invert('x', min(drag[0], drag[1])), invert('x', max(drag[0], drag[1]))] : shown" },
            { events: 'dblclick', update: JSON.stringify(span) }] },
          { name: 'drag', value: null, on: [
            { events: 'mousedown', update: '[x(), x()]' },
            { events: '[mousedown, window:mouseup] > window:mousemove!', update: '[drag[0], clamp(x(), 0, width)]' },
            { events: { signal: 'shown' }, update: 'null' }] },
        ],
      };
      const dragged = (theme) => ({ type: 'rect', encode: { update: { x: { signal: 'drag ? min(drag[0], drag[1]) : 0' }, x2: { signal: 'drag ? max(drag[0], drag[1]) : 0' }, y: { value: 0 }, y2: { signal: 'height' }, fill: { value: theme.main }, fillOpacity: { value: 0.2 } } } });
      const bucket = r.bucket > 1 ? ` Each plotted interval represents up to ${r.bucket} samples by their extremes.` : '';
      const left = [Math.min(0, ...values.map((v) => v.rest)), Math.max(0, ...values.map((v) => v.rest))];
      const bound = 1.96 / Math.sqrt(r.samples);
      const rho = r.autocorrelation.map((v, i) => ({ lag: i + 1, v }));
      const deep = Math.min(-bound, ...r.autocorrelation) * 1.1, high = Math.max(bound, ...r.autocorrelation) * 1.1;
      const frequencies = frequencyScale(r.spectrum, (row) => row[1]);
      const positive = r.spectrum.flatMap((s) => s.slice(1)).filter((v) => v > 0);
      const powers = decades(r.spectrum.flatMap((s) => [s[1], s[3]]).filter((v) => v > 0), positive, 9);
      return [
        {
          id: 'response-' + slug(r.name), section: 'fit', wide: true, zoom: span, title: `Measured and predicted: ${label}`,
          caption: `${r.noise_free
            ? 'Predicted: median and 95 % credible band of the motion without noise, on the paler 95 % prediction band of measurements with noise.'
            : 'Predicted: median and 95 % prediction band of measurements with noise (this run stored no prediction without noise).'} Drag to zoom, double-click for the whole record, or use the buttons.${bucket}`,
          table: () => ({ head: ['time [s]', 'measured', 'with noise 2.5 %', 'predicted 2.5 %', 'predicted 50 %', 'predicted 97.5 %', 'with noise 97.5 %', 'residual'], rows: r.history }),
          spec: (width, theme) => frame(width, 220, theme, {
            ...zoomed,
            data: [{ name: 'd', values }],
            scales: [linear('x', { signal: 'shown' }, 'width'), linear('y', y, 'height'),
              { name: 'who', type: 'ordinal', domain: ['measured', 'predicted'], range: [theme.ink, theme.other] }],
            axes: [axisX('time [s]'), axisY(label, { format: tickFormat(...y) })],
            legends: [strokes(width, ['measured', 'predicted'])],
            marks: [band('low', 'high', theme.other, r.noise_free ? 0.16 : 0.3), ...(r.noise_free ? [band('a', 'b', theme.other, 0.45)] : []),
              line('m', theme.other, 1.5), line('y', theme.ink, 0.9), dragged(theme)],
          }),
        },
        {
          id: 'residual-' + slug(r.name), section: 'fit', wide: true, zoom: span, title: `Residual: ${label}`,
          caption: `Measured minus predicted${r.noise_free ? ' (the median without noise)' : ''}. Noise looks the same everywhere; residuals that follow the motion indicate an error of the model.${bucket}`,
          table: () => ({ head: ['time [s]', 'residual'], rows: values.map((v) => [v.t, v.rest]) }),
          spec: (width, theme) => frame(width, 120, theme, {
            ...zoomed,
            data: [{ name: 'd', values }],
            scales: [linear('x', { signal: 'shown' }, 'width'), linear('y', left[0] < left[1] ? left : [-1, 1], 'height')],
            axes: [axisX('time [s]'), axisY('residual', { format: tickFormat(...left) })],
            marks: [{ type: 'rule', encode: { enter: { x: { value: 0 }, x2: { signal: 'width' }, y: { scale: 'y', value: 0 }, stroke: { value: theme.soft } } } },
              line('rest', theme.main, 0.9), dragged(theme)],
          }),
        },
        {
          id: 'spectrum-' + slug(r.name), section: 'fit', title: `Spectrum: ${r.name}`, caption: `Power spectral density of the data, of the prediction${r.noise_free ? ' without noise' : ''} and of the residual.`,
          table: () => ({ head: ['frequency [Hz]', 'data', 'predicted', 'residual'], rows: r.spectrum }),
          spec: (width, theme) => frame(width, 170, theme, {
            data: [{ name: 'd', values: ['data', 'predicted', 'residual'].flatMap((who, k) => r.spectrum.filter((s) => s[k + 1] > 0).map((s) => ({ f: s[0], v: s[k + 1], who }))) }],
            scales: [frequencies, { name: 'y', type: 'log', domain: powers, range: 'height' },
              { name: 'who', type: 'ordinal', domain: ['data', 'predicted', 'residual'], range: [theme.ink, theme.other, theme.main] }],
            axes: [frequencyAxis(frequencies), axisY(r.unit ? (r.unit === 'm' ? 'm²/Hz' : `(${r.unit.replace('^2', '²')})²/Hz`) : null, { format: powerFormat(powersOfTen(powers)), values: powersOfTen(powers) })],
            legends: [strokes(width, ['data', 'predicted', 'residual'])],
            marks: [{ type: 'group', clip: true, encode: { enter: { width: { signal: 'width' }, height: { signal: 'height' } } }, from: { facet: { name: 'one', data: 'd', groupby: 'who' } }, marks: [{ type: 'line', from: { data: 'one' }, encode: { enter: { x: { scale: 'x', field: 'f' }, y: { scale: 'y', field: 'v' }, stroke: { scale: 'who', field: 'who' }, strokeWidth: { value: 1.2 } } } }] }],
          }),
        },
        ...(r.transfer || []).filter((t) => t.rows.some((row) => row[1] > 0)).map((t) => transfer(r, t)),
        {
          id: 'autocorrelation-' + slug(r.name), section: 'fit', title: `Autocorrelation of the residuals: ${r.name}`, caption: 'For white residuals, one value in twenty lies outside the shaded band. Many values outside the band mean that the model lacks an effect and that its intervals are too narrow.',
          table: () => ({ head: ['lag', 'autocorrelation'], rows: rho.map((v) => [v.lag, v.v]) }),
          spec: (width, theme) => frame(width, 170, theme, {
            data: [{ name: 'd', values: rho }],
            scales: [linear('x', [0, rho.length + 1], 'width'), linear('y', [deep, high], 'height')],
            axes: [axisX('lag [samples]', { domain: false }), axisY(null)],
            marks: [
              { type: 'rect', encode: { enter: { x: { value: 0 }, x2: { signal: 'width' }, y: { scale: 'y', value: -bound }, y2: { scale: 'y', value: bound }, fill: { value: theme.other }, fillOpacity: { value: 0.18 } } } },
              { type: 'rule', from: { data: 'd' }, encode: { enter: { x: { scale: 'x', field: 'lag' }, y: { scale: 'y', value: 0 }, y2: { scale: 'y', field: 'v' }, stroke: { value: theme.main }, strokeWidth: { value: Math.max(1.5, Math.min(5, width / 100)) } } } },
            ],
          }),
        },
      ];
    });
  }

  return { responses };
})(kit);
