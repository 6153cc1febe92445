// Numbers at the cursor: true value, estimate, error, 3 sigma. A click copies the value as the table has it.

import { norm } from './frames.js';
import { number, withUnit } from './units.js';

const kVectors = [['relative_position_rtn', 'm', 'm', ''], ['relative_velocity_rtn', 'mps', 'm/s', ' vel.']];
const kElements = [['da', 'a δa'], ['dlambda', 'a δλ'], ['dex', 'a δex'], ['dey', 'a δey'], ['dix', 'a δix'], ['diy', 'a δiy']];

/** The state of each source of navigation that was ever on, as [name, state]. */
function aidsAt(run, t) {
  const table = run.table('telemetry_event'), states = new Map();
  if (!table) return [];
  const [event, device, after] = ['event', 'device', 'after'].map((name) => table.cells(name));
  for (let k = 0; k <= table.rowAt(t); ++k) if (event[k] === 'aid') states.set(device[k], after[k]);
  return [...states].filter(([, state]) => state !== 'off' && state !== 'waiting').map(([name, state]) => [`Aid: ${name.replaceAll('_', ' ')}`, state]);
}

/** The place of each spacecraft of a propagation over the Earth, as [name, place]. */
function orbitsAt(run, t) {
  return run.spacecraft.map((name) => {
    const table = run.table(name), row = table.rowAt(t);
    const [altitude, latitude, longitude] = table.vector('altitude_m', 'latitude_deg', 'longitude_deg').map((column) => column[row]);
    return [name, row < 0 ? '–' : `${number(altitude / 1e3, 6)} km, ${latitude.toFixed(2)}°, ${longitude.toFixed(2)}°`];
  });
}

/** Values of the rows at the cursor: what the page shows and what a test compares with the files. */
export function valuesAt(run, t) {
  const at = (table) => { const found = run.table(table); const row = found?.rowAt(t) ?? -1; return (name, as = 'numbers') => (row < 0 ? undefined : found.column(name)?.[as][row]); };
  const value = (number) => number ?? NaN;
  const truth = at('truth'), estimate = at('estimate'), sunlight = at('sunlight');
  const rows = [];
  if (!run.table('truth')) return { rows, words: orbitsAt(run, t) };
  const components = (of) => ['r', 't', 'n'].map((a) => value(of(`relative_position_rtn_${a}_m`)));
  const range = norm(components(truth)), estimatedRange = norm(components(estimate));
  rows.push({ name: 'Range', unit: 'm', truth: range, estimate: estimatedRange, error: estimatedRange - range });
  for (const [stem, unitName, unit, suffix] of kVectors)
    for (const a of ['r', 't', 'n']) {
      const [x, e, s] = [value(truth(`${stem}_${a}_${unitName}`)), value(estimate(`${stem}_${a}_${unitName}`)), value(estimate(`sigma_rtn_${a}_${unitName}`))];
      rows.push({ name: a.toUpperCase() + suffix, unit, truth: x, estimate: e, error: e - x, sigma3: 3 * s, column: `truth.${stem}_${a}_${unitName}` });
    }
  for (const [element, name] of run.isPropagation ? [] : kElements) {
    const [x, e] = [value(truth(`a_roe_mean_${element}_m`)), value(estimate(`a_roe_mean_${element}_m`))];
    rows.push({ name, unit: 'm', truth: x, estimate: e, error: e - x, column: `truth.a_roe_mean_${element}_m` });
  }
  const word = (name) => estimate(name, 'cells');
  const words = [['Mode', word('mode')], ['Solver', word('active_solver')], ['Source', word('navigation_source')],
                 ...aidsAt(run, t), ['Image', at('images')('status', 'cells')], ['Pose', at('poses')('status', 'cells')],
                 ['Next waypoint', Number(word('waypoint_index')) < 0 ? 'none' : word('waypoint_index')], ['Burns planned', word('planned_burns')], ['Delta-v so far', estimate('commanded_dv_mps') === undefined ? undefined : withUnit(estimate('commanded_dv_mps'), 'm/s')],
                 ['Sunlight', Number.isNaN(value(sunlight('servicer_sunlit'))) ? undefined : `${number(100 * value(sunlight('servicer_sunlit')), 3)} %`],
                 ['Faults present', at('telemetry_health')('faults_present', 'cells')]];
  words.push(...orbitsAt(run, t));
  return { rows, words: words.filter(([, shown]) => shown !== undefined && shown !== '') };
}

const element = (tag, text, kind) => { const made = document.createElement(tag); made.textContent = text; if (kind) made.className = kind; return made; };

export class Numbers {
  constructor(place, run, cursor) {
    this.place = place;
    this.run = run;
    const { rows, words } = valuesAt(run, cursor.t);
    this.table = element('table', '', 'numbers');
    const head = this.table.createTHead().insertRow();
    const columns = run.isPropagation ? ['value'] : ['true', 'estimate', 'error', '3σ'];
    if (rows.length) for (const name of ['', ...columns]) head.append(element('th', name));
    const body = this.table.createTBody();
    this.rows = rows.map((row) => { const made = body.insertRow(); made.append(element('th', row.name)); return columns.map(() => made.insertCell()); });
    this.facts = element('dl', '', run.isPropagation ? 'facts orbits' : 'facts');
    this.place.append(this.facts, this.table);
    this.table.addEventListener('click', (event) => { const raw = event.target.dataset?.raw; if (raw) { navigator.clipboard?.writeText(raw); event.target.classList.add('copied'); setTimeout(() => event.target.classList.remove('copied'), 500); } });
    cursor.onChange((t) => this.show(t));
    this.show(cursor.t);
  }

  show(t) {
    const { rows, words } = valuesAt(this.run, t);
    rows.forEach((row, k) => this.rows[k].forEach((cell, c) => {
      const value = [row.truth, row.estimate, row.error, row.sigma3][c], shown = Number.isFinite(value);
      cell.textContent = shown ? withUnit(value, row.unit, c < 2 && row.unit === 'm' ? 5 : 4) : value === undefined ? '' : '–';
      cell.title = shown ? `${value} ${row.unit} (click to copy)` : '';
      cell.dataset.raw = shown ? String(value) : '';
      cell.classList.toggle('beyond', c === 2 && Math.abs(value) > row.sigma3);
    }));
    this.facts.replaceChildren(...words.flatMap(([name, word]) => [element('dt', name), element('dd', this.run.isPropagation ? word : word.replaceAll('_', ' '))]));
  }
}
