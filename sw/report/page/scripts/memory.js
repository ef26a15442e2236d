// The memory chart: the block diagram of the board with the traffic of each link.
import {addChart} from './card.js';
import {choice, controls, h} from './dom.js';
import {settingOf} from './findings.js';
import {fixed, percent, signed} from './format.js';
import {isDark, whenThemeChanges} from './theme.js';
import {linkMarks, mark} from './tooltip.js';

const kBytesPerWord = 4;
const kMostEnlarged = 1.4;  // of its own size
const kMargin = 8;          // pixels

// The drawing as elements. Its names are text already (chart_text.h).
const parsedSvg = text =>
    document.importNode(new DOMParser().parseFromString(text, 'image/svg+xml').documentElement, true);

const nameOf = id => id.slice(id.indexOf('-') + 1);

// The links of a drawing: {name, from, to, rate, peak, element}.
const linksOf = svg => [...svg.querySelectorAll('.edge')].map(element => {
  const [from, to] = [nameOf(element.dataset.from), nameOf(element.dataset.to)];
  const {mbps, peak} = element.dataset;
  return {name: `${from} – ${to}`, from, to, rate: Number(mbps), peak: Number(peak), element};
});

// Gives a drawing marks, its size and the theme of the page. `moreLines(link)`: for the tooltip of a link.
// The titles of the drawing go, because a browser would show them beside the tooltips.
function useInPage(svg, links, moreLines = () => []) {
  for (const title of svg.querySelectorAll('title')) {
    const element = title.parentElement;
    title.remove();
    if (element === svg) continue;
    const link = links.find(each => each.element === element);
    mark(element, [...title.textContent.split('\n'), ...(link ? moreLines(link) : [])]);
  }
  const width = Number(svg.getAttribute('width'));
  svg.removeAttribute('width');
  svg.removeAttribute('height');
  svg.style.cssText = `min-width:${width}px;max-width:${kMostEnlarged * width}px`;
  const useTheme = () => svg.setAttribute('class', `memory-chart ${isDark() ? 'dark' : 'light'}`);
  useTheme();
  whenThemeChanges(useTheme);
}

const kHowTo = 'Each block and link has its figures: point at it, or go there with the arrow keys.';

// Where the drawing is wider than the page, begins with its highest block: there may be nothing on its left.
function openAtHighest(body, svg) {
  const boxes = [...svg.querySelectorAll('.block')].map(block => block.getBoundingClientRect());
  const highest = boxes.reduce((a, b) => b.top < a.top ? b : a);
  body.scrollLeft += highest.left - body.getBoundingClientRect().left - kMargin;
}

export function addMemory(page, run) {
  const svg = parsedSvg(run.memory_chart);
  const links = linksOf(svg);
  useInPage(svg, links);
  const clock = settingOf(run, 'fpga.clock_mhz');
  const banks = run.stats.banks.map(({name, megabytes_per_second: rate}, i) => {
    const peak = kBytesPerWord * clock * run.banks[i].accesses_per_cycle;
    return {name, rate, share: rate / peak};
  });
  const fullest = [...banks].sort((a, b) => b.share - a.share)[0];
  const body = h('div', {class: 'memory'}, svg);
  linkMarks(body);
  addChart(page, {
    id: 'memory',
    wide: true,
    title: `${fullest.name} carries ${fixed(fullest.rate, 1)} MB/s, ${percent(fullest.share)} of its peak`,
    note: `The board as it was run, with the traffic of each link. ${kHowTo}`,
    body,
    numbers: () => [
        ['from', 'to', 'megabytes_per_second', 'peak', 'percent'],
        links.map(({from, to, rate, peak}) => [from, to, rate, peak, 100 * rate / peak])]
  });
  openAtHighest(body, svg);
}

// Both boards at the same place, one shown at a time.
export function addMemoryOfTwo(page, a, b) {
  const svgs = [a, b].map(run => parsedSvg(run.memory_chart));
  const links = svgs.map(linksOf);
  const rates = new Map();  // of each link, in A and in B
  for (const {name} of links.flat())
    rates.set(name, links.map(some => some.find(link => link.name === name)?.rate));
  const linesOf = ({name}) => {
    const [inA, inB] = rates.get(name);
    return inA === undefined ? ['not in A'] :
        inB === undefined    ? ['not in B'] :
                               [`B − A: ${signed(inB - inA, rate => fixed(rate, 1))} MB/s`];
  };
  svgs.forEach((svg, i) => useInPage(svg, links[i], linesOf));
  const body = h('div', {class: 'memory'}, svgs);
  const show = number => {
    svgs.forEach((svg, i) => svg.toggleAttribute('hidden', i !== Number(number)));
    linkMarks(body);
  };
  const differences = [...rates].map(([key, [inA = 0, inB = 0]]) => [key, inA, inB, inB - inA]);
  const [[name, inA, inB]] = [...differences].sort((x, y) => Math.abs(y[3]) - Math.abs(x[3]));
  addChart(page, {
    id: 'memory',
    wide: true,
    title: inA === inB ?
        'Each link carries the same' :
        `${name}: ${
                [inA, inB]
                    .map((rate, i) => `${rate ? `${fixed(rate, 1)} MB/s` : 'nothing'} in ${'AB'[i]}`)
                    .join(', ')}`,
    note: `The board with the traffic of each link. ${kHowTo}`,
    body: [controls(h('label', null, 'run ', choice('memory-run', [[0, 'A'], [1, 'B']], 0, show))), body],
    numbers: () => [['link', 'megabytes_per_second_a', 'megabytes_per_second_b', 'difference'], differences]
  });
  show(0);
  openAtHighest(body, svgs[0]);
}
