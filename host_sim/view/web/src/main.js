// The page of a run: scene, numbers, picture, time bar and plots around one cursor.

import { Cursor, Link, secondsOf } from './cursor.js';
import { Motion, norm } from './frames.js';
import { GroundTrack } from './ground_track.js';
import { followRun, paceControl } from './live.js';
import { Numbers, valuesAt } from './numbers.js';
import { Picture } from './picture.js';
import { orbitOf, selectedPlots, tabsOf } from './plot_tabs.js';
import { Plots } from './plots.js';
import { Run } from './run_data.js';
import { kViews, Scene } from './scene.js';
import { TimeBar } from './time_bar.js';
import { hours, withUnit } from './units.js';

/** An element: make('button', {class: 'x', text: 'y', click() {}}, child...). Text of a run is only ever set as text. */
function make(tag, { text, class: kind, title, ...events } = {}, ...children) {
  const element = document.createElement(tag);
  if (text !== undefined) element.textContent = text;
  if (kind) element.className = kind;
  if (title) element.title = title;
  for (const [event, listener] of Object.entries(events)) element.addEventListener(event, listener);
  element.append(...children);
  return element;
}

const kSpeeds = [1, 10, 60, 100, 300, 1000, 3000, 10000];

/** UTC of an instant of the mission. */
function utc(run, t) {
  const epoch = run.scene?.epoch_utc;
  if (!epoch) return '';
  return `${new Date(Date.parse(epoch) + t * 1000).toISOString().slice(0, 19).replace('T', ' ')} UTC`;
}

function headOf(runs, cursor, link) {
  const [run] = runs, { summary } = run;
  const verdict = summary.complete ? summary.verdict : location.protocol.startsWith('http') ? 'flying' : 'incomplete';
  const clock = make('span', { class: 'clock' }), range = make('b', { class: 'range', title: 'true distance to the target' });
  const entry = make('input', { class: 'time', title: 'time of the mission: 39.7h, 90min or 5400s', change() {
    const t = secondsOf(entry.value);
    if (t !== undefined) cursor.set(t);
    entry.value = hours(cursor.t);
  } });
  entry.setAttribute('aria-label', 'time of the mission');
  const play = make('button', { class: 'play', title: 'play or pause (space)', click: () => cursor.play(!cursor.playing) });
  const speed = make('select', { title: 'speed: keys + and −', change: () => { cursor.speed = Number(speed.value); } },
                     ...kSpeeds.map((s) => Object.assign(make('option', { text: `${s}×` }), { value: s })));
  speed.value = cursor.speed;
  const head = make('header', {},
    make('h1', { text: runs.map((r) => r.name).join(' | '), title: run.isPropagation ? summary.mission : `${summary.mission}, seed ${summary.seed}` }),
    make('span', { class: `status ${{ achieved: 'good', 'not judged': '', flying: '', propagated: '' }[verdict] ?? 'bad'}`, text: verdict, title: summary.verdict_reason ?? summary.incomplete_reason ?? '' }),
    make('span', { class: 'space' }), range, clock,
    make('span', { class: 'controls' },
      make('button', { text: '‹', title: 'a step back (←; with shift 10 steps)', click: () => cursor.step(-1) }), play,
      make('button', { text: '›', title: 'a step on (→; with shift 10 steps)', click: () => cursor.step(1) }), speed, entry,
      make('button', { text: 'Link', title: 'copy the address of this instant', click(event) {
        navigator.clipboard?.writeText(`${location.href.split('#')[0]}#${link.text}`);
        event.target.textContent = 'Copied';
        setTimeout(() => { event.target.textContent = 'Link'; }, 900);
      } })));
  const show = (t) => {
    const row = valuesAt(run, t).rows[0];
    range.textContent = row ? withUnit(row.truth, 'm', 5) : '';
    clock.textContent = utc(run, t);
    if (document.activeElement !== entry) entry.value = hours(t);
    play.textContent = cursor.playing ? '❚❚' : '▶';
  };
  cursor.onChange(show);
  show(cursor.t);
  return { head, speed };
}

