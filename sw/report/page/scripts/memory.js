// The memory chart: the block diagram of the board with the traffic of each link.
import {addChart} from './card.js';
import {choice, controls, h} from './dom.js';
import {settingOf} from './findings.js';
import {bankText, fixed, percent, signed} from './format.js';
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
export const linksOf = svg => [...svg.querySelectorAll('.edge')].map(element => {
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
    if (element === svg) {
      // Its marks have names of their own: it is more than one picture.
      svg.setAttribute('role', 'group');
      svg.setAttribute('aria-label', title.textContent);
      continue;
    }
    const link = links.find(each => each.element === element);
    mark(element, [...title.textContent.split('\n'), ...(link ? moreLines(link) : [])]);
  }
  const width = Number(svg.getAttribute('width'));
  svg.removeAttribute('width');
  svg.removeAttribute('height');
  svg.style.cssText = `min-width:${width}px;max-width:${kMostEnlarged * width}px`;
  const useTheme = () => {
    svg.classList.toggle('dark', isDark());
    svg.classList.toggle('light', !isDark());
  };
  useTheme();
  whenThemeChanges(svg, useTheme);
}

// Where the drawing is wider than the page, begins with its highest block: there may be nothing on its left.
function openAtHighest(body, svg) {
  const boxes = [...svg.querySelectorAll('.block')].map(block => block.getBoundingClientRect());
  const highest = boxes.reduce((a, b) => b.top < a.top ? b : a);
  body.scrollLeft += highest.left - body.getBoundingClientRect().left - kMargin;
}

// The chart of a run, or those of two at the same place, one shown at a time. `moreLines`: for the tooltips
// of the links of one run; `hint`: what can be done.
export function addMemory(page, runs, moreLines = () => [], hint = 'The board as it was run.') {
  const svgs = runs.map(run => parsedSvg(run.memory_chart));
  const links = svgs.map(linksOf);
  const ratesOf = ({name}) => links.map(some => some.find(link => link.name === name)?.rate);
  const differenceOf = link => {
    const [inA, inB] = ratesOf(link);
    return [
      inA === undefined     ? 'not in A' :
          inB === undefined ? 'not in B' :
                              `B − A: ${signed(inB - inA, rate => fixed(rate, 1))} MB/s`
    ];
  };
  svgs.forEach((svg, i) => useInPage(svg, links[i], runs.length > 1 ? differenceOf : moreLines));
  const body = h('div', {class: 'memory'}, svgs);
  const show = number => {
    svgs.forEach((svg, i) => svg.toggleAttribute('hidden', i !== Number(number)));
    linkMarks(body);
  };
  const chosen = runs.length > 1 &&
      controls(h('label', null, 'run ', choice('memory-run', [[0, 'A'], [1, 'B']], 0, show)));
  addChart(page, {
    id: 'memory',
    wide: true,
    ...runs.length > 1 ? differenceText(links, ratesOf) : trafficText(runs[0], links[0]),
    note: `${hint} Each block and link has its figures: point at it, or go there with the arrow keys.`,
    body: [chosen, body]
  });
  show(0);
  openAtHighest(body, svgs[0]);
}

// The title and the numbers of a chart.
function trafficText(run, links) {
  const clock = settingOf(run, 'fpga.clock_mhz');
  const shares = run.stats.banks.map(
      ({megabytes_per_second: rate}, i) => rate / (kBytesPerWord * clock * run.banks[i].accesses_per_cycle));
  const fullest = shares.indexOf(Math.max(...shares));
  const {name, megabytes_per_second: rate} = run.stats.banks[fullest];
  return {
    title: `${bankText(name)} carries ${fixed(rate, 1)} MB/s, ${percent(shares[fullest])} of its peak`,
    numbers: () => [
        ['from', 'to', 'megabytes_per_second', 'peak', 'percent', 'energy_pj', 'energy_percent'],
        [...links.map(({from, to, rate: its, peak}) => [from, to, its, peak, 100 * its / peak, null, null]),
         ...run.stats.banks.filter(({energy}) => energy)
             .map(({name: bank, energy: {energy_pj: pj, energy_percent: share}}) =>
                      [bank, 'energy', null, null, null, pj, share])]]
  };
}

function differenceText(links, ratesOf) {
  const all = [...new Map(links.flat().map(link => [link.name, ratesOf(link)]))].map(
      ([name, [inA = 0, inB = 0]]) => [name, inA, inB, inB - inA]);
  const [[name, ...rates]] = [...all].sort((x, y) => Math.abs(y[3]) - Math.abs(x[3]));
  const inRun = i => `${rates[i] ? `${fixed(rates[i], 1)} MB/s` : 'nothing'} in ${'AB'[i]}`;
  return {
    title: rates[2] === 0 ? 'Each link carries the same' : `${name}: ${inRun(0)}, ${inRun(1)}`,
    numbers: () => [['link', 'megabytes_per_second_a', 'megabytes_per_second_b', 'difference'], all]
  };
}
