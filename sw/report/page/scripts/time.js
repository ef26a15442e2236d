// When things happen in the computer: the time line of captures, transfers, frames of the core, waits and
// drops, and how long a frame takes from its first pixel to its results on the host.
import {drawColumns} from './bars.js';
import {addChart, addLeftOut, htmlTable, legend} from './card.js';
import {objectsOf} from './data.js';
import {s} from './dom.js';
import {droppedText, settingOf} from './findings.js';
import {count, fixed, inMs, kPsOfMs, percent, sum, whole} from './format.js';
import {addBrush, axisBelow, cut, drawing, numeric, Zoom} from './plot.js';
import {mark} from './tooltip.js';

const kFirstFrames = 6;
const kMostMarks = 1500;
const kLeastPs = 1000;
const kLine = 34;

// Of each kind of event: its colour and its name.
const kKinds = {
  capture: ['--blue', 'capture'],
  upload: ['--sky', 'upload to the board'],
  frame: ['--vermilion', 'core'],
  read_back: ['--green', 'read-back'],
  interrupt: ['--purple', 'interrupt']
};
const kLanes = ['left camera', 'right camera', 'upload', 'pairs wait', 'core', 'read-back', 'interrupts'];

// The lane of an event.
const laneOf = (kind, what) => ({
  capture: `${what} camera`,
  drop: `${what} camera`,
  upload: 'upload',
  frame: 'core',
  read_back: 'read-back',
  interrupt: 'interrupts',
  wait: {ring: 'upload', pair: 'pairs wait', core: 'core', result: 'read-back'}[what]
})[kind];

const kWaits = {
  ring: 'A pair waits in host memory',
  pair: 'A pair waits on the board',
  core: 'The core waits',
  result: 'A result waits'
};
const kWhy = {
  'ring copy': 'the pair before is copied to the board',
  'ring input_buffer': 'no input buffer is free',
  'pair core': 'the core works on the frame before',
  'pair output_buffer': 'no output buffer is free',
  'core upload': 'the tables are uploaded',
  'core camera': 'a capture begins with the next frame of the camera',
  'core capture': 'the capture of the next pair runs',
  'core copy': 'its pair is copied to the board',
  'core output_buffer': 'no output buffer is free',
  'result read_back': 'the result before is read back',
  'drop not_armed': 'the capture board was not armed',
  'drop busy': 'the capture before had not ended',
  'drop partner': 'the other camera lost this frame'
};
const whyText = (who, why) => kWhy[`${who} ${why}`] ?? 'the driver works: register accesses and interrupts';

const kHardly = 0.001;  // of the time of a run that the core waits: not worth its reasons

// How long the core waits and why, in words: {title, note}. `early`: the wait before its first frame, in ps.
function coreWaits(run, span, early) {
  const waits = run.recording.waits.filter(wait => wait.class === 'core').sort((a, b) => b.ps - a.ps);
  const all = sum(waits.map(wait => wait.ps));
  if (all <= kHardly * span) return {title: ', and hardly waits', note: null};
  const [most, ...others] =
      waits.filter((wait, i) => i === 0 || wait.ps > kHardly * span)
          .slice(0, 3)
          .map(wait => `${percent(wait.ps / span)} because ${whyText('core', wait.why)}`);
  const ms = ps => inMs(ps, ps < 0.1 * kPsOfMs ? 2 : 1);
  return {
    title: `, and waits ${most}`,
    note: `The core waits ${ms(early)} before its first frame, and ${ms(all - early)} later${
        others.length ? `; ${others.join(', and ')}` : ''}.`
  };
}

// event: {kind, class, frame, camera_frame, start_ps, end_ps, dropped_pixels, why, lane}.
function titleOf({kind, class: what, frame, camera_frame: cameraFrame}) {
  if (kind === 'wait') return `${kWaits[what]}${frame >= 0 ? ` (frame ${frame})` : ''}`;
  if (kind === 'drop') return `Camera frame ${cameraFrame} of the ${what} camera is dropped`;
  const part = {strobe: ': start', pipeline: ': last registers'}[what] ?? '';
  const of = frame >= 0 ? ` of frame ${frame}` : kind === 'upload' ? ` of ${what}` : '';
  return `${kKinds[kind][1]}${part}${of}`;
}

function linesOfEvent(event) {
  const {kind, class: what, start_ps: start, end_ps: end, dropped_pixels: lost, why} = event;
  return [
    titleOf(event),
    end > start ? `${fixed(start / kPsOfMs, 3)} to ${inMs(end, 3)}: ${inMs(end - start, 3)}` :
                  `at ${inMs(start, 3)}`,
    lost > 0 && `${whole(lost)} pixels are lost: the FIFO was full`,
    ['wait', 'drop'].includes(kind) && whyText(kind === 'drop' ? 'drop' : what, why)
  ].filter(Boolean);
}

