// Channels of a case: the position, direction and sign of each, in the keys of the case.
import { at, pointerOf } from './schema.js';
import { folderOf } from './modes_case.js';
import { seriesRows } from './series.js';
import { get } from './server.js';

const radian = Math.PI / 180;

// The lists of channels of a case. `record`: channels of a measured file, in a modal case, or in a case of system
// identification (`ofMasses`). `modes`: sensors of mode shapes, in a damage or update case. `series`: columns of the table
// of a monitor case, which the key `key` names.
export const channelLists = (doc) => {
  if (doc?.kind === 'modal') {
    if (Array.isArray(doc.records)) return doc.records.map((record, i) => ({ kind: 'record', path: ['records', i], label: `Set-up ${i + 1}: ${record?.file ?? ''}` }));
    return doc.record ? [{ kind: 'record', path: ['record'], label: String(doc.record.file ?? '') }] : [];
  }
  if (doc?.kind === 'sid') return doc.record?.file === undefined ? [] : [{ kind: 'record', ofMasses: true, path: ['record'], label: String(doc.record.file) }];
  if (doc?.kind === 'monitor') {
    const key = ['file', 'times'].find((one) => typeof doc.series?.[one] === 'string');
    return key ? [{ kind: 'series', key, path: ['series'], label: doc.series[key] }] : [];
  }
  if (!['damage', 'update'].includes(doc?.kind)) return [];
  const found = [];
  const add = (path, label) => {
    const block = at(doc, path);
    if (block?.from !== undefined || Array.isArray(block?.sensors)) found.push({ kind: 'modes', path, label });
  };
  add(['data'], 'Data');
  (Array.isArray(doc.data?.states) ? doc.data.states : []).forEach((state, i) => add(['data', 'states', i], `State ${state?.name ?? i + 1}`));
  add(['baseline', 'data'], 'Baseline');
  return found;
};

// The file that a list of a case names.
export const fileOf = (doc, list) => {
  const block = at(doc, list.path);
  return (list.kind === 'modes' ? block?.from : block?.[list.key ?? 'file']) ?? '';
};

// A file and the keys of the case that state the layout of its table, for a request to the server.
const layoutKeys = ['decimal', 'separator', 'skip', 'header', 'units_row', 'sheet', 'time_format', 'rows_are_channels', 'resample'];
export const sourceOf = (name, block) => {
  const stated = Object.fromEntries(layoutKeys.filter((key) => block?.[key] !== undefined).map((key) => [key, block[key]]));
  if (stated.resample && block.sample_rate !== undefined) stated.sample_rate = block.sample_rate;
  return Object.keys(stated).length ? { name, layout: JSON.stringify(stated) } : { name };
};

// The type of a sensor's position: a node in 2D or 3D, a coordinate on a beam, a mass of a chain, a row of matrices.
export const supportOf = (doc, structure) => {
  if (doc.beam) return 'beam';
  if (doc.structure?.chain || doc.kind === 'sid') return 'chain';
  if (doc.structure?.matrices !== undefined) return 'matrices';
  return structure && structure.dimension !== 3 ? 'plane' : 'space';
};

// Directions that a channel of the list may have; "angles" stands for azimuth and elevation.
export const directionsOf = (list, support) => {
  const both = (names) => names.flatMap((name) => [name, `-${name}`]);
  if (list.ofMasses) return [];
  if (list.kind === 'record') return [...both(support === 'plane' ? ['x', 'y'] : ['x', 'y', 'z']), 'angles'];
  return { beam: ['deflection', 'rotation'], chain: ['x', '-x'], matrices: [], plane: both(['x', 'y', 'rotation']), space: both(['x', 'y', 'z', 'rx', 'ry', 'rz']) }[support];
};

