// Charts that compare measured and computed mode shapes.
const modeCharts = (({ frame, linear, axisY }) => {
  // Measured and computed shapes of the data of an update, or of each state of a damage run.
  const sets = (run) => run.summary.data?.shapes_of || [run.summary.data || {}];
  const named = (set) => (set.state ? `: ${set.state}` : '');
  const slug = (set) => (set.state ? `${set.state}-` : '');
  // Rows: measured modes; columns: computed modes; null without a measured shape.
  const mac = (run) => sets(run).flatMap((set) => macOf(set));
  function macOf(set) {
    const rows = set.mac || [];
    const cells = rows.flatMap((row, i) => row.map((value, j) => ({ measured: String(i + 1), computed: String(j + 1), value })).filter((c) => typeof c.value === 'number'));
    if (!cells.length) return [];
    const measured = [...new Set(cells.map((c) => c.measured))], computed = [...new Set(cells.map((c) => c.computed))];
    return [{
      id: `${slug(set)}mac`, section: 'fit', title: `MAC of measured and computed shapes${named(set)}`,
      caption: 'Modal assurance criterion (MAC) at the best draw, over the sensors of each shape; 1 means the same shape. Wheeltap matches measured and computed modes by shape and frequency together.',
      table: () => ({ head: ['measured mode', ...computed.map((c) => `computed ${c}`)], rows: measured.map((m) => [Number(m), ...computed.map((c) => cells.find((x) => x.measured === m && x.computed === c)?.value ?? null)]) }),
      spec: (width, theme) => frame(width, Math.max(120, 34 * measured.length), theme, {
        data: [{ name: 'c', values: cells }],
        scales: [{ name: 'x', type: 'band', domain: computed, range: 'width', padding: 0.04 }, { name: 'y', type: 'band', domain: measured, range: 'height', padding: 0.04 },
          { name: 'heat', type: 'linear', domain: [0, 1], range: theme.heat, interpolate: 'lab' }],
        axes: [{ orient: 'bottom', scale: 'x', title: 'computed mode', domain: false, ticks: false }, { orient: 'left', scale: 'y', title: 'measured mode', domain: false, ticks: false }],
        marks: [
          { type: 'rect', from: { data: 'c' }, encode: { enter: { x: { scale: 'x', field: 'computed' }, width: { scale: 'x', band: 1 }, y: { scale: 'y', field: 'measured' }, height: { scale: 'y', band: 1 }, fill: { scale: 'heat', field: 'value' } } } },
          { type: 'text', from: { data: 'c' }, encode: { enter: { x: { scale: 'x', field: 'computed', band: 0.5 }, y: { scale: 'y', field: 'measured', band: 0.5 }, align: { value: 'center' }, baseline: { value: 'middle' },
            text: { signal: "format(datum.value, '.2f')" }, fill: { signal: `datum.value > 0.5 ? '${theme.paper}' : '${theme.ink}'` } } } },
        ],
      }),
    }];
  }

  // Measured and computed entries over the sensors, one figure per mode.
  const shapes = (run) => sets(run).flatMap((set) => shapesOf(set));
  function shapesOf(set) {
    const { shapes: measured, computed_shapes: computed, sensors } = set;
    if (!measured?.length || !computed?.length || !sensors?.length) return [];
    return measured.flatMap((row, i) => {
      const values = row.map((m, s) => ({ sensor: s + 1, name: sensors[s], measured: m, computed: computed[i]?.[s] })).filter((v) => typeof v.measured === 'number' && typeof v.computed === 'number');
      if (values.length < 2) return [];
      const all = values.flatMap((v) => [v.measured, v.computed, 0]);
      const low = Math.min(...all), high = Math.max(...all), pad = 0.08 * (high - low);
      return [{
        id: `${slug(set)}shape-${i + 1}`, section: 'fit', title: `Shape of mode ${i + 1}${named(set)}`, caption: 'Points: measured. Strokes: computed at the best draw, scaled to the points.',
        table: () => ({ head: ['sensor', 'measured', 'computed'], rows: values.map((v) => [v.name, v.measured, v.computed]) }),
        spec: (width, theme) => frame(width, 150, theme, {
          data: [{ name: 'v', values }],
          scales: [{ name: 'x', type: 'point', domain: values.map((v) => v.sensor), range: 'width', padding: 0.6 }, linear('y', [low - pad, high + pad], 'height')],
          axes: [{ orient: 'bottom', scale: 'x', title: 'sensor', domain: false, ticks: false, labelOverlap: true }, axisY(null)],
          marks: [
            { type: 'rule', encode: { enter: { x: { value: 0 }, x2: { signal: 'width' }, y: { scale: 'y', value: 0 }, stroke: { value: theme.grid } } } },
            { type: 'rule', from: { data: 'v' }, encode: { enter: { x: { scale: 'x', field: 'sensor', offset: -8 }, x2: { scale: 'x', field: 'sensor', offset: 8 }, y: { scale: 'y', field: 'computed' }, stroke: { value: theme.main }, strokeWidth: { value: 3 } } } },
            { type: 'symbol', from: { data: 'v' }, encode: { enter: { x: { scale: 'x', field: 'sensor' }, y: { scale: 'y', field: 'measured' }, fill: { value: theme.other }, size: { value: 40 } } } },
          ],
        }),
      }];
    });
  }

  return { mac, shapes };
})(kit);
