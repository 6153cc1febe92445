// Plots of a tab, with the one cursor: pointing at a plot moves the instant, and the instant moves the line in all plots.

import uPlot from 'uplot';
import { number, unitFor, withUnit } from './units.js';

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const kHeight = 190;

/** All times of ascending lists, ascending. */
function union(lists) {
  const all = new Float64Array(lists.reduce((sum, list) => sum + list.length, 0)), next = lists.map(() => 0);
  let count = 0;
  for (;;) {
    let least = Infinity;
    lists.forEach((list, k) => { if (list[next[k]] < least) least = list[next[k]]; });
    if (least === Infinity) return all.slice(0, count);
    all[count++] = least;
    lists.forEach((list, k) => { while (list[next[k]] <= least) ++next[k]; });
  }
}

const isAscending = (list) => list.every((t, k) => k === 0 || t >= list[k - 1]);

/** Puts curves over one ascending set of times: undefined where a curve has no row. Plots of a tab share times. */
class Joiner {
  #known = [];
  #times(lists) {
    const same = this.#known.find(({ lists: others }) => others.length === lists.length && others.every((list, k) => list === lists[k]));
    if (same) return same.times;
    const times = union(lists);
    this.#known.push({ lists, times });
    return times;
  }
  join(curves) {
    const lists = [...new Set(curves.map((c) => c.x))];
    if (lists.length === 1) return [lists[0], ...curves.map((c) => c.y)];
    if (!lists.every(isAscending)) return uPlot.join(curves.map((c) => [c.x, c.y]));
    const times = this.#times(lists);
    return [times, ...curves.map(({ x, y }) => {
      const values = new Array(times.length);
      for (let k = 0, row = 0; k < times.length; ++k) {
        values[k] = undefined;
        while (x[row] <= times[k]) values[k] = y[row++];
      }
      return values;
    })];
  }
}

/** The largest and, but for zeros, the smallest size of a value. */
function sizes(curves) {
  let most = 0, least = Infinity;
  for (const { y } of curves)
    for (const value of y) {
      const size = value === null ? 0 : Math.abs(value);
      if (size > most) most = size;
      if (size > 0 && size < least) least = size;
    }
  return { most, least };
}

/** A range about zero that the largest twentieth of the values may leave: the first hour of a filter would hide all others. */
function clipped(curves) {
  const values = Float64Array.from(curves.flatMap((c) => Array.from(c.y).filter((y) => y !== null)), Math.abs).sort();
  const most = 1.3 * values[Math.floor(0.95 * (values.length - 1))];
  return most > 0 && values.at(-1) > 3 * most ? [-most, most] : undefined;
}

/** Ticks with as many digits as their step needs: neighbours are never the same text. */
function tickTexts(_, ticks, axis, space, step) {
  const digits = Math.min(Math.max(1 - Math.floor(Math.log10(step)), 0), 12);
  return ticks.map((value) => `${+value.toFixed(digits)}`);
}