// The direction of a channel: a vector, "rotation", "-rotation", or null.
export const vectorOf = (channel, support) => {
  if (channel.azimuth !== undefined || channel.elevation !== undefined) {
    const a = radian * (Number(channel.azimuth) || 0), e = radian * (Number(channel.elevation) || 0);
    return [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
  }
  if (support === 'beam') return channel.direction === 'rotation' ? 'rotation' : [0, 1, 0];
  const direction = String(channel.direction ?? (support === 'chain' ? 'x' : '')), sign = direction.startsWith('-') ? -1 : 1;
  const name = direction.replace(/^[-+]/, '');
  if (name === 'rotation' || /^r[xyz]$/.test(name)) return sign > 0 ? 'rotation' : '-rotation';
  const k = ['x', 'y', 'z'].indexOf(name);
  return k < 0 ? null : [0, 1, 2].map((i) => (i === k ? sign : 0));
};

const massOf = (channel) => (Number.isInteger(channel.mass) ? channel.mass : Number(/^(?:mass )?(\d+)$/.exec(String(channel.node ?? ''))?.[1] ?? NaN));

// The position of a channel in the terms of the drawing; null if the channel has none.
export const placeOf = (channel, support) => {
  if (support === 'beam') return typeof channel.at === 'number' ? { at: channel.at } : null;
  if (support === 'chain') return Number.isFinite(massOf(channel)) ? { mass: massOf(channel) } : null;
  if (channel.member !== undefined) return { member: String(channel.member), at: channel.at };
  if (channel.dof !== undefined) return { dof: channel.dof };
  return channel.node !== undefined && channel.node !== '' ? { node: String(channel.node) } : null;
};

// Gives a channel a position. In a chain, a sign is possible only if the sensor has the name of its mass.
export const setPlace = (channel, place, support) => {
  const backwards = String(channel.direction ?? '').startsWith('-');
  for (const key of ['node', 'member', 'at', 'mass', 'dof']) delete channel[key];
  if (support === 'chain' && place?.mass !== undefined && backwards) channel.node = `mass ${place.mass}`;
  else Object.assign(channel, place ?? {});
};

export const setDirection = (channel, direction, support) => {
  const vector = vectorOf(channel, support), place = placeOf(channel, support);
  for (const key of ['direction', 'azimuth', 'elevation']) delete channel[key];
  if (direction === 'angles') {
    const [x, y, z] = Array.isArray(vector) ? vector : [1, 0, 0];
    channel.azimuth = Math.round(10 * Math.atan2(y, x) / radian) / 10 || 0;
    channel.elevation = Math.round(10 * Math.asin(Math.max(-1, Math.min(1, z))) / radian) / 10 || 0;
  } else if (direction && !(support === 'chain' && direction === 'x')) channel.direction = direction;
  if (support === 'chain') setPlace(channel, place, support);
};

export const reverse = (channel, support) => {
  if (channel.azimuth !== undefined || channel.elevation !== undefined) {
    const azimuth = Number(channel.azimuth) || 0;
    channel.azimuth = azimuth > 0 ? azimuth - 180 : azimuth + 180;
    channel.elevation = -(Number(channel.elevation) || 0) || 0;
    return;
  }
  const direction = String(channel.direction ?? 'x').replace(/^\+/, '');
  setDirection(channel, direction.startsWith('-') ? direction.slice(1) : `-${direction}`, support);
};

const bare = (text) => String(text).replace(/\s*(\[[^\]]*\]|\([^)]*\))$/, '');

// How a case names a column of a file: by its name, or by its number if another column has the name.
export const columnOf = (column, all) => {
  const alone = all.filter((one) => one.name === column.name).length === 1 && !/^\d+$/.test(column.name);
  return alone || !column.number ? column.name : column.number;
};

// The rows of a list: its channels, then the columns of the file that it does not name. `known` are the columns of the
// file, or the sensors of the modes.json that the list refers to.
export const rowsOf = (doc, list, known) => {
  if (list.kind === 'series') return seriesRows(doc, list, known);
  const block = at(doc, list.path) ?? {};
  if (list.kind === 'record') {
    const channels = Array.isArray(block.channels) ? block.channels : [], used = new Set();
    const rows = channels.map((channel, i) => {
      const text = String(channel?.column ?? '');
      const column = known.find((one) => one.name === text) ?? known.find((one) => one.name === bare(text)) ?? known.find((one) => String(one.number) === text);
      if (column) used.add(column);
      return { i, channel: channel ?? {}, role: channel?.role, unit: channel?.unit ?? column?.unit, name: /^\d*$/.test(text) ? column?.name ?? `column ${text}` : text, pointer: pointerOf([...list.path, 'channels', i]) };
    });
    return [...rows, ...known.filter((one) => !used.has(one) && !one.is_time).map((column) => ({ i: null, column, channel: {}, role: '', unit: column.unit, name: column.name, pointer: '' }))];
  }
  const given = Array.isArray(block.sensors) ? block.sensors : null;
  return Array.from({ length: Math.max(given?.length ?? 0, known.length) }, (ignored, i) => {
    const channel = given ? given[i] : known[i];
    return { i, channel: channel ?? {}, role: channel === null || channel === undefined ? 'ignore' : 'response', inherited: !given,
      name: known[i]?.name || `sensor ${i + 1}`, pointer: pointerOf([...list.path, 'sensors', i]) };
  });
};

export const rolesOf = (doc, list) => (list.kind === 'record' ? ['response', 'force', ...(list.ofMasses ? ['base-acceleration', 'base-displacement'] : []), 'ignore', 'time'] : at(doc, list.path)?.from !== undefined ? ['response', 'ignore'] : ['response']);

