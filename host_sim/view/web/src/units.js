// Numbers for the eye, in units that suit them.

const kSteps = { m: [[2e3, 1e-3, 'km'], [0.2, 1, 'm'], [2e-5, 1e3, 'mm'], [0, 1e6, 'µm']], 'm/s': [[0.2, 1, 'm/s'], [2e-5, 1e3, 'mm/s'], [0, 1e6, 'µm/s']],
                 s: [[0, 1, 's']], rad: [[0, 180 / Math.PI, 'deg']], 'rad/s': [[0, 180 / Math.PI, 'deg/s']] };

/** The factor and the name of the unit in which values up to `largest` (SI) are read best. */
export function unitFor(unit, largest) {
  const step = kSteps[unit]?.find(([from]) => largest >= from);
  return step ? { factor: step[1], name: step[2] } : { factor: 1, name: unit };
}

export function number(value, digits = 4) {
  if (value === undefined || !Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (size >= 1e7 || size < 1e-3) return value.toExponential(digits - 2);
  return size >= 10 ** digits ? String(Math.round(value)) : value.toPrecision(digits);
}

export function withUnit(value, unit, digits = 4) {
  if (value === undefined || !Number.isFinite(value)) return '–';
  const { factor, name } = unitFor(unit, Math.abs(value));
  return `${number(value * factor, digits)} ${name}`;
}

export const hours = (t) => `${(t / 3600).toFixed(4)} h`;

const kEndings = [['_radps', 'rad/s'], ['_mps2', 'm/s²'], ['_mps', 'm/s'], ['_arcsec', 'arcsec'], ['_deg', 'deg'], ['_rad', 'rad'],
                  ['_km', 'km'], ['_mm', 'mm'], ['_px', 'px'], ['_ms', 'ms'], ['_ns', 'ns'], ['_m2', 'm²'], ['_m', 'm'], ['_s', 's']];
/** The unit in a column's name; empty if it has none. */
export const unitOf = (column) => kEndings.find(([ending]) => column.endsWith(ending))?.[1] ?? '';
/** A column's name without its unit, which a plot may show in another one. */
export const withoutUnit = (column) => column.slice(0, column.length - (kEndings.find(([ending]) => column.endsWith(ending))?.[0].length ?? 0));
