// The page of two runs: what differs in B.
import {addAnswers, addChart, addGroup, addHead, htmlTable} from './card.js';
import {commandLine} from './dom.js';
import {headlineOf, kindOfRate, lostPixels, settingOf, waitsOf, waitText} from './findings.js';
import {count, fixed, gainText, grouped, lossText, rateWith, shortened, sum, whole} from './format.js';
import {laneNote, withFoldedLanes} from './lanes.js';
import {addFrames, addPortStates} from './limits.js';
import {addMemory} from './memory.js';
import {addPicture} from './picture.js';
import {kRateColumns} from './points.js';
import {addBlameDifference, addRowDifference} from './waits.js';

// Settings that differ: [key, value in A, value in B]. The name of the board is the last.
const settingsOf = ({settings}) =>
    settings.map(({path, banks, a = banks ?? '–', b = banks ? '' : '–'}) => [path, a, b])
        .sort(([x], [y]) => (x === 'name') - (y === 'name'));

function addTotals(page, {figures}, loss) {
  const rows = figures.filter(({a, b}) => typeof a === 'number' && typeof b === 'number')
                   .filter(({a, b}) => Number.isInteger(a + b) || a.toPrecision(6) !== b.toPrecision(6))
                   .map(({path, a, b}) => [path + (kRateColumns.includes(path) ? loss : ''), a, b, b - a]);
  addChart(page, {
    id: 'totals',
    title: rows.length ?
        `${count(rows.length, 'figure')} of stats.json differ${rows.length === 1 ? 's' : ''}` :
        'All figures are the same',
    note: 'Only figures that differ are listed.',
    body: htmlTable(['figure', 'A', 'B', 'B − A'], rows.map(row => row.map(shortened))),
    numbers: () => [['figure', 'a', 'b', 'difference'], rows]
  });
}

// How the disparities of the runs differ.
function pixelText({disparities: {not_compared: reason, ...pixels}}) {
  if (reason) return `not compared: ${reason}`;
  if (pixels.frames === 0) return 'not compared: no camera frame was computed by both runs';
  if (pixels.pixels_that_differ === 0)
    return `the same, pixel for pixel, in ${count(pixels.frames, 'frame')}`;
  return `${whole(pixels.pixels_that_differ)} differ, in ${pixels.frames_that_differ} of ${
             count(pixels.frames, 'frame')}; the first ` +
      `in column ${pixels.first.column}, row ${pixels.first.row} of camera frame ${
             pixels.first.camera_frame}`;
}

// What differs in B for the user, the most important first.
function headlineOfTwo(a, b) {
  const [name, kind] = kindOfRate(a, b);
  const [before, after] = [a, b].map(run => run.stats.frames_per_second[name]);
  const opens = [a, b].map(run => run.stats.frames_per_second[`${name}_uncertainty`] ?? 0);
  const [textA, textB] = [rateWith(before, opens[0]), rateWith(after, opens[1])];
  const isTie = textA !== textB && Math.abs(after - before) <= sum(opens);
  const [lostA, lostB] = [a, b].map(lostPixels);
  const now = `${textB} frames/s, ${kind}${lossText(lostB)}`;
  const isSame = (isTie || textA === textB) && lostA === lostB;
  const rates = isSame ?
      `The same ${now}${isTie ? ', within the uncertainty' : ''}` :
      `${now}, instead of ${textA}${lossText(lostA)} (${isTie ? '≈ 0' : gainText(after / before - 1)})`;
  const noun = name => number => count(number, name);
  const others =
      [
        [run => run.banks_used, noun('bank')], [run => run.pins, noun('pin')],
        [run => run.area.slices, noun('slice')], [run => run.area.block_rams, noun('block RAM')],
        [run => run.area.multipliers, noun('multiplier')],
        [run => run.stats.latency_ms?.capture_to_host.p50, ms => `${fixed(ms, 1)} ms of latency`]
      ].filter(([of]) => of(a) !== undefined && of(b) !== undefined)
          .map(([of, text]) => [text(of(a)), text(of(b))])
          .filter(([x, y]) => x !== y)
          .map(([x, y]) => `${y} instead of ${x.split(' ')[0]}`);
  if (isSame && others.length === 0) return `${rates}, with the same banks, pins and area`;
  return [rates, others.join(', ')].filter(Boolean).join(', with ');
}