// The channel of a row in the case, for a change. A new list of sensors contains those of the modes.json.
export const writable = (doc, list, row, known, support) => {
  const block = at(doc, list.path);
  if (list.kind === 'record') {
    block.channels ??= [];
    if (row.i === null) {
      block.channels.push({ column: columnOf(row.column, known), role: 'response' });
      row.i = block.channels.length - 1;
    }
    if (!block.channels[row.i] || typeof block.channels[row.i] !== 'object') block.channels[row.i] = {};
    return block.channels[row.i];
  }
  if (!Array.isArray(block.sensors)) {
    const turned = known.find((sensor) => sensor.azimuth !== undefined || sensor.elevation !== undefined);
    if (turned && ['plane', 'space'].includes(support))
      throw new Error(`The sensor ${turned.name} of ${block.from} has azimuth and elevation, which the key "sensors" of this case cannot state. Set the direction of this channel in the modal case instead.`);
    block.sensors = known.map((sensor) => {
      const made = {}, place = placeOf(sensor, support);
      if (support !== 'beam' && sensor.direction) setDirection(made, sensor.direction, support);
      if (place && support !== 'beam') setPlace(made, place, support);
      return made;
    });
  }
  while (block.sensors.length <= row.i) block.sensors.push(null);
  if (!block.sensors[row.i] || typeof block.sensors[row.i] !== 'object') block.sensors[row.i] = {};
  return block.sensors[row.i];
};

// Gives a channel another role; deletes the keys that the role does not allow.
export const setRole = (doc, list, row, role, known, support) => {
  const channel = writable(doc, list, row, known, support);
  if (list.kind !== 'record') {
    if (role === 'ignore') at(doc, list.path).sensors[row.i] = null;
    return;
  }
  channel.role = role;
  if (list.ofMasses) {
    const own = { response: ['mass', 'quantity', 'frame'], force: ['mass'] }[role] ?? [];
    for (const key of ['mass', 'quantity', 'frame', ...({ ignore: ['unit', 'scale', 'offset'], time: ['unit', 'offset'] }[role] ?? [])]) if (!own.includes(key)) delete channel[key];
    return;
  }
  const gone = { response: [], force: ['reference', 'quantity'], time: ['node', 'direction', 'azimuth', 'elevation', 'reference', 'quantity', 'unit'],
    ignore: ['node', 'direction', 'azimuth', 'elevation', 'reference', 'quantity', 'unit', 'scale'] }[role] ?? [];
  for (const key of gone) delete channel[key];
};

// One arrow for each row with a position and a direction.
export const arrowsOf = (rows, support) => rows.flatMap((row, k) => {
  if (!['response', 'force'].includes(row.role)) return [];
  const place = placeOf(row.channel, support), vector = vectorOf(row.channel, support);
  return place && vector ? [{ place, vector, number: k + 1, title: row.name, force: row.role === 'force' }] : [];
});

// The arrows of all lists of a case, without the files that it names.
export const allArrows = (doc, structure) => {
  const lists = channelLists(doc), support = supportOf(doc, structure);
  return lists.flatMap((list) => arrowsOf(rowsOf(doc, list, []), support)).map((arrow) => (lists.length > 1 ? { ...arrow, number: '' } : arrow));
};

// The path of a file that a case in `folder` names; null outside the folder of the application, for
// an absolute path and for an empty name.
export const resolved = (folder, name) => {
  if (name === '' || String(name).startsWith('/')) return null;
  const parts = [];
  for (const part of [...folder.split('/'), ...String(name).split('/')]) {
    if (part === '..' && !parts.length) return null;
    if (part === '..') parts.pop();
    else if (part && part !== '.') parts.push(part);
  }
  return parts.join('/');
};

// The structure that the key geometry of a case shows: nodes, members, supports. Null without one.
export const geometryAsStructure = (geometry) => {
  if (!geometry?.nodes || typeof geometry.nodes !== 'object') return null;
  const members = (Array.isArray(geometry.lines) ? geometry.lines : []).filter(Array.isArray)
    .flatMap((line) => line.slice(1).map((to, i) => ({ nodes: [String(line[i]), String(to)] })));
  return { nodes: geometry.nodes, members, supports: (Array.isArray(geometry.fixed) ? geometry.fixed : []).map((node) => ({ node: String(node), fix: ['x', 'y'] })),
    dimension: Object.values(geometry.nodes).some((p) => p?.length === 3) ? 3 : 2 };
};

// The structure of the case that `geometry` names; null if it has none of nodes and members.
export const namedStructure = async (name, geometry) => {
  const file = resolved(folderOf(name), geometry);
  if (!file) return null;
  try {
    const { structure } = JSON.parse((await get('case', { name: file })).text);
    return structure?.nodes ? structure : null;
  } catch {
    return null;
  }
};
