// A run as the page holds it: tables by name, columns as numbers or words, read when they are first asked for.

export async function inflate(base64) {
  const text = atob(base64), packed = new Uint8Array(text.length);
  for (let k = 0; k < text.length; ++k) packed[k] = text.charCodeAt(k);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Returns the last index of ascending `values` whose value is at most `value`; -1 if there is none. */
export function indexAt(values, value) {
  let low = 0, high = values.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] <= value) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

/** Returns numbers whose bytes are given plane by plane: all lowest ones, then all second ones, and so on. */
function numbersOfPlanes(bytes) {
  const rows = bytes.length / 8, whole = new Uint8Array(bytes.length);
  for (let plane = 0; plane < 8; ++plane) for (let row = 0; row < rows; ++row) whole[8 * row + plane] = bytes[plane * rows + row];
  return new BigUint64Array(whole.buffer);
}

const difference = (folded) => (folded >> 1n) ^ -(folded & 1n);

/** Returns the bits of a column of numbers: as embedded_table.h has made its form. */
function bitsOf(form, bytes, other) {
  const bits = numbersOfPlanes(bytes);
  if (form === 'step') for (let row = 0, before = 0n; row < bits.length; ++row) before = bits[row] = before + difference(bits[row]);
  if (form === 'difference') other.bits.forEach((number, row) => { bits[row] = number + difference(bits[row]); });
  return bits;
}

class Column {
  #data; #cells; #bits; #numbers;
  /** `data`: form, bytes and, if those are of differences, the column from which. */
  constructor(table, head, data) {
    this.table = table;
    this.name = head.name;
    this.meaning = head.meaning;
    this.#data = data;
  }
  get id() { return `${this.table.name}.${this.name}`; }
  get data() { return this.#data; }
  /** The bits of each number, of a column that is not text. */
  get bits() {
    return (this.#bits ??= this.#data.form === 'text' ? new BigUint64Array(this.numbers.buffer) : bitsOf(this.#data.form, this.#data.bytes, this.#data.of));
  }
  /** The text of each cell. */
  get cells() {
    if (!this.#cells) {
      if (this.#data.form === 'text') {
        this.#cells = new TextDecoder().decode(this.#data.bytes).split('\n');
        this.#cells.pop();
      } else {
        this.#cells = Array.from(this.numbers, (number) => (Number.isNaN(number) ? '' : `${number}`));
      }
    }
    return this.#cells;
  }
  /** The number of each cell; NaN of an empty one, or of a word. */
  get numbers() {
    return (this.#numbers ??= this.#data.form === 'text' ? Float64Array.from(this.cells, (cell) => (cell === '' ? NaN : Number(cell)))
      : new Float64Array(this.bits.buffer));
  }
  /** Adds cells of rows that follow. */
  append(cells) {
    this.#cells = [...this.cells, ...cells];
    this.#data = { form: 'text' };
    this.#numbers = this.#bits = undefined;
  }
  get isNumeric() { return this.#data.form !== 'text' || this.cells.every((cell, row) => cell === '' || !Number.isNaN(this.numbers[row])); }
  get hasValues() { return this.#data.form === 'text' ? this.cells.some((cell) => cell !== '') : this.numbers.some((number) => !Number.isNaN(number)); }
}

const kTimes = ['time_s', 'execution_time_s', 'begin_s'];

class Table {
  constructor(head) {
    this.file = head.file;
    this.name = head.name || head.file.replace(/\.csv$/, '');
    this.rows = head.rows;
    this.rowsOfFile = head.rows_of_file;
    this.columns = new Map();
  }
  /** Adds rows of cells, which have the order of `names`. */
  append(names, rows) {
    names.forEach((name, k) => {
      if (!this.columns.has(name)) this.columns.set(name, new Column(this, { name, meaning: '' }, { form: 'text', bytes: new Uint8Array() }));
      this.columns.get(name).append(rows.map((cells) => cells[k] ?? ''));
    });
    this.rows += rows.length;
    this.rowsOfFile += rows.length;
  }
  column(name) { return this.columns.get(name); }
  numbers(name) { return this.columns.get(name)?.numbers; }
  cells(name) { return this.columns.get(name)?.cells; }
  /** s since the epoch of the mission; undefined for a table that is no function of time. */
  get time() { return this.numbers(kTimes.find((name) => this.columns.has(name))); }
  /** Vectors of columns with these names, each of them an array over the rows; undefined if one is missing. */
  vector(...names) {
    const columns = names.map((name) => this.numbers(name));
    return columns.every(Boolean) ? columns : undefined;
  }
  /** The index of the last row until a time, -1 before the first. */
  rowAt(t) { return indexAt(this.time, t + 1e-9); }
}

export class Run {
  constructor(head) {
    this.name = head.name;
    this.isPropagation = head.kind === 'propagation';
    this.spacecraft = head.spacecraft ?? [];  // of a propagation, in the order of the mission
    this.summary = head.summary;
    this.pictures = head.pictures;
    this.scene = head.scene;
    this.note = head.note;
    this.tables = new Map();
  }
  table(name) { return this.tables.get(name); }
  append(name, columns, rows) {
    if (!this.tables.has(name)) this.tables.set(name, new Table({ file: `${name}.csv`, rows: 0, rows_of_file: 0 }));
    this.tables.get(name).append(columns, rows);
  }
  column(id) {
    const dot = id.indexOf('.');
    return this.table(id.slice(0, dot))?.column(id.slice(dot + 1));
  }
  /** Intervals [{begin, end, word}] in which the servicer sees less than half of the Sun. */
  get eclipses() {
    const table = this.table('sunlight'), fraction = table?.numbers('servicer_sunlit'), found = [];
    fraction?.forEach((f, k) => {
      if (f > 0.5) return;
      const end = table.time[Math.min(k + 1, table.rows - 1)];
      if (found.length && found.at(-1).row === k - 1) Object.assign(found.at(-1), { row: k, end });
      else found.push({ begin: table.time[k], end, row: k, word: 'eclipse' });
    });
    return found;
  }
  /** Times of the steps; of a propagation of one spacecraft, which has no relative motion, those of its ephemeris. */
  get time() { return (this.table('truth') ?? this.table(this.spacecraft[0]))?.time; }
  get start() { return this.time[0]; }
  get end() { return this.time.at(-1); }

  static async read(head) {
    const run = new Run(head);
    const tables = [];
    const at = ([table, column]) => [...tables[table].columns.values()][column];
    for (const tableHead of head.tables) {
      const table = new Table(tableHead);
      tables.push(table);
      const data = await inflate(tableHead.data);
      let offset = 0;
      for (const column of tableHead.columns) {
        const form = column.same ? at(column.same).data
          : { form: column.form, of: column.of && at(column.of), bytes: data.subarray(offset, offset += column.bytes) };
        table.columns.set(column.name, new Column(table, column, form));
      }
      run.tables.set(table.name, table);
    }
    return run;
  }
}
