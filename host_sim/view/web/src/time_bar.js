// The time bar: waypoints, burns, aiding, modes, faults and eclipse on one axis; it is dragged or moved by keys.

import { norm } from './frames.js';
import { hours, withUnit } from './units.js';

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const kLeft = 78, kRight = 14;

/** Intervals [{begin, end, word}] in which a column of words keeps its value. */
export function intervals(table, name, last) {
  const cells = table?.cells(name), time = table?.time;
  if (!cells?.length) return [];
  const found = [];
  cells.forEach((word, k) => {
    if (found.length && found.at(-1).word === word) return;
    if (found.length) found.at(-1).end = time[k];
    found.push({ begin: time[k], end: last, word });
  });
  return found;
}

function aidLanes(run) {
  const table = run.table('telemetry_event'), lanes = new Map();
  if (!table) return lanes;
  const [event, device, after] = ['event', 'device', 'after'].map((name) => table.cells(name));
  for (let k = 0; k < table.rows; ++k) {
    if (event[k] !== 'aid') continue;
    const lane = lanes.get(device[k]) ?? lanes.set(device[k], []).get(device[k]);
    if (lane.length) lane.at(-1).end = table.time[k];
    lane.push({ begin: table.time[k], end: run.end, word: after[k] });
  }
  for (const [name, lane] of lanes) if (lane.every(({ word }) => word === 'off' || word === 'waiting')) lanes.delete(name);
  return lanes;
}

function burnsOf(run) {
  const table = run.table('maneuvers');
  const dv = table?.vector('executed_dv_rtn_r_mps', 'executed_dv_rtn_t_mps', 'executed_dv_rtn_n_mps');
  return dv ? [...table.time].map((t, k) => ({ begin: t, end: t, size: norm(dv.map((c) => c[k])) })).filter(({ size }) => size > 0) : [];
}

function faultsOf(run) {
  const present = intervals(run.table('telemetry_health'), 'faults_present', run.end).filter(({ word }) => word !== 'none' && word !== '');
  const table = run.table('faults');
  const scenario = table ? table.cells('name').map((name, k) => ({ begin: table.time[k], end: Number.isFinite(table.numbers('end_s')[k]) ? table.numbers('end_s')[k] : run.end, word: name })).filter(({ begin }) => Number.isFinite(begin)) : [];
  return [...scenario, ...present];
}

const kAidColours = { aiding: '--good', starting: '--c3', waiting: '--grid', suspended: '--caution', failed: '--bad', off: '--grid' };
const kModeColours = { approach: '--c0', station_keeping: '--c2', hold: '--c3', retreat: '--bad', idle: '--c5' };