function keyboard(cursor, speed, view) {
  const faster = (count) => { speed.selectedIndex = Math.min(Math.max(speed.selectedIndex + count, 0), kSpeeds.length - 1); cursor.speed = Number(speed.value); };
  addEventListener('keydown', (event) => {
    if (event.target.matches('input, select') || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === ' ' && event.target.matches('button')) return;
    const count = event.shiftKey ? 10 : 1;
    const act = { ' ': () => cursor.play(!cursor.playing), ArrowLeft: () => cursor.step(-count), ArrowRight: () => cursor.step(count),
                  '+': () => faster(1), '-': () => faster(-1) }[event.key] ?? (kViews[Number(event.key) - 1] && (() => view(kViews[Number(event.key) - 1][0])));
    if (!act) return;
    act();
    event.preventDefault();
  });
}

/** The scene with its buttons; a message in its place where the browser has no WebGL. */
async function sceneOf(place, runs, motions, cursor, link) {
  let scene;
  const buttons = kViews.map(([id, name], k) => make('button', { text: name, title: `key ${k + 1}`, click: () => view(id) }));
  const view = (id) => {
    scene?.setView(id);
    link.set('view', id === 'both' ? '' : id);
    buttons.forEach((button, k) => button.setAttribute('aria-pressed', kViews[k][0] === id));
  };
  if (!motions.length) {
    new GroundTrack(place, runs[0], cursor);
    return { view: () => {} };
  }
  try {
    scene = await Scene.make(place, runs, motions);
  } catch (error) {
    place.append(make('p', { class: 'noScene', text: `This browser draws no scene (WebGL: ${error.message}). Plots and numbers are complete.` }));
    return { view: () => {} };
  }
  const choice = (name, values) => {
    const select = make('select', { title: name, change: () => { scene.set({ [name]: select.value }); link.set(name, select.value === values[0][0] ? '' : select.value); } },
                        ...values.map(([value, text]) => Object.assign(make('option', { text }), { value })));
    const linked = link.get(name);
    if (values.some(([value]) => value === linked)) { select.value = linked; scene.options[name] = linked; }
    return select;
  };
  place.append(make('div', { class: 'views' }, ...buttons,
    choice('centre', ['servicer', 'target'].map((body) => [body, `about ${runs[0].isPropagation ? '' : 'the '}${scene[body].userData.name}`])), choice('axes', [['rotating', 'RTN rotating'], ['fixed', 'RTN fixed at start']])));
  scene.rebuildPaths();
  view(kViews.some(([id]) => id === link.get('view')) ? link.get('view') : 'both');
  cursor.onChange((t) => scene.show(t));
  scene.show(cursor.t);
  return { view, scene };
}

/** The list of all columns, of which each can be plotted. */
function columnChooser(runs, ids, change) {
  const list = make('div', { class: 'columns' });
  const filter = Object.assign(make('input', { input: () => fill() }), { placeholder: 'column or meaning…' });
  filter.setAttribute('aria-label', 'filter of the columns');
  const fill = () => {
    const words = filter.value.toLowerCase().split(/\s+/).filter(Boolean);
    const found = [...runs[0].tables.values()].flatMap((table) => [...table.columns.values()])
      .filter((column) => words.every((word) => `${column.id} ${column.meaning}`.toLowerCase().includes(word)));
    list.replaceChildren(...found.map((column) => {
      const box = Object.assign(make('input', { change: () => { if (box.checked) ids.add(column.id); else ids.delete(column.id); change(); } }), { type: 'checkbox', checked: ids.has(column.id) });
      return make('label', { title: column.meaning }, box, make('span', { text: column.id }));
    }));
  };
  fill();
  return make('div', { class: 'chooser' }, filter, list);
}

