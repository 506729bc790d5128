// Charts of a discovery: the terms of the links and their laws.
const discoveryCharts = (({ percent, bracketed, unitSystem, inLines, nameRoom, namesInLines, tickFormat, slug, frame, linear, axisX, axisY }) => {
  function terms(run) {
    const all = run.summary.terms || [];
    if (!all.length) return [];
    const rows = all.map((t, i) => ({ ...t, i, said: percent(t.inclusion), low: Math.max(0, t.inclusion - 2 * (t.mcse || 0)), high: Math.min(1, t.inclusion + 2 * (t.mcse || 0)) }));
    return [{
      id: 'terms', section: 'models', wide: true, title: 'Probability of each term',
      caption: 'Dots: the probability that the link has the term, over all subsets of the terms; whiskers: twice its Monte Carlo error; short strokes: the prior.',
      table: () => ({ head: ['term', 'link', 'inclusion', 'mcse', 'prior'], rows: all.map((t) => [t.name, t.link.join(' – '), t.inclusion, t.mcse, t.prior]) }),
      spec: (width, theme) => frame(width, 26 * rows.length, theme, {
        data: [{ name: 't', values: rows }],
        scales: [linear('x', [0, 1], [6, { signal: 'width - 58' }]), { name: 'y', type: 'band', domain: rows.map((t) => t.i), range: 'height', padding: 0.3 },
          { name: 'names', type: 'ordinal', domain: rows.map((t) => t.i), range: rows.map((t) => inLines(t.label.replace(/_/g, ' '), nameRoom(width))) }],
        axes: [axisX(null, { format: '%', grid: true, tickCount: width < 480 ? 3 : 5, labelFlush: false }),
          { orient: 'left', scale: 'y', domain: false, ticks: false, labelLimit: nameRoom(width), labelFontSize: 12, labelColor: theme.ink,
            labelPadding: 6, encode: namesInLines }],
        marks: [
          { type: 'rule', from: { data: 't' }, encode: { enter: { x: { scale: 'x', field: 'prior' }, y: { scale: 'y', field: 'i', offset: -2 },
            y2: { scale: 'y', field: 'i', band: 1, offset: 2 }, stroke: { value: theme.other }, strokeWidth: { value: 2 } } } },
          { type: 'rule', from: { data: 't' }, encode: { enter: { x: { scale: 'x', field: 'low' }, x2: { scale: 'x', field: 'high' },
            y: { scale: 'y', field: 'i', band: 0.5 }, stroke: { value: theme.ink }, strokeWidth: { value: 1.5 } } } },
          { type: 'symbol', from: { data: 't' }, encode: { enter: { x: { scale: 'x', field: 'inclusion' }, y: { scale: 'y', field: 'i', band: 0.5 },
            size: { value: 90 }, fill: { value: theme.main }, tooltip: { signal: "datum.label + ': ' + datum.said" } } } },
          { type: 'text', from: { data: 't' }, encode: { enter: { x: { signal: 'width' }, align: { value: 'right' }, y: { scale: 'y', field: 'i', band: 0.5 }, baseline: { value: 'middle' },
            text: { field: 'said' }, fontSize: { value: 12 }, fontWeight: { value: 600 } } } },
        ],
      }),
    }];
  }
  // A law averaged over all models, at rest or at zero extension, and the forces from the record.
  function foundLaw(law, at, { force, length, rate }) {
    const key = law.between.join(' – '), resting = at === 'extension';
    const bands = resting ? law.tension : law.resistance;
    const values = law[at].map((x, i) => ({ x, a: bands['q2.5'][i], m: bands.q50[i], b: bands['q97.5'][i] }));
    const points = (law.map || []).map(([e, v, t]) => ({ x: resting ? e : v, t }));
    const ends = (list) => [Math.min(...list), Math.max(...list)];
    const [low, high] = ends([...values.flatMap((v) => [v.a, v.b]), ...points.map((p) => p.t)]);
    const axis = resting ? `extension${length}` : `rate${rate}`, along = ends([...values.map((v) => v.x), ...points.map((p) => p.x)]);
    return {
      id: `found-law-${at}-` + slug(key), section: 'where', group: key, title: resting ? 'Law at rest, averaged over all models' : 'Resistance, averaged over all models', name: `${resting ? 'Law' : 'Resistance'} of link ${key}, averaged over all models`,
      caption: (resting ? 'Tension at rest: median and 95 % band over all models, weighted by their probabilities.' : 'Tension at zero extension: median and 95 % band over all models, without laws with memory (hysteresis).')
        + (points.length ? ` Dots: the tension from the measured motion (force minus mass times acceleration). Their scatter about the line is the part of the tension that depends on the ${resting ? 'rate' : 'extension'}.` : ''),
      table: () => ({ head: [axis, `2.5 %${force}`, `50 %${force}`, `97.5 %${force}`], rows: values.map((v) => [v.x, v.a, v.m, v.b]) }),
      spec: (width, theme) => frame(width, 190, theme, {
        data: [{ name: 'd', values }, { name: 'p', values: points }],
        scales: [linear('x', along, 'width'), linear('y', low < high ? [low, high] : [low - 1, high + 1], 'height')],
        axes: [axisX(axis, { format: tickFormat(...along) }), axisY(`tension${force}`, { format: tickFormat(low, high) })],
        marks: [
          { type: 'symbol', from: { data: 'p' }, encode: { enter: { x: { scale: 'x', field: 'x' }, y: { scale: 'y', field: 't' }, size: { value: 7 }, fill: { value: theme.soft }, fillOpacity: { value: 0.5 } } } },
          { type: 'area', from: { data: 'd' }, encode: { enter: { x: { scale: 'x', field: 'x' }, y: { scale: 'y', field: 'a' }, y2: { scale: 'y', field: 'b' }, fill: { value: theme.main }, fillOpacity: { value: 0.3 } } } },
          { type: 'line', from: { data: 'd' }, encode: { enter: { x: { scale: 'x', field: 'x' }, y: { scale: 'y', field: 'm' }, stroke: { value: theme.main }, strokeWidth: { value: 1.8 } } } },
        ],
      }),
    };
  }
  // Map of Masri and Caughey: the tension from the record over extension and rate.
  function forceMap(law, { force, length, rate }) {
    const key = law.between.join(' – ');
    const points = law.map.map(([e, v, t]) => ({ e, v, t }));
    const most = Math.max(...points.map((p) => Math.abs(p.t))), ends = (what) => [Math.min(...points.map((p) => p[what])), Math.max(...points.map((p) => p[what]))];
    return {
      id: 'force-map-' + slug(key), section: 'where', group: key, title: 'Restoring force', name: `Restoring force of link ${key} over its states`,
      caption: 'Each dot is a sample of the record, at the extension and rate of the link. The colour is the tension of the link: force minus mass times acceleration (Masri and Caughey 1979).',
      table: () => ({ head: [`extension${length}`, `rate${rate}`, `tension${force}`], rows: law.map }),
      spec: (width, theme) => frame(width, 220, theme, {
        data: [{ name: 'p', values: points }],
        scales: [linear('x', ends('e'), 'width'), linear('y', ends('v'), 'height'),
          linear('c', [-most, 0, most], [theme.main, theme.grid, theme.other], { interpolate: 'rgb' })],
        axes: [axisX(`extension${length}`, { format: tickFormat(...ends('e')), grid: true }), axisY(`rate${rate}`, { format: tickFormat(...ends('v')) })],
        legends: [{ fill: 'c', title: `tension${force}`, type: 'gradient', gradientLength: Math.max(80, Math.min(200, width / 2)) }],
        marks: [{ type: 'symbol', from: { data: 'p' }, encode: { enter: { x: { scale: 'x', field: 'e' }, y: { scale: 'y', field: 'v' }, size: { value: 26 }, fill: { scale: 'c', field: 't' } } } }],
      }),
    };
  }
  function discovery(run) {
    const found = run.summary.discovery?.laws || [], { force, length } = unitSystem(run);
    const units = { force: bracketed(force), length: bracketed(length), rate: bracketed(length && `${length}/s`) };
    return [...terms(run), ...found.flatMap((law) => [foundLaw(law, 'extension', units), foundLaw(law, 'rate', units), ...(law.map?.length ? [forceMap(law, units)] : [])])];
  }

  return { discovery };
})(kit);
