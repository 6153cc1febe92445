// Rows that follow while the run goes on: from the program that served the page (vbar watch), never for a page opened from disk.

/** The cells of a line of a CSV file. */
export function cellsOf(line) {
  if (!line.includes('"')) return line.split(',');
  return [...line.matchAll(/(?:^|,)(?:"((?:[^"]|"")*)"|([^,]*))/g)].map(([, quoted, plain]) => (quoted !== undefined ? quoted.replaceAll('""', '"') : plain));
}

/** Appends rows to the first run of the page as they come, and calls `renew` after them, at most every two seconds. */
export function followRun(run, renew) {
  if (!location.protocol.startsWith('http')) return undefined;
  const counts = new URLSearchParams([...run.tables.values()].filter((table) => table.file).map((table) => [table.name, table.rowsOfFile]));
  const source = new EventSource(`events?${counts}`);
  let timer;
  source.addEventListener('rows', (event) => {
    for (const [name, { columns, rows }] of Object.entries(JSON.parse(event.data))) run.append(name, columns, rows.map(cellsOf));
    timer ??= setTimeout(() => { timer = undefined; renew(); }, 2000);
  });
  source.addEventListener('end', () => { source.close(); setTimeout(() => location.reload(), 1500); });
  source.onerror = () => source.close();  // the counts of a second connection would be those of this one
  return source;
}