function plotsOf(place, runs, cursor, link) {
  const area = make('div', { class: 'plots' }), plots = new Plots(area, cursor, runs[0].eclipses);
  const selected = new Set((link.get('plot') ?? '').split(',').filter((id) => runs[0].column(id)));
  const showSelected = () => { link.set('plot', [...selected].join(',')); plots.show(selectedPlots(runs, [...selected]), 'Select columns of the list; the address keeps them.'); };
  const chooser = columnChooser(runs, selected, showSelected);
  const tabs = [...tabsOf(runs).map((tab) => ({ ...tab, show: () => plots.show(tab.plots()) })), { id: 'columns', name: 'All columns', show: showSelected }];
  const buttons = tabs.map((tab) => make('button', { text: tab.name, click: () => choose(tab.id) }));
  buttons.forEach((button) => button.setAttribute('role', 'tab'));
  const choose = (id) => {
    const k = Math.max(tabs.findIndex((tab) => tab.id === id), 0);
    buttons.forEach((button, other) => button.setAttribute('aria-selected', other === k));
    chooser.hidden = tabs[k].id !== 'columns';
    link.set('tab', k === 0 ? '' : tabs[k].id);
    tabs[k].show();
  };
  const thinned = [...runs[0].tables.values()].filter((table) => table.file && table.rowsOfFile > table.rows);
  const each = thinned.map((table) => `${table.name}: ${table.rows} of ${table.rowsOfFile} rows`);
  const note = make('span', { class: 'note', title: each.join('\n'), text: thinned.length === 0 ? ''
    : thinned.length === 1 ? `${each[0]}, extremes kept; all are in ${thinned[0].file}` : `${each[0]}, and ${thinned.length - 1} more tables in part, extremes kept; the CSV files have all rows` });
  const row = make('nav', { class: 'tabs' }, ...buttons, note);
  row.setAttribute('role', 'tablist');
  place.append(row, make('div', { class: 'plotArea' }, chooser, area));
  choose(link.get('tab'));
  // Tabs without content go when there is time to find that out; those of a propagation have some.
  const hideEmpty = (k) => {
    if (k >= tabs.length) return;
    if (tabs[k].plots) buttons[k].hidden = tabs[k].plots().length === 0;
    setTimeout(() => hideEmpty(k + 1), 100);
  };
  if (!runs[0].isPropagation) setTimeout(() => hideEmpty(0), 1500);
  return choose;
}

async function start() {
  const heads = JSON.parse(document.getElementById('runs').textContent);
  document.getElementById('runs').remove();
  const runs = await Promise.all(heads.map(Run.read));
  const page = document.getElementById('page');
  const [run] = runs;
  if (!run.time?.length) throw new Error('the run has no steps');
  const motions = run.table('truth') ? runs.map((r) => new Motion(r)) : [];
  const link = new Link(), cursor = new Cursor(run.time);
  cursor.set(secondsOf(link.get('t')) ?? cursor.start);

  const { head, speed } = headOf(runs, cursor, link);
  const pace = paceControl(make, kSpeeds);
  head.querySelector('.space').after(pace.element);
  const sceneElement = make('section', { class: 'scene' }), pictureElement = make('section', { class: 'picture' }), side = make('section', { class: 'side' });
  const bar = make('section', { class: 'timeBar' }), plotElement = make('section', { class: 'plotSection' });
  page.replaceChildren(head, make('div', { class: `upper${run.pictures.length ? ' withPicture' : ''}` }, sceneElement, pictureElement, side), bar, plotElement);
  const notes = [run.note, ...(run.scene?.notes ?? [])].filter(Boolean);
  if (notes.length) side.append(make('p', { class: 'warning', text: `${run.isPropagation ? 'Note' : 'The mission of this run could not be read in full'}: ${notes.join('; ')}` }));
  new Numbers(side, run, cursor);
  new Picture(pictureElement, run, cursor, link);
  const timeBar = new TimeBar(bar, run, cursor);
  const choose = plotsOf(plotElement, runs, cursor, link);
  const { view, scene } = await sceneOf(sceneElement, runs, motions, cursor, link);
  keyboard(cursor, speed, view);
  cursor.onChange((t) => link.set('t', t === cursor.start ? '' : `${+(t / 3600).toFixed(6)}h`));
  link.onChange(() => { cursor.set(secondsOf(link.get('t')) ?? cursor.start); choose(link.get('tab')); });

  const live = followRun(run, () => {
    motions[0] = new Motion(run);
    cursor.extend(run.table('truth').time);
    timeBar.renew();
    scene?.rebuildPaths();
    choose(link.get('tab'));
  }, pace.show);
  if (live) cursor.set(cursor.end);

  // For scripts and tests: the state of the page, the cells of the tables, the values shown.
  window.vbarView = { runs, cursor, scene, timeBar, motions, choose, valuesAt: (t) => valuesAt(run, t), rangeAt: (t) => norm(motions[0].frameAt(t).rho), elementsAt: (row) => orbitOf(run, row) };
  requestAnimationFrame(() => { document.documentElement.dataset.ready = 'yes'; });  // after the first frame of the scene
}

start().catch((error) => {
  document.getElementById('page').textContent = `The page cannot be shown: ${error.message}`;
  throw error;
});
