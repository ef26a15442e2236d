// The scales and the colours of a scatter.
import {brief, value} from './format.js';
import {linear, logarithmic, ordinal} from './scale.js';
import {css, heat, nthColour, styleColour} from './theme.js';

export const kMostColours = 8;  // names with a colour of their own

export function scaleOf(points, axis, range) {
  const values = points.column(axis.name);
  if (!points.isNumeric(axis.name)) return ordinal([...new Set(values.map(value))].sort(), range);
  const numbers = values.filter(each => each !== null);
  const low = numbers.reduce((a, b) => Math.min(a, b), Infinity);
  const high = numbers.reduce((a, b) => Math.max(a, b), -Infinity);
  const room = (high - low) * 0.03;
  return axis.log && low > 0 ? logarithmic([low / 1.05, high * 1.05], range) :
                               linear([low - room, high + room], range);
}

// The line around what a front beats, from the best x on: steps between its points, and on to the edges of the
// drawing. `spots`: places of the points; `edges`: the worst x and y.
export function stepsOf(spots, edges) {
  if (spots.length === 0) return [];
  const worse = edges.map(edge => edge === 0 ? Math.min : Math.max);
  return spots
      .flatMap((spot, i) => {
        const before = spots[i - 1] ?? [spot[0], edges[1]];
        return [worse.map((worst, axis) => worst(before[axis], spot[axis])), spot];
      })
      .concat([[edges[0], spots.at(-1)[1]]]);
}

// The colour of each point: [function of a row, entries of the legend].
export function coloursOf(points, name) {
  if (!name) return [() => styleColour('--blue'), []];
  const values = points.column(name);
  const words =
      [...new Set(values)].sort((a, b) => typeof a === 'number' ? a - b : value(a).localeCompare(value(b)));
  if (words.length <= kMostColours) {
    const colours = new Map(words.map((word, i) => [word, styleColour(nthColour(i))]));
    return [row => colours.get(values[row]), words.map(word => [value(word), colours.get(word)])];
  }
  if (!points.isNumeric(name))
    return [() => styleColour('--blue'), [[`more than ${kMostColours} values`, styleColour('--blue')]]];
  const [low, high] = [words[0], words.at(-1)];
  const stops = Array.from({length: 32}, (_, i) => css(heat(0.2 + 0.8 * i / 31)));
  return [
    row => stops[Math.round((values[row] - low) / (high - low) * 31)],
    [[brief(low), stops[0]], [brief(high), stops[31]]]
  ];
}
