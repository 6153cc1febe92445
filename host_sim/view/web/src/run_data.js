// A run as the page holds it: tables by name, columns as numbers or words, read from the cells of the CSV files when they
// are first asked for.

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

class Column {
  #bytes; #cells; #numbers;
  constructor(table, head, bytes) {
    this.table = table;
    this.name = head.name;
    this.meaning = head.meaning;
    this.#bytes = bytes;
  }
  get id() { return `${this.table.name}.${this.name}`; }
  /** The text of each cell. */
  get cells() {
    if (!this.#cells) {
      this.#cells = new TextDecoder().decode(this.#bytes).split('\n');
      this.#cells.pop();
      this.#bytes = null;
    }
    return this.#cells;
  }
  /** The number of each cell; NaN of an empty one, or of a word. */
  get numbers() {
    return (this.#numbers ??= Float64Array.from(this.cells, (cell) => (cell === '' ? NaN : Number(cell))));
  }
  get isNumeric() { return this.cells.every((cell, row) => cell === '' || !Number.isNaN(this.numbers[row])); }
  get hasValues() { return this.cells.some((cell) => cell !== ''); }
}

const kTimes = ['time_s', 'execution_time_s', 'begin_s'];

class Table {
  constructor(head) {
    this.file = head.file;
    this.name = head.file ? head.file.replace(/\.csv$/, '') : 'sunlight';
    this.rows = head.rows;
    this.rowsOfFile = head.rows_of_file;
    this.columns = new Map();
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
    this.summary = head.summary;
    this.pictures = head.pictures;
    this.scene = head.scene;
    this.note = head.note;
    this.tables = new Map();
  }
  table(name) { return this.tables.get(name); }
  column(id) {
    const dot = id.indexOf('.');
    return this.table(id.slice(0, dot))?.column(id.slice(dot + 1));
  }
  get start() { return this.table('truth').time[0]; }
  get end() { return this.table('truth').time.at(-1); }

  static async read(head) {
    const run = new Run(head);
    const places = [];
    for (const tableHead of head.tables) {
      const table = new Table(tableHead);
      const data = await inflate(tableHead.data);
      let offset = 0;
      const bytesOf = [];
      places.push(bytesOf);
      for (const column of tableHead.columns) {
        if (column.same) {
          bytesOf.push(places[column.same[0]][column.same[1]]);
        } else {
          bytesOf.push(data.subarray(offset, offset + column.bytes));
          offset += column.bytes;
        }
      }
      tableHead.columns.forEach((column, k) => table.columns.set(column.name, new Column(table, column, bytesOf[k])));
      run.tables.set(table.name, table);
    }
    return run;
  }
}
