// The memory chart: the block diagram of the board with the traffic of each link.
import {addChart} from './chart.js';
import {h} from './dom.js';
import {settingOf} from './findings.js';
import {fixed, percent} from './format.js';
import {isDark, whenThemeChanges} from './theme.js';
import {linkMarks, mark} from './tooltip.js';

const kBytesPerWord = 4;
const kMostEnlarged = 1.4;  // of its own size

// The drawing as elements: without scripts, without handlers, without links to elsewhere.
function parsedSvg(text) {
  const svg =
      document.importNode(new DOMParser().parseFromString(text, 'image/svg+xml').documentElement, true);
  svg.querySelectorAll('script, foreignObject').forEach(element => element.remove());
  for (const element of [svg, ...svg.querySelectorAll('*')]) {
    for (const {name, value} of [...element.attributes]) {
      if (name.startsWith('on') || (/href$/.test(name) && !value.startsWith('#')))
        element.removeAttribute(name);
    }
  }
  return svg;
}

const nameOf = id => id.slice(id.indexOf('-') + 1);

// Takes the titles of the drawing, which a browser would show beside the tooltips of the page.
function markAll(svg) {
  for (const title of svg.querySelectorAll('title')) {
    const element = title.parentElement;
    title.remove();
    if (element !== svg) mark(element, title.textContent.split('\n'));
  }
}

export function addMemory(page, run) {
  const svg = parsedSvg(run.memory_chart);
  markAll(svg);
  const clock = settingOf(run, 'fpga.clock_mhz');
  const banks = run.stats.banks.map(({name, megabytes_per_second: rate}, i) => {
    const peak = kBytesPerWord * clock * run.banks[i].accesses_per_cycle;
    return {name, rate, peak, share: rate / peak};
  });
  const fullest = [...banks].sort((a, b) => b.share - a.share)[0];
  const links = [...svg.querySelectorAll('.edge')].map(
      ({dataset: {from, to, mbps, peak}}) => [nameOf(from), nameOf(to), Number(mbps), Number(peak)]);
  const width = Number(svg.getAttribute('width'));
  svg.removeAttribute('width');
  svg.removeAttribute('height');
  svg.style.cssText = `min-width:${width}px;max-width:${kMostEnlarged * width}px`;
  const useTheme = () => svg.setAttribute('class', `memory-chart ${isDark() ? 'dark' : 'light'}`);
  useTheme();
  whenThemeChanges(useTheme);
  const body = h('div', {class: 'memory'}, svg);
  linkMarks(body);
  addChart(page, {
    id: 'memory',
    wide: true,
    title: `${fullest.name} carries ${fixed(fullest.rate, 1)} MB/s, ${percent(fullest.share)} of its peak`,
    note: 'The board as it was run, with the traffic of each link. Each block and link has its figures: ' +
        'point at it, or go there with the arrow keys.',
    body,
    numbers: () => [
        ['from', 'to', 'megabytes_per_second', 'peak', 'percent'],
        links.map(([from, to, rate, peak]) => [from, to, rate, peak, 100 * rate / peak])]
  });
}