// The mark of an event between two places of its lane, which begins at y, and the number of its frame.
function shapesOf(event, x0, x1, y) {
  const {kind, frame, dropped_pixels: lost} = event;
  const bar = (above, height, least, attributes) =>
      s('rect', {x: x0, y: y + above, width: Math.max(least, x1 - x0), height, ...attributes});
  const shape = kind === 'wait' ? bar(13, 8, 1, {class: 'waiting'}) :
      kind === 'drop'           ? s('path', {d: `M${x0 - 4},${y + 13}l8,8m0,-8l-8,8`, class: 'cross'}) :
                                  bar(7, 20, 1.5, {
                                    rx: Math.min(2, (x1 - x0) / 2),
                                    class: lost > 0 && 'loses',
                                    style: `fill:var(${kKinds[kind][0]})`
                        });
  const isNumbered = kind in kKinds && frame >= 0 && x1 - x0 > 24;
  return [
    mark(shape, linesOfEvent(event)),
    isNumbered &&
        s('text', {x: (x0 + x1) / 2, y: y + 21, 'text-anchor': 'middle', class: 'on-bar'}, String(frame))
  ].filter(Boolean);
}

// The time line of a part of the run.
export function addTimeLine(page, run) {
  if (!run.recording) return addLeftOut(page, 'time', 'Time line of captures, core and read-backs');
  const recorded = run.recording.events;
  const events = objectsOf(recorded).map(event => ({...event, lane: laneOf(event.kind, event.class)}));
  const lanes = kLanes.filter(lane => events.some(event => event.lane === lane));
  const last = Math.max(...events.map(event => event.end_ps));
  const begin = Math.min(...events.filter(({kind}) => kind === 'capture').map(event => event.start_ps), last);
  const early = Math.max(
      ...events.filter(({frame}) => frame >= 0 && frame < kFirstFrames).map(event => event.end_ps), 1);

  const draw = (host, width) => {
    const left = Math.min(100, width * 0.26);
    const {plot, width: inner, height} =
        drawing(host, width, lanes.length * kLine + 46, {left, right: 8, bottom: 40}, 'Time line');
    const x = numeric([zoom.from / kPsOfMs, zoom.to / kPsOfMs], [0, inner]);
    const atPs = ps => Math.max(0, Math.min(inner, x(ps / kPsOfMs)));
    const digits = Math.max(0, Math.ceil(1 - Math.log10((zoom.to - zoom.from) / kPsOfMs / 5)));
    plot.append(axisBelow(x, inner, height, 'ms since power-up', tick => fixed(tick, digits)));
    addBrush(plot, {
      axis: 'x',
      width: inner,
      height,
      end: box => box && zoom.set(kPsOfMs * x.invert(box.x0), kPsOfMs * x.invert(box.x1))
    });
    lanes.forEach(
        (name, line) =>
            plot.append(s('text', {x: -8, y: line * kLine + 21, 'text-anchor': 'end'}, cut(name, left - 8))));
    // Where the page has no events.
    let known = 0;
    for (const [from, to] of [...recorded.periods_ps, [last, last]]) {
      if (from > known && atPs(from) > atPs(known)) {
        const place = {x: atPs(known), y: 0, width: atPs(from) - atPs(known), height};
        plot.append(mark(
            s('rect', {...place, class: 'left-out'}),
            ['Events of this time are not in the page', 'timeline.csv of the run has them']));
      }
      known = Math.max(known, to);
    }
    const inWindow = events.filter(({start_ps: start, end_ps: end}) => end >= zoom.from && start <= zoom.to);
    // Of many events those are left out that would lie on others.
    const gap = inWindow.length > kMostMarks ? 1 : -Infinity;
    const drawnTo = new Map();  // of a lane and kind, in pixels
    for (const event of inWindow) {
      const {kind, lane} = event;
      const [x0, x1] = [atPs(event.start_ps), atPs(event.end_ps)];
      if (x1 < (drawnTo.get(lane + kind) ?? -Infinity) + (kind === 'drop' ? 8 * gap : gap)) continue;
      drawnTo.set(lane + kind, x1);
      if (kind === 'wait' && event.end_ps === event.start_ps) continue;
      plot.append(...shapesOf(event, x0, x1, lanes.indexOf(lane) * kLine));
    }
  };
  const zoom = new Zoom(
      {last, least: kLeastPs, step: 0.5, from: Math.min(begin, early), to: early},
      [['◀', 'Earlier'], ['▶', 'Later'], 'All'], () => chart.redraw());
  const {frames} = run.recording;
  const works = sum(run.recording.rows.cycles) / settingOf(run, 'fpga.clock_mhz') * 1e6 / last;
  const drops = run.stats.cameras[0].dropped_frames;
  const firstFrame = Math.min(...events.filter(({kind}) => kind === 'frame').map(event => event.start_ps));
  const before = events.filter(
      ({kind, class: what, end_ps: end}) => kind === 'wait' && what === 'core' && end <= firstFrame);
  const waits = coreWaits(run, last, sum(before.map(event => event.end_ps - event.start_ps)));
  const chart = addChart(page, {
    id: 'time',
    wide: true,
    draw,
    title: `The core works ${percent(works)} of the time${waits.title}`,
    note: [
      waits.note, drops > 0 && `${droppedText(run)} Crosses: dropped frames.`,
      'The number in a bar is the frame; thin grey bars are waits. Drag to choose the time that is shown.',
      frames < run.stats.frames && `The first ${frames} of ${count(run.stats.frames, 'frame')} are recorded.`,
      recorded.all > recorded.rows.length &&
          `The page has ${whole(recorded.rows.length)} of ${
              whole(recorded.all)} events: those of the beginning, of ` +
              'the slowest frame and of the end.'
    ].filter(Boolean)
              .join(' '),
    body: [
      zoom.controls, legend([
        ...Object.entries(kKinds)
            .filter(([name]) => events.some(({kind}) => kind === name))
            .map(([, [colour, name]]) => [name, `var(${colour})`]),
        ['waits', 'var(--faint)'],
        ...events.some(event => event.dropped_pixels > 0) ? [['loses pixels', 'var(--bad)']] : []
      ])
    ],
    numbers: () => [recorded.names, recorded.rows]
  });
}

