// The lanes of a side: their ports as one row, or each port as a row of its own.
import {h} from './dom.js';
import {sum} from './format.js';

// "left_pixel.3" -> "left_pixel", also at the beginning of a longer text
export const groupOf = name => name.replace(/^((?:left|right)_(?:lut|pixel))\.\d+/, '$1');

const kEveryLane = '#every-lane';
addEventListener('hashchange', () => location.reload());

// The objects with the same values of `keys`, as one: other numbers and lists of numbers are summed, and
// divided by divisorOf(object).
function merged(objects, keys, divisorOf) {
  const all = new Map();
  for (const each of objects) {
    const key = keys.map(name => each[name]).join('\n');
    if (!all.has(key)) all.set(key, []);
    all.get(key).push(each);
  }
  return [...all.values()].map(some => {
    const divisor = divisorOf(some[0]);
    const names = Object.keys(some[0]).filter(name => !keys.includes(name));
    const valueOf = name => Array.isArray(some[0][name]) ?
        some[0][name].map((_, i) => sum(some.map(each => each[name][i])) / divisor) :
        sum(some.map(each => each[name])) / divisor;
    return {...some[0], ...Object.fromEntries(names.map(name => [name, valueOf(name)]))};
  });
}

// The most lanes of a port.
export const lanesOf = run => Math.max(...sizesOf(run).values());

function sizesOf({stats}) {
  const sizes = new Map();
  for (const {name} of stats.ports) sizes.set(groupOf(name), (sizes.get(groupOf(name)) ?? 0) + 1);
  return sizes;
}

// The run with one port for the lanes of a side, unless the address of the page asks for every lane. Its
// figures are means over the lanes, its accesses of banks are sums.
export function withFoldedLanes(run) {
  if (lanesOf(run) === 1 || location.hash === kEveryLane) return run;
  const sizes = sizesOf(run);
  const renamed = rows => rows.map(row => {
    const copy = {...row};
    for (const key of ['name', 'port', 'by']) {
      if (copy[key] !== undefined) copy[key] = groupOf(copy[key]);
    }
    return copy;
  });
  const meanOf = (rows, keys) =>
      merged(renamed(rows), keys, row => sizes.get(row.port ?? row.name) ?? 1);  // of `host capture`: 1
  const boundOf = text => text.replace(/^port (.*)$/, (_, name) => `port ${groupOf(name)}`);
  const {stats, bounds, recording} = run;
  const bound = Object.fromEntries(Object.entries(stats.bound).map(
      ([name, value]) => [name, typeof value === 'string' ? boundOf(value) : value]));
  return {
    ...run,
    stats: {
      ...stats,
      bound,
      ports: meanOf(stats.ports, ['name']),
      blame: meanOf(stats.blame, ['port', 'bank', 'by'])
    },
    bounds: {
      ...bounds,
      core: bounds.core.map(
          resources => resources.map(each => ({...each, resource: boundOf(each.resource)})))
    },
    recording: recording && {
      ...recording,
      rows: {
        ...recording.rows,
        accesses: merged(renamed(recording.rows.accesses), ['bank', 'by'], () => 1)
      },
      stalls: meanOf(recording.stalls, ['port', 'bank', 'by'])
    }
  };
}

// What the page says of the lanes of a run, and a link to the other view. null: there is one lane a side.
export function laneNote(run) {
  const lanes = lanesOf(run);
  if (lanes === 1) return null;
  const isEvery = location.hash === kEveryLane;
  return h(
      'p', {class: 'note', id: 'lanes'},
      isEvery ? `Each of the ${lanes} lanes of a side has its own ports. ` :
                `The ports of the ${lanes} lanes of a side are one row, with the mean of the lanes. `,
      h('a', {href: isEvery ? '#' : kEveryLane}, isEvery ? 'One row for all lanes' : 'Every lane'));
}
