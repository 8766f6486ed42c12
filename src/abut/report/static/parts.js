"use strict";
// The bodies and contact surfaces of the picture as geometry that three.js draws.

const MAPS = {
  "pressure": ["1b0c41", "4a0c6b", "781c6d", "a52c60", "cf4446", "ed6925", "fb9b06", "f7d13d", "fcffa4"],
  "gap": ["fde725", "b5de2b", "6ece58", "35b779", "1f9e89", "26828e", "31688e", "3e4989", "482878", "440154"],
  "traction": ["f7fbff", "c6dbef", "6baed6", "3182bd", "225ea8", "253494", "081d58"],
  "slip": ["fff7ec", "fee8c8", "fdd49e", "fdbb84", "fc8d59", "ef6548", "d7301f", "b30000", "7f0000"],
  "slip in the step": ["fff7ec", "fee8c8", "fdd49e", "fdbb84", "fc8d59", "ef6548", "d7301f", "b30000", "7f0000"],
  "friction work": ["fcfbfd", "dadaeb", "9e9ac8", "756bb1", "54278f", "3f007d"],
  "status": ["b8bec6", "b8bec6", "e8a33d", "e8a33d", "e8a33d", "2a6fb5", "2a6fb5"],
  "von Mises": ["30123b", "4145ab", "4675ed", "39a2fc", "1bcfd4", "24eca6", "61fc6c", "a4fc3b", "d1e834", "f3c63a", "fe9b2d", "f36315", "d93806", "b11901", "7a0402"],
  "largest principal stress": ["313695", "4575b4", "74add1", "abd9e9", "f7f7f7", "fdae61", "f46d43", "d73027", "a50026"],
  "smallest principal stress": ["313695", "4575b4", "74add1", "abd9e9", "f7f7f7", "fdae61", "f46d43", "d73027", "a50026"],
  "plastic strain": ["fffff0", "fff2ae", "fec44f", "fe9929", "ec7014", "cc4c02", "8c2d04"],
  "stress error": ["fcfbfd", "dadaeb", "9e9ac8", "756bb1", "54278f", "3f007d"],
  "displacement": ["440154", "482878", "3e4989", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b", "fde725"],
  "mode shape": ["440154", "482878", "3e4989", "31688e", "26828e", "1f9e89", "35b779", "6ece58", "b5de2b", "fde725"],
};

const STATUS = [["open", "b8bec6"], ["slipping", "e8a33d"], ["sticking", "2a6fb5"]]; // by its value as drawn
const FROM_ZERO = ["pressure", "traction", "slip", "slip in the step", "friction work"];
const ON_BODIES = ["von Mises", "largest principal stress", "smallest principal stress", "plastic strain", "stress error", "displacement", "mode shape"];

// An array of the page, from its place in the text that has all of them, byte by byte of its numbers.
function unpack(array) {
  unpack.bytes ||= inflate(atob(document.getElementById("arrays").textContent.trim()));
  const n = array.count, from = unpack.bytes.subarray(4 * array.at, 4 * (array.at + n)), bytes = new Uint8Array(4 * n);
  for (let k = 0; k < 4; k++) for (let i = 0; i < n; i++) bytes[4 * i + k] = from[k * n + i];
  return array.type === "f4" ? new Float32Array(bytes.buffer) : new Uint32Array(bytes.buffer);
}

function ramp(stops) { // a colour map as a texture
  const size = 256, data = new Uint8Array(4 * size);
  const rgb = stops.map((s) => [0, 2, 4].map((k) => parseInt(s.slice(k, k + 2), 16)));
  for (let i = 0; i < size; i++) {
    const at = (i / (size - 1)) * (rgb.length - 1), k = Math.min(Math.floor(at), rgb.length - 2), t = at - k;
    for (let c = 0; c < 3; c++) data[4 * i + c] = Math.round((1 - t) * rgb[k][c] + t * rgb[k + 1][c]);
    data[4 * i + 3] = 255;
  }
  const texture = new THREE.DataTexture(data, size, 1);
  texture.magFilter = texture.minFilter = THREE.LinearFilter;
  texture.needsUpdate = true;
  return texture;
}

// What lies beyond the plane ``cut`` is not drawn.
const WHERE = "where = (modelMatrix * vec4(position, 1.0)).xyz;", CUT = "if (dot(cut.xyz, where) > cut.w) discard;";

function surfaceMaterial(lit, cut) {
  return new THREE.ShaderMaterial({
    side: THREE.DoubleSide, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
    uniforms: {
      plain: { value: new THREE.Color() }, map: { value: null }, low: { value: 0 }, high: { value: 1 }, bands: { value: 0 },
      coloured: { value: 0 }, nothing: { value: -1e30 }, opacity: { value: 1 }, lit: { value: lit ? 1 : 0 }, cut,
    },
    vertexShader: `attribute vec2 value; varying vec2 v; varying vec3 n, where;
      void main() { v = value; ${WHERE} n = normalMatrix * normal; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
    fragmentShader: `uniform vec3 plain; uniform sampler2D map; uniform float low, high, bands, coloured, nothing, opacity, lit;
      uniform vec4 cut; varying vec2 v; varying vec3 n, where;
      void main() {
        ${CUT}
        float t = clamp((v.x - low) / max(high - low, 1e-30), 0.0, 1.0);
        if (bands > 0.0) t = (min(floor(t * bands), bands - 1.0) + 0.5) / bands;
        bool shown = coloured > 0.5 && v.y > 0.99 && v.x > nothing;
        vec3 rgb = shown ? texture2D(map, vec2(t, 0.5)).rgb : plain;
        vec3 normal = normalize(n);
        if (normal.z < 0.0) normal = -normal;
        float key = max(dot(normal, normalize(vec3(-0.4, 0.55, 0.75))), 0.0);
        float light = shown ? 0.62 + 0.3 * key + 0.12 * normal.z : 0.6 + 0.32 * key + 0.12 * normal.z;
        gl_FragColor = vec4(rgb * mix(1.0, light, lit), opacity);
      }`,
  });
}

function lineMaterial(cut) {
  return new THREE.ShaderMaterial({
    transparent: true, depthWrite: false,
    uniforms: { ink: { value: new THREE.Color() }, opacity: { value: 1 }, cut },
    vertexShader: `varying vec3 where; void main() { ${WHERE} gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
    fragmentShader: `uniform vec3 ink; uniform float opacity; uniform vec4 cut; varying vec3 where; void main() { ${CUT} gl_FragColor = vec4(ink, opacity); }`,
  });
}

// Normals at the corners of triangles, averaged over neighbours that meet at less than 40 degrees.
function creasedNormals(points, triangles) {
  const count = triangles.length / 3, own = new Float32Array(3 * count), result = new Float32Array(3 * triangles.length);
  const first = new Uint32Array(points.length / 3 + 1), list = new Uint32Array(triangles.length);
  for (let t = 0; t < count; t++) {
    const [a, b, c] = [0, 1, 2].map((k) => 3 * triangles[3 * t + k]);
    const [ux, uy, uz] = [0, 1, 2].map((k) => points[b + k] - points[a + k]);
    const [vx, vy, vz] = [0, 1, 2].map((k) => points[c + k] - points[a + k]);
    own.set([uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx], 3 * t);
  }
  for (const node of triangles) first[node + 1]++;
  for (let i = 1; i < first.length; i++) first[i] += first[i - 1];
  const next = first.slice();
  for (let i = 0; i < triangles.length; i++) list[next[triangles[i]]++] = Math.floor(i / 3);
  const size = (t) => Math.hypot(own[3 * t], own[3 * t + 1], own[3 * t + 2]) || 1e-30;
  for (let i = 0; i < triangles.length; i++) {
    const t = Math.floor(i / 3), here = size(t), sum = [0, 0, 0];
    for (let k = first[triangles[i]]; k < first[triangles[i] + 1]; k++) {
      const o = list[k];
      const dot = own[3 * t] * own[3 * o] + own[3 * t + 1] * own[3 * o + 1] + own[3 * t + 2] * own[3 * o + 2];
      if (dot > 0.766 * here * size(o)) for (let c = 0; c < 3; c++) sum[c] += own[3 * o + c];
    }
    const length = Math.hypot(...sum) || 1;
    for (let c = 0; c < 3; c++) result[3 * i + c] = sum[c] / length;
  }
  return result;
}

// One body or one side of a contact. Vertices of the drawing take their place and values from points of the data (map).
class Part {
  constructor(item, kind, flat, turns, cut) {
    this.item = item;
    this.turns = turns; // far: normals go with the deformation
    this.kind = kind; // "body", "side" (surface of a contact) or "fence" (values drawn across a line in 2D)
    this.flat = flat;
    this.sway = null; // of a mode, see sway()
    this.base = unpack(item.points);
    const cells = unpack(item.cells || item.triangles);
    this.geometry = new THREE.BufferGeometry();
    if (kind === "fence") {
      const lines = cells.length / 2, index = [];
      this.map = new Uint32Array(4 * lines);
      for (let i = 0; i < lines; i++) {
        this.map.set([cells[2 * i], cells[2 * i + 1], cells[2 * i + 1], cells[2 * i]], 4 * i);
        index.push(4 * i, 4 * i + 1, 4 * i + 2, 4 * i, 4 * i + 2, 4 * i + 3);
      }
      this.out = this.normals = unpack(item.normals);
      this.lines = cells;
      this.geometry.setIndex(index);
    } else if (kind === "side") {
      this.map = Uint32Array.from({ length: this.base.length / 3 }, (_, i) => i);
      this.geometry.setIndex(new THREE.BufferAttribute(cells, 1));
    } else {
      this.map = cells;
    }
    const n = this.map.length;
    let normals = new Float32Array(3 * n);
    if (flat) for (let i = 0; i < n; i++) normals[3 * i + 2] = 1;
    else normals = kind === "side" ? unpack(item.normals) : creasedNormals(this.base, cells);
    this.geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(3 * n), 3));
    this.geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
    this.geometry.setAttribute("value", new THREE.BufferAttribute(new Float32Array(2 * n), 2));
    this.mesh = new THREE.Mesh(this.geometry, surfaceMaterial(!flat, cut));
    this.mesh.userData.part = this;
    const edges = kind === "fence" ? this.fenceEdges(cells.length / 2) : unpack(item.edges);
    const features = kind === "body" ? item.features : 0;
    this.place = new THREE.BufferAttribute(kind === "fence" ? this.geometry.attributes.position.array : new Float32Array(this.base.length), 3);
    const lines = (part) => {
      const geometry = new THREE.BufferGeometry();
      geometry.setAttribute("position", this.place);
      geometry.setIndex(new THREE.BufferAttribute(part, 1));
      const result = new THREE.LineSegments(geometry, lineMaterial(cut));
      result.frustumCulled = false;
      return result;
    };
    this.features = lines(edges.subarray(0, 2 * features));
    this.grid = lines(edges.subarray(2 * features));
    this.mesh.frustumCulled = false;
  }

  fenceEdges(lines) {
    const edges = new Uint32Array(2 * lines);
    for (let i = 0; i < lines; i++) edges.set([4 * i + 3, 4 * i + 2], 2 * i);
    return edges;
  }

  // Values of a field at the points of the data, or null where this part does not have it.
  field(step, name) {
    if (name === "mode shape") return this.sway && this.sway.size;
    const own = (this.kind === "body" ? step.bodies : step.contacts)[this.item.number];
    if (name !== "displacement") return own[name] ? (own[name].array ||= unpack(own[name])) : null;
    if (!own.size) {
      const u = this.displacement(step);
      own.size = Float32Array.from({ length: u.length / 3 }, (_, i) => Math.hypot(u[3 * i], u[3 * i + 1], u[3 * i + 2]));
    }
    return own.size;
  }

  displacement(step) {
    const own = (this.kind === "body" ? step.bodies : step.contacts)[this.item.number].displacement;
    return (own.array ||= unpack(own));
  }

  // Points of the data at a step, deformed ``scale`` times.
  moved(step, scale) {
    if (!scale) return this.base;
    const u = this.displacement(step);
    return this.base.map((v, i) => v + scale * u[i]);
  }

  // Triangles between points of the data.
  get corners() { return this.kind === "body" ? this.map : this.geometry.index.array; }

  // Normals of a surface at its points as they are now.
  turn(moved) {
    if (this.kind === "side") return this.geometry.computeVertexNormals();
    this.geometry.attributes.normal.array.set(creasedNormals(moved, this.map));
    this.geometry.attributes.normal.needsUpdate = true;
  }

  // Those of the surface before anything moved.
  turnBack() {
    this.geometry.attributes.normal.array.set(this.kind === "side" ? unpack(this.item.normals) : creasedNormals(this.base, this.map));
    this.geometry.attributes.normal.needsUpdate = true;
  }

  // Normals of a line, turned as much as its pieces.
  turned(moved) {
    const turn = new Float32Array(2 * this.base.length / 3), result = new Float32Array(this.normals.length);
    for (let i = 0; i < this.lines.length; i += 2) {
      const [a, b] = [3 * this.lines[i], 3 * this.lines[i + 1]];
      const [x, y, p, q] = [this.base[b] - this.base[a], this.base[b + 1] - this.base[a + 1], moved[b] - moved[a], moved[b + 1] - moved[a + 1]];
      for (const k of [this.lines[i], this.lines[i + 1]]) {
        turn[2 * k] += p * x + q * y;
        turn[2 * k + 1] += q * x - p * y;
      }
    }
    for (let k = 0; 2 * k < turn.length; k++) {
      const size = Math.hypot(turn[2 * k], turn[2 * k + 1]) || 1, [c, s] = [turn[2 * k] / size, turn[2 * k + 1] / size];
      const [x, y] = [this.normals[3 * k], this.normals[3 * k + 1]];
      result.set([c * x - s * y, s * x + c * y, 0], 3 * k);
    }
    return result;
  }

  // Put the part where it is at a step, deformed ``scale`` times; a fence as high as ``height`` times the field ``tall``.
  update(step, scale, name, tall, height) {
    const u = this.displacement(step), values = this.field(step, name), high = this.kind === "fence" ? this.field(step, tall) : null;
    const position = this.geometry.attributes.position, value = this.geometry.attributes.value.array;
    const moved = this.kind === "fence" ? new Float32Array(this.base.length) : this.place.array;
    for (let i = 0; i < moved.length; i++) moved[i] = this.base[i] + scale * u[i] + (this.sway ? this.sway.add[i] : 0);
    if (this.turns && this.kind === "fence") this.out = this.turned(moved);
    for (let i = 0; i < this.map.length; i++) {
      const k = this.map[i], known = values !== null && !Number.isNaN(values[k]);
      value[2 * i] = known ? values[k] : 0;
      value[2 * i + 1] = known ? 1 : 0;
      const up = high !== null && i % 4 > 1 && high[k] > 0 ? height * high[k] : 0;
      for (let c = 0; c < 3; c++) position.array[3 * i + c] = moved[3 * k + c] + (up ? up * this.out[3 * k + c] : 0);
    }
    position.needsUpdate = this.place.needsUpdate = this.geometry.attributes.value.needsUpdate = true;
    if (!this.flat && (this.turns || this.sway)) this.turn(moved);
    else if (this.bent) this.turnBack();
    this.bent = !this.flat && !this.turns && this.sway !== null;
    this.geometry.boundingSphere = this.geometry.boundingBox = null;
  }
}
