// The figures of a report as Vega specifications: charts.figures(run) lists them, each with
// spec(width, theme) and table() of the same numbers. Neither this file nor charts_*.js changes
// the page.
const charts = (() => {
  const { themes, number, percent, probability, pValue, r2, slug, unit, bracketed, shares } = kit;
  const { modelProbabilities, evidence, sweep } = modelCharts;
  const { beam, structure, jointFigures, residuals, emulator } = damageCharts;
  const { chain, laws, loops } = chainCharts;
  const { discovery } = discoveryCharts;
  const { mac, shapes } = modeCharts;
  const { responses } = recordCharts;
  const { marginal, pair, history, visits, running, acceptance } = samplingCharts;

  // Charts of the results, in the order of the page: a chart maps a run to its figures (an empty list if the run lacks
  // their data).
  const ofResults = [evidence, residuals, mac, shapes, responses];

  function figures(run) {
    if (run.summary.sweep) return sweep(run);
    const { summary, draws } = run;
    const isShare = shares(run);
    const alone = summary.models.length === 1;
    const out = [...discovery(run), ...(alone ? [] : [modelProbabilities(run)])];
    if (summary.damage) {
      const several = summary.kinds.length > 1;
      for (const kind of summary.kinds) {
        const inclusion = (several ? summary.damage.inclusion_by_element[kind.name] : summary.damage.inclusion_by_element)?.overall;
        if (inclusion?.length) out.push((summary.structure ? structure : beam)(run, kind, inclusion, several));
      }
      out.push(...jointFigures(run));
    } else {
      // For a discovery, the law averaged over all models replaces the laws of each model, and its map of forces
      // replaces the map of the most probable model.
      const mapped = (summary.discovery?.laws || []).filter((law) => law.map?.length).map((law) => law.between.join(' – '));
      out.push(...chain(run), ...(summary.terms ? [] : laws(run)), ...loops(run).filter((f) => !(f.id.startsWith('restoring-force') && mapped.includes(f.group))));
    }
    out.push(...ofResults.flatMap((chart) => chart(run)));
    // Draws that could not be written have no figures.
    const drawn = draws.parameters || {};
    for (const [model, list] of Object.entries(drawn)) {
      for (const p of list) out.push(marginal(model, p, isShare(p.name)));
      for (const p of draws.pairs[model] || []) out.push(pair(model, p, isShare));
    }
    if (draws.visits && !alone) out.push(visits(run), running(run));
    if (draws.log_posterior) out.push(Object.assign(history('log-posterior', 'sampling', null, 'log posterior', draws.log_posterior, draws.draws, true), { wide: true }));
    out.push(...acceptance(run));
    for (const [model, list] of Object.entries(drawn)) {
      for (const p of list) out.push(history(`history-${slug(model)}-${slug(p.name)}`, 'histories', model, p.name + unit(p.name, p.unit), p.history, draws.draws, false, isShare(p.name)));
    }
    out.push(...emulator(run));
    // Different names may have the same shortened form.
    const seen = new Map();
    for (const f of out) {
      const n = (seen.get(f.id) || 0) + 1;
      seen.set(f.id, n);
      if (n > 1) f.id += '-' + n;
    }
    return out;
  }
  return { figures, ofResults, themes, number, percent, probability, pValue, r2, bracketed };
})();
