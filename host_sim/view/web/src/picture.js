// The camera's picture at the cursor, with what the software made of it.

import { hours } from './units.js';

const css = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const kKinds = { target: '--bad', star: '--c0', unmatched: '--c3', hot_pixel: '--c5' };
const kFates = { used: '--c2', without_filter: '--c2', rejected: '--bad' };  // of keypoints

export class Picture {
  constructor(element, run, cursor, link) {
    Object.assign(this, { element, run, cursor });
    element.hidden = run.pictures.length === 0;
    if (element.hidden) return;
    this.image = new Image();
    this.image.alt = 'picture of the camera';
    this.canvas = document.createElement('canvas');
    const frame = document.createElement('div');
    frame.className = 'frame';
    frame.append(this.image, this.canvas);
    frame.title = 'larger, or small again';
    frame.addEventListener('click', () => this.#enlarge(!this.large));
    this.link = link;
    this.caption = document.createElement('p');
    this.buttons = ['‹', '›'].map((sign, k) => {
      const button = document.createElement('button');
      button.textContent = sign;
      button.title = k ? 'next picture' : 'picture before';
      button.addEventListener('click', () => this.#go(k ? 1 : -1));
      return button;
    });
    const row = document.createElement('div');
    row.className = 'pictureRow';
    row.append(this.buttons[0], this.caption, this.buttons[1]);
    element.append(row, frame);
    this.#enlarge(link.get('picture') === 'large');
    this.image.addEventListener('load', () => this.#mark());
    cursor.onChange((t) => this.show(t));
    this.show(cursor.t);
  }

  /** The last picture until the instant, else the first. */
  #at(t) {
    let found = 0;
    this.run.pictures.forEach((picture, k) => { if (picture.time_s <= t + 1e-9) found = k; });
    return found;
  }

  /** Gives the picture the place of the scene, or takes it back. */
  #enlarge(large) {
    this.large = large;
    this.element.parentElement.classList.toggle('largePicture', large);
    this.link.set('picture', large ? 'large' : '');
  }

  #go(count) {
    const k = this.#at(this.cursor.t), pictures = this.run.pictures;
    const next = this.cursor.t < pictures[k].time_s ? k : Math.min(Math.max(k + count, 0), pictures.length - 1);
    this.cursor.set(pictures[next].time_s);
  }

  show(t) {
    const k = this.#at(t);
    if (k === this.shown) return this.#describe(t);
    this.shown = k;
    this.image.src = this.run.pictures[k].png;
    this.#describe(t);
  }

  #describe(t) {
    const picture = this.run.pictures[this.shown], age = t - picture.time_s;
    this.caption.textContent = `${hours(picture.time_s)}${Math.abs(age) > 1 ? ` (${age > 0 ? `${(age / 3600).toFixed(2)} h before` : 'after'} the cursor)` : ''}: ${picture.caption}`;
    this.element.classList.toggle('stale', Math.abs(age) > 1);
  }

  #mark() {
    const picture = this.run.pictures[this.shown], { canvas } = this;
    canvas.width = this.image.naturalWidth;
    canvas.height = this.image.naturalHeight;
    const g = canvas.getContext('2d'), objects = this.run.table('objects');
    g.lineWidth = Math.max(1, canvas.width / 300);
    if (objects) {
      const [image, kind] = [objects.cells('image'), objects.cells('kind')], [x, y] = objects.vector('x_px', 'y_px');
      const wanted = String(picture.image);
      for (let row = 0; row < objects.rows; ++row) {
        if (image[row] !== wanted) continue;
        g.strokeStyle = css(kKinds[kind[row]] ?? '--c5');
        const radius = kind[row] === 'target' ? Math.max(picture.target_radius_px, 8) : 5;
        g.beginPath();
        g.arc(x[row] - picture.origin_px[0], y[row] - picture.origin_px[1], radius, 0, 2 * Math.PI);
        g.stroke();
      }
    }
    this.#markKeypoints(g, picture);
    const [left, side] = picture.crop_px;
    if (side > 0) { g.strokeStyle = css('--c2'); g.strokeRect(left, 0, side, side); }
  }

  /** Crosses at the keypoints of the picture: green where navigation used them, red where it rejected them. */
  #markKeypoints(g, picture) {
    const keypoints = this.run.table('keypoints');
    if (!keypoints) return;
    const [image, x, y] = keypoints.vector('image', 'x_px', 'y_px'), fates = keypoints.cells('fate'), arm = 5;
    for (let row = 0; row < keypoints.rows; ++row) {
      if (image[row] !== picture.image || !kFates[fates[row]]) continue;
      const [u, v] = [x[row] - picture.origin_px[0], y[row] - picture.origin_px[1]];
      g.strokeStyle = css(kFates[fates[row]]);
      g.beginPath(); g.moveTo(u - arm, v); g.lineTo(u + arm, v); g.moveTo(u, v - arm); g.lineTo(u, v + arm); g.stroke();
    }
  }
}
