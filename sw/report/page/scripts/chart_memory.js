// The memory chart: blocks, banks and links of the board with their traffic. Without a drawing, a list.
import {addChart, htmlTable, shareBar} from './chart.js';
import {h} from './dom.js';
import {settingOf} from './findings.js';
import {fixed, percent} from './format.js';
import {mark} from './tooltip.js';

const kBytesPerWord = 4;

// The links of the machine: {id, name, what, rate, peak} in 10^6 bytes a second.
export function linksOf(run) {
  const {stats} = run;
  const clock = settingOf(run, 'fpga.clock_mhz');
  const links = [];
  for (const port of run.ports) {
    const counted = stats.ports.find(each => each.name === port.name);
    if (counted.grants === 0 && port.banks.length === 0) continue;
    links.push({
      id: `edge-${port.name}`,
      name: `${port.name} ${port.writes ? '→' : '←'} ${[...new Set(port.banks)].join(', ')}`,
      what: 'port',
      rate: kBytesPerWord * counted.grants * clock / stats.cycles,
      peak: kBytesPerWord * clock
    });
  }
  for (const bank of stats.banks) {
    const {buffers, accesses_per_cycle: ports} = run.banks.find(each => each.name === bank.name);
    links.push({
      id: `bank-${bank.name}`,
      name: `${bank.name}: ${buffers.map(buffer => buffer.name).join(', ') || 'empty'}`,
      what: 'bank',
      rate: bank.megabytes_per_second,
      peak: kBytesPerWord * clock * ports
    });
  }
  if (stats.pci) {
    const pciClock = settingOf(run, 'pci.clock_mhz');
    const peak = kBytesPerWord * pciClock * (settingOf(run, 'pci.width_bits') ?? 32) / 32;
    for (const master of stats.pci.masters) {
      links.push({
        id: `edge-pci-${master.name}`,
        name: `${master.name} on the PCI bus`,
        what: 'PCI',
        rate: kBytesPerWord * master.words * pciClock / stats.pci.clocks,
        peak
      });
    }
    const local = settingOf(run, 'bridge.local_clock_mhz');
    links.push({
      id: 'edge-local-bus',
      name: 'local bus',
      what: 'bridge',
      peak: kBytesPerWord * local,
      rate: kBytesPerWord * (stats.bridge.posted_words + stats.bridge.dma_words) * local /
          stats.bridge.local_clocks
    });
  }
  return links;
}

// The drawing as elements: without scripts, without handlers, without links to elsewhere.
function parsedSvg(text) {
  const svg =
      document.importNode(new DOMParser().parseFromString(text, 'image/svg+xml').documentElement, true);
  if (svg.localName !== 'svg') return null;
  svg.querySelectorAll('script, foreignObject').forEach(element => element.remove());
  for (const element of [svg, ...svg.querySelectorAll('*')]) {
    for (const {name, value} of [...element.attributes]) {
      if (name.startsWith('on') || (/href$/.test(name) && !value.startsWith('#')))
        element.removeAttribute(name);
    }
  }
  return svg;
}

export function addMemory(page, run) {
  const links = linksOf(run);
  const banks = links.filter(link => link.what === 'bank');
  const fullest = [...banks].sort((a, b) => b.rate / b.peak - a.rate / a.peak)[0];
  const bar = link =>
      shareBar(link.rate / link.peak, `${link.name}: ${percent(link.rate / link.peak)} of its peak`);
  const title = `${fullest.id.slice(5)} carries ${fixed(fullest.rate, 1)} MB/s, ${
      percent(fullest.rate / fullest.peak)} of its peak`;
  const numbers = () => [
      ['link', 'kind', 'megabytes_per_second', 'peak', 'percent'],
      links.map(link => [link.name, link.what, link.rate, link.peak, 100 * link.rate / link.peak])];
  const svg = run.memory_chart && parsedSvg(run.memory_chart);
  if (svg) {
    for (const link of links) {
      const element = svg.querySelector(`[id="${CSS.escape(link.id)}"]`);
      if (element)
        mark(element, [
          link.name, `${fixed(link.rate, 2)} of ${fixed(link.peak, 2)} MB/s`,
          `${percent(link.rate / link.peak)} of its peak`
        ]);
    }
    svg.removeAttribute('width');
    svg.removeAttribute('height');
    addChart(page, {
      id: 'memory',
      wide: true,
      title,
      numbers,
      note: 'Links of the board, as wide as their traffic.',
      body: h('div', {class: 'memory'}, svg)
    });
    return;
  }
  addChart(page, {
    id: 'memory',
    title,
    numbers,
    note:
        'Mean traffic of each link, and its share of the peak. Ports and banks: while the core works on ' +
        'a frame; buses: all the time.',
    body: htmlTable(
        ['link', 'MB/s', 'of peak', ''],
        links.map(link => [link.name, fixed(link.rate, 2), percent(link.rate / link.peak), bar(link)]), 200)
  });
}
