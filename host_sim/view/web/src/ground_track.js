// The ground track of a propagation of one spacecraft, which has no relative motion: an orbit before and after the instant.

import { kEarth_m3ps2, orbitOf } from './plot_tabs.js';

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export class GroundTrack {
  constructor(element, run, cursor) {
    Object.assign(this, { element, run, cursor, name: run.spacecraft[0], table: run.table(run.spacecraft[0]) });
    this.canvas = document.createElement('canvas');
    element.append(this.canvas);
    cursor.onChange(() => this.draw());
    new ResizeObserver(() => this.draw()).observe(element);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => this.draw());
  }

  /** A map of 360 by 180 deg, as large as fits, in the middle. */
  draw() {
    const { clientWidth: width, clientHeight: height } = this.element, ratio = devicePixelRatio, g = this.canvas.getContext('2d');
    if (!width || !height) return;
    Object.assign(this.canvas, { width: width * ratio, height: height * ratio });
    const scale = Math.min((width - 90) / 360, (height - 40) / 180), left = (width - 360 * scale) / 2, top = (height - 180 * scale) / 2;
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.font = '11px system-ui, sans-serif';
    const x = (longitude) => left + (longitude + 180) * scale, y = (latitude) => top + (90 - latitude) * scale;
    this.#drawGrid(g, x, y);
    const [latitude, longitude] = this.table.vector('latitude_deg', 'longitude_deg'), row = Math.max(this.table.rowAt(this.cursor.t), 0);
    const period = 2 * Math.PI * Math.sqrt(orbitOf(this.run, row).semiMajorAxis ** 3 / kEarth_m3ps2);
    for (const [colour, from, to] of [['--c0', this.cursor.t - period, this.cursor.t], ['--c5', this.cursor.t, this.cursor.t + period]]) {
      g.strokeStyle = css(colour);
      g.lineWidth = 1.5;
      g.beginPath();
      for (let k = Math.max(this.table.rowAt(from), 0); k <= this.table.rowAt(to); ++k) {
        const isCut = k > 0 && Math.abs(longitude[k] - longitude[k - 1]) > 180;
        if (isCut) g.moveTo(x(longitude[k]), y(latitude[k]));
        else g.lineTo(x(longitude[k]), y(latitude[k]));
      }
      g.stroke();
    }
    g.fillStyle = css('--c1');
    g.beginPath();
    g.arc(x(longitude[row]), y(latitude[row]), 4, 0, 2 * Math.PI);
    g.fill();
    g.fillStyle = css('--ink');
    g.textAlign = x(longitude[row]) > width - 120 ? 'right' : 'left';
    g.fillText(this.name, x(longitude[row]) + (g.textAlign === 'left' ? 8 : -8), y(latitude[row]) - 6);
  }

  #drawGrid(g, x, y) {
    g.strokeStyle = css('--frame');
    g.fillStyle = css('--muted');
    g.lineWidth = 0.5;
    g.textBaseline = 'middle';
    g.beginPath();
    for (let longitude = -180; longitude <= 180; longitude += 30) {
      g.moveTo(x(longitude), y(90)); g.lineTo(x(longitude), y(-90));
      if (longitude % 60 === 0) { g.textAlign = 'center'; g.fillText(`${longitude}°`, x(longitude), y(-90) + 10); }
    }
    for (let latitude = -90; latitude <= 90; latitude += 30) {
      g.moveTo(x(-180), y(latitude)); g.lineTo(x(180), y(latitude));
      g.textAlign = 'right'; g.fillText(`${latitude}°`, x(-180) - 5, y(latitude));
    }
    g.stroke();
  }
}
