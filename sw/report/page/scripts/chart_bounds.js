// The ladder of bounds: what each resource alone would allow, beside what the run reaches.
import {addChart, cut, drawing} from './chart.js';
import {s} from './dom.js';
import {rateOf} from './findings.js';
import {percent, rate, whole} from './format.js';
import {axisBelow, logarithmic} from './scale.js';
import {mark} from './tooltip.js';

// Each resource with the frame in which it allows least.
function resourcesOf(run) {
  const clock = 1e6 * run.settings.find(setting => setting.key === 'fpga.clock_mhz').value;
  const all = new Map();
  run.bounds.core.forEach((resources, frame) => resources.forEach(({resource, cycles}) => {
    const known = all.get(resource);
    if (!known || cycles > known.cycles) all.set(resource, {resource, cycles, frame, fps: clock / cycles});
  }));
  const computer =
      (run.bounds.computer ?? []).map(each => ({resource: each.resource, fps: each.frames_per_second}));
  return [...all.values(), ...computer].sort((a, b) => a.fps - b.fps);
}

export function addBounds(page, run) {
  const {now, limit, by} = rateOf(run);
  const together = {resource: 'all together', fps: limit};
  const resources = [...resourcesOf(run), together].sort((a, b) => a.fps - b.fps);
  const turn = run.bounds.core.length;
  const draw = (host, width) => {
    const left = Math.min(width * 0.34, 130);
    const {plot, width: inner, height} = drawing(
        host, width, resources.length * 21 + 60, {left, right: 54, top: 20, bottom: 40},
        'Bounds of the resources');
    const most = resources.at(-1).fps;
    const x = logarithmic([Math.min(now, resources[0].fps) * 0.8, Math.max(most, now) * 1.1], [0, inner]);
    plot.append(axisBelow(x, inner, height, 'frames/s (logarithmic)'));
    resources.forEach((each, line) => {
      const y = line * 21 + 12;
      const tight = each.resource === by || each === together;
      plot.append(
          s('text', {x: -8, y: y + 4, 'text-anchor': 'end', class: tight ? 'strong' : null},
            cut(each.resource, left - 8)),
          s('line', {x1: 0, x2: x(each.fps), y1: y, y2: y, class: 'stem'}),
          mark(
              s('circle',
                {cx: x(each.fps), cy: y, r: 5, style: `fill:var(${tight ? '--vermilion' : '--blue'})`}),
              [
                `${each.resource}: at most ${rate(each.fps)} frames/s`,
                each.cycles &&
                    `${whole(each.cycles)} cycles a frame${
                        turn > 1 ? `, in frame ${each.frame} of each ${turn}` : ''}`,
                `the run reaches ${percent(now / each.fps)} of it`
              ].filter(Boolean)),
          s('text', {x: inner + 6, y: y + 4, class: 'value'}, rate(each.fps)));
    });
    plot.append(
        s('line', {x1: x(now), x2: x(now), y1: -4, y2: height, class: 'now'}),
        s('text', {x: x(now), y: -8, 'text-anchor': x(now) > inner / 2 ? 'end' : 'start', class: 'now-label'},
          `the run: ${rate(now)}`));
  };
  addChart(page, {
    id: 'bounds',
    title: `${by.replace(/^(bank|port) /, '')} sets the bound of ${rate(limit)} frames/s`,
    draw,
    note:
        'The frames a second that each resource alone would allow, in the frame where it allows least; all ' +
        'together: the mean of the slowest resource of each frame.',
    numbers: () => [
        ['resource', 'frames_per_second', 'cycles', 'frame'],
        resources.map(each => [each.resource, each.fps, each.cycles ?? null, each.frame ?? null])]
  });
}
