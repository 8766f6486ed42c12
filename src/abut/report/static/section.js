"use strict";
// A section: what lies before a plane is cut away, and bodies show their inside on it.

// How a copy of the model, mirrored at some planes (normal, constant), lies in space.
class Reflection {
  constructor(planes) { this.planes = planes; }

  // A plane (normal, constant) as the original sees it.
  plane([a, b, c, d]) {
    let n = [a, b, c], at = d;
    for (const [x, y, z, level] of [...this.planes].reverse()) {
      const along = n[0] * x + n[1] * y + n[2] * z;
      at -= 2 * level * along;
      n = [n[0] - 2 * along * x, n[1] - 2 * along * y, n[2] - 2 * along * z];
    }
    return [...n, at];
  }

  point(x) {
    let p = x;
    for (const [a, b, c, level] of this.planes) {
      const out = 2 * (p[0] * a + p[1] * b + p[2] * c - level);
      p = [p[0] - out * a, p[1] - out * b, p[2] - out * c];
    }
    return p;
  }

  // Puts it into a Matrix4.
  into(matrix) {
    const o = this.point([0, 0, 0]), columns = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((e) => this.point(e).map((v, i) => v - o[i]));
    matrix.set(...[0, 1, 2].flatMap((i) => [columns[0][i], columns[1][i], columns[2][i], o[i]]), 0, 0, 0, 1);
  }
}

// Every way to mirror at some of the planes, the original left out; two planes that are not at right angles make no whole.
function reflections(planes) {
  const square = planes.filter((p, i) => planes.slice(0, i).every((o) => Math.abs(p[0] * o[0] + p[1] * o[1] + p[2] * o[2]) < 1e-6));
  return Array.from({ length: (1 << square.length) - 1 }, (_, k) => new Reflection(square.filter((_, i) => ((k + 1) >> i) & 1)));
}

// The inside of one body on the plane.
class Cap {
  constructor(part) {
    this.part = part;
    this.inside = unpack(part.item.inside);
    this.geometry = new THREE.BufferGeometry();
    this.mesh = new THREE.Mesh(this.geometry, surfaceMaterial(true, { value: [0, 0, 0, 1] }));
    this.mesh.frustumCulled = false;
    this.mesh.matrixAutoUpdate = false;
    this.mesh.visible = false;
    this.mesh.userData.cap = this;
  }

  // Cut the body where it is drawn: plane (normal, constant) in its own coordinates; values at its points, or null.
  update(plane, values) {
    const x = this.part.place.array, n = x.length / 3, height = new Float32Array(n), [a, b, c, d] = plane;
    for (let i = 0; i < n; i++) height[i] = a * x[3 * i] + b * x[3 * i + 1] + c * x[3 * i + 2] - d;
    const place = [], value = [], known = values !== null;
    const between = (i, j) => {
      const t = height[i] / (height[i] - height[j]);
      for (let k = 0; k < 3; k++) place.push(x[3 * i + k] + t * (x[3 * j + k] - x[3 * i + k]));
      value.push(known ? values[i] + t * (values[j] - values[i]) : 0, known ? 1 : 0);
    };
    for (let t = 0; t < this.inside.length; t += 4) {
      const corners = this.inside.subarray(t, t + 4), up = [], down = [];
      for (const k of corners) (height[k] > 0 ? up : down).push(k);
      if (!up.length || !down.length) continue;
      if (up.length === 2) {
        const [p, q] = up, [r, s] = down;
        for (const [i, j] of [[p, r], [q, r], [q, s], [p, r], [q, s], [p, s]]) between(i, j);
      } else {
        const [one, others] = up.length === 1 ? [up[0], down] : [down[0], up];
        for (const other of others) between(one, other);
      }
    }
    const normal = new Float32Array(place.length);
    for (let i = 0; i < normal.length; i++) normal[i] = plane[i % 3];
    const array = (list, size) => new THREE.BufferAttribute(Float32Array.from(list), size);
    this.geometry.dispose();
    this.geometry.setAttribute("position", array(place, 3));
    this.geometry.setAttribute("normal", array(normal, 3));
    this.geometry.setAttribute("value", array(value, 2));
    this.geometry.boundingSphere = this.geometry.boundingBox = null;
    this.count = place.length / 9;
  }
}
