// A run as the page holds it: tables by name, columns as numbers or words, read when they are first asked for.

/** Returns the bytes of base64. */
function bytesOf(base64) {
  if (Uint8Array.fromBase64) return Uint8Array.fromBase64(base64);
  const text = atob(base64), bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; ++k) bytes[k] = text.charCodeAt(k);
  return bytes;
}

/** Gives memory back before it is collected. */
const discard = (bytes) => bytes.buffer.transfer?.(0);

/** The stream of the expanded bytes of base64. */
function expanded(base64) {
  const { readable, writable } = new DecompressionStream('deflate'), writer = writable.getWriter();
  const ignore = () => {};  // who reads has the error
  const bytes = bytesOf(base64);
  writer.write(bytes).then(() => discard(bytes), ignore);
  writer.close().catch(ignore);
  return readable;
}

export const inflate = async (base64) => new Uint8Array(await new Response(expanded(base64)).arrayBuffer());

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

/** Takes the bytes of a column in order: text as it is; numbers come plane by plane, all lowest bytes, then all second ones,
 *  and so on, and are put together row by row. Returns how many bytes of the part it took. */
class Filler {
  #row = 0; #plane = 0; #isText;
  constructor({ form, bytes }) {
    this.bytes = new Uint8Array(bytes);
    this.left = bytes;
    this.#isText = form === 'text';
  }
  take(part) {
    const count = Math.min(part.length, this.left), { bytes } = this, rows = bytes.length / 8;
    if (this.#isText) bytes.set(part.subarray(0, count), bytes.length - this.left);
    else
      for (let k = 0; k < count; ++k) {
        bytes[8 * this.#row + this.#plane] = part[k];
        if (++this.#row === rows) { this.#row = 0; ++this.#plane; }
      }
    this.left -= count;
    return count;
  }
}

/** Returns the bytes of each column that has its own ones, of a table of the page. */
async function columnBytes(base64, heads) {
  const fillers = heads.filter((head) => !head.same).map((head) => new Filler(head));
  const reader = expanded(base64).getReader();
  let at = 0;
  for (let { value: part } = await reader.read(); part; { value: part } = await reader.read()) {
    let rest = part;
    while (rest.length) {
      rest = rest.subarray(fillers[at].take(rest));
      if (!fillers[at].left) ++at;
    }
    discard(part);
  }
  return fillers.map(({ bytes }) => bytes);
}

/** Adds to the bits of a number before it, or of the reference in the same row, what each number states as the difference
 *  from them: its sign in the lowest bit. Words of 32 bits, the lower one first. */
function addDifferences(words, reference) {
  let low = 0, high = 0;
  for (let k = 0; k < words.length; k += 2) {
    if (reference) { low = reference[k]; high = reference[k + 1]; }
    const sign = -(words[k] & 1), sum = low + (((words[k] >>> 1 | words[k + 1] << 31) ^ sign) >>> 0);
    high = (high + ((words[k + 1] >>> 1 ^ sign) >>> 0) + (sum > 0xffffffff)) >>> 0;
    low = sum >>> 0;
    words[k] = low;
    words[k + 1] = high;
  }
}

/** What the cells of a column state, each form made when it is first asked for. Columns of the same cells share it. */
class Values {
  #form; #bytes; #reference; #cells; #numbers;
  /** `bytes` of text, or of numbers in a form of embedded_table.h; `reference`: the values from which they differ. */
  constructor(form, bytes, reference) {
    this.#form = form;
    this.#bytes = bytes;
    this.#reference = reference;
  }
  static ofCells(cells) {
    const values = new Values('text');
    values.#cells = cells;
    return values;
  }
  get isText() { return this.#form === 'text'; }
  get cells() {
    if (!this.#cells && this.isText) {
      this.#cells = new TextDecoder().decode(this.#bytes).split('\n');
      this.#cells.pop();
      this.#bytes = undefined;
    }
    return (this.#cells ??= Array.from(this.numbers, (number) => (Number.isNaN(number) ? '' : `${number}`)));
  }
  get numbers() {
    if (!this.#numbers) {
      if (this.isText) this.#numbers = Float64Array.from(this.cells, (cell) => (cell === '' ? NaN : Number(cell)));
      else {
        if (this.#form !== 'number') addDifferences(new Uint32Array(this.#bytes.buffer), this.#reference && new Uint32Array(this.#reference.numbers.buffer));
        this.#numbers = new Float64Array(this.#bytes.buffer);
      }
    }
    return this.#numbers;
  }
}

class Column {
  constructor(table, head, values) {
    Object.assign(this, { table, values, name: head.name, meaning: head.meaning });
  }
  get id() { return `${this.table.name}.${this.name}`; }
  /** The text of each cell. */
  get cells() { return this.values.cells; }
  /** The number of each cell; NaN of an empty one, or of a word. */
  get numbers() { return this.values.numbers; }
  /** Adds cells of rows that follow. */
  append(cells) { this.values = Values.ofCells([...this.cells, ...cells]); }
  get isNumeric() { return !this.values.isText || this.cells.every((cell, row) => cell === '' || !Number.isNaN(this.numbers[row])); }
  get hasValues() { return this.values.isText ? this.cells.some((cell) => cell !== '') : this.numbers.some((number) => !Number.isNaN(number)); }
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
      if (!this.columns.has(name)) this.columns.set(name, new Column(this, { name, meaning: '' }, Values.ofCells([])));
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

  /** Reads the run of this place in the page; the tables are in elements of their own, which go. */
  static async read(head, place) {
    const run = new Run(head);
    const tables = [];
    const at = ([table, column]) => [...tables[table].columns.values()][column];
    for (const tableHead of head.tables) {
      const table = new Table(tableHead);
      const element = document.getElementById(`data-${place}-${tables.length}`), text = element.textContent;
      element.remove();
      tables.push(table);
      const bytes = await columnBytes(text, tableHead.columns);
      for (const column of tableHead.columns) {
        const values = column.same ? at(column.same).values : new Values(column.form, bytes.shift(), column.of && at(column.of).values);
        table.columns.set(column.name, new Column(table, column, values));
      }
      run.tables.set(table.name, table);
    }
    return run;
  }
}
