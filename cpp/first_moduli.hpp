// Moduli of the first stress of Piola and Kirchhoff by gradients of displacements, theory (D6).
#pragma once
#include "deformed.hpp"

namespace abut {

// By the gradients of displacements, times the point's weight: of the first stress of Piola and Kirchhoff, stress (a,
// b) by slope (c, d) at [d][b][a][c], and of its hoop component.
template <int dim> struct FirstModuli {
  double plane[dim][dim][dim][dim], hoop[dim][dim], of_hoop[dim][dim], own; // hoop: [d][c], of_hoop: [b][a]
};

// Of a tangent c (6, 6).
template <int dim, bool axisymmetric>
void linearise(const Deformed<dim> &at, double w, const double *c, FirstModuli<dim> &result) {
  double half[STRAINS][dim][dim] = {{{0}}}; // w times the second stress by the slope, [s][d][c]
  for (int s = 0; s < STRAINS; ++s)
    for (int d = 0; d < dim; ++d)
      for (int a = 0; a < dim; ++a)
        for (int p = 0; p < dim; ++p)
          half[s][d][a] += w * c[s * STRAINS + COMPONENT[p][d]] * at.f[a][p];
  for (int d = 0; d < dim; ++d)
    for (int b = 0; b < dim; ++b)
      for (int a = 0; a < dim; ++a)
        for (int e = 0; e < dim; ++e) {
          double sum = 0;
          for (int p = 0; p < dim; ++p)
            sum += at.f[a][p] * half[COMPONENT[p][b]][d][e];
          result.plane[d][b][a][e] = sum;
        }
  if constexpr (axisymmetric) {
    const double out = at.f[2][2];
    for (int d = 0; d < dim; ++d)
      for (int a = 0; a < dim; ++a) {
        result.hoop[d][a] = out * half[2][d][a], result.of_hoop[d][a] = 0;
        for (int p = 0; p < dim; ++p)
          result.of_hoop[d][a] += w * out * at.f[a][p] * c[COMPONENT[p][d] * STRAINS + 2];
      }
    result.own = w * out * out * c[2 * STRAINS + 2];
  }
}

// Adds what the hoop strain of a node does; r: as ``respond`` of ``FiniteStrain`` has it.
template <int dim> void add_hoop(const FirstModuli<dim> &moduli, const double (&g)[dim], double hoop, double *r) {
  for (int b = 0; b < dim; ++b)
    for (int a = 0; a < dim; ++a)
      r[(b * dim + a) * dim] += moduli.of_hoop[b][a] * hoop;
  for (int c = 0; c < dim; ++c) {
    double sum = c == 0 ? moduli.own * hoop : 0;
    for (int d = 0; d < dim; ++d)
      sum += moduli.hoop[d][c] * g[d];
    r[dim * dim * dim + c] = sum;
  }
}

} // namespace abut
