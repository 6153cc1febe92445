// The scene: relative motion in the RTN frame of the servicer, rotating with it or fixed, about the servicer or the target.

import * as three from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { displayOf, matrixOf, norm, product, scaled, times, transposed } from './frames.js';
import { bodyOf } from './spacecraft.js';
import { withUnit } from './units.js';

/** Views: what the camera looks at and from where; keys 1 to 6. */
export const kViews = [['both', 'Both'], ['servicer', 'Servicer'], ['target', 'Target'], ['along', 'Along T'], ['above', 'From above'], ['whole', 'Whole path']];
const kMinPixels = 26;  // radius at which a spacecraft is drawn at least

const vector = (a) => new three.Vector3(...a);
const cssColour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

export class Scene {
  static async make(element, runs, motions) {
    const scene = new Scene(element, runs, motions);
    await scene.#build();
    return scene;
  }

  constructor(element, runs, motions) {
    this.element = element;
    this.runs = runs;
    this.motions = motions;
    this.options = { centre: 'servicer', axes: 'rotating', view: 'both' };
    this.renderer = new three.WebGLRenderer({ antialias: true, logarithmicDepthBuffer: true, preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(devicePixelRatio);
    element.prepend(this.renderer.domElement);
    this.camera = new three.PerspectiveCamera(40, 1, 0.01, 1e8);
    this.camera.position.set(0.35, 0.45, 1);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener('change', () => this.#draw());
    this.world = new three.Scene();
    this.labels = [];
    new ResizeObserver(() => this.resize()).observe(element);
    matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => { this.colour(); this.rebuildPaths(); this.#draw(); });
  }

  async #build() {
    const run = this.runs[0];
    this.sunLight = new three.DirectionalLight(0xffffff, 3);
    this.ambient = new three.AmbientLight(0xffffff, 0.5);
    this.world.add(this.sunLight, this.sunLight.target, this.ambient);
    this.servicer = await bodyOf(run, 'servicer', 0x7f9fd0);
    this.target = await bodyOf(run, 'target', 0xd0a060);
    this.ghosts = [];
    for (let k = 1; k < this.runs.length; ++k) {
      const ghost = await bodyOf(this.runs[k], 'target', 0xa0a0a0);
      ghost.traverse((part) => { for (const m of [part.material].flat().filter(Boolean)) { m.transparent = true; m.opacity = 0.45; } });
      this.ghosts.push(ghost);
    }
    this.world.add(this.servicer, this.target, ...this.ghosts);
    this.paths = new three.Group();
    this.world.add(this.paths);

    const sphere = new three.SphereGeometry(1, 40, 24);
    this.ellipsoid = new three.Mesh(sphere, new three.MeshBasicMaterial({ transparent: true, opacity: 0.16, depthWrite: false }));
    this.ellipsoid.add(new three.LineSegments(new three.WireframeGeometry(new three.SphereGeometry(1, 16, 10)), new three.LineBasicMaterial({ transparent: true, opacity: 0.4 })));
    this.keepOut = new three.Mesh(sphere, new three.MeshBasicMaterial({ transparent: true, opacity: 0.07, depthWrite: false }));
    this.keepOut.add(new three.LineSegments(new three.WireframeGeometry(new three.SphereGeometry(1, 24, 12)), new three.LineBasicMaterial({ transparent: true, opacity: 0.22 })));
    this.world.add(this.ellipsoid, this.keepOut);

    this.arrows = { sun: this.#arrow('Sun'), earth: this.#arrow('Earth'), r: this.#arrow('R'), t: this.#arrow('T'), n: this.#arrow('N') };
    this.commanded = new three.LineLoop(new three.BufferGeometry(), new three.LineBasicMaterial({ transparent: true, opacity: 0.9 }));
    this.commanded.frustumCulled = false;
    this.world.add(this.commanded);
    this.sight = new three.LineSegments(new three.BufferGeometry(), new three.LineBasicMaterial({ transparent: true, opacity: 0.8 }));
    this.world.add(this.sight);
    this.grid = new three.Group();
    this.world.add(this.grid);
    this.servicerLabel = this.#label('', 'craft');
    this.targetLabel = this.#label('', 'craft');
    this.estimateLabel = this.#label('', 'note');
    this.gridLabel = document.createElement('div');
    this.gridLabel.className = 'gridNote';
    this.element.append(this.gridLabel);
    this.colour();
    this.rebuildPaths();
    this.resize();
  }

  // ---- parts

  #label(text, kind) {
    const element = document.createElement('div');
    element.className = `label ${kind}`;
    element.textContent = text;
    this.element.append(element);
    const label = { element, position: new three.Vector3(), visible: true, kind };
    this.labels.push(label);
    return label;
  }

  /** An arrow of constant length on the screen. */
  #arrow(name) {
    const geometry = new three.BufferGeometry().setFromPoints([[0, 0, 0], [0, 1, 0], [0, 1, 0], [0.05, 0.86, 0], [0, 1, 0], [-0.05, 0.86, 0]].map(vector));
    const arrow = new three.LineSegments(geometry, new three.LineBasicMaterial());
    arrow.userData.label = this.#label(name, 'axis');
    this.world.add(arrow);
    return arrow;
  }

  colour() {
    this.spacing = undefined;  // the grid is made again
    this.world.background = new three.Color(cssColour('--sky'));
    const set = (object, name) => object.material.color.set(cssColour(name));
    for (const [name, variable] of [['sun', '--c3'], ['earth', '--c0'], ['r', '--muted'], ['t', '--muted'], ['n', '--muted']]) set(this.arrows[name], variable);
    for (const part of [this.ellipsoid, this.ellipsoid.children[0]]) set(part, '--c1');
    for (const part of [this.keepOut, this.keepOut.children[0]]) set(part, '--bad');
    for (const line of [this.sight, this.commanded]) set(line, '--c2');
  }

  // ---- geometry in display axes

  /** To display axes from RTN at this frame. */
  #toDisplay(frame) {
    if (this.options.axes === 'rotating') return displayOf;
    const first = this.motions[0].rtnFromEciAtRow(0), fixed = product(first, transposed(frame.rtnFromEci));
    return (a) => displayOf(times(fixed, a));
  }

  /** The place of the target, or of the servicer with the target at the centre, from the target's position in RTN. */
  #placeOf(rho) { return this.options.centre === 'servicer' ? rho : scaled(-1, rho); }

  #points(motion, time, rho, each = () => true) {
    const points = [];
    for (let k = 0; k < time.length; ++k) {
      const p = rho.map((column) => column[k]);
      if (Number.isNaN(p[0]) || !each(k)) continue;
      const frame = this.options.axes === 'rotating' ? undefined : motion.frameAt(time[k]);
      points.push({ t: time[k], at: vector(this.#toDisplay(frame)(this.#placeOf(p))) });
    }
    return points;
  }

  #line(points, colour, opacity, dashed = false) {
    const geometry = new three.BufferGeometry().setFromPoints(points.map((p) => p.at));
    const line = new three.Line(geometry, dashed ? new three.LineDashedMaterial({ color: cssColour(colour), transparent: true, opacity, dashSize: 1, gapSize: 1 })
                                                 : new three.LineBasicMaterial({ color: cssColour(colour), transparent: true, opacity }));
    line.frustumCulled = false;
    this.paths.add(line);
    return line;
  }

  rebuildPaths() {
    for (const part of [...this.paths.children]) { this.paths.remove(part); part.geometry?.dispose(); }
    this.labels = this.labels.filter((label) => { if (label.kind !== 'waypoint') return true; label.element.remove(); return false; });
    const [run, motion] = [this.runs[0], this.motions[0]];
    this.truePoints = this.#points(motion, motion.time, motion.rho);
    this.#line(this.truePoints, '--c0', 0.35);
    this.flown = this.#line(this.truePoints, '--c0', 1);
    if (motion.estimate?.rho) {
      const known = this.#points(motion, motion.estimate.time, motion.estimate.rho);
      if (known.length) this.#line(known, '--c1', 0.75);
    }
    for (const other of this.motions.slice(1)) this.#line(this.#points(other, other.time, other.rho), '--c4', 0.7);
    this.#addBurns(run, motion);
    if (this.options.axes === 'rotating') this.#addWaypoints(run);
  }

  #addBurns(run, motion) {
    this.burns = [];
    const table = run.table('maneuvers');
    const dv = table?.vector('executed_dv_rtn_r_mps', 'executed_dv_rtn_t_mps', 'executed_dv_rtn_n_mps');
    if (!dv) return;
    for (let k = 0; k < table.rows; ++k) {
      const executed = dv.map((column) => column[k]), t = table.time[k], size = norm(executed);
      if (!(size > 0) || t < motion.time[0] || t > motion.time.at(-1)) continue;
      const frame = motion.frameAt(t), display = this.#toDisplay(frame);
      const geometry = new three.BufferGeometry().setFromPoints([[0, 0, 0], [0, 1, 0], [0, 1, 0], [0.1, 0.75, 0], [0, 1, 0], [-0.1, 0.75, 0]].map(vector));
      const burn = new three.LineSegments(geometry, new three.LineBasicMaterial({ color: cssColour('--c3') }));
      burn.position.copy(vector(display(this.#placeOf(frame.rho))));
      burn.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), vector(display(scaled(1 / size, executed))).normalize());
      burn.userData = { t, pixels: Math.min(Math.max(14 + 18 * (Math.log10(size) + 4), 10), 90) };
      burn.frustumCulled = false;
      this.burns.push(burn);
      this.paths.add(burn);
    }
  }

  #addWaypoints(run) {
    const table = run.table('waypoints');
    const place = table?.vector('desired_position_rtn_r_m', 'desired_position_rtn_t_m', 'desired_position_rtn_n_m');
    for (let k = 0; place && k < table.rows; ++k) {
      const label = this.#label(`${table.cells('index')[k]}`, 'waypoint');
      label.position.copy(vector(displayOf(this.#placeOf(place.map((column) => column[k])))));
      label.element.title = `waypoint ${table.cells('index')[k]}`;
    }
  }

  // ---- the instant

  show(t) {
    const motion = this.motions[0], frame = motion.frameAt(t), display = this.#toDisplay(frame);
    const place = vector(display(this.#placeOf(frame.rho)));
    const origin = new three.Vector3();
    const [atServicer, atTarget] = this.options.centre === 'servicer' ? [origin, place] : [place, origin];
    this.frame = frame;
    this.range = norm(frame.rho);
    this.t = t;
    this.servicer.position.copy(atServicer);
    this.target.position.copy(atTarget);
    this.#orient(this.servicer, motion, frame, display);
    this.#orient(this.target, motion, frame, display);
    this.ghosts.forEach((ghost, k) => {
      const other = this.motions[k + 1], there = other.frameAt(t);
      ghost.visible = t >= other.time[0] && t <= other.time.at(-1);
      const at = vector(this.#toDisplay(there)(this.#placeOf(there.rho)));
      ghost.position.copy(at);
      this.#orient(ghost, other, there, this.#toDisplay(there));
    });
    this.flown.geometry.setDrawRange(0, frame.row + 1);

    const estimate = motion.estimateAt(t);
    this.ellipsoid.visible = Boolean(estimate);
    if (estimate) {
      // Drawn about the estimate of the target; about the target, that of the servicer has the same errors.
      this.ellipsoid.position.copy(vector(display(this.#placeOf(estimate.rho))));
      this.ellipsoid.quaternion.setFromRotationMatrix(this.#matrix(display));
      this.ellipsoid.scale.set(...estimate.sigma.map((s) => Math.max(3 * s, 1e-6)));
    }
    const keepOut = this.#keepOutAt(t);
    this.keepOut.visible = keepOut > 0;
    this.keepOut.position.copy(atTarget);
    this.keepOut.scale.setScalar(Math.max(keepOut, 1e-6));
    this.keepOutRadius = keepOut;

    const orbit = motion.commandedOrbitAt(t);
    this.commanded.visible = Boolean(orbit);
    if (orbit) this.commanded.geometry.setFromPoints(orbit.map((place) => vector(display(this.#placeOf(place)))));

    const sun = motion.sunAt(t);
    this.arrows.sun.visible = Boolean(sun);
    const sunDirection = sun ? vector(display(times(frame.rtnFromEci, sun.eci))) : new three.Vector3(0.5, 1, 0.7).normalize();
    this.sunLight.position.copy(sunDirection);
    this.sunLight.intensity = 3.2 * (sun ? sun.fraction : 1);
    this.ambient.intensity = sun ? 0.55 : 1.2;
    const turn = (arrow, direction) => arrow.quaternion.setFromUnitVectors(new three.Vector3(0, 1, 0), direction.clone().normalize());
    turn(this.arrows.sun, sunDirection);
    turn(this.arrows.earth, vector(display([-1, 0, 0])));
    turn(this.arrows.r, vector(display([1, 0, 0])));
    turn(this.arrows.t, vector(display([0, 1, 0])));
    turn(this.arrows.n, vector(display([0, 0, 1])));
    this.#see(motion, frame, display, atServicer);
    this.#aim(atServicer, atTarget);
    this.#draw();
  }

  /** The rotation to display axes from RTN. */
  #matrix(display) {
    return new three.Matrix4().makeBasis(...[[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => vector(display(axis))));
  }

  #orient(body, motion, frame, display) {
    const eciFromBody = motion.eciFromBody(body.userData.name, frame.t);
    body.userData.hasAttitude = Boolean(eciFromBody);
    // The display axes of RTN are a rotation; without attitudes the body axes are those of RTN.
    const axes = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((axis) => (eciFromBody ? times(frame.rtnFromEci, times(eciFromBody, axis)) : axis));
    body.quaternion.setFromRotationMatrix(new three.Matrix4().makeBasis(...axes.map((axis) => vector(display(axis)))));
  }

  #keepOutAt(t) {
    const scene = this.runs[0].scene;
    if (!scene?.waypoints) return 0;
    return scene.waypoints.find((waypoint) => waypoint.time_s >= t)?.keep_out_m ?? scene.keep_out_m ?? 0;
  }

  /** The field of view of the first camera, out to the range of the target. */
  #see(motion, frame, display, atServicer) {
    const camera = this.servicer.userData.cameras[0], eciFromBody = motion.eciFromBody(this.servicer.userData.name, frame.t);
    this.sight.visible = Boolean(camera && eciFromBody);
    if (!this.sight.visible) return;
    const bodyFromCamera = transposed(matrixOf(camera.q_camera_body));
    const corner = (x, y) => vector(display(times(frame.rtnFromEci, times(eciFromBody, times(bodyFromCamera,
      scaled(this.range, [x * camera.tan_half_width, y * camera.tan_half_height, 1])))))).add(atServicer);
    const corners = [corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1)];
    const points = corners.flatMap((c, k) => [atServicer, c, c, corners[(k + 1) % 4]]);
    this.sight.geometry.dispose();
    this.sight.geometry = new three.BufferGeometry().setFromPoints(points);
  }

  // ---- the camera

  setView(view) {
    this.options.view = view;
    const directions = { along: [-1, 0.02, 0.02], above: [0, 1, 0.001], whole: [0, 0.25, 1], both: [0.12, 0.3, 1], servicer: [0.5, 0.4, 1], target: [0.5, 0.4, 1] };
    this.aimed = undefined;
    this.direction = vector(directions[view]).normalize();
    if (this.frame) this.show(this.t);
  }

  set(options) {
    Object.assign(this.options, options);
    this.rebuildPaths();
    this.setView(this.options.view);
  }

  /** Keeps what the view is about in the middle, at a distance in proportion to its size; the user's zoom and direction
   *  stay. */
  #aim(atServicer, atTarget) {
    const view = this.options.view;
    let centre, size;
    if (view === 'whole') {
      const box = new three.Box3().setFromPoints(this.truePoints.map((p) => p.at)).expandByPoint(new three.Vector3());
      centre = box.getCenter(new three.Vector3());
      size = 0.62 * box.getSize(new three.Vector3()).length();
    } else if (view === 'servicer' || view === 'target') {
      const body = this[view];
      centre = body.position.clone();
      size = 2 * body.userData.radius;
    } else {
      centre = atServicer.clone().add(atTarget).multiplyScalar(0.5);
      size = Math.max(0.62 * this.range, 1.5);
    }
    if (!this.aimed) {
      this.camera.position.copy(centre).addScaledVector(this.direction, 2.4 * size);
    } else {
      const offset = this.camera.position.clone().sub(this.controls.target).multiplyScalar(size / this.aimed.size);
      this.camera.position.copy(centre).add(offset);
    }
    this.controls.target.copy(centre);
    this.aimed = { size };
    this.camera.near = size * 1e-4;
    this.camera.far = size * 1e4 + 1e6;
    this.camera.updateProjectionMatrix();
    this.updating = true;
    this.controls.update();
    this.updating = false;
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.#draw();
  }

  /** m a pixel at a place. */
  #metresPerPixel(place) {
    return (2 * Math.tan((this.camera.fov * Math.PI) / 360) * Math.max(this.camera.position.distanceTo(place), 1e-9)) / this.element.clientHeight;
  }

  /** Draws with the next frame of the browser, however often it is asked to before. */
  #draw() {
    if (this.updating || !this.frame || this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.#render();
    });
  }

  #render() {
    for (const body of [this.servicer, this.target, ...this.ghosts]) {
      const scale = Math.max((kMinPixels * this.#metresPerPixel(body.position)) / body.userData.radius, 1);
      body.scale.setScalar(scale);
      body.userData.scale = scale;
    }
    const perPixel = this.#metresPerPixel(this.controls.target);
    const origin = this.options.centre === 'servicer' ? this.servicer.position : this.target.position;
    for (const [name, arrow] of Object.entries(this.arrows)) {
      const isAxis = name.length === 1;
      arrow.position.copy(origin);
      arrow.scale.setScalar((isAxis ? 60 : 100) * this.#metresPerPixel(origin));
      arrow.userData.label.position.copy(new three.Vector3(0, 1.12, 0).applyQuaternion(arrow.quaternion).multiplyScalar(arrow.scale.x).add(arrow.position));
      arrow.userData.label.visible = arrow.visible;
    }
    for (const burn of this.burns) {
      burn.scale.setScalar(burn.userData.pixels * this.#metresPerPixel(burn.position));
      burn.material.opacity = burn.userData.t <= this.t ? 1 : 0.35;
      burn.material.transparent = true;
    }
    this.#drawGrid(perPixel);
    this.#describe();
    this.renderer.render(this.world, this.camera);
    this.#placeLabels();
  }

  /** Lines in the plane of R and T, a decade apart from what a hundred pixels show. */
  #drawGrid(perPixel) {
    const spacing = 10 ** Math.ceil(Math.log10(60 * perPixel));
    if (spacing !== this.spacing) {
      this.spacing = spacing;
      this.grid.clear();
      const grid = new three.GridHelper(40 * spacing, 40);
      Object.assign(grid.material, { transparent: true, opacity: 0.16, vertexColors: false });
      grid.material.color.set(cssColour('--muted'));
      grid.rotation.x = Math.PI / 2;
      this.grid.add(grid);
    }
    const snap = (x) => Math.round(x / spacing) * spacing;
    this.grid.position.set(snap(this.controls.target.x), snap(this.controls.target.y), 0);
  }

  #describe() {
    const enlarged = (body) => (body.userData.scale > 1.05 ? ` ×${body.userData.scale >= 10 ? Math.round(body.userData.scale) : body.userData.scale.toFixed(1)}` : '');
    const without = (body) => (body.userData.hasShape ? '' : ', no model');
    this.servicerLabel.element.textContent = `${this.servicer.userData.name}${enlarged(this.servicer)}${without(this.servicer)}`;
    this.servicerLabel.position.copy(this.servicer.position);
    this.targetLabel.element.textContent = `${this.target.userData.name}${enlarged(this.target)}${without(this.target)}`;
    this.targetLabel.position.copy(this.target.position);
    this.estimateLabel.visible = this.ellipsoid.visible;
    this.estimateLabel.element.textContent = '3σ';
    this.estimateLabel.position.copy(new three.Vector3(1, 0, 0).applyQuaternion(this.ellipsoid.quaternion).multiplyScalar(this.ellipsoid.scale.x).add(this.ellipsoid.position));
    if (this.estimateLabel.position.distanceTo(this.target.position) < 12 * this.#metresPerPixel(this.target.position)) this.estimateLabel.visible = false;
    const keepOut = this.keepOut.visible ? `, keep-out ${withUnit(this.keepOutRadius, 'm', 3)}` : '';
    this.gridLabel.textContent = `RTN ${this.options.axes}, about the ${this.options.centre} · grid ${this.spacing >= 1000 ? `${this.spacing / 1000} km` : `${+this.spacing.toPrecision(3)} m`}${keepOut}`;
  }

  #placeLabels() {
    const { clientWidth: width, clientHeight: height } = this.element;
    for (const { element, position, visible } of this.labels) {
      const p = position.clone().project(this.camera);
      const shown = visible && p.z < 1 && Math.abs(p.x) < 1.05 && Math.abs(p.y) < 1.05;
      element.style.display = shown ? '' : 'none';
      if (shown) element.style.transform = `translate(${((p.x + 1) * width) / 2}px, ${((1 - p.y) * height) / 2}px)`;
    }
  }
}
