// Modes of hexahedra: slopes and forces are those of the shape functions, and stiffness is the same on all processors.
#include "cells.hpp"
#include "check.hpp"
#include "wide.cpp"

using namespace abut;
using check::holds;
using check::same;

namespace {

constexpr int N = 8, DIM3 = 3;

// A hexahedron with the points of Gauss's rule in an order of their own.
struct Rule {
  double shapes[N][N], derivatives[N][N][DIM3], weights[N];
  Cells cells{nullptr, nullptr, 1, N, shapes[0], derivatives[0][0], weights, N, true, 0};

  Rule() {
    for (int q = 0; q < N; ++q) {
      const int corner = (3 * q + 5) % N;
      double at[DIM3], d[MAX_NODES][3], n[MAX_NODES];
      for (int a = 0; a < DIM3; ++a)
        at[a] = (corner >> a & 1 ? 1 : -1) / std::sqrt(3.0);
      shape(HEX8, at, n, d);
      for (int k = 0; k < N; ++k) {
        shapes[q][k] = n[k];
        std::copy_n(d[k], DIM3, derivatives[q][k]);
      }
      weights[q] = 1;
    }
  }
};

double number(int i) { return std::sin(1.7 * i + 0.3); }

} // namespace

TEST(slopes_of_modes) {
  const Rule rule;
  auto modes = CornerModes<3>::of(rule.cells);
  double values[N][DIM3];
  for (int j = 0; j < N * DIM3; ++j)
    values[j / DIM3][j % DIM3] = number(j);
  modes->set_slopes(values[0]);
  for (int q = 0; q < N; ++q) {
    double slope[3][3];
    reference_slope<3>(values[0], N, rule.derivatives[q][0], slope);
    for (int a = 0; a < DIM3; ++a)
      for (int b = 0; b < DIM3; ++b)
        same(modes->slope(q)[a][b], slope[a][b], 1e-15, "slope");
  }
}

// The work of stresses at slopes is that of their forces at displacements.
TEST(forces_of_modes) {
  const Rule rule;
  auto modes = CornerModes<3>::of(rule.cells);
  double forces[N][DIM3] = {{1}}, expected[N][DIM3] = {{1}}; // added to what is there
  for (int q = 0; q < N; ++q)
    for (int b = 0; b < DIM3; ++b)
      for (int a = 0; a < DIM3; ++a) {
        modes->pushing(q)[b][a] = number(9 * q + 3 * b + a);
        for (int k = 0; k < N; ++k)
          expected[k][a] += rule.derivatives[q][k][b] * number(9 * q + 3 * b + a);
      }
  modes->add_forces(forces[0]);
  for (int k = 0; k < N; ++k)
    for (int a = 0; a < DIM3; ++a)
      same(forces[k][a], expected[k][a], 2e-15, "force");
}

// Bit by bit, whatever the processor's registers.
TEST(wide_stiffness) {
  const Rule rule;
  auto modes = CornerModes<3>::of(rule.cells);
  double f[3][3], reference[3][3], axes[3][3], c[STRAINS * STRAINS], centre[N * DIM3], one[N * N * 9], other[N * N * 9];
  for (int i = 0; i < 9; ++i)
    f[i / 3][i % 3] = number(i), reference[i / 3][i % 3] = number(i + 9), axes[i / 3][i % 3] = number(i + 18);
  for (int i = 0; i < STRAINS * STRAINS; ++i)
    c[i] = number(i);
  for (int j = 0; j < N * DIM3; ++j)
    centre[j] = number(j);
  const ReferenceLines<3> lines(f, reference, axes);
  for (const bool upper : {false, true})
    for (int q = 0; q < N; ++q) {
      double by_itself[81] = {0}, wide[81] = {0};
      upper ? lines.moduli<true>(c, q + 1, by_itself) : lines.moduli<false>(c, q + 1, by_itself);
      write_moduli(lines, upper, c, q + 1, wide);
      holds(!std::memcmp(by_itself, wide, sizeof wide), "the same moduli");
      std::copy_n(wide, 81, &modes->moduli(q)[0][0][0][0]);
      for (int i = 0; i < 9; ++i)
        modes->by_centre(q)[i / 3][i % 3] = number(i + q);
    }
  for (const bool symmetric : {false, true}) {
    modes->write(symmetric, symmetric ? nullptr : centre, one);
    write_stiffness(*modes, symmetric, symmetric ? nullptr : centre, other);
    holds(!std::memcmp(one, other, sizeof one), "the same stiffness");
  }
}
