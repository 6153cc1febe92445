// The tabs of plots: which columns of which tables make a curve. A curve: x (h), y (SI, null where there is no value), unit,
// label, style.

import { norm } from './frames.js';
import { indexAt } from './run_data.js';
import { number, unitOf, withoutUnit } from './units.js';

const kAxes = ['r', 't', 'n'], kElements = ['da', 'dlambda', 'dex', 'dey', 'dix', 'diy'];
const kTrue = { width: 3.5 };  // under the estimate, and visible beside it
const kElementNames = ['a δa', 'a δλ', 'a δex', 'a δey', 'a δix', 'a δiy'];

// A gap is null: a NaN would leave the whole curve and its scale empty.
const gapped = (values) => (values.every(Number.isFinite) ? values : Array.from(values, (y) => (Number.isFinite(y) ? y : null)));

/** Hours of a list of seconds: the same list for the same one, by which plots know curves over the same times. */
const hoursOf = (() => {
  const known = new WeakMap();
  return (time) => known.get(time) ?? known.set(time, Float64Array.from(time, (t) => t / 3600)).get(time);
})();

const curve = (label, colour, time, values, more = {}) => ({ label, colour, x: hoursOf(time), y: gapped(values), ...more });

function column(run, table, name, label, colour, more) {
  const found = run.table(table)?.column(name);
  return found?.hasValues && found.isNumeric ? [curve(label, colour, found.table.time, found.numbers, more)] : [];
}

/** The values of a function of the rows at which a table has values. */
function computed(run, table, names, each, label, colour, more) {
  const columns = run.table(table)?.vector(...names);
  if (!columns) return [];
  const rows = columns[0].length;
  return [curve(label, colour, run.table(table).time, Float64Array.from({ length: rows }, (_, k) => each(columns.map((c) => c[k]), k)), more)];
}

/** Estimate minus truth at the steps of the estimate; NaN where there is no row of the truth at that time. */
function errors(run, stem, axis, unit) {
  const estimate = run.table('estimate'), truth = run.table('truth'), name = `${stem}_${axis}_${unit}`;
  const [e, t] = [estimate?.numbers(name), truth?.numbers(name)];
  if (!e || !t) return undefined;
  return { time: estimate.time, values: Float64Array.from(e, (value, k) => {
    const row = truth.rowAt(estimate.time[k]);
    return row >= 0 && Math.abs(truth.time[row] - estimate.time[k]) < 1e-6 ? value - t[row] : NaN;
  }) };
}

function relativePlots(run) {
  const range = computed(run, 'truth', kAxes.map((a) => `relative_position_rtn_${a}_m`), norm, 'true', 'c0', kTrue);
  const estimated = computed(run, 'estimate', kAxes.map((a) => `relative_position_rtn_${a}_m`), norm, 'estimated', 'c1');
  const component = (stem, unitName) => kAxes.map((a) => [
    ...column(run, 'truth', `${stem}_${a}_${unitName}`, 'true', 'c0', kTrue), ...column(run, 'estimate', `${stem}_${a}_${unitName}`, 'estimated', 'c1')]);
  return [{ title: 'Range', unit: 'm', log: true, curves: [...range, ...estimated] },
          ...component('relative_position_rtn', 'm').map((curves, k) => ({ title: `${kAxes[k].toUpperCase()} of ${run.isPropagation ? run.spacecraft[1] : 'the target'}`, unit: 'm', curves })),
          ...component('relative_velocity_rtn', 'mps').map((curves, k) => ({ title: `${kAxes[k].toUpperCase()} velocity`, unit: 'm/s', curves }))];
}

/** How often errors are within three sigma: "in 3σ 99.2 %, in eclipse 98.0 %". */
function withinText(run, error, sigma) {
  const within = [...error.values.keys()].filter((k) => Number.isFinite(error.values[k]) && sigma[k] > 0);
  const share = (rows) => `${number((100 * rows.filter((k) => Math.abs(error.values[k]) <= 3 * sigma[k]).length) / rows.length, 3)} %`;
  const { eclipses } = run, shaded = within.filter((k) => eclipses.some(({ begin, end }) => error.time[k] >= begin && error.time[k] < end));
  return within.length ? `: in 3σ ${share(within)}${shaded.length ? `, in eclipse ${share(shaded)}` : ''}` : '';
}

