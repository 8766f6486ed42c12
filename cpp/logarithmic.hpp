// Laws for small strains in the space of logarithmic strains, docs/theory/plasticity.md (Miehe, Apel, Lambrecht 2002):
// from the strain of Green and Lagrange to the logarithmic one, and from the stress conjugate to that to the second one
// of Piola and Kirchhoff, with the tangent.
#pragma once
#include "each.hpp"
#include "turned.hpp"
#include <algorithm>
#include <array>
#include <cmath>

namespace abut {

class Logarithm {
public:
  // At a strain of Green and Lagrange, shear doubled. near: null, or axes that are not far from the principal ones.
  explicit Logarithm(const double *strain, const double (*near)[3] = nullptr) {
    for (int s = 0; s < STRAINS; ++s)
      matrix[I[s]][J[s]] = matrix[J[s]][I[s]] = strain[s] / (s < 3 ? 1 : 2);
    if (near)
      start(near);
    diagonalise();
    for (int a = 0; a < 3; ++a)
      sound = sound && matrix[a][a] > -0.5;
    strain_rotation(axes, of_strain);
    set();
  }

  bool sound = true; // squares of all stretches are positive

  // The logarithmic strain along the principal axes, without shear.
  void principal(double *result) const {
    for (int a = 0; a < 3; ++a)
      result[a] = matrix[a][a] * logarithm(2 * matrix[a][a]), result[3 + a] = 0;
  }

  // The logarithmic strain, shear doubled.
  void strain(double *result) const {
    std::fill_n(result, STRAINS, 0.0);
    for (int a = 0; a < 3; ++a) {
      const double own = matrix[a][a] * logarithm(2 * matrix[a][a]);
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

  // Turns stress and tangent in the space of logarithms into those of Piola, Kirchhoff, Green and Lagrange,
  // theory (Y9), (Y10), the tangent along the principal axes.
  void back(double *stress, Dense &tangent) const {
    Square given, wide, own, rows, columns; // of the turn, and transposed
    stress_rotation(columns);
    for (int m = 0; m < STRAINS; ++m)
      for (int t = 0; t < STRAINS; ++t)
        rows[t][m] = columns[m][t], given[m][t] = tangent.c[m * STRAINS + t];
    multiply(rows, given, wide);
    multiply(wide, columns, own);
    double turned[STRAINS];
    turn(columns, stress, turned);
    std::copy_n(&own[0][0], STRAINS * STRAINS, tangent.c);
    finish(turned, stress, tangent);
  }

  // The same of a tangent in parts.
  void back(double *stress, const Flowing &parts, Dense &tangent) const {
    double turned[STRAINS];
    Square columns;
    Flowing along = parts;
    stress_rotation(columns);
    turn(columns, stress, turned);
    if (parts.flows) {
      turn(columns, parts.normal, along.normal);
      if (parts.coaxial)
        for (int s = 0; s < STRAINS; ++s)
          along.stress[s] = parts.factor * along.normal[s];
      else
        turn(columns, parts.stress, along.stress);
    }
    along.write(tangent.c, first);
    add_bending(turned, tangent.c);
    write(turned, stress, tangent);
  }

  // The same of stress and tangent along the principal axes, of laws that are isotropic: no shear stress, shear apart.
  void back_from_principal(double *stress, Dense &tangent) const {
    const Second second(*this);
    double *const c = tangent.c;
    for (int s = 0; s < 3; ++s) {
      for (int m = 0; m < 3; ++m)
        c[s * STRAINS + m] *= first[s] * first[m];
      c[s * STRAINS + s] += 2 * second.same[s] * stress[s];
    }
    for (int s = 3; s < STRAINS; ++s) {
      const double bending = (second.first_twice[s] * stress[I[s]] + second.last_twice[s] * stress[J[s]]) / 2;
      c[s * STRAINS + s] = c[s * STRAINS + s] * first[s] * first[s] + bending;
    }
    double turned[STRAINS];
    std::copy_n(stress, STRAINS, turned);
    write(turned, stress, tangent);
  }

private:
  static constexpr int I[STRAINS] = {0, 1, 2, 0, 1, 2}, J[STRAINS] = {0, 1, 2, 1, 2, 0};
  static constexpr int AT[3][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}};

  // Turns the strain to axes.
  void start(const double (*near)[3]) {
    double half[3][3];
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        axes[i][j] = near[i][j];
        half[i][j] = matrix[i][0] * near[0][j] + matrix[i][1] * near[1][j] + matrix[i][2] * near[2][j];
      }
    for (int i = 0; i < 3; ++i)
      for (int j = i; j < 3; ++j)
        matrix[i][j] = matrix[j][i] = near[0][i] * half[0][j] + near[1][i] * half[1][j] + near[2][i] * half[2][j];
  }

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

