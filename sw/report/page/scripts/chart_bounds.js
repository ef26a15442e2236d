// The ladder of bounds: what each resource alone would allow, beside what the run reaches.
import {addChart, cut, drawing} from './chart.js';
import {s} from './dom.js';
import {rateOf, resourceText, withVerb} from './findings.js';
import {percent, rate, whole} from './format.js';
import {axisBelow, logarithmic} from './scale.js';
import {mark} from './tooltip.js';

// Each resource with the frame in which it allows least.
function resourcesOf(run) {
  const clock = 1e6 * run.settings.find(setting => setting.key === 'fpga.clock_mhz').value;
  const all = new Map();
  run.bounds.core.forEach((resources, frame) => resources.forEach(({resource, cycles}) => {
    if (run.bounds.computer && resource.startsWith('bank ')) return;  // there with the accesses of the host
    const known = all.get(resource);
    if (!known || cycles > known.cycles) all.set(resource, {resource, cycles, frame, fps: clock / cycles});
  }));
  const computer =
      (run.bounds.computer ?? []).map(each => ({resource: each.resource, fps: each.frames_per_second}));
  return [...all.values(), ...computer].sort((a, b) => a.fps - b.fps);
}

export function addBounds(page, run) {
  const {now, kind, limit, by} = rateOf(run);
  const resources = resourcesOf(run);
  const turn = run.bounds.core.length;
  // The bound is a mean over frames that differ.
  const isMean = limit > resources[0].fps * 1.001;
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
      const tight = each.resource === by;
      plot.append(
          s('text', {x: -8, y: y + 4, 'text-anchor': 'end', class: tight ? 'strong' : null},
            cut(resourceText(each.resource).replace(/^the /, ''), left - 8)),
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
          `the run: ${rate(now)}, ${kind}`));
  };
  addChart(page, {
    id: 'bounds',
    title: `${withVerb(by, 'set')} the bound of ${rate(limit)} frames/s`.replace(/^the /, 'The '),
    draw,
    note: 'The frames a second that each resource alone would allow' +
        (run.bounds.computer ? '. Of banks and buses all masters count.' : '.') +
        (isMean ?
             ` Frames differ: a resource has the frame in which it allows least, and the bound is the mean ${
                 turn > 1 ? `over ${turn} frames` : 'over all frames'} of the slowest resource of each.` :
                            ''),
    numbers: () => [
        ['resource', 'frames_per_second', 'cycles', 'frame'],
        resources.map(each => [each.resource, each.fps, each.cycles ?? null, each.frame ?? null])]
  });
}
