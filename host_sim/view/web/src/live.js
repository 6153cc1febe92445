// Rows that follow while the run goes on: from the program that served the page (vbar watch), never for a page opened from disk.

/** The cells of a line of a CSV file. */
export function cellsOf(line) {
  if (!line.includes('"')) return line.split(',');
  return [...line.matchAll(/(?:^|,)(?:"((?:[^"]|"")*)"|([^,]*))/g)].map(([, quoted, plain]) => (quoted !== undefined ? quoted.replaceAll('""', '"') : plain));
}

/** Appends rows to the first run of the page as they come, and calls `renew` after them, at most every two seconds. */
export function followRun(run, renew, showPace) {
  if (!location.protocol.startsWith('http')) return undefined;
  const counts = new URLSearchParams([...run.tables.values()].filter((table) => table.file).map((table) => [table.name, table.rowsOfFile]));
  const source = new EventSource(`events?${counts}`);
  let timer;
  source.addEventListener('rows', (event) => {
    for (const [name, { columns, rows }] of Object.entries(JSON.parse(event.data))) run.append(name, columns, rows.map(cellsOf));
    timer ??= setTimeout(() => { timer = undefined; renew(); }, 2000);
  });
  source.addEventListener('pace', (event) => showPace(JSON.parse(event.data)));
  source.addEventListener('end', () => { source.close(); setTimeout(() => location.reload(), 1500); });
  source.onerror = () => source.close();  // the counts of a second connection would be those of this one
  return source;
}

/** The pace of a run that was started with --view-control: pause, step and speed of the flight. Shown when the program states the first pace. */
export function paceControl(make, speeds) {
  let pace;
  const ask = async (request) => {
    const answer = await fetch('pace', { method: 'POST', body: JSON.stringify(request) });
    if (answer.ok) show(await answer.json()); else element.title = (await answer.text()).trim();
  };
  const hold = make('button', { click: () => ask({ do: pace.paused ? 'go_on' : 'pause' }) });
  const step = make('button', { text: 'Step', title: 'let the flight software do one step', click: () => ask({ do: 'step' }) });
  const speed = make('select', { title: 'simulated seconds per second', change: () => ask({ speed: Number(speed.value) }) });
  const element = make('span', { class: 'controls pace' }, make('span', { text: 'Flight' }), hold, step, speed);
  element.hidden = true;
  const show = (next) => {
    pace = next;
    element.hidden = false;
    hold.textContent = pace.paused ? 'Go on' : 'Pause';
    hold.title = pace.paused ? 'let the run go on' : 'pause the run itself';
    const values = [...new Set([...speeds, pace.speed])].sort((a, b) => a - b);
    speed.replaceChildren(...values.map((value) => Object.assign(make('option', { text: `${value}×` }), { value })));
    speed.value = pace.speed;
  };
  return { element, show };
}
