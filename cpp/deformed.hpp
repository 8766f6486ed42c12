// Deformation at a point.
#pragma once
#include "materials.hpp"

namespace abut {

constexpr int COMPONENT[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}}; // of a symmetric tensor

inline void tensor(const double *stress, double (&sigma)[3][3]) {
  for (int a = 0; a < 3; ++a) {
    sigma[a][a] = stress[a];
    sigma[a][(a + 1) % 3] = sigma[(a + 1) % 3][a] = stress[3 + a];
  }
}

// The deformation gradient at a point, its determinant and inverse, the strain, and the factor of F-bar.
template <int dim> struct Deformed {
  double f[3][3], inverse[3][3], det, strain[STRAINS], scale = 1;
  double reference[dim][dim]; // reference coordinate by position

  void set(const double (&slope)[3][3]) {
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        f[a][b] = slope[a][b] + (a == b);
    det = f[0][0] * (f[1][1] * f[2][2] - f[1][2] * f[2][1]) - f[0][1] * (f[1][0] * f[2][2] - f[1][2] * f[2][0]) +
          f[0][2] * (f[1][0] * f[2][1] - f[1][1] * f[2][0]);
    for (int a = 0; a < 3; ++a) {
      const int b = (a + 1) % 3;
      double own = 0, mixed = 0; // of slope^T slope: small strains lose no digits
      for (int c = 0; c < 3; ++c)
        own += slope[c][a] * slope[c][a], mixed += slope[c][a] * slope[c][b];
      strain[a] = slope[a][a] + own / 2;
      strain[3 + a] = slope[a][b] + slope[b][a] + mixed;
    }
  }
  void invert() {
    const double over = 1 / det;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        const int a1 = (a + 1) % 3, a2 = (a + 2) % 3, b1 = (b + 1) % 3, b2 = (b + 2) % 3;
        inverse[b][a] = (f[a1][b1] * f[a2][b2] - f[a1][b2] * f[a2][b1]) * over;
      }
  }
};

// Invariants of a tensor; the third one is its determinant.
inline double second_invariant(const double (&h)[3][3]) {
  return h[0][0] * h[1][1] - h[0][1] * h[1][0] + h[1][1] * h[2][2] - h[1][2] * h[2][1] + h[2][2] * h[0][0] -
         h[2][0] * h[0][2];
}
inline double third_invariant(const double (&h)[3][3]) {
  return h[0][0] * (h[1][1] * h[2][2] - h[1][2] * h[2][1]) - h[0][1] * (h[1][0] * h[2][2] - h[1][2] * h[2][0]) +
         h[0][2] * (h[1][0] * h[2][1] - h[1][1] * h[2][0]);
}

// Of det F from one state to another, without what is linear in the displacements between them.
template <int dim> double bent(Deformed<dim> from, const Deformed<dim> &to) {
  double h[3][3] = {{0}};
  from.invert();
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      for (int c = 0; c < 3; ++c)
        h[a][b] += (to.f[a][c] - from.f[a][c]) * from.inverse[c][b];
  return from.det * (second_invariant(h) + third_invariant(h));
}

} // namespace abut