export class Plots {
  /** `eclipses`: intervals that are grey in all plots. */
  constructor(element, cursor, eclipses) {
    this.element = element;
    this.eclipses = eclipses;
    this.cursor = cursor;
    this.plots = [];
    cursor.onChange((t) => this.#mark(t));
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.show(this.shown));
    new ResizeObserver(() => this.#fit()).observe(element);
  }

  show(plots, empty = 'This run has nothing to show here.') {
    this.shown = plots;
    for (const plot of this.plots) plot.destroy();
    this.element.replaceChildren();
    const joiner = new Joiner();
    this.plots = plots.map((plot) => this.#make(plot, joiner));
    if (!plots.length) {
      const note = document.createElement('p');
      note.className = 'empty';
      note.textContent = empty;
      this.element.append(note);
    }
    this.#fit();
    setTimeout(() => this.#mark(this.cursor.t));  // the plots have their scales then
  }

  #make({ title, note = '', unit, curves, log, clip }, joiner) {
    const { most, least } = sizes(curves), cut = clip && clipped(curves);
    const { factor, name } = unitFor(unit, cut ? cut[1] : most), useLog = log && most > 100 * least;
    const scaledCurves = curves.map((c) => ({ ...c, y: factor === 1 ? c.y : c.y.map((y) => (y === null ? null : y * factor)) }));
    const data = joiner.join(scaledCurves);
    const series = scaledCurves.map((c) => ({
      label: c.label, stroke: css(`--${c.colour}`), width: c.width ?? 1.5, dash: c.dash ? [5, 4] : undefined, spanGaps: false,
      paths: c.points ? () => null : c.step ? uPlot.paths.stepped({ align: 1 }) : undefined,
      points: c.points ? { show: true, size: 4, fill: css(`--${c.colour}`) } : { show: false }, value: (_, v) => (v === null || v === undefined ? '–' : number(v, 5)) }));
    const bands = scaledCurves[0]?.band && scaledCurves[1]?.band ? [{ series: [1, 2], fill: css('--band') }] : [];
    const axis = { stroke: css('--muted'), grid: { stroke: css('--grid'), width: 1 }, ticks: { stroke: css('--grid'), width: 1, size: 4 }, font: '11px system-ui, sans-serif' };
    const plot = new uPlot({
      title: `${title}${name ? `, ${name}` : ''}${cut ? ` (to ${withUnit(most, unit, 3)})` : ''}${note}`, width: 380, height: kHeight, series: [{ label: 'h', value: (_, v) => (v === null || v === undefined ? '–' : v.toFixed(4)) }, ...series], bands,
      scales: { x: { time: false, range: (_, min, max) => (max > min ? [min, max] : [min - 1, max + 1]) }, y: useLog ? { distr: 3 } : cut ? { range: cut.map((y) => y * factor) } : {} },
      axes: [{ ...axis, size: 24, values: (_, ticks) => ticks.map((t) => `${+t.toFixed(6)} h`) }, { ...axis, size: 64, values: useLog ? (_, ticks) => ticks.map((v) => (v === null ? '' : `${+v.toPrecision(3)}`)) : tickTexts }],
      cursor: { y: false, drag: { x: true, y: false } }, legend: { live: true },
      hooks: { drawClear: [(u) => this.#shade(u)], setCursor: [(u) => this.#point(u)], setScale: [(u, key) => key === 'x' && this.#zoom(u)] },
    }, data, this.element);
    plot.over.addEventListener('mouseenter', () => { this.pointed = plot; });
    plot.over.addEventListener('mouseleave', () => { this.pointed = undefined; this.#mark(this.cursor.t); });
    return plot;
  }

  #shade(plot) {
    const { left, top, width, height } = plot.bbox, g = plot.ctx;
    g.fillStyle = css('--shade');
    for (const { begin, end } of this.eclipses) {
      const [from, to] = [begin, end].map((t) => Math.min(Math.max(plot.valToPos(t / 3600, 'x', true), left), left + width));
      g.fillRect(from, top, to - from, height);
    }
  }

  #point(plot) {
    if (this.marking || this.pointed !== plot || this.cursor.playing || plot.cursor.left < 0) return;
    this.cursor.set(plot.posToVal(plot.cursor.left, 'x') * 3600);
  }

  #mark(t) {
    this.marking = true;
    for (const plot of this.plots) {
      if (plot === this.pointed && !this.cursor.playing) continue;
      const left = plot.valToPos(t / 3600, 'x');
      plot.setCursor({ left: left >= 0 && left <= plot.bbox.width / devicePixelRatio ? left : -10, top: 5 }, false);
    }
    this.marking = false;
  }

  #zoom(from) {
    if (this.zooming) return;
    this.zooming = true;
    const { min, max } = from.scales.x;
    for (const plot of this.plots) if (plot !== from && plot.scales.x.min !== undefined) plot.setScale('x', { min, max });
    this.zooming = false;
  }

  #fit() {
    const width = this.element.clientWidth - 14;
    if (width <= 0) return;
    const columns = Math.max(1, Math.min(this.plots.length, Math.floor(width / 360)));
    for (const plot of this.plots) plot.setSize({ width: Math.floor(width / columns) - 8, height: kHeight });
  }
}