export class TimeBar {
  constructor(element, run, cursor) {
    Object.assign(this, { element, run, cursor });
    this.canvas = document.createElement('canvas');
    this.note = document.createElement('div');
    this.note.className = 'pointed';
    this.note.hidden = true;
    element.append(this.canvas, this.note);
    Object.assign(element, { tabIndex: 0, role: 'slider', ariaLabel: 'time of the mission' });
    this.#read();
    this.#listen();
    cursor.onChange(() => this.draw());
    new ResizeObserver(() => this.draw()).observe(element);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.draw());
  }

  /** Takes the rows that a run has now. */
  renew() {
    this.#read();
    this.canvas.width = 0;  // its height may be another
    this.draw();
  }

  #read() {
    const { run, cursor, element } = this;
    Object.assign(element, { ariaValueMin: String(cursor.start), ariaValueMax: String(cursor.end) });
    const waypoints = run.table('waypoints');
    this.waypoints = waypoints ? [...waypoints.time].map((t, k) => ({ begin: t, end: t, word: `waypoint ${waypoints.cells('index')[k]}`, index: waypoints.cells('index')[k] })) : [];
    this.burns = burnsOf(run);
    this.modes = intervals(run.table('estimate'), 'mode', run.end);
    this.faults = faultsOf(run);
    this.eclipses = run.eclipses;
    this.pictures = run.pictures.map((picture) => ({ begin: picture.time_s, end: picture.time_s, word: `picture ${picture.image}` }));
    this.lanes = run.isPropagation ? [] : [
                  { name: 'burns', height: 20, draw: 'burns' }, { name: 'mode', height: 10, items: this.modes, colour: (word) => kModeColours[word] ?? '--c5' },
                  ...[...aidLanes(run)].map(([name, items]) => ({ name, height: 9, items, colour: (word) => kAidColours[word] ?? '--c5' }))];
    if (this.faults.length) this.lanes.push({ name: 'faults', height: 10, items: this.faults, colour: () => '--bad' });
    this.height = 20 + this.lanes.reduce((sum, lane) => sum + lane.height + 3, 0) + 16;
    element.style.height = `${this.height}px`;
  }

  #x(t) { return kLeft + ((t - this.cursor.start) / (this.cursor.end - this.cursor.start || 1)) * (this.element.clientWidth - kLeft - kRight); }
  #time(x) { return this.cursor.start + ((x - kLeft) / (this.element.clientWidth - kLeft - kRight)) * (this.cursor.end - this.cursor.start); }

  #listen() {
    const move = (event) => this.cursor.set(this.#time(event.clientX - this.element.getBoundingClientRect().left));
    this.element.addEventListener('pointerdown', (event) => { this.element.setPointerCapture(event.pointerId); this.dragging = true; this.cursor.play(false); move(event); });
    this.element.addEventListener('pointermove', (event) => { if (this.dragging) move(event); else this.#explain(event); });
    this.element.addEventListener('pointerleave', () => { this.note.hidden = true; });
    this.element.addEventListener('pointerup', () => { this.dragging = false; });
    this.element.addEventListener('keydown', (event) => {
      const moved = { Home: () => this.cursor.set(this.cursor.start), End: () => this.cursor.set(this.cursor.end), PageUp: () => this.cursor.step(-60), PageDown: () => this.cursor.step(60) }[event.key];
      if (moved) { moved(); event.preventDefault(); }
    });
  }

  /** The place of an instant in a lane, px in the window. */
  placeOf(name, t) {
    const box = this.element.getBoundingClientRect(), lane = this.lanes.find((l) => l.name === name);
    return [box.x + this.#x(t), box.y + lane.top + lane.height / 2];
  }

  /** A note on what is under the pointer. */
  #explain(event) {
    const box = this.element.getBoundingClientRect(), x = event.clientX - box.left, y = event.clientY - box.top, t = this.#time(x);
    const near = (items) => items.find(({ begin, end }) => x >= this.#x(begin) - 3 && x <= this.#x(end) + 3);
    const lane = this.lanes.find((l) => y >= l.top && y < l.top + l.height + 3);
    const burn = lane?.draw ? near(this.burns) : undefined;
    const item = burn ? { word: `burn of ${withUnit(burn.size, 'm/s')} at ${hours(burn.begin)}` } : lane?.items ? near([...lane.items].reverse()) : y < 20 ? near(this.waypoints) ?? near(this.pictures) : undefined;
    const lasts = item && item.end > item.begin ? `, ${hours(item.begin)} to ${hours(item.end)}` : '';
    this.note.textContent = item ? `${lane?.items ? `${lane.name} ` : ''}${item.word}${lasts}`.replaceAll('_', ' ') : hours(t);
    this.note.hidden = x < kLeft;
    const right = x > this.element.clientWidth / 2;
    Object.assign(this.note.style, { top: `${Math.max(y - 24, 1)}px`, left: right ? '' : `${x + 10}px`, right: right ? `${this.element.clientWidth - x + 10}px` : '' });
  }

  draw() {
    const { canvas, element, cursor } = this, width = element.clientWidth, ratio = devicePixelRatio;
    if (!width) return;
    if (canvas.width !== Math.round(width * ratio)) { canvas.width = Math.round(width * ratio); canvas.height = Math.round(this.height * ratio); canvas.style.width = `${width}px`; canvas.style.height = `${this.height}px`; }
    const g = canvas.getContext('2d');
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, width, this.height);
    g.font = '11px system-ui, sans-serif';
    g.textBaseline = 'middle';
    const bottom = this.height - 16;
    g.fillStyle = css('--eclipse');
    for (const { begin, end } of this.eclipses) g.fillRect(this.#x(begin), 18, this.#x(end) - this.#x(begin), bottom - 18);
    this.#drawWaypoints(g, bottom);
    let top = 20;
    for (const lane of this.lanes) {
      lane.top = top;
      g.fillStyle = css('--muted');
      g.textAlign = 'right';
      g.fillText(lane.name.replaceAll('_', ' ').slice(0, 14), kLeft - 6, top + lane.height / 2 + 0.5);
      if (lane.draw) this.#drawBurns(g, top, lane.height);
      else this.#drawIntervals(g, lane, top);
      top += lane.height + 3;
    }
    this.#drawAxis(g, bottom);
    const x = this.#x(cursor.t);
    g.strokeStyle = css('--ink');
    g.lineWidth = 1.5;
    g.beginPath(); g.moveTo(x, 14); g.lineTo(x, bottom); g.stroke();
    g.fillStyle = css('--ink');
    g.beginPath(); g.moveTo(x - 5, 9); g.lineTo(x + 5, 9); g.lineTo(x, 17); g.fill();
    element.ariaValueNow = String(cursor.t);
    element.ariaValueText = hours(cursor.t);
  }

  #drawWaypoints(g, bottom) {
    g.textAlign = 'center';
    g.strokeStyle = css('--c2');
    g.fillStyle = css('--c2');
    g.lineWidth = 1;
    let last = -Infinity;
    for (const { begin, index } of this.waypoints) {
      const x = this.#x(begin);
      g.setLineDash([2, 3]);
      g.beginPath(); g.moveTo(x, 18); g.lineTo(x, bottom); g.stroke();
      g.setLineDash([]);
      if (x - last > 14) { g.fillText(index, x, 9); last = x; }
    }
    g.fillStyle = css('--c4');
    for (const { begin } of this.pictures) g.fillRect(this.#x(begin) - 1, 15, 2, 4);
  }

  #drawBurns(g, top, height) {
    g.fillStyle = css('--c3');
    for (const { begin, size } of this.burns) {
      const share = Math.min(Math.max((Math.log10(size) + 5) / 5, 0.12), 1);
      g.fillRect(this.#x(begin) - 0.75, top + height * (1 - share), 1.5, height * share);
    }
  }

  #drawIntervals(g, lane, top) {
    for (const { begin, end, word } of lane.items) {
      const x = this.#x(begin), w = Math.max(this.#x(end) - x, 1.5);
      g.fillStyle = css(lane.colour(word));
      g.globalAlpha = word === 'waiting' || word === 'off' ? 0.5 : 0.8;
      g.fillRect(x, top + 1, w, lane.height - 2);
      g.globalAlpha = 1;
      if (w > 70 && lane.name === 'mode') { g.fillStyle = css('--page'); g.font = '9px system-ui, sans-serif'; g.textAlign = 'left'; g.fillText(word.replaceAll('_', ' '), x + 4, top + lane.height / 2 + 0.5); g.font = '11px system-ui, sans-serif'; }
    }
  }

  #drawAxis(g, bottom) {
    const span = (this.cursor.end - this.cursor.start) / 3600, width = this.element.clientWidth - kLeft - kRight;
    const rough = (span / width) * 90, decade = 10 ** Math.floor(Math.log10(rough || 1));
    const step = [1, 2, 5, 10].map((m) => m * decade).find((s) => s >= rough) ?? 1;
    g.fillStyle = css('--muted');
    g.strokeStyle = css('--frame');
    g.lineWidth = 1;
    g.beginPath(); g.moveTo(kLeft, bottom + 0.5); g.lineTo(kLeft + width, bottom + 0.5); g.stroke();
    for (let h = Math.ceil(this.cursor.start / 3600 / step - 1e-9) * step; h <= this.cursor.end / 3600 + 1e-9; h += step) {
      const x = this.#x(h * 3600);
      g.beginPath(); g.moveTo(x, bottom); g.lineTo(x, bottom + 4); g.stroke();
      g.textAlign = x > kLeft + width - 20 ? 'right' : 'center';
      g.fillText(`${+h.toFixed(6)} h`, x, bottom + 11);
    }
  }
}