function navigationPlots(run) {
  const plots = [];
  for (const [stem, unitName, unit, what] of [['relative_position_rtn', 'm', 'm', 'position error'], ['relative_velocity_rtn', 'mps', 'm/s', 'velocity error']]) {
    for (const a of kAxes) {
      const error = errors(run, stem, a, unitName), sigma = run.table('estimate')?.numbers(`sigma_rtn_${a}_${unitName}`);
      if (!error || !error.values.some(Number.isFinite)) continue;
      const bound = (sign) => sigma ? [curve(sign > 0 ? '+3σ' : '−3σ', 'c5', error.time, sigma.map((s) => sign * 3 * s), { band: true, width: 1 })] : [];
      plots.push({ title: `${a.toUpperCase()} ${what}`, note: sigma ? withinText(run, error, sigma) : '', unit, clip: true, curves: [...bound(1), ...bound(-1), curve('error', 'c1', error.time, error.values)] });
    }
  }
  return plots;
}

function elementPlots(run) {
  return kElements.map((element, k) => ({ title: kElementNames[k], unit: 'm', curves: [
    ...column(run, 'truth', `a_roe_mean_${element}_m`, 'true', 'c0', kTrue), ...column(run, 'estimate', `a_roe_mean_${element}_m`, 'estimated', 'c1'),
    ...column(run, 'estimate', `a_roe_desired_${element}_m`, 'desired', 'c2', { step: true })] }));
}

function burnPlots(run) {
  const table = run.table('maneuvers');
  const dv = table?.vector('executed_dv_rtn_r_mps', 'executed_dv_rtn_t_mps', 'executed_dv_rtn_n_mps');
  if (!dv) return [];
  const order = [...table.time.keys()].filter((k) => dv.every((c) => Number.isFinite(c[k]))).sort((a, b) => table.time[a] - table.time[b]);
  const time = order.map((k) => table.time[k]), sizes = order.map((k) => norm(dv.map((c) => c[k])));
  let sum = 0;
  const total = sizes.map((size) => (sum += size));
  return [{ title: 'Delta-v, cumulative', unit: 'm/s', curves: [curve('executed', 'c0', [run.start, ...time, run.end], [0, ...total, sum], { step: true })] },
          { title: 'Burns', unit: 'm/s', curves: [curve('size', 'c3', time, sizes, { points: true })] },
          ...kAxes.map((a, k) => ({ title: `Burns, ${a.toUpperCase()}`, unit: 'm/s', curves: [curve('executed', 'c3', time, order.map((row) => dv[k][row]), { points: true })] }))];
}

function residualPlots(run) {
  const table = run.table('residuals');
  if (!table) return [];
  const sensors = table.cells('sensor'), names = [...new Set(sensors)];
  return names.map((name) => {
    const rows = [...sensors.keys()].filter((k) => sensors[k] === name);
    const of = (values) => rows.map((k) => values[k]), time = of(table.time), sigma = of(table.numbers('sigma'));
    return { title: name, unit: unitOf(name), clip: true, curves: [
      curve('+3σ', 'c5', time, sigma.map((s) => 3 * s), { band: true, width: 1 }), curve('−3σ', 'c5', time, sigma.map((s) => -3 * s), { band: true, width: 1 }),
      curve('prefit', 'c0', time, of(table.numbers('prefit')), { points: true }), curve('postfit', 'c1', time, of(table.numbers('postfit')), { points: true })] };
  });
}

/** A plot for each column of a table that is a number and changes. */
function columnPlots(run, tableName, names) {
  const table = run.table(tableName);
  if (!table) return [];
  return names.filter((name) => table.column(name)).map((name) => ({ title: withoutUnit(name).replaceAll('_', ' '), unit: unitOf(name), curves: column(run, tableName, name, withoutUnit(name).replaceAll('_', ' '), 'c0', { step: true }) }));
}

