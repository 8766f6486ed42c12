// Laws for small strains in the space of logarithmic strains, docs/theory/plasticity.md (Miehe, Apel, Lambrecht 2002):
// from the strain of Green and Lagrange to the logarithmic one, and from the stress conjugate to that to the second one
// of Piola and Kirchhoff, with the tangent.
#pragma once
#include "materials.hpp"
#include <algorithm>
#include <array>
#include <cmath>

namespace abut {

class Logarithm {
public:
  // At a strain of Green and Lagrange, shear doubled.
  explicit Logarithm(const double *strain) {
    for (int s = 0; s < STRAINS; ++s)
      matrix[I[s]][J[s]] = matrix[J[s]][I[s]] = strain[s] / (s < 3 ? 1 : 2);
    diagonalise();
    for (int a = 0; a < 3; ++a)
      sound = sound && matrix[a][a] > -0.5;
    rotations();
    set();
  }

  bool sound = true; // squares of all stretches are positive

  // The logarithmic strain along the principal axes, without shear.
  void principal(double *result) const {
    for (int a = 0; a < 3; ++a)
      result[a] = std::log1p(2 * matrix[a][a]) / 2, result[3 + a] = 0;
  }

  // The logarithmic strain, shear doubled.
  void strain(double *result) const {
    std::fill_n(result, STRAINS, 0.0);
    for (int a = 0; a < 3; ++a)
      for (int s = 0; s < STRAINS; ++s) // transposed rotation of stresses takes strains back
        result[s] += of_stress[a][s] * std::log1p(2 * matrix[a][a]) / 2;
  }

  // Takes another strain out of the plane, logarithmic.
  void thicken(double strain) {
    matrix[2][2] = std::expm1(2 * strain) / 2;
    set();
  }
  double across() const { return matrix[2][2]; }

  // Turns stress and tangent (6, 6) in the space of logarithms into those of Piola, Kirchhoff, Green and Lagrange,
  // theory (Y9), (Y10).
  void back(double *stress, double *c) const {
    double turned[STRAINS] = {0}, half[STRAINS][STRAINS] = {{0}};
    for (int s = 0; s < STRAINS; ++s)
      for (int t = 0; t < STRAINS; ++t) {
        turned[s] += of_stress[s][t] * stress[t];
        for (int m = 0; m < STRAINS; ++m)
          half[s][t] += of_stress[s][m] * c[m * STRAINS + t];
      }
    for (int s = 0; s < STRAINS; ++s)
      for (int t = 0; t < STRAINS; ++t) {
        c[s * STRAINS + t] = 0;
        for (int m = 0; m < STRAINS; ++m)
          c[s * STRAINS + t] += half[s][m] * of_stress[t][m];
      }
    std::copy_n(turned, STRAINS, stress);
    back_from_principal(stress, c);
  }

