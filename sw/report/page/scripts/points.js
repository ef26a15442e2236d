// The points of a database: their columns, which of them are selected, and the front of Pareto.
import {kRates, lossText, value} from './format.js';

export const kRateColumns = kRates.map(([name]) => `frames_per_second.${name}`);
export const kLostPixels = 'lost_pixels';

// Rates and prices first, then keys, then the other figures.
const kFirst = [
  kRateColumns[0], kLostPixels, ...kRateColumns.slice(1), 'bound.system', 'bound.core', 'area.slices',
  'area.block_rams', 'area.multipliers', 'energy.memory_mj_per_frame', 'latency_ms.capture_to_host.p50'
];

export class Points {
  constructor({columns, points, keys}) {
    this.size = points;
    this.columns = new Map(columns.map(({name, ...column}) => [name, column]));
    this.addShares();
    this.lost = (this.has(kLostPixels) ? this.column(kLostPixels) : new Array(points).fill(0)).map(Number);
    this.keys = keys.filter(key => this.has(key) && !this.isConstant(key));
    this.constantKeys = keys.filter(key => this.has(key) && this.isConstant(key));
    const figures = this.allNames.filter(name => !keys.includes(name));
    const differ = figures.filter(name => !this.isConstant(name));
    this.figures = differ.some(name => this.isNumeric(name)) ? differ : figures;
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
    if (!this.has('cycles')) return;
    const cycles = this.column('cycles');
    for (const name of this.allNames) {
      const target = name.startsWith('banks.') ? name.replace(/busy_cycles$/, 'utilization') :
          name.startsWith('ports.')            ? name.replace(/stall_cycles$/, 'stall_percent') :
                                                 name;
      if (target === name || this.isConstant(name)) continue;
      const factor = target.endsWith('percent') ? 100 : 1;
      const list = this.column(name).map((each, row) => each === null ? null : factor * each / cycles[row]);
      this.columns.set(target, {list});
    }
  }
  losing(rows = [...this.lost.keys()]) {
    return rows.filter(row => this.lost[row] > 0).length;
  }
  textWithLoss(name, row) {
    const text = value(this.column(name)[row]);
    return text && kRateColumns.includes(name) ? text + lossText(this.lost[row]) : text;
  }
  // The value of the first of these columns that has one for a point.
  first(names, row) {
    return names.map(name => this.has(name) ? this.column(name)[row] : null).find(each => each !== null);
  }
  // The columns that are offered, and all columns.
  get names() {
    return [...this.figures, ...this.keys];
  }
  get allNames() {
    return [...this.columns.keys()];
  }
  has(name) {
    return this.columns.has(name);
  }
  isConstant(name) {
    return 'constant' in this.columns.get(name);
  }
  // The values of a column, one for each row.
  column(name) {
    const column = this.columns.get(name);
    column.list ??= new Array(this.size).fill(column.constant);
    return column.list;
  }
  // These columns of these rows, as addChart() takes its numbers.
  numbers(names, rows) {
    const columns = names.map(name => this.column(name));
    return [names, rows.map(row => columns.map(values => values[row]))];
  }
  isNumeric(name) {
    return this.column(name).every(value => value === null || typeof value === 'number');
  }
  whenSelected(listener) {
    this.listeners.add(listener);
  }

  // Sets or (with null) takes away the filter of a name.
  filter(name, passes) {
    if (passes)
      this.filters.set(name, passes);
    else
      this.filters.delete(name);
    this.selected.fill(1);
    for (const each of this.filters.values()) {
      for (let row = 0; row < this.size; ++row) this.selected[row] &= each(row) ? 1 : 0;
    }
    for (const listener of this.listeners) listener();
  }
  get count() {
    return this.selected.reduce((sum, is) => sum + is, 0);
  }
  selectedRows() {
    return [...this.selected.keys()].filter(row => this.selected[row]);
  }

  hasUncertainty(name) {
    return this.has(`${name}_uncertainty`);
  }
  // How far each value of a column may be off.
  uncertainty(name) {
    return this.hasUncertainty(name) ? this.column(`${name}_uncertainty`) : new Float64Array(this.size);
  }

  // Returns the number of banks that the allocation of a point names.
  banksUsed() {
    const lists = this.allNames.filter(name => name.startsWith('allocation.')).map(name => this.column(name));
    return row => {
      const banks = new Set(lists.flatMap(list => value(list[row]).match(/[^[\]{}, ]+/g) ?? []));
      for (const word of ['none', 'rows:']) banks.delete(word);
      return banks.size;
    };
  }

  // The points with a number in this column whose board fits its FPGA and loses no pixels. If there are none:
  // all points with a number.
  sound(name) {
    const numbers = this.column(name);
    const limits = this.allNames.filter(each => /^area\..*_percent$/.test(each))
                       .map(each => [each, 100])
                       .concat([[kLostPixels, 0]])
                       .filter(([each]) => this.has(each))
                       .map(([each, most]) => [this.column(each), most]);
    const all = [...numbers.keys()].filter(row => typeof numbers[row] === 'number');
    const sound = all.filter(row => limits.every(([values, most]) => values[row] <= most));
    return sound.length > 0 ? sound : all;
  }

  // The fastest points that tie within the uncertainty of their rates, the cheapest first: that with the
  // fewest banks, then with the fewest slices.
  fastest(name) {
    const [rates, open] = [this.column(name), this.uncertainty(name)];
    const rows = this.sound(name);
    const banksUsed = this.banksUsed();
    const best = rows.reduce((a, b) => rates[b] > rates[a] ? b : a, rows[0]);
    const slices = this.has('area.slices') ? this.column('area.slices') : rates.map(() => 0);
    const ties = rows.filter(row => rates[best] - rates[row] <= open[best] + open[row])
                     .map(row => ({row, banks: banksUsed(row), slices: slices[row], rate: rates[row]}));
    ties.sort((a, b) => a.banks - b.banks || a.slices - b.slices || b.rate - a.rate);
    return {best, ties};
  }

  // The selected points that no other beats, from the best value of the first axis on. A point beats another
  // if it is better in one column and worse in none, by more than both uncertainties together. Exact columns
  // decide the order in which points are looked at.
  front(axes) {
    const values = axes.map(
        axis => this.column(axis.name).map(
            v => typeof v !== 'number' ? NaN :
                axis.best === 'min'    ? v :
                                         -v));
    const open = axes.map(axis => this.uncertainty(axis.name));
    const order = [...axes.keys()].sort(
        (a, b) => this.hasUncertainty(axes[a].name) - this.hasUncertainty(axes[b].name));
    const rows = this.selectedRows().filter(row => values.every(list => !Number.isNaN(list[row])));
    rows.sort((a, b) => order.map(axis => values[axis][a] - values[axis][b]).find(each => each !== 0) ?? 0);
    const front = [];
    for (const row of rows) {
      const beats = other => {
        const loss = axes.map((axis, i) => values[i][row] - values[i][other]);
        const both = axes.map((axis, i) => open[i][row] + open[i][other]);
        return loss.some((each, i) => each > both[i]) && loss.every((each, i) => each >= -both[i]);
      };
      if (!front.some(beats)) front.push(row);
    }
    const [xs, ys] = values;
    return front.sort((a, b) => xs[a] - xs[b] || ys[b] - ys[a]);
  }
}