// Columns of latency.csv that are parts of it. The second of each is shown with the first.
const kParts = [
  [['capture_ps'], 'capture', '--blue'],
  [['wait_copy_ps'], 'waiting for the copy', '--pale'],
  [['copy_ps'], 'copy to the board', '--sky'],
  [['wait_core_ps'], 'waiting for the core', '--pale-blue'],
  [['core_ps'], 'core', '--vermilion'],
  [['wait_read_back_ps'], 'waiting for the read-back', '--faint'],
  [['read_back_ps', 'delivery_ps'], 'read-back', '--green'],
];
const kWaitParts = ['wait_copy_ps', 'wait_core_ps', 'wait_read_back_ps'];

function addPercentiles(page, latency) {
  const table =
      [['percentile', 'ms'], ['min', 'p50', 'p95', 'p99', 'max'].map(name => [name, latency[name]])];
  addChart(page, {
    id: 'latency',
    title: `Half of the results are ${fixed(latency.p50, 1)} ms old when they arrive, the oldest ${
        fixed(latency.max, 1)} ms`,
    body: htmlTable(...table),
    note:
        'From the first pixel of a capture to the results on the host. What of it is waiting was not ' +
        'recorded.',
    numbers: () => table
  });
}

export function addLatency(page, run) {
  const percentiles = run.stats.latency_ms?.capture_to_host;
  if (!percentiles) return;
  if (!run.recording) return addPercentiles(page, percentiles);
  const {names, rows, all, means_ps: means} = run.recording.latency;
  const msOf = (parts, frame) => sum(parts.map(name => frame[name])) / kPsOfMs;
  const parts = kParts.filter(([columns]) => columns.some(name => means[name] > 0));
  const barOf = frame => ({
    parts: parts.map(([columns, , colour]) => [msOf(columns, frame), colour]),
    lines: [
      `frame ${frame.frame}: ${fixed(msOf(['latency_ps'], frame), 3)} ms`,
      ...parts.map(([columns, text]) => `${text}: ${fixed(msOf(columns, frame), 3)} ms`)
    ]
  });
  const waiting = sum(kWaitParts.map(name => means[name])) / means.latency_ps;
  addChart(page, {
    id: 'latency',
    wide: true,
    draw: (host, width) => drawColumns(host, width, {
      groups: objectsOf({names, rows}).map(frame => [barOf(frame)]),
      label: 'Latency of each frame',
      unit: 'ms',
      below: `${count(rows.length, 'frame')}${rows.length < all ? ` of ${all}` : ''}, the quickest first`
    }),
    title: `Of the mean ${inMs(means.latency_ps, 1)} from capture to host, ${percent(waiting, 0)} is waiting`,
    note:
        'One bar for each delivered frame, from the first pixel of the capture to the results on the host. ' +
        `Half of the frames take at most ${fixed(percentiles.p50, 1)} ms, 95 % at most ${
            fixed(percentiles.p95, 1)}, the slowest ${fixed(percentiles.max, 1)}.`,
    body: legend(parts.map(([, text, colour]) => [text, `var(${colour})`])),
    numbers: () => [names, rows]
  });
}