  // The same of stress and tangent along the principal axes.
  void back_from_principal(double *stress, double *c) const {
    double turned[STRAINS], own[STRAINS][STRAINS];
    std::copy_n(stress, STRAINS, turned);
    for (int s = 0; s < STRAINS; ++s)
      for (int t = 0; t < STRAINS; ++t)
        own[s][t] = c[s * STRAINS + t] * first[s] * first[t];
    add_bending(turned, own);
    for (int s = 0; s < STRAINS; ++s)
      turned[s] *= first[s];
    double wide[STRAINS][STRAINS] = {{0}};
    for (int s = 0; s < STRAINS; ++s) {
      stress[s] = 0;
      for (int m = 0; m < STRAINS; ++m) {
        stress[s] += of_strain[m][s] * turned[m];
        for (int t = 0; t < STRAINS; ++t)
          wide[s][t] += of_strain[m][s] * own[m][t];
      }
    }
    for (int s = 0; s < STRAINS; ++s)
      for (int t = 0; t < STRAINS; ++t) {
        double sum = 0;
        for (int m = 0; m < STRAINS; ++m)
          sum += wide[s][m] * of_strain[m][t];
        c[s * STRAINS + t] = sum;
      }
  }

private:
  static constexpr int I[STRAINS] = {0, 1, 2, 0, 1, 2}, J[STRAINS] = {0, 1, 2, 1, 2, 0};
  static constexpr int AT[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

  // Jacobi's rotations: every eigenvalue to the digits that the strain has.
  void diagonalise() {
    constexpr int SWEEPS = 30;
    for (int sweep = 0; sweep < SWEEPS; ++sweep) {
      if (matrix[0][1] == 0 && matrix[1][2] == 0 && matrix[2][0] == 0)
        return;
      for (int p = 0; p < 2; ++p)
        for (int q = p + 1; q < 3; ++q)
          rotate(p, q);
    }
  }

  void rotate(int p, int q) {
    const double off = matrix[p][q];
    const double tiny = 1e-17 * (std::abs(matrix[p][p]) + std::abs(matrix[q][q]));
    if (std::abs(off) <= tiny) {
      matrix[p][q] = matrix[q][p] = 0;
      return;
    }
    const double theta = (matrix[q][q] - matrix[p][p]) / (2 * off);
    const double t = (theta >= 0 ? 1 : -1) / (std::abs(theta) + std::sqrt(1 + theta * theta));
    const double cosine = 1 / std::sqrt(1 + t * t), sine = t * cosine;
    const int r = 3 - p - q;
    const double rp = matrix[r][p], rq = matrix[r][q];
    matrix[p][p] -= t * off, matrix[q][q] += t * off;
    matrix[p][q] = matrix[q][p] = 0;
    matrix[r][p] = matrix[p][r] = cosine * rp - sine * rq;
    matrix[r][q] = matrix[q][r] = sine * rp + cosine * rq;
    for (auto &row : axes) {
      const double vp = row[p], vq = row[q];
      row[p] = cosine * vp - sine * vq, row[q] = sine * vp + cosine * vq;
    }
  }

  // To the principal axes, of stresses and of strains with doubled shear.
  void rotations() {
    for (int s = 0; s < STRAINS; ++s)
      for (int t = 0; t < STRAINS; ++t) {
        const int a = I[s], b = J[s], i = I[t], j = J[t];
        const double one = axes[i][a] * axes[j][b], other = axes[j][a] * axes[i][b];
        of_stress[s][t] = t < 3 ? one : one + other;
        of_strain[s][t] = (s < 3 ? 1 : 2) * (t < 3 ? one : (one + other) / 2);
      }
  }

  // First and second divided differences of ln(1 + 2 g) / 2 over the eigenvalues g.
  void set() {
    for (int a = 0; a < 3; ++a)
      square[a] = 1 + 2 * matrix[a][a];
    for (int s = 0; s < STRAINS; ++s) {
      const int a = I[s], b = J[s];
      const double more = 2 * (matrix[a][a] - matrix[b][b]) / square[b];
      first[s] = (more == 0 ? 1 : std::log1p(more) / more) / square[b];
    }
  }

  double second(int a, int b, int c) const {
    double x[3] = {square[a], square[b], square[c]};
    const double mean = (x[0] + x[1] + x[2]) / 3;
    const double d[3] = {x[0] / mean - 1, x[1] / mean - 1, x[2] / mean - 1};
    const double far = std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])});
    if (far < 0.1) { // the series of ln about the mean: no differences of near numbers
      const double two = d[0] * d[1] + d[1] * d[2] + d[2] * d[0], three = d[0] * d[1] * d[2];
      double sums[3] = {1, 0, -two}, result = -0.5; // complete symmetric polynomials, the sum of d being zero
      double sign = 1;
      for (int n = 3; n < 26; ++n, sign = -sign) {
        const double h = n - 2 < 3 ? sums[n - 2] : -two * sums[1] + three * sums[0];
        if (n - 2 >= 3)
          sums[0] = sums[1], sums[1] = sums[2], sums[2] = h;
        result += sign * h / n;
      }
      return 2 * result / (mean * mean);
    }
    std::sort(x, x + 3);
    const auto slope = [](double p, double q) { return p == q ? 1 / p : std::log1p((q - p) / p) / (q - p); };
    return 2 * (slope(x[1], x[2]) - slope(x[0], x[1])) / (x[2] - x[0]);
  }

  // Adds what the stress contributes as the axes turn and the first differences change, in principal axes.
  void add_bending(const double *stress, double (&c)[STRAINS][STRAINS]) const {
    double f[3][3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j)
        for (int k = j; k < 3; ++k) {
          const double value = second(i, j, k);
          f[i][j][k] = f[i][k][j] = f[j][i][k] = f[j][k][i] = f[k][i][j] = f[k][j][i] = value;
        }
    for (int t = 0; t < STRAINS; ++t) {
      double unit[3][3] = {{0}};
      unit[I[t]][J[t]] = unit[J[t]][I[t]] = t < 3 ? 1 : 0.5;
      for (int s = 0; s < STRAINS; ++s) {
        const int i = I[s], k = J[s];
        double sum = 0;
        for (int j = 0; j < 3; ++j)
          sum += f[i][j][k] * (stress[AT[i][j]] * unit[j][k] + unit[i][j] * stress[AT[j][k]]);
        c[s][t] += sum;
      }
    }
  }

  double matrix[3][3], axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; // axes in columns
  double square[3], first[STRAINS];
  double of_stress[STRAINS][STRAINS], of_strain[STRAINS][STRAINS];
};

} // namespace abut
