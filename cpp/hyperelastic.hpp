// Hyperelastic materials: stress (second Piola-Kirchhoff) and tangent from the strain of Green and Lagrange,
// docs/theory/finite-deformation.md.
#pragma once
#include "materials.hpp"
#include <cmath>

namespace abut {

enum class Law { SAINT_VENANT_KIRCHHOFF, LOG_SQUARED, SQUARE_LOG, ISOCHORIC };

// The right Cauchy-Green tensor 1 + 2 E, its inverse and what of it is small where strains are small.
struct Metric {
  double inverse[STRAINS]; // xx yy zz xy yz zx
  double missing[STRAINS]; // 1 - inverse
  double jacobian, growth; // J and J - 1
  double trace;            // of E

  explicit Metric(const double *e) {
    // det C - 1 by the invariants of E, lest small strains lose their digits; e[3..5] are twice xy, yz, zx
    const double xy = e[3] / 2, yz = e[4] / 2, zx = e[5] / 2;
    trace = e[0] + e[1] + e[2];
    const double second = e[0] * e[1] + e[1] * e[2] + e[2] * e[0] - xy * xy - yz * yz - zx * zx;
    const double third = e[0] * (e[1] * e[2] - yz * yz) - xy * (xy * e[2] - yz * zx) + zx * (xy * yz - e[1] * zx);
    const double more = 2 * trace + 4 * second + 8 * third;
    jacobian = std::sqrt(1 + more), growth = more / (1 + jacobian);
    const double cx = 1 + 2 * e[0], cy = 1 + 2 * e[1], cz = 1 + 2 * e[2], det = 1 + more;
    inverse[0] = (cy * cz - e[4] * e[4]) / det, inverse[1] = (cx * cz - e[5] * e[5]) / det;
    inverse[2] = (cx * cy - e[3] * e[3]) / det;
    inverse[3] = (e[4] * e[5] - e[3] * cz) / det, inverse[4] = (e[3] * e[5] - e[4] * cx) / det;
    inverse[5] = (e[3] * e[4] - e[5] * cy) / det;
    for (int a = 0; a < 3; ++a) { // 2 E C^-1
      const int b = (a + 1) % 3, c = (a + 2) % 3;
      missing[a] = 2 * e[a] * inverse[a] + e[3 + a] * inverse[3 + a] + e[3 + c] * inverse[3 + c];
      missing[3 + a] = 2 * e[a] * inverse[3 + a] + e[3 + a] * inverse[b] + e[3 + c] * inverse[3 + b];
    }
  }

  // c += outer inverse x inverse + square (its square as a product of fourth order, symmetric in each pair of indices)
  void add_to(double *c, double outer, double square) const {
    static constexpr int I[STRAINS] = {0, 1, 2, 0, 1, 2}, J[STRAINS] = {0, 1, 2, 1, 2, 0};
    static constexpr int AT[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};
    for (int s = 0; s < STRAINS; ++s)
      for (int t = 0; t < STRAINS; ++t)
        c[s * STRAINS + t] += outer * inverse[s] * inverse[t] + square / 2 *
                                                                    (inverse[AT[I[s]][I[t]]] * inverse[AT[J[s]][J[t]]] +
                                                                     inverse[AT[I[s]][J[t]]] * inverse[AT[J[s]][I[t]]]);
  }
};

// With the two constants (cells, 2) of each cell: lambda and mu, the bulk modulus and mu of the isochoric law.
struct Hyperelastic {
  using Tangent = Dense;
  static constexpr bool stress_by_strain = true, tangent_by_strain = true;
  static constexpr double ROUNDING = 1e-14; // stress out of the plane over the modulus
  static constexpr int LIMIT = 50;          // iterations in plane stress; about five are needed
  const double *constants;
  Law law;
  bool plane_stress;

  static constexpr bool symmetric() { return true; }

