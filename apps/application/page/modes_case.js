// A new damage case from the modes of a finished modal run: its data are the run's modes.json.
import { ask, attempt, element, say } from './dom.js';
import { written } from './schema.js';
import { get, post } from './server.js';

export const folderOf = (name) => (name.includes('/') ? name.slice(0, name.lastIndexOf('/')) : '');
const joined = (folder, name) => (folder ? `${folder}/${name}` : name);

// The path of a file as a file of `folder` names it.
export const relative = (folder, file) => {
  const from = folder.split('/').filter(Boolean), to = file.split('/').filter(Boolean);
  let same = 0;
  while (same < from.length && same < to.length - 1 && from[same] === to[same]) same += 1;
  return [...from.slice(same).map(() => '..'), ...to.slice(same)].join('/');
};

const distance = (a, b) => Math.hypot(...a.map((x, k) => x - b[k]));

// The ends of a straight line through all nodes and the distance of each node from its first end; null for other nodes.
const lineThrough = (nodes) => {
  const places = Object.values(nodes);
  let ends = null;
  for (const a of places) for (const b of places) if (!ends || distance(a, b) > distance(...ends) + 1e-12) ends = [a, b];
  if (!ends || !(distance(...ends) > 0)) return null;
  const length = distance(...ends), along = ends[1].map((x, k) => (x - ends[0][k]) / length);
  const at = {};
  for (const [name, place] of Object.entries(nodes)) {
    at[name] = along.reduce((sum, x, k) => sum + x * (place[k] - ends[0][k]), 0);
    if (Math.abs(distance(place, ends[0]) ** 2 - at[name] ** 2) > 1e-6 * length ** 2) return null;
  }
  return { length, at };
};

// Each maker changes a starter case so that its structure has positions for the sensors of the modes.
const makers = {
  building: (doc, { sensors }) => {
    const numbers = sensors.map((sensor) => Number(/^(?:mass )?(\d+)$/.exec(sensor.node ?? '')?.[1] ?? 0));
    const numbered = numbers.every((n) => n > 0), count = numbered ? Math.max(...numbers) : sensors.length;
    const { chain } = doc.structure, [mass] = chain.masses, { stiffness } = chain.links[0];
    chain.masses = Array.from({ length: count }, () => mass);
    chain.links = chain.masses.map((ignored, i) => ({ name: `storey ${i + 1}`, between: [i, i + 1], stiffness }));
    return numbered ? {} : { sensors: sensors.map((ignored, i) => ({ mass: i + 1 })) };
  },
  frame: (doc, { sensors, geometry }) => {
    const s = doc.structure, [material] = Object.keys(s.materials), [section] = Object.keys(s.sections), solid = geometry.dimension === 3;
    s.dimension = geometry.dimension;
    s.nodes = Object.fromEntries(Object.entries(geometry.nodes).map(([name, place]) => [name, solid ? place : place.slice(0, 2)]));
    const pairs = new Set(geometry.lines.flatMap((line) => line.slice(1).map((to, i) => JSON.stringify([String(line[i]), String(to)].sort()))));
    s.members = [...pairs].map((pair) => JSON.parse(pair)).map((nodes) => ({ name: nodes.join(' to '), nodes, elements: 4, material, section }));
    const up = solid ? 2 : 1, lowest = Math.min(...Object.values(s.nodes).map((place) => place[up]));
    const fixed = geometry.fixed?.length ? geometry.fixed : Object.keys(s.nodes).filter((name) => s.nodes[name][up] === lowest);
    s.supports = fixed.map((node) => ({ node: String(node), fix: solid ? ['x', 'y', 'z', 'rx', 'ry', 'rz'] : ['x', 'y', 'rotation'] }));
    delete s.masses;
    doc.damage = [doc.damage].flat().filter((block) => !block.on);
    return sensors.every((sensor) => String(sensor.node ?? '') in s.nodes) ? {} : { sensors: sensors.map((sensor) => (String(sensor.node ?? '') in s.nodes ? { node: sensor.node, direction: sensor.direction || 'x' } : null)) };
  },
  beam: (doc, { sensors, geometry }) => {
    const line = geometry && lineThrough(geometry.nodes), known = line && sensors.every((sensor) => sensor.node in line.at);
    if (line) {
      const scale = line.length / doc.beam.length;
      doc.beam.length = line.length;
      for (const key of ['location', 'extent']) if (doc.damage[key]?.uniform) doc.damage[key].uniform = doc.damage[key].uniform.map((x) => Number((scale * x).toPrecision(6)));
    }
    return { sensors: sensors.map((sensor, i) => ({ at: Number((known ? line.at[sensor.node] : doc.beam.length * (i + 1) / (sensors.length + 1)).toPrecision(6)) })) };
  },
};

export const newDamageCase = (result) => attempt(async () => {
  const [modes, summary, projects] = await Promise.all([get('result', { name: result, file: 'modes.json' }), get('result', { name: result }), get('projects')]);
  const { geometry } = summary, { sensors } = modes;
  const kinds = [{ text: 'A shear building, one storey for each measured floor', structure: 'building' },
    geometry && { text: 'A frame on the nodes and lines of the measured geometry', structure: 'frame' }, { text: 'A beam', structure: 'beam' },
    ...projects.cases.filter((one) => ['damage', 'update'].includes(one.kind)).map((one) => ({ text: `The structure of ${one.name}`, name: one.name }))].filter(Boolean);
  const choice = element('select', {}, kinds.map((kind, i) => element('option', { value: i }, kind.text)));
  const stem = result.slice(result.lastIndexOf('/') + 1).replace(/-results$/, '');
  const name = element('input', { value: `${stem}-damage`, required: true, spellcheck: 'false', pattern: '[^\\/\\\\.][^\\/\\\\]*', title: 'A name without slashes' });
  const given = await ask('New damage case from these modes', [{ label: 'Structure', control: choice }, { label: 'Name of the case', control: name }], 'Create');
  if (!given) return;
  const kind = kinds[Number(given[0])], file = `${result}/modes.json`, chosen = given[1].trim();
  let made;
  if (kind.name) {
    made = (await post('copy', { name: kind.name, to: joined(folderOf(kind.name), `${chosen}.json`) })).name;
  } else {
    made = (await post('start', { kind: 'damage', structure: kind.structure, folder: joined(folderOf(result), chosen) })).name;
  }
  const opened = await get('case', { name: made }), doc = JSON.parse(opened.text);
  const from = relative(folderOf(made), file);
  if (kind.name) {
    doc.data = { from, ...(doc.data?.from && doc.data.sensors?.length === sensors.length ? { sensors: doc.data.sensors } : {}) };
  } else {
    doc.data = { from, ...makers[kind.structure](doc, { sensors, geometry }) };
    doc.notes = [`The data are the modes of ${from}. The dimensions, masses and stiffnesses are examples: replace them with those of your structure.`];
    doc.title = `Damage (${modes.title || stem})`;
  }
  await post('save', { name: made, text: `${written(doc)}\n`, before: opened.version });
  location.hash = `#/case/${encodeURIComponent(made)}`;
  if (!kind.name) say('Replace the example values of the structure with those of your structure. Set the positions of the sensors on the page “Channels on the structure”.');
});
