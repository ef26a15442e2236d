// What a recording holds (README.md), as the charts ask for it.
import {bankText, sum} from './format.js';

// The rows of a table {names, rows} as objects.
export const objectsOf = ({names, rows}) =>
    rows.map(row => Object.fromEntries(names.map((name, i) => [name, row[i]])));

// The lines of tiles of a recording, from top to bottom, each of `height` rows of results. Values are sums
// over all frames: {frames, lines, height, cycles, fill, accesses: [{bank, by, values, fill}], stalls:
// [{port, bank, by, values, fill, total}]}. `fill`: the sum before the first line. null without a recording.
export function linesOf({recording}) {
  if (!recording) return null;
  const {frames, rows: {lines, height, cycles, accesses}, stalls} = recording;
  const split = ([fill, ...values]) => ({fill, values, total: fill + sum(values)});
  const all = split(cycles);
  return {
    frames,
    lines,
    height,
    cycles: all.values,
    fill: all.fill,
    accesses: accesses.map(({bank, by, accesses: column}) => ({bank, by, ...split(column)})),
    stalls: stalls.map(({port, bank, by, rows}) => ({port, bank, by, ...split(rows)}))
                .sort((a, b) => b.total - a.total)
  };
}

// The last row of a line, and the rows of lines `from` to `to` - 1, as text.
export const lastRow = ({height}, line, imageHeight) => Math.min((line + 1) * height, imageHeight) - 1;
export function rowsText(recorded, from, to, imageHeight) {
  const [first, last] = [from * recorded.height, lastRow(recorded, to - 1, imageHeight)];
  return last === first ? `row ${last}` : `rows ${first} to ${last}`;
}

// Maps of the waits over the picture, the most first: {name, values, columns, rows, width, height}. The
// latter two are the size of a tile in pixels.
export function tilesOf({recording}) {
  if (!recording) return [];
  const {tiles} = recording;
  const maps = recording.stalls.map(
      ({port, bank, by, tiles: values}) =>
          ({...tiles, name: `${port} on ${bankText(bank)} for ${by}`, values, total: sum(values)}));
  const some = maps.filter(({total}) => total > 0).sort((a, b) => b.total - a.total);
  if (some.length < 2) return some;
  const all = some[0].values.map((_, tile) => sum(some.map(({values}) => values[tile])));
  return [{...tiles, name: 'all waits', values: all, total: sum(all)}, ...some];
}
