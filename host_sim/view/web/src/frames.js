// Frames of a run at an instant. Position and attitude of everything drawn come from one frame object.
// Vectors are arrays of three, matrices arrays of three rows.

import { indexAt } from './run_data.js';

export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const norm = (a) => Math.sqrt(dot(a, a));
export const scaled = (s, a) => [s * a[0], s * a[1], s * a[2]];
export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const unit = (a) => scaled(1 / norm(a), a);
export const times = (M, a) => M.map((row) => dot(row, a));
export const transposed = (M) => [0, 1, 2].map((k) => M.map((row) => row[k]));
export const product = (A, B) => { const columns = transposed(B); return A.map((row) => columns.map((c) => dot(row, c))); };

/** The rotation to RTN from ECI: rows R, T, N; N along the angular momentum. */
export function rtnFromEci(position, velocity) {
  const r = unit(position), n = unit(cross(position, velocity));
  return [r, cross(n, r), n];
}

/** The rotation matrix that turns components as the quaternion [w, x, y, z] does (Hamilton, v' = q v q*). */
export function matrixOf([w, x, y, z]) {
  return [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
          [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
          [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]];
}

const quaternionProduct = ([a, b, c, d], [e, f, g, h]) => [
  a * e - b * f - c * g - d * h, a * f + b * e + c * h - d * g, a * g - b * h + c * e + d * f, a * h + b * g - c * f + d * e];

/** Display axes: x along T, y along R, z against N, a right-handed set seen from against the angular momentum. */
export const displayOf = ([r, t, n]) => [t, r, -n];

const rtn = (stem, unitName) => ['r', 't', 'n'].map((axis) => `${stem}_${axis}_${unitName}`);
const xyz = (stem, unitName) => ['x', 'y', 'z'].map((axis) => `${stem}_${axis}${unitName}`);

/** The motion of a run: the frame at any instant between its first and last row. */
export class Motion {
  constructor(run) {
    this.run = run;
    const truth = run.table('truth');
    this.time = truth.time;
    this.rho = truth.vector(...rtn('relative_position_rtn', 'm'));
    this.rhoDot = truth.vector(...rtn('relative_velocity_rtn', 'mps'));
    this.servicer = truth.vector(...xyz('servicer_position_eci', '_m'), ...xyz('servicer_velocity_eci', '_mps'));
    const estimate = run.table('estimate');
    this.estimate = estimate && { time: estimate.time, rho: estimate.vector(...rtn('relative_position_rtn', 'm')),
                                  sigma: estimate.vector('sigma_rtn_r_m', 'sigma_rtn_t_m', 'sigma_rtn_n_m') };
    this.desired = estimate && { time: estimate.time, elements: estimate.vector(...['da', 'dlambda', 'dex', 'dey', 'dix', 'diy'].map((e) => `a_roe_desired_${e}_m`)) };
    const sunlight = run.table('sunlight');
    this.sunlight = sunlight && { time: sunlight.time, sun: sunlight.vector('sun_eci_x', 'sun_eci_y', 'sun_eci_z'),
                                  fraction: sunlight.numbers('servicer_sunlit') };
    this.attitudes = this.#attitudesByName();
  }

  #attitudesByName() {
    const attitudes = new Map();
    const table = this.run.table('attitude');
    if (!table) return attitudes;
    const columns = table.vector('q_body_eci_w', 'q_body_eci_x', 'q_body_eci_y', 'q_body_eci_z', 'rate_body_x_radps',
                                 'rate_body_y_radps', 'rate_body_z_radps');
    table.cells('spacecraft').forEach((name, row) => {
      if (!attitudes.has(name)) attitudes.set(name, { time: [], rows: [] });
      attitudes.get(name).time.push(table.time[row]);
      attitudes.get(name).rows.push(columns.map((column) => column[row]));
    });
    return attitudes;
  }

  /** The rotation to RTN from ECI at a row of the truth. */
  rtnFromEciAtRow(k) {
    const s = this.servicer.map((column) => column[k]);
    return rtnFromEci(s.slice(0, 3), s.slice(3));
  }

  /** The rotation to ECI from the body axes of a spacecraft: its last row, continued at the rate of that row; undefined
   *  without attitudes. */
  eciFromBody(name, t) {
    const attitude = this.attitudes.get(name);
    if (!attitude) return undefined;
    const k = Math.max(indexAt(attitude.time, t + 1e-9), 0), row = attitude.rows[k];
    const rate = row.slice(4), angle = norm(rate) * (t - attitude.time[k]);
    const s = angle === 0 ? [0, 0, 0] : scaled(Math.sin(angle / 2) / norm(rate), rate);
    // The body turns by `angle` about `rate` in body axes: components in the new body axes are q* v q of that rotation.
    const q = quaternionProduct([Math.cos(angle / 2), -s[0], -s[1], -s[2]], row.slice(0, 4));
    return transposed(matrixOf(q));
  }

  frameAt(t) {
    const k = Math.min(Math.max(indexAt(this.time, t + 1e-9), 0), this.time.length - 1);
    const last = k === this.time.length - 1;
    const h = last ? 1 : this.time[k + 1] - this.time[k], u = last ? 0 : Math.min(Math.max((t - this.time[k]) / h, 0), 1);
    const h00 = (1 + 2 * u) * (1 - u) ** 2, h10 = u * (1 - u) ** 2, h01 = u * u * (3 - 2 * u), h11 = u * u * (u - 1);
    const between = (p, v) => (axis) => (u === 0 ? p[axis][k] : h00 * p[axis][k] + h10 * h * v[axis][k] + h01 * p[axis][k + 1] + h11 * h * v[axis][k + 1]);
    const rho = [0, 1, 2].map(between(this.rho, this.rhoDot));
    const p = [0, 1, 2].map(between(this.servicer.slice(0, 3), this.servicer.slice(3)));
    const v = [3, 4, 5].map((axis) => (u === 0 ? this.servicer[axis][k] : (1 - u) * this.servicer[axis][k] + u * this.servicer[axis][k + 1]));
    return { t, row: k, rho, rtnFromEci: rtnFromEci(p, v) };
  }

  /** The estimate of the last step until a time; undefined while there is none. */
  estimateAt(t) {
    if (!this.estimate?.rho) return undefined;
    const k = indexAt(this.estimate.time, t + 1e-9);
    if (k < 0 || Number.isNaN(this.estimate.rho[0][k])) return undefined;
    return { rho: this.estimate.rho.map((c) => c[k]), sigma: this.estimate.sigma.map((c) => c[k]) };
  }

  /** The relative orbit of the elements that guidance flies to, one revolution about its mean place, as positions of the
   *  target in RTN (near-circular orbits, D'Amico 2010, eq. 2.27, without drift); undefined without a waypoint ahead. */
  commandedOrbitAt(t) {
    if (!this.desired?.elements) return undefined;
    const k = indexAt(this.desired.time, t + 1e-9);
    const [da, dlambda, dex, dey, dix, diy] = this.desired.elements.map((c) => (k < 0 ? 0 : c[k]));
    if (![da, dlambda, dex, dey, dix, diy].some(Boolean)) return undefined;
    return Array.from({ length: 97 }, (_, step) => {
      const u = (step / 96) * 2 * Math.PI, c = Math.cos(u), s = Math.sin(u);
      return [da - dex * c - dey * s, dlambda + 2 * dex * s - 2 * dey * c, dix * s - diy * c];
    });
  }

  /** Direction to the Sun in ECI and the fraction of its light; undefined where the mission was not read. */
  sunAt(t) {
    if (!this.sunlight) return undefined;
    const k = Math.max(indexAt(this.sunlight.time, t + 1e-9), 0);
    return { eci: this.sunlight.sun.map((c) => c[k]), fraction: this.sunlight.fraction[k] };
  }
}
