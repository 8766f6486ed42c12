// Materials as the integration sees them: evaluate(point, strain, stress) returns the tangent and writes the stress.
// Stresses are xx yy zz xy yz zx; strains alike, shear strains doubled, so that their product is work. A material with
// history holds it by point: what was before it reads, what comes after it writes where point.mine says so.
#pragma once
#include <algorithm>
#include <cstddef>

namespace abut {

constexpr int STRAINS = 6;

// Tangents: what the stiffness of a cell is made of. Two constants of an isotropic material, or any (6, 6).
struct Moduli {
  double lambda, mu;
};
struct Full {
  const double *c;
};

// What a law says at a point: tangent and energy. sound: false where plane stress found no strain out of the plane.
// turned: the tangent is along the columns of ``axes``, which save turning it where that is not needed.
struct Dense {
  double c[STRAINS * STRAINS], energy;
  bool sound, turned = false;
  double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
};

// An integration point: of a cell, its number among all points of all cells, and whether this thread is the one to
// write what belongs to it (cells may be visited by several). near: null, or what the law said at another point of the
// cell, whose axes are a first guess.
struct Point {
  std::size_t cell, number;
  bool mine;
  const Dense *near = nullptr;
};

// A tangent of isotropic elasticity and of flow: diagonal times the identity of symmetric tensors, spherical times that
// of their traces, and, where it flows, the dyad of two stresses, coaxial: the first is ``factor`` times the second.
struct Flowing {
  double diagonal, spherical, stress[STRAINS], normal[STRAINS], factor;
  bool flows = false, coaxial = false;

  // c (6, 6), its rows and columns times ``scale``.
  void write(double *c, const double (&scale)[STRAINS]) const {
    double left[STRAINS], right[STRAINS];
    for (int s = 0; s < STRAINS; ++s)
      left[s] = flows ? scale[s] * stress[s] : 0, right[s] = flows ? scale[s] * normal[s] : 0;
    for (int s = 0; s < STRAINS; ++s)
      for (int t = 0; t < STRAINS; ++t)
        c[s * STRAINS + t] = left[s] * right[t];
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b)
        c[a * STRAINS + b] += spherical * scale[a] * scale[b];
      c[a * STRAINS + a] += diagonal * scale[a] * scale[a];
      c[(3 + a) * STRAINS + 3 + a] += diagonal / 2 * scale[3 + a] * scale[3 + a];
    }
  }
};

// Isotropic linear elasticity with the constants (cells, 2) of each cell; in plane stress lambda is the reduced one.
struct Isotropic {
  using Tangent = Moduli;
  static constexpr bool stress_by_strain = true, tangent_by_strain = false; // what strains have to be known for
  const double *constants;
  bool plane_stress;

  static constexpr bool symmetric() { return true; } // its tangent

  Moduli evaluate(const Point &at, const double *strain, double *stress) const {
    const double lambda = constants[2 * at.cell], mu = constants[2 * at.cell + 1];
    if (stress) {
      const double spherical = lambda * (strain[0] + strain[1] + (plane_stress ? 0 : strain[2]));
      for (int a = 0; a < 3; ++a) {
        stress[a] = 2 * mu * strain[a] + spherical;
        stress[3 + a] = mu * strain[3 + a];
      }
      if (plane_stress)
        stress[2] = 0;
    }
    return {lambda, mu};
  }
};

// Stresses (points, 6) and tangents (points, 6, 6) that somebody else has evaluated.
struct Given {
  using Tangent = Full;
  static constexpr bool stress_by_strain = false, tangent_by_strain = false;
  const double *stresses, *tangents;

  static constexpr bool symmetric() { return false; }

  Full evaluate(const Point &at, const double *, double *stress) const {
    if (stress)
      std::copy_n(stresses + at.number * STRAINS, STRAINS, stress);
    return {tangents ? tangents + at.number * STRAINS * STRAINS : nullptr};
  }
};

// The same under finite strains, with the strains (points, 6) that belong to them.
struct GivenFinite {
  using Tangent = Dense;
  static constexpr bool stress_by_strain = true, tangent_by_strain = true;
  const double *strains, *stresses, *tangents;
  bool plane_stress;

  static constexpr bool symmetric() { return false; }

  Dense evaluate(const Point &at, double *strain, double *stress) const {
    Dense result;
    result.sound = true, result.energy = 0;
    std::copy_n(strains + at.number * STRAINS, STRAINS, strain);
    std::copy_n(stresses + at.number * STRAINS, STRAINS, stress);
    std::copy_n(tangents + at.number * STRAINS * STRAINS, STRAINS * STRAINS, result.c);
    return result;
  }
};

// Writes the strains (points, 6) down.
struct Told {
  using Tangent = Dense;
  static constexpr bool stress_by_strain = true, tangent_by_strain = true, plane_stress = false;
  double *strains;

  static constexpr bool symmetric() { return false; }

  Dense evaluate(const Point &at, const double *strain, double *stress) const {
    std::copy_n(strain, STRAINS, strains + at.number * STRAINS);
    std::fill_n(stress, STRAINS, 0.0);
    return {{0}, 0, true};
  }
};

// A material at a point that heat stretches freely by ``stretch``, theory (D5): its strain is the elastic one.
template <class Material>
typename Material::Tangent heated(const Material &material, const Point &point, double stretch, double *strain,
                                  double *stress) {
  const double square = stretch * stretch;
  if (stretch != 1)
    for (int s = 0; s < STRAINS; ++s)
      strain[s] = (strain[s] - (s < 3) * (square - 1) / 2) / square;
  auto result = material.evaluate(point, strain, stress);
  if (stretch != 1) {
    for (int s = 0; s < STRAINS; ++s)
      stress[s] *= stretch;
    for (double &c : result.c)
      c /= stretch;
    result.energy *= stretch * square;
  }
  return result;
}

} // namespace abut
