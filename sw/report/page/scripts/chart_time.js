// The time line of the computer: captures, transfers, frames of the core, waits and drops, in a window that is
// chosen in an overview of the whole run.
import {addBrush} from './brush.js';
import {addChart, cut, drawing, legend} from './chart.js';
import {h, s} from './dom.js';
import {droppedText, settingOf} from './findings.js';
import {count, fixed, kPsOfMs, percent, sum, whole} from './format.js';
import {axisBelow, linear} from './scale.js';
import {Table, unpack} from './table.js';
import {mark} from './tooltip.js';

const kFirstFrames = 6;
const kMostMarks = 1500;
const kLine = 34;
const kOverviewLine = 9;

const kColours = {
  capture: '--blue',
  upload: '--sky',
  frame: '--vermilion',
  read_back: '--green',
  drop: '--grey',
  interrupt: '--purple'
};
const kNames = {
  capture: 'capture',
  upload: 'upload to the board',
  frame: 'core',
  read_back: 'read-back',
  drop: 'camera frame dropped',
  interrupt: 'interrupt'
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
const kFewLater = 0.1;  // of its waits that are after the beginning of its first frame

// How long the core waits and why, in words: {title, note}. `early`: what of it is before its first frame, in ps.
function coreWaits(run, span, early) {
  const waits = run.recording.waits.filter(wait => wait.class === 'core').sort((a, b) => b.ps - a.ps);
  const all = sum(waits.map(wait => wait.ps));
  const reasons = textOf => waits.filter((wait, i) => i === 0 || wait.ps > kHardly * span)
                                .slice(0, 3)
                                .map(wait => `${textOf(wait.ps)} because ${whyText('core', wait.why)}`);
  const ms = ps => `${fixed(ps / kPsOfMs, ps < 0.1 * kPsOfMs ? 2 : 1)} ms`;
  if (all <= kHardly * span) return {title: ', and hardly waits', note: null};
  if (all - early <= kFewLater * all) {
    const later = all === early       ? 'then never' :
        all - early < 0.005 * kPsOfMs ? 'then hardly ever' :
                                        `later ${ms(all - early)} in all`;
    return {
      title: `; it waits ${ms(early)} before its first frame, ${later}`,
      note: `All in all the core waits ${reasons(ms).join(', ')}.`
    };
  }
  const [most, ...others] = reasons(ps => percent(ps / span));
  return {
    title: most ? `, and waits ${most}` : '',
    note: others.length ? `It also waits ${others.join(', and ')}.` : null
  };
}

export function addTimeLine(page, run) {
  if (!run.recording) {
    addChart(page, {
      id: 'time',
      title: 'Time line of captures, core and read-backs',
      note: 'Left out by --quick, because the run was not recorded.'
    });
    return;
  }
  const {events, overview} = run.recording;
  const table = new Table(events.columns, events.rows);
  const [kind, what, frame, cameraFrame, start, end, lost, why] = [
    'kind', 'class', 'frame', 'camera_frame', 'start_ps', 'end_ps', 'dropped_pixels', 'why'
  ].map(name => table.column(name));
  const lane = kind.map((each, i) => laneOf(each, what[i]));
  const lanes = kLanes.filter(each => lane.includes(each));
  const last = overview.end_ps;
  const isCapture = kind.map(each => each === 'capture');
  const begin = Math.min(...start.filter((_, i) => isCapture[i]), last);
  const early = Math.max(...end.filter((_, i) => frame[i] >= 0 && frame[i] < kFirstFrames), 1);
  const state = {from: Math.min(begin, early), to: early};

  const titleOf = i => {
    if (kind[i] === 'wait') return `${kWaits[what[i]]}${frame[i] >= 0 ? ` (frame ${frame[i]})` : ''}`;
    if (kind[i] === 'drop') return `Camera frame ${cameraFrame[i]} of the ${what[i]} camera is dropped`;
    const part = {strobe: ': start', pipeline: ': last registers'}[what[i]] ?? '';
    const of = frame[i] >= 0 ? ` of frame ${frame[i]}` : kind[i] === 'upload' ? ` of ${what[i]}` : '';
    return `${kNames[kind[i]]}${part}${of}`;
  };
  const linesOfEvent =
      i => [titleOf(i),
            end[i] > start[i] ? `${fixed(start[i] / kPsOfMs, 3)} to ${fixed(end[i] / kPsOfMs, 3)} ms: ${
                                    fixed((end[i] - start[i]) / kPsOfMs, 3)} ms` :
                                `at ${fixed(start[i] / kPsOfMs, 3)} ms`,
            lost[i] > 0 && `${whole(lost[i])} pixels are lost: the FIFO was full`,
            ['wait', 'drop'].includes(kind[i]) && whyText(kind[i] === 'drop' ? 'drop' : what[i], why[i])]
               .filter(Boolean);

  const drawOverview = (plot, inner) => {
    const x = linear([0, last], [0, inner]);
    lanes.forEach((name, line) => overview.lanes.forEach(({kind: its, class: side, amounts}) => {
      if (laneOf(its, side) !== name) return;
      const isDrop = its === 'drop';
      unpack(amounts, overview.bins).forEach((amount, bin) => {
        if (amount === 0) return;
        plot.append(s('rect', {
          x: bin / overview.bins * inner,
          y: line * kOverviewLine + (isDrop ? 5 : 1),
          width: inner / overview.bins + 0.3,
          height: isDrop ? 2 : 7,
          style: `fill:var(${isDrop ? '--ink' : kColours[its]});fill-opacity:${
              isDrop ? 1 : 0.15 + 0.85 * Math.min(1, amount / 100)}`
        }));
      });
    }));
    const height = lanes.length * kOverviewLine;
    plot.append(s('rect', {
      x: x(state.from),
      y: -1,
      width: Math.max(2, x(state.to) - x(state.from)),
      height: height + 2,
      class: 'window'
    }));
    addBrush(plot, {
      axis: 'x',
      width: inner,
      height,
      end: (box, event) => {
        if (box) return zoom(x.invert(box.x0), x.invert(box.x1));
        const at = event.target.getBoundingClientRect();
        const middle = x.invert((event.clientX - at.left) / at.width * inner);
        zoom(middle - (state.to - state.from) / 2, middle + (state.to - state.from) / 2);
      }
    });
  };

  const draw = (host, width) => {
    const left = Math.min(100, width * 0.26);
    const top = lanes.length * kOverviewLine + 34;
    const {svg, plot, width: inner, height} =
        drawing(host, width, top + lanes.length * kLine + 46, {left, right: 8, top, bottom: 40}, 'Time line');
    const above = s('g', {transform: `translate(${left} 16)`});
    svg.append(above);
    above.append(s('text', {x: -8, y: 12, 'text-anchor': 'end', class: 'label'}, 'whole run'));
    above.append(
        s('text', {x: inner, y: -5, 'text-anchor': 'end', class: 'label'},
          `0 to ${fixed(last / kPsOfMs, 0)} ms; below: the window`));
    drawOverview(above, inner);
    const x = linear([state.from / kPsOfMs, state.to / kPsOfMs], [0, inner]);
    const atPs = ps => Math.max(0, Math.min(inner, x(ps / kPsOfMs)));
    const span = (state.to - state.from) / kPsOfMs;
    plot.append(axisBelow(
        x, inner, height, 'ms since power-up',
        {text: tick => fixed(tick, Math.max(0, Math.ceil(1 - Math.log10(span / 5))))}));
    addBrush(plot, {
      axis: 'x',
      width: inner,
      height,
      end: box => box && zoom(kPsOfMs * x.invert(box.x0), kPsOfMs * x.invert(box.x1))
    });
    lanes.forEach(
        (name, line) =>
            plot.append(s('text', {x: -8, y: line * kLine + 21, 'text-anchor': 'end'}, cut(name, left - 8))));
    // Where the page has no events.
    let known = 0;
    for (const [from, to] of [...events.periods_ps, [last, last]]) {
      if (from > known && atPs(from) > atPs(known))
        plot.append(mark(
            s('rect', {x: atPs(known), y: 0, width: atPs(from) - atPs(known), height, class: 'left-out'}),
            ['Events of this time are not in the page', 'run --record --out writes all to timeline.csv']));
      known = to;
    }
    const inWindow = kind.map((_, i) => i).filter(i => end[i] >= state.from && start[i] <= state.to);
    // Of many events those are left out that would lie on others.
    const gap = inWindow.length > kMostMarks ? 1 : -Infinity;
    const drawnTo = new Map();  // of a lane and kind, in pixels
    for (const i of inWindow) {
      const place = `${lane[i]} ${kind[i]}`;
      const far = kind[i] === 'drop' ? 8 * gap : gap;
      if (atPs(end[i]) < (drawnTo.get(place) ?? -Infinity) + far) continue;
      drawnTo.set(place, atPs(end[i]));
      const y = lanes.indexOf(lane[i]) * kLine;
      const [x0, x1] = [atPs(start[i]), atPs(end[i])];
      if (kind[i] === 'wait') {
        if (end[i] > start[i])
          plot.append(mark(
              s('rect', {x: x0, y: y + 13, width: Math.max(1, x1 - x0), height: 8, class: 'waiting'}),
              linesOfEvent(i)));
        continue;
      }
      const shape = kind[i] === 'drop' ?
          s('path', {d: `M${x0 - 4},${y + 13}l8,8m0,-8l-8,8`, class: 'cross', style: 'stroke:var(--ink)'}) :
          s('rect', {
            x: x0,
            y: y + 7,
            width: Math.max(1.5, x1 - x0),
            height: 20,
            rx: Math.min(2, (x1 - x0) / 2),
            style: `fill:var(${kColours[kind[i]]})${lost[i] > 0 ? ';stroke:var(--bad);stroke-width:2.5' : ''}`
          });
      plot.append(mark(shape, linesOfEvent(i)));
      if (frame[i] >= 0 && x1 - x0 > 24)
        plot.append(
            s('text', {x: (x0 + x1) / 2, y: y + 21, 'text-anchor': 'middle', class: 'on-bar'},
              String(frame[i])));
    }
  };
  const zoom = (from, to) => {
    const size = Math.max(1000, Math.min(last, to - from));
    state.from = Math.max(0, Math.min(last - size, from));
    state.to = state.from + size;
    chart.redraw();
  };
  const button = (label, name, from, to) =>
      h('button', {
        type: 'button',
        class: 'small',
        'aria-label': name,
        click: () => {
          const size = state.to - state.from;
          zoom(state.from + from * size, state.to + to * size);
        }
      },
        label);
  const clock = settingOf(run, 'fpga.clock_mhz');
  const works = run.stats.cycles / clock * 1e6 / last;
  const drops = run.stats.cameras[0].dropped_frames;
  const firstFrame = Math.min(...start.filter((_, i) => kind[i] === 'frame'));
  const waitedBefore = sum(kind.map(
      (each, i) => each === 'wait' && what[i] === 'core' && end[i] <= firstFrame ? end[i] - start[i] : 0));
  const waits = coreWaits(run, last, waitedBefore);
  const leftOut = events.all > events.rows;
  const chart = addChart(page, {
    id: 'time',
    wide: true,
    draw,
    title: `The core works ${percent(works)} of the time${waits.title}`,
    note: [
      waits.note,
      drops > 0 && (droppedText(run) ?? `${count(drops, 'frame')} of the left camera are dropped.`),
      drops > 0 && 'Crosses: dropped frames.',
      'The number in a bar is the frame; thin grey bars are waits. Drag in the overview, or in the window ' +
          'below it, to choose the time that is shown.',
      leftOut &&
          `The page has ${whole(events.rows)} of ${whole(events.all)} events: those of the beginning, of ` +
              'the slowest frame and of the end.'
    ].filter(Boolean)
              .join(' '),
    body: [
      h('div', {class: 'controls'}, button('+', 'Zoom in', 0.25, -0.25), button('−', 'Zoom out', -0.5, 0.5),
        button('◀', 'Earlier', -0.5, -0.5), button('▶', 'Later', 0.5, 0.5),
        h('button', {type: 'button', class: 'small', click: () => zoom(0, last)}, 'All')),
      legend([
        ...Object.keys(kColours)
            .filter(name => name !== 'drop' && kind.includes(name))
            .map(name => [kNames[name], `var(${kColours[name]})`]),
        ['waits', 'var(--faint)'], lost.some(pixels => pixels > 0) && ['loses pixels', 'var(--bad)']
      ].filter(Boolean))
    ],
    numbers: () =>
        [table.names,
         Array.from({length: events.rows}, (_, i) => table.names.map(name => table.column(name)[i]))]
  });
}
