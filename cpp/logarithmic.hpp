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
    for (int a = 0; a < 3; ++a) {
      const double own = std::log1p(2 * matrix[a][a]) / 2;
      for (int s = 0; s < STRAINS; ++s) // transposed rotation of stresses takes strains back
        result[s] += of_strain[a][s] * doubled(s) * own;
    }
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
    Square own, wide, given, rows, columns; // of the turn, and transposed
    for (int m = 0; m < STRAINS; ++m)
      for (int t = 0; t < STRAINS; ++t) {
        rows[t][m] = columns[m][t] = of_strain[t][m] * doubled(m) / doubled(t);
        given[m][t] = c[m * STRAINS + t];
      }
    multiply(rows, given, wide);
    multiply(wide, columns, own);
    double turned[STRAINS];
    turn(stress, turned);
    finish(turned, own, stress, c);
  }

  // The same of a tangent in parts.
  void back(double *stress, const Flowing &tangent, double *c) const {
    double turned[STRAINS];
    Square own;
    Flowing along = tangent;
    turn(stress, turned);
    if (tangent.flows)
      turn(tangent.stress, along.stress), turn(tangent.normal, along.normal);
    along.write(&own[0][0]);
    finish(turned, own, stress, c);
  }

  // The same of stress and tangent along the principal axes, of laws that are isotropic: no shear stress, shear apart.
  void back_from_principal(double *stress, double *c) const {
    Square wide;
    const Second second(*this);
    for (int s = 0; s < 3; ++s) {
      double own[3];
      for (int m = 0; m < 3; ++m)
        own[m] = c[s * STRAINS + m] * first[s] * first[m];
      own[s] += 2 * second.of[s][s][s] * stress[s];
      for (int t = 0; t < STRAINS; ++t)
        wide[s][t] = own[0] * of_strain[0][t] + own[1] * of_strain[1][t] + own[2] * of_strain[2][t];
    }
    for (int s = 3; s < STRAINS; ++s) {
      const int i = I[s], k = J[s];
      const double bending = (second.of[i][i][k] * stress[i] + second.of[i][k][k] * stress[k]) / 2;
      const double own = c[s * STRAINS + s] * first[s] * first[s] + bending;
      for (int t = 0; t < STRAINS; ++t)
        wide[s][t] = own * of_strain[s][t];
    }
    double turned[STRAINS];
    std::copy_n(stress, STRAINS, turned);
    write(turned, wide, stress, c);
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
      rotate<0, 1>(), rotate<0, 2>(), rotate<1, 2>();
    }
  }

  template <int p, int q> void rotate() {
    const double off = matrix[p][q];
    const double tiny = 1e-17 * (std::abs(matrix[p][p]) + std::abs(matrix[q][q]));
    if (std::abs(off) <= tiny) {
      matrix[p][q] = matrix[q][p] = 0;
      return;
    }
    const double apart = matrix[q][q] - matrix[p][p];
    double t, cosine;
    if (off * off <= 1e-6 * apart * apart) { // small turns by series to all digits, without roots
      const double x = off / apart;
      t = x * (1 - x * x * (1 - 2 * x * x));
      cosine = 1 - t * t * (1.0 / 2 - 3.0 / 8 * t * t);
    } else {
      const double root = std::sqrt(apart * apart + 4 * off * off), sum = std::abs(apart) + root;
      t = (apart >= 0 ? 2 : -2) * off / sum;
      cosine = std::sqrt(sum / (2 * root));
    }
    const double sine = t * cosine;
    constexpr int r = 3 - p - q;
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

  static constexpr double doubled(int s) { return s < 3 ? 1 : 2; }

  using Square = double[STRAINS][STRAINS];
  // a b; written once, as zeros would take as long as a factor.
  static void multiply(const Square &a, const Square &b, Square &result) {
    for (int s = 0; s < STRAINS; ++s)
      for (int t = 0; t < STRAINS; ++t) {
        double sum = a[s][0] * b[0][t];
        for (int m = 1; m < STRAINS; ++m)
          sum += a[s][m] * b[m][t];
        result[s][t] = sum;
      }
  }

  // To the principal axes, of strains with doubled shear. That of stresses doubles its columns of shear and halves its
  // rows of shear.
  void rotations() {
    for (int s = 0; s < STRAINS; ++s) {
      const int a = I[s], b = J[s];
      double *const row = of_strain[s];
      for (int i = 0; i < 3; ++i) {
        const int j = (i + 1) % 3;
        row[i] = doubled(s) * axes[i][a] * axes[i][b];
        row[3 + i] = doubled(s) / 2 * (axes[i][a] * axes[j][b] + axes[j][a] * axes[i][b]);
      }
    }
  }

  // First divided differences of ln(1 + 2 g) / 2 over the eigenvalues g.
  void set() {
    for (int a = 0; a < 3; ++a)
      square[a] = 1 + 2 * matrix[a][a];
    for (int a = 0; a < 3; ++a)
      first[a] = 1 / square[a];
    for (int s = 3; s < STRAINS; ++s) {
      const int a = I[s], b = J[s];
      const double more = 2 * (matrix[a][a] - matrix[b][b]) * first[b];
      first[s] = logarithm(more) * first[b];
    }
  }

  // ln(1 + x) / x, by its series where that has all digits.
  static double logarithm(double x) {
    if (std::abs(x) > NEAR)
      return std::log1p(x) / x;
    return 1 - x * (1.0 / 2 - x * (1.0 / 3 - x * (1.0 / 4 - x * (1.0 / 5 - x / 6))));
  }

  // Twice the second divided differences, by three eigenvalues.
  struct Second {
    double of[3][3][3];

    explicit Second(const Logarithm &log) {
      for (int i = 0; i < 3; ++i)
        for (int j = i; j < 3; ++j)
          for (int k = j; k < 3; ++k) {
            const double value = i == k ? -log.first[i] * log.first[i] : log.second(i, j, k);
            of[i][j][k] = of[i][k][j] = of[j][i][k] = of[j][k][i] = of[k][i][j] = of[k][j][i] = value;
          }
    }
  };

  double second(int a, int b, int c) const {
    const double mean = (square[a] + square[b] + square[c]) / 3;
    double d[3] = {square[a] - mean, square[b] - mean, square[c] - mean};
    const double far = std::max({std::abs(d[0]), std::abs(d[1]), std::abs(d[2])});
    if (far < NEAR * mean) { // the series of ln about the mean: no differences of near numbers
      const double part = 1 / mean;
      for (double &value : d)
        value *= part;
      const double two = d[0] * d[1] + d[1] * d[2] + d[2] * d[0], three = d[0] * d[1] * d[2];
      return 2 * (-0.5 + two / 4 + three / 5 - two * two / 6) * part * part;
    }
    const double ab = std::abs(square[a] - square[b]), bc = std::abs(square[b] - square[c]);
    const double ca = std::abs(square[c] - square[a]);
    if (ca < ab || ca < bc) // the outer two the farthest apart
      return ab < bc ? second(b, a, c) : second(a, c, b);
    return 2 * (difference(b, c) - difference(a, b)) / (square[c] - square[a]);
  }

  double difference(int a, int b) const { return first[AT[a][b]]; }

  // A stress along the principal axes.
  void turn(const double *stress, double *result) const {
    for (int s = 0; s < STRAINS; ++s) {
      double sum = 0;
      for (int m = 0; m < STRAINS; ++m)
        sum += of_strain[s][m] * doubled(m) * stress[m];
      result[s] = sum / doubled(s);
    }
  }

  // Stress and tangent from those of logarithms along the principal axes.
  void finish(const double *turned, Square &own, double *stress, double *c) const {
    Square wide;
    for (int s = 0; s < STRAINS; ++s)
      for (int t = 0; t < STRAINS; ++t)
        own[s][t] *= first[s] * first[t];
    add_bending(turned, own);
    multiply(own, of_strain, wide);
    write(turned, wide, stress, c);
  }

  // Adds what the stress contributes as the axes turn and the first differences change, in principal axes: pairs of
  // components that share an index.
  void add_bending(const double *stress, Square &c) const {
    const Second second(*this);
    const auto &f = second.of;
    for (int a = 0; a < 3; ++a)
      c[a][a] += 2 * f[a][a][a] * stress[a];
    for (int s = 3; s < STRAINS; ++s) {
      const int i = I[s], k = J[s], next = s == 5 ? 3 : s + 1, last = 12 - s - next; // the other shear components
      const double at_i = f[i][i][k] * stress[s], at_k = f[i][k][k] * stress[s];
      const double mixed = f[0][1][2] * stress[last] / 2;
      c[i][s] += at_i, c[s][i] += at_i, c[k][s] += at_k, c[s][k] += at_k;
      c[s][s] += (f[i][i][k] * stress[i] + f[i][k][k] * stress[k]) / 2;
      c[s][next] += mixed, c[next][s] += mixed;
    }
  }

  // Stress and tangent from those along the principal axes; wide: of the latter, by strain.
  void write(const double *turned, const Square &wide, double *__restrict stress, double *__restrict c) const {
    for (int s = 0; s < STRAINS; ++s) {
      stress[s] = of_strain[0][s] * first[0] * turned[0];
      for (int m = 1; m < STRAINS; ++m)
        stress[s] += of_strain[m][s] * first[m] * turned[m];
      for (int t = 0; t < STRAINS; ++t) {
        double sum = of_strain[0][s] * wide[0][t];
        for (int m = 1; m < STRAINS; ++m)
          sum += of_strain[m][s] * wide[m][t];
        c[s * STRAINS + t] = sum;
      }
    }
  }

  static constexpr double NEAR = 1e-3; // from here on differences keep twelve digits, the series below all

  double matrix[3][3], axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; // axes in columns
  double square[3], first[STRAINS];
  Square of_strain;
};

} // namespace abut
