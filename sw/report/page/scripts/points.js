// The points of a database: their columns, which of them are selected, and the front of Pareto.
import {Table} from './table.js';

// Rates and prices first, then keys, then the other figures.
const kFirst = [
  'frames_per_second.steady', 'frames_per_second.system', 'frames_per_second.core', 'bound.system',
  'bound.core', 'area.slices', 'area.block_rams', 'area.multipliers', 'latency_ms.capture_to_host.p50'
];

export class Points {
  constructor({columns, points, keys}) {
    this.table = new Table(columns, points);
    this.size = points;
    this.addShares();
    this.keys = keys.filter(key => this.table.has(key) && !this.table.isConstant(key));
    this.constantKeys = keys.filter(key => this.table.has(key) && this.table.isConstant(key));
    this.figures = this.table.names.filter(name => !keys.includes(name) && !this.table.isConstant(name));
    this.figures.sort((a, b) => this.rank(a) - this.rank(b));
    this.filters = new Map();  // of a name: row => whether the point passes
    this.selected = new Uint8Array(points).fill(1);
    this.listeners = new Set();
    this.chosen = -1;
  }
  rank(name) {
    const place = kFirst.indexOf(name);
    return place < 0 ? kFirst.length : place;
  }
  // Utilization of each bank and stalls of each port in percent, as run's stats.json has the former.
  addShares() {
    if (!this.table.has('cycles')) return;
    const cycles = this.table.column('cycles');
    for (const name of [...this.table.names]) {
      const target = name.startsWith('banks.') ? name.replace(/busy_cycles$/, 'utilization') :
          name.startsWith('ports.')            ? name.replace(/stall_cycles$/, 'stall_percent') :
                                                 name;
      if (target === name) continue;
      if (this.table.isConstant(name)) continue;
      const factor = target.endsWith('percent') ? 100 : 1;
      this.table.add(
          target,
          this.table.column(name).map((value, row) => value === null ? null : factor * value / cycles[row]));
    }
  }
  get names() {
    return [...this.figures, ...this.keys];
  }
  column(name) {
    return this.table.column(name);
  }
  isNumeric(name) {
    return this.column(name).every(value => value === null || typeof value === 'number');
  }
  whenSelected(listener) {
    this.listeners.add(listener);
  }

  // Sets or (with null) takes away the filter of a name. `final`: false while a brush moves.
  filter(name, passes, final = true) {
    if (passes)
      this.filters.set(name, passes);
    else
      this.filters.delete(name);
    this.selected.fill(1);
    for (const each of this.filters.values()) {
      for (let row = 0; row < this.size; ++row) this.selected[row] &= each(row) ? 1 : 0;
    }
    for (const listener of this.listeners) listener(final);
  }
  get count() {
    return this.selected.reduce((sum, is) => sum + is, 0);
  }

  // The selected points than which none is better in both columns, from left to right.
  front(x, y) {
    const [xs, ys] = [this.column(x.name), this.column(y.name)];
    const rows = [];
    for (let row = 0; row < this.size; ++row) {
      if (this.selected[row] && typeof xs[row] === 'number' && typeof ys[row] === 'number') rows.push(row);
    }
    const sign = axis => axis.best === 'min' ? 1 : -1;
    rows.sort((a, b) => sign(x) * (xs[a] - xs[b]) || sign(y) * (ys[a] - ys[b]));
    const front = [];
    let best = Infinity;
    let bestX = NaN;
    for (const row of rows) {
      const value = sign(y) * ys[row];
      if (value > best || (value === best && xs[row] !== bestX)) continue;
      [best, bestX] = [value, xs[row]];
      front.push(row);
    }
    return front.sort((a, b) => xs[a] - xs[b]);
  }
}