const changeText = ([key, x, y]) => `${key}: ${x}${y === '' ? '' : ` → ${y}`}`;

// Amounts of rows as a map over the picture.
const layerOf = (cycles, width) =>
    ({name: 'B, by row', values: cycles, columns: 1, rows: cycles.length, width, height: 1});

export function showTwoRuns(page, {runs, difference}) {
  const [a, b] = runs.map(withFoldedLanes);
  const settings = settingsOf(difference);
  const isSame = difference.disparities.frames > 0 && difference.disparities.pixels_that_differ === 0;
  const blame = run => waitsOf(run).length ? `${waitText(waitsOf(run)[0])}.` : 'Nobody.';
  addHead(page, {
    kind: 'two runs',
    name: `A ${a.folder} · B ${b.folder}`,
    headline: headlineOfTwo(a, b),
    sub: [runs.map(laneNote).find(Boolean), commandLine(a.command), commandLine(b.command)]
  });
  const {rows} = difference;
  addAnswers(page, [
    [
      'What was changed?',
      settings.length ? settings.slice(0, 4)
                            .map(changeText)
                            .concat(settings.length > 4 ? `and ${settings.length - 4} more` : []) :
                                                          ['Nothing on the board.']
    ],
    [
      'Which is faster, and why?',
      [grouped(difference.verdict), !isSame && `Disparities: ${pixelText(difference)}.`]
    ],
    ['Who waits for whom?', [`A: ${blame(a)}`, `B: ${blame(b)}`]],
    [
      'Where do they part?',
      [rows.not_compared ? `Rows cannot be compared: ${rows.not_compared}.` :
           rows.parting ? `In frame ${rows.parting.frame}, row ${rows.parting.row}.` :
                          'Nowhere.']
    ],
    ['How near are their bounds?', [`A: ${headlineOf(a)}.`, `B: ${headlineOf(b)}.`]]
  ]);

  const where = addGroup(page, 'Where and when');
  addRowDifference(where, difference);
  if (a.pictures && b.pictures) {
    addPicture(where, {
      title: `Disparities of A and B: ${pixelText(difference)}`,
      note: (difference.camera_frame === undefined ?
                 'The last frame of each run, because no camera frame was computed by both.' :
                 `Camera frame ${difference.camera_frame} in both.`) +
          ' With the rows that take longer in B.',
      pictures: [a, b].map(({pictures: {disparity, disparities}}) => ({url: disparity, disparities})),
      names: ['A', 'B'],
      frames: rows.frames,
      layers: rows.cycles?.some(value => value > 0) ? [layerOf(rows.cycles, settingOf(b, 'image.width'))] : []
    });
  }
  addFrames(
      where, [['A', a.stats.frame_cycles, '--blue'], ['B', b.stats.frame_cycles, '--vermilion']],
      settingOf(a, 'fpga.clock_mhz'));
  addBlameDifference(where, a, b);
  addMemory(where, [a, b]);

  const ports = addGroup(page, 'The ports');
  addPortStates(ports, a, 'A');
  addPortStates(ports, b, 'B');
  const figures = addGroup(page, 'The figures');
  addChart(figures, {
    id: 'settings',
    title: settings.length ?
        `${count(settings.length, 'difference')} between the boards` :
        'The boards are the same',
    body: settings.length > 0 && htmlTable(['key', 'A', 'B'], settings),
    numbers: () => [['key', 'a', 'b'], settings]
  });
  addTotals(figures, difference, lossText(lostPixels(a) + lostPixels(b) > 0));
}
