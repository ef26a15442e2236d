// The packed tables of the data (see README.md): columns that are unpacked when they are asked for.

const kLetters = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/';
const kDigits = new Uint8Array(128);
[...kLetters].forEach((letter, digit) => {
  kDigits[letter.charCodeAt(0)] = digit;
});

// The values of a column, one for each row.
export function unpack(column, rows) {
  if (column.list) return column.list;
  if ('constant' in column) return new Array(rows).fill(column.constant);
  if (column.float64) {
    const bytes = Uint8Array.from(atob(column.float64), letter => letter.charCodeAt(0));
    const view = new DataView(bytes.buffer);
    return Array.from({length: rows}, (_, row) => view.getFloat64(8 * row, true));
  }
  const letters = column.codes.length / rows;
  const values = new Array(rows);
  for (let row = 0, place = 0; row < rows; ++row) {
    let code = 0;
    for (let letter = 0; letter < letters; ++letter)
      code = 64 * code + kDigits[column.codes.charCodeAt(place++)];
    values[row] = column.values[code];
  }
  return values;
}

export class Table {
  constructor(columns, rows) {
    this.rows = rows;
    this.packed = new Map(columns.map(column => [column.name, column]));
    this.unpacked = new Map();
  }
  get names() {
    return [...this.packed.keys()];
  }
  has(name) {
    return this.packed.has(name);
  }
  isConstant(name) {
    return 'constant' in (this.packed.get(name) ?? {constant: null});
  }
  // A column that follows from others.
  add(name, values) {
    this.packed.set(name, {name});
    this.unpacked.set(name, values);
  }
  column(name) {
    if (!this.unpacked.has(name)) this.unpacked.set(name, unpack(this.packed.get(name), this.rows));
    return this.unpacked.get(name);
  }
}

// The texts of the part `boards`: text(row).
export class Boards {
  constructor(packed, rows) {
    this.shape = unpack(packed.shape, rows);
    const sizes = packed.shapes.map(() => 0);
    this.place = this.shape.map(shape => sizes[shape]++);
    this.shapes = packed.shapes;
    this.sizes = sizes;
    this.words = new Map();
  }
  text(row) {
    const shape = this.shape[row];
    if (!this.words.has(shape)) {
      this.words.set(
          shape,
          this.shapes[shape].map(word => typeof word === 'string' ? word : unpack(word, this.sizes[shape])));
    }
    return this.words.get(shape)
        .map(word => typeof word === 'string' ? word : word[this.place[row]])
        .join('');
  }
}
