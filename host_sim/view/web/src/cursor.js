// The one instant that scene, plots, numbers and picture show, and the link that states it.

import { indexAt } from './run_data.js';

export class Cursor {
  #listeners = [];
  #playing = false;
  constructor(steps) {
    this.steps = steps;
    this.start = steps[0];
    this.end = steps.at(-1);
    this.t = this.start;
    this.speed = 100;
  }
  onChange(listener) { this.#listeners.push(listener); }
  #tell() { for (const listener of this.#listeners) listener(this.t); }

  /** Takes the steps of a run that goes on; an instant at its end stays there. */
  extend(steps) {
    const atEnd = this.t >= this.end;
    this.steps = steps;
    this.end = steps.at(-1);
    if (atEnd && !this.#playing) this.set(this.end);
  }
  set(t) {
    this.t = Math.min(Math.max(t, this.start), this.end);
    this.#tell();
  }
  /** Moves to the step `count` after (or, negative, before) the instant. */
  step(count) {
    const k = indexAt(this.steps, this.t + 1e-9);
    const before = count < 0 && this.steps[k] < this.t - 1e-9 ? 1 : 0;
    this.set(this.steps[Math.min(Math.max(k + count + before, 0), this.steps.length - 1)]);
  }

  get playing() { return this.#playing; }
  play(on = true) {
    if (on === this.#playing) return;
    this.#playing = on;
    if (on && this.t >= this.end) this.t = this.start;
    let last;
    const frame = (now) => {
      if (!this.#playing) return;
      const t = this.t + (last === undefined ? 0 : (now - last) * 1e-3 * this.speed);
      last = now;
      if (t >= this.end) this.#playing = false;
      this.set(t);
      if (this.#playing) requestAnimationFrame(frame);
    };
    if (on) requestAnimationFrame(frame);
    this.#tell();
  }
}

/** The state in the address: #t=39.7h&tab=navigation&plot=truth.a,estimate.b */
export class Link {
  #state;
  #timer;
  constructor() { this.#state = Link.parse(location.hash); }
  static parse(hash) { return new Map(new URLSearchParams(hash.slice(1))); }
  get(name) { return this.#state.get(name); }
  set(name, value) {
    if (value === undefined || value === '') this.#state.delete(name);
    else this.#state.set(name, value);
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => history.replaceState(null, '', `#${this.text}`), 200);
  }
  get text() { return [...this.#state].map(([name, value]) => `${name}=${encodeURIComponent(value).replaceAll('%2C', ',')}`).join('&'); }
  onChange(listener) {
    addEventListener('hashchange', () => { this.#state = Link.parse(location.hash); listener(); });
  }
}

/** s of a text like "39.7h", "90min", "5400s" or "5400"; undefined for another one. */
export function secondsOf(text) {
  const match = /^\s*(-?[0-9.]+(?:e[-+]?[0-9]+)?)\s*(h|min|s)?\s*$/i.exec(text ?? '');
  if (!match) return undefined;
  const value = Number(match[1]) * { h: 3600, min: 60, s: 1 }[(match[2] ?? 's').toLowerCase()];
  return Number.isFinite(value) ? value : undefined;
}