function attitudePlots(run) {
  const table = run.table('attitude');
  if (!table) return [];
  const crafts = table.cells('spacecraft'), names = [...new Set(crafts)];
  const size = (k) => norm(['x', 'y', 'z'].map((axis) => table.numbers(`rate_body_${axis}_radps`)[k]));
  const rows = (name) => [...crafts.keys()].filter((k) => crafts[k] === name);
  const curves = (values) => names.map((name, index) => curve(name, `c${index % 6}`, rows(name).map((k) => table.time[k]), rows(name).map(values)));
  return [{ title: 'Body rate', unit: 'rad/s', curves: curves(size) },
          ...['w', 'x', 'y', 'z'].map((axis) => ({ title: `q_body_eci_${axis}`, unit: '', curves: curves((k) => table.numbers(`q_body_eci_${axis}`)[k]) }))];
}

const kSensorColumns = { gnss: ['tracked', 'fixed', 'ratio', 'codes_used', 'phases_used', 'code_nis', 'phase_nis'],
                         images: ['objects', 'stars', 'range_m', 'bearing_error_x_arcsec', 'bearing_error_y_arcsec', 'nis', 'nees'],
                         poses: ['keypoints_used', 'range_m', 'nis'] };
const kComputerColumns = ['step_cost', 'stack_bytes'];
const kHealthColumns = ['packets_accepted', 'rejected_other', 'solver_fallbacks', 'plans_unsafe', 'holds'];

export const kEarth_m3ps2 = 3.986004415e14;  // of the truth's gravity field (GGM05S)

/** Osculating elements of a position and a velocity (m, m/s, ECI): semi-major axis in m, eccentricity, angles in deg. Made
 *  for tens of thousands of rows: without arrays. */
function elementsOf(x, y, z, u, v, w) {
  const hx = y * w - z * v, hy = z * u - x * w, hz = x * v - y * u, h = Math.hypot(hx, hy, hz), size = Math.hypot(x, y, z), toDeg = 180 / Math.PI;
  const ex = (v * hz - w * hy) / kEarth_m3ps2 - x / size, ey = (w * hx - u * hz) / kEarth_m3ps2 - y / size, ez = (u * hy - v * hx) / kEarth_m3ps2 - z / size;
  return { semiMajorAxis: 1 / (2 / size - (u * u + v * v + w * w) / kEarth_m3ps2), eccentricity: Math.hypot(ex, ey, ez), inclination: Math.acos(hz / h) * toDeg,
           ascendingNode: (Math.atan2(hx, -hy) * toDeg + 360) % 360 };
}

const kStateColumns = ['position_eci_x_m', 'position_eci_y_m', 'position_eci_z_m', 'velocity_eci_x_mps', 'velocity_eci_y_mps', 'velocity_eci_z_mps'];

/** The osculating elements of the first spacecraft of a propagation in a row. */
export function orbitOf(run, row) {
  return elementsOf(...run.table(run.spacecraft[0]).vector(...kStateColumns).map((column) => column[row]));
}

const kElementsShown = [['semiMajorAxis', 'Semi-major axis', 'm'], ['eccentricity', 'Eccentricity', ''], ['inclination', 'Inclination', 'deg'],
                        ['ascendingNode', 'Right ascension of the ascending node', 'deg']];

/** The elements shown of all rows of a spacecraft, each an array. */
function elementsOfRows(run, name) {
  const [x, y, z, u, v, w] = run.table(name).vector(...kStateColumns);
  const elements = Object.fromEntries(kElementsShown.map(([element]) => [element, new Float64Array(x.length)]));
  for (let row = 0; row < x.length; ++row) {
    const of = elementsOf(x[row], y[row], z[row], u[row], v[row], w[row]);
    for (const element in elements) elements[element][row] = of[element];
  }
  return elements;
}