  Dense evaluate(const Point &at, double *strain, double *stress) const {
    const double first = constants[2 * at.cell], mu = constants[2 * at.cell + 1];
    Dense result{};
    result.sound = true;
    if (!plane_stress)
      respond(first, mu, strain, stress, result);
    else
      result.sound = find_thickness(first, mu, strain, stress, result);
    return result;
  }

private:
  // The strain out of the plane that leaves no stress there, by Newton's method on the logarithm of the stretch; that
  // of Saint Venant and Kirchhoff is linear. False where there is none.
  bool find_thickness(double first, double mu, double *strain, double *stress, Dense &result) const {
    constexpr int Z = 2;
    if (law == Law::SAINT_VENANT_KIRCHHOFF) {
      strain[Z] = -first / (first + 2 * mu) * (strain[0] + strain[1]);
      respond(first, mu, strain, stress, result);
      return strain[Z] > -0.5 && condense(stress, result);
    }
    const double area = 2 * (strain[0] + strain[1]) + 4 * strain[0] * strain[1] - strain[3] * strain[3];
    double log = -first / (first + 2 * mu) * std::log1p(area) / 2;
    for (int i = 0; i < LIMIT; ++i) {
      strain[Z] = std::expm1(2 * log) / 2;
      respond(first, mu, strain, stress, result);
      // The Kirchhoff stress, which grows with the stretch where the second of Piola and Kirchhoff may not.
      const double square = 1 + 2 * strain[Z], left = square * stress[Z];
      if (std::abs(left) <= ROUNDING * (std::abs(first) + mu) || (i > 8 && flat(left, first, mu)))
        return condense(stress, result);
      const double slope = square * (square * result.c[Z * STRAINS + Z] + 2 * stress[Z]);
      log -= slope > 0 ? std::max(std::min(left / slope, 0.5), -0.5) : std::copysign(0.5, left);
    }
    return false;
  }
  static bool flat(double left, double first, double mu) { return std::abs(left) <= 1e-11 * (std::abs(first) + mu); }

  static bool condense(double *stress, Dense &result) {
    constexpr int Z = 2;
    const double own = result.c[Z * STRAINS + Z];
    double column[STRAINS];
    for (int s = 0; s < STRAINS; ++s)
      column[s] = result.c[s * STRAINS + Z];
    for (int s = 0; s < STRAINS; ++s)
      for (int t = 0; t < STRAINS; ++t)
        result.c[s * STRAINS + t] -= column[s] * column[t] / own;
    stress[Z] = 0;
    return own > 0;
  }

  void respond(double first, double mu, const double *e, double *stress, Dense &result) const {
    std::fill_n(result.c, STRAINS * STRAINS, 0.0);
    if (law == Law::SAINT_VENANT_KIRCHHOFF)
      return linear(first, mu, e, stress, result);
    const Metric metric(e);
    if (law == Law::ISOCHORIC)
      return isochoric(first, mu, metric, stress, result);
    // push = J U'(J), slope = J (J U')'
    const double log = std::log1p(metric.growth), j = metric.jacobian, grown = metric.growth * (1 + j); // J^2 - 1
    const bool squared = law == Law::LOG_SQUARED;
    const double push = squared ? first * log : first / 2 * grown, slope = squared ? first : first * j * j;
    for (int s = 0; s < STRAINS; ++s)
      stress[s] = mu * metric.missing[s] + push * metric.inverse[s];
    metric.add_to(result.c, slope, 2 * (mu - push));
    const double swelling = squared ? log * log : grown / 2 - log;
    result.energy = mu * (metric.trace - log) + first / 2 * swelling;
  }

  static void linear(double lambda, double mu, const double *e, double *stress, Dense &result) {
    const double trace = e[0] + e[1] + e[2];
    for (int a = 0; a < 3; ++a) {
      stress[a] = 2 * mu * e[a] + lambda * trace, stress[3 + a] = mu * e[3 + a];
      for (int b = 0; b < 3; ++b)
        result.c[a * STRAINS + b] = lambda + 2 * mu * (a == b);
      result.c[(3 + a) * STRAINS + 3 + a] = mu;
    }
    result.energy = 0;
    for (int s = 0; s < STRAINS; ++s)
      result.energy += stress[s] * e[s] / 2;
  }

  static void isochoric(double bulk, double mu, const Metric &m, double *stress, Dense &result) {
    const double j = m.jacobian, shear = mu * std::pow(j, -2.0 / 3), third = 1 + 2 * m.trace / 3; // tr C / 3
    const double push = bulk * j * m.growth;
    for (int s = 0; s < STRAINS; ++s)
      stress[s] = shear * (m.missing[s] - 2 * m.trace / 3 * m.inverse[s]) + push * m.inverse[s];
    m.add_to(result.c, 2.0 / 3 * shear * third + bulk * j * (2 * j - 1), 2 * shear * third - 2 * push);
    for (int a = 0; a < 3; ++a)
      for (int s = 0; s < STRAINS; ++s) {
        result.c[a * STRAINS + s] -= 2.0 / 3 * shear * m.inverse[s];
        result.c[s * STRAINS + a] -= 2.0 / 3 * shear * m.inverse[s];
      }
    const double shrink = std::expm1(-2.0 / 3 * std::log1p(m.growth)); // J^(-2/3) - 1
    result.energy = mu / 2 * (2 * m.trace + shrink * (3 + 2 * m.trace)) + bulk / 2 * m.growth * m.growth;
  }
};

} // namespace abut
