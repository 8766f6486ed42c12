// Pressures that Newton's method foresees, docs/theory/finite-deformation.md (D24).
#pragma once
#include "hyperelastic.hpp"

namespace abut {

// Puts the pressure in the place of that at a strain which there would be without a change of volume: in the stress
// (6,) and its tangent (6, 6). The bulk modulus is what the tangent says of a strain alike in all directions; a
// negative one foresees nothing.
inline void foresee_pressure(const double *strain, double change, double *stress, double *c) {
  const Metric metric(strain);
  double swelling[STRAINS], mean = 0, stiff = 0; // the right Cauchy-Green tensor; Kirchhoff's mean stress
  for (int s = 0; s < STRAINS; ++s)
    swelling[s] = 2 * strain[s] + (s < 3);
  for (int s = 0; s < STRAINS; ++s) {
    mean += swelling[s] * stress[s] / 3;
    for (int t = 0; t < STRAINS; ++t)
      stiff += swelling[s] * c[s * STRAINS + t] * swelling[t] / 9;
  }
  const double j = metric.jacobian, bulk = std::max((stiff - mean / 3) / (j * j), 0.0);
  const double more = -bulk * change * j;
  for (int s = 0; s < STRAINS; ++s)
    stress[s] += more * metric.inverse[s];
  metric.add_to(c, more, -2 * more);
}

} // namespace abut