  // ln(1 + x) / x: of small x by the series of 2 artanh(z), z = x / (2 + x), to all digits, in a third of the time.
  static double logarithm(double x) {
    if (std::abs(x) > 0.1)
      return std::log1p(x) / x;
    const double over = 1 / (2 + x), z = x * over, y = z * z;
    return 2 * over *
           (1 + y * (1.0 / 3 + y * (1.0 / 5 + y * (1.0 / 7 + y * (1.0 / 9 + y * (1.0 / 11 + y * (1.0 / 13)))))));
  }

  // Twice the second divided differences, by three eigenvalues: thrice the same, of shear component s two of the first
  // and two of the last index, and all three.
  struct Second {
    double same[3], first_twice[STRAINS], last_twice[STRAINS];

    explicit Second(const Logarithm &log) {
      for (int i = 0; i < 3; ++i)
        same[i] = -log.first[i] * log.first[i];
      for (int s = 3; s < STRAINS; ++s) {
        const int i = I[s], k = J[s];
        const double apart = log.square[i] - log.square[k];
        if (std::abs(apart) > 2 * NEAR * (log.square[i] + log.square[k])) {
          const double over = 2 / apart;
          first_twice[s] = over * (log.first[i] - log.first[s]), last_twice[s] = over * (log.first[s] - log.first[k]);
        } else
          first_twice[s] = log.second(i, i, k), last_twice[s] = log.second(i, k, k);
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

  // Stresses along the principal axes by those along coordinates, as rows: by the latter's component m at [m].
  void stress_rotation(Square &result) const {
    for (int m = 0; m < STRAINS; ++m)
      for (int s = 0; s < STRAINS; ++s)
        result[m][s] = of_strain[s][m] * (doubled(m) / doubled(s));
  }

  static void turn(const Square &columns, const double *stress, double *__restrict result) {
    for (int s = 0; s < STRAINS; ++s) {
      double sum = columns[0][s] * stress[0];
      each<1, STRAINS>([&](auto m) { sum += columns[m][s] * stress[m]; });
      result[s] = sum;
    }
  }

  // Stress and tangent from those of logarithms along the principal axes.
  void finish(const double *turned, double *stress, Dense &tangent) const {
    for (int s = 0; s < STRAINS; ++s)
      for (int t = 0; t < STRAINS; ++t)
        tangent.c[s * STRAINS + t] *= first[s] * first[t];
    add_bending(turned, tangent.c);
    write(turned, stress, tangent);
  }

  // Adds what the stress contributes as the axes turn and the first differences change, in principal axes: pairs of
  // components that share an index.
  void add_bending(const double *stress, double *c) const {
    const Second second(*this);
    const double all = this->second(0, 1, 2) / 2;
    const auto add = [c](int s, int t, double value) { c[s * STRAINS + t] += value; };
    for (int a = 0; a < 3; ++a)
      add(a, a, 2 * second.same[a] * stress[a]);
    for (int s = 3; s < STRAINS; ++s) {
      const int i = I[s], k = J[s], next = s == 5 ? 3 : s + 1, last = 12 - s - next; // the other shear components
      const double at_i = second.first_twice[s] * stress[s], at_k = second.last_twice[s] * stress[s];
      const double mixed = all * stress[last];
      add(i, s, at_i), add(s, i, at_i), add(k, s, at_k), add(s, k, at_k);
      add(s, s, (second.first_twice[s] * stress[i] + second.last_twice[s] * stress[k]) / 2);
      add(s, next, mixed), add(next, s, mixed);
    }
  }

  // The stress from that along the principal axes, and where the tangent is.
  void write(const double *turned, double *stress, Dense &tangent) const {
    for (int s = 0; s < STRAINS; ++s) {
      stress[s] = of_strain[0][s] * first[0] * turned[0];
      for (int m = 1; m < STRAINS; ++m)
        stress[s] += of_strain[m][s] * first[m] * turned[m];
    }
    tangent.turned = true;
    std::copy_n(&axes[0][0], 9, &tangent.axes[0][0]);
  }

  static constexpr double NEAR = 1e-3; // from here on differences keep twelve digits, the series below all

  double matrix[3][3], axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; // axes in columns
  double square[3], first[STRAINS];
  Square of_strain;
};

} // namespace abut
