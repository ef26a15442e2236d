// What a recording holds, unpacked: sums over all frames of what `run --record` writes.
import {sum} from './format.js';
import {unpack} from './table.js';

const known = new WeakMap();

// The lines of the picture from top to bottom, each of `height` rows:
// {frames, lines, height, cycles, fill, accesses: [{bank, by, values, fill}], stalls: [{port, bank, by, values,
// fill, total}]}. `fill` is before the first line. null without a recording.
export function linesOf({recording}) {
  if (!recording) return null;
  if (known.has(recording)) return known.get(recording);
  const {frames, rows: {lines, height, cycles, accesses}, stalls} = recording;
  const split = column => {
    const [fill, ...values] = unpack(column, lines + 1);
    return {fill, values, total: fill + sum(values)};
  };
  const all = split(cycles);
  known.set(recording, {
    frames,
    lines,
    height,
    cycles: all.values,
    fill: all.fill,
    accesses: accesses.map(({bank, by, accesses: column}) => ({bank, by, ...split(column)})),
    stalls: stalls.map(({port, bank, by, rows}) => ({port, bank, by, ...split(rows)}))
                .sort((a, b) => b.total - a.total)
  });
  return known.get(recording);
}

// The rows of lines `from` to `to` - 1, as text.
export function rowsText({height}, from, to, imageHeight) {
  const last = Math.min(to * height, imageHeight) - 1;
  return last === from * height ? `row ${last}` : `rows ${from * height} to ${last}`;
}

// Maps of the waits over the picture, the most first: {name, values, columns, rows, width, height}. The
// latter two are the size of a tile in pixels.
export function tilesOf({recording}) {
  if (!recording) return [];
  const {tiles} = recording;
  const maps = recording.stalls.map(({port, bank, by, tiles: column}) => {
    const values = unpack(column, tiles.columns * tiles.rows);
    return {...tiles, name: `${port} on ${bank} for ${by}`, values, total: sum(values)};
  });
  const some = maps.filter(({total}) => total > 0).sort((a, b) => b.total - a.total);
  if (some.length < 2) return some;
  const all = some[0].values.map((_, tile) => sum(some.map(({values}) => values[tile])));
  return [{...tiles, name: 'all waits', values: all, total: sum(all)}, ...some];
}