/** Orbits of the spacecraft of a propagation. */
function orbitPlots(run) {
  const all = run.spacecraft.map((name) => elementsOfRows(run, name));
  const curves = (element) => run.spacecraft.map((name, k) => curve(name, `c${k % 6}`, run.table(name).time, all[k][element]));
  return [{ title: 'Altitude above WGS 84', unit: 'm', curves: run.spacecraft.flatMap((name, k) => column(run, name, 'altitude_m', name, `c${k % 6}`)) },
          ...kElementsShown.map(([element, title, unit]) => ({ title, unit, curves: curves(element) }))];
}

const kPropagationTabs = { orbit: ['Orbits', orbitPlots], relative: ['Relative motion', relativePlots] };

const kTabs = {
  relative: ['Relative state', relativePlots],
  navigation: ['Navigation', navigationPlots],
  roe: ['ROE', elementPlots],
  burns: ['Burns', burnPlots],
  residuals: ['Residuals', residualPlots],
  sensors: ['Sensors', (run) => Object.entries(kSensorColumns).flatMap(([table, names]) => columnPlots(run, table, names))],
  attitude: ['Attitude', attitudePlots],
  computer: ['Computer', (run) => [...columnPlots(run, 'estimate', kComputerColumns), ...columnPlots(run, 'telemetry_health', kHealthColumns)]],
};

/** Curves of the other runs, dashed, into the plots of the first one. */
function withGhosts(plots, others) {
  for (const plot of plots)
    others.forEach((other, k) => {
      const same = other.plots.find((candidate) => candidate.title === plot.title);
      for (const more of same?.curves ?? []) if (!more.band) plot.curves.push({ ...more, label: `${more.label}, ${other.name}`, dash: true, colour: `c${(4 + k) % 6}` });
    });
  return plots;
}

/** Second run minus first run, at the times of the truth of the first. */
function differencePlots(first, second) {
  const difference = (table, name, unit, title) => {
    const [a, b] = [first.table(table), second.table(table)];
    const [ya, yb] = [a?.numbers(name), b?.numbers(name)];
    if (!ya || !yb) return [];
    const values = Float64Array.from(ya, (y, k) => {
      const row = indexAt(b.time, a.time[k] + 1e-9);
      return row >= 0 && Math.abs(b.time[row] - a.time[k]) < 1e-6 ? yb[row] - y : NaN;
    });
    return [{ title, unit, curves: [curve('second − first', 'c4', a.time, values)] }];
  };
  return [...kAxes.flatMap((a) => difference('truth', `relative_position_rtn_${a}_m`, 'm', `${a.toUpperCase()}, true`)),
          ...kAxes.flatMap((a) => difference('estimate', `relative_position_rtn_${a}_m`, 'm', `${a.toUpperCase()}, estimated`)),
          ...kElements.flatMap((e, k) => difference('truth', `a_roe_mean_${e}_m`, 'm', kElementNames[k]))];
}

/** The plots of columns that the user has selected, ids as "truth.relative_position_rtn_r_m". */
export function selectedPlots(runs, ids) {
  return ids.flatMap((id) => {
    const curves = runs.flatMap((run, k) => {
      const found = run.column(id);
      return found?.isNumeric && found.table.time ? [curve(k === 0 ? withoutUnit(found.name) : `${withoutUnit(found.name)}, ${run.name}`, `c${k % 6}`, found.table.time, found.numbers, { dash: k > 0 })] : [];
    });
    return curves.length ? [{ title: withoutUnit(id), unit: unitOf(id), curves }] : [];
  });
}

/** The tabs that the runs have something for: id, name, plots(). */
export function tabsOf(runs) {
  const [first, ...others] = runs;
  const tabs = Object.entries(first.isPropagation ? kPropagationTabs : kTabs).map(([id, [name, make]]) => ({ id, name, plots: () => withGhosts(
    make(first).filter((plot) => plot.curves.length), others.map((run) => ({ name: run.name, plots: make(run) }))) }));
  if (first.isPropagation && !first.table('truth')) tabs.pop();
  if (others.length) tabs.push({ id: 'difference', name: 'Difference', plots: () => differencePlots(first, others[0]) });
  return tabs;
}
