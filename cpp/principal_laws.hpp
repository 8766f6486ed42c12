// Isotropic hyperelastic laws in principal logarithmic strains, theory (D18): respond as the laws in point_laws.hpp,
// but at strains along the principal axes, without shear.
#pragma once
#include "materials.hpp"
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace abut {

// Energy of volume-preserving stretches l_a = J^(-1/3) lambda_a: Ogden's terms mu / alpha (sum l_a^alpha - 3), powers
// c_i (I - 3)^i of I = sum l_a^2; and of the volume: sum k_i (J - 1)^(2 i), i from 1 on.
struct Stretches {
  static constexpr std::size_t history = 0;
  static constexpr bool principal = true;
  std::vector<double> terms, powers, volume; // terms (n, 2): mu, alpha

  static constexpr bool symmetric() { return true; }

  void respond(const double *strain, const double *, double *, double *stress, Dense &result) const {
    const double log = strain[0] + strain[1] + strain[2];
    double e[3], by[3] = {0}, second[3][3] = {{0}}; // of the energy by volume-preserving strains
    for (int a = 0; a < 3; ++a)
      e[a] = strain[a] - log / 3;
    result.energy = 0;
    for (std::size_t k = 0; k + 1 < terms.size(); k += 2)
      for (int a = 0; a < 3; ++a) {
        const double mu = terms[k], alpha = terms[k + 1], grown = std::expm1(alpha * e[a]);
        result.energy += mu / alpha * grown;
        by[a] += mu * grown, second[a][a] += mu * alpha * (1 + grown); // less mu, which is the same in all directions
      }
    add_powers(e, by, second, result.energy);
    double slope, bend;
    add_volume(std::expm1(log), slope, bend, result.energy);
    write(e, by, second, slope, bend, stress, result.c);
  }

  // Strain out of the plane without stress there, as a first guess.
  double across(const double *strain, const double *) const {
    const double shear = modulus(), lambda = 2 * volume[0] - 2 * shear / 3;
    return -lambda / (lambda + 2 * shear) * (strain[0] + strain[1]);
  }

private:
  double modulus() const { // of shear at rest
    double result = powers.empty() ? 0 : 2 * powers[0];
    for (std::size_t k = 0; k + 1 < terms.size(); k += 2)
      result += terms[k] * terms[k + 1] / 2;
    return result;
  }

  void add_powers(const double *e, double *by, double (&second)[3][3], double &energy) const {
    if (powers.empty())
      return;
    double more = 0, grown[3]; // I - 3
    for (int a = 0; a < 3; ++a)
      grown[a] = std::expm1(2 * e[a]), more += grown[a];
    double first = 0, next = 0, before = 0, power = 1; // derivatives by I; more to the powers n - 2 and n - 1
    for (std::size_t i = 0; i < powers.size(); ++i) {
      const double n = double(i + 1);
      energy += powers[i] * power * more;
      first += n * powers[i] * power;
      next += n * (n - 1) * powers[i] * before;
      before = power, power *= more;
    }
    for (int a = 0; a < 3; ++a) {
      by[a] += 2 * first * grown[a];
      second[a][a] += 4 * first * (1 + grown[a]);
      for (int b = 0; b < 3; ++b)
        second[a][b] += 4 * next * (1 + grown[a]) * (1 + grown[b]);
    }
  }

  // First and second derivative by ln J; swelling: J - 1.
  void add_volume(double swelling, double &slope, double &bend, double &energy) const {
    double first = 0, second = 0, power = 1; // swelling to the power n - 2
    for (std::size_t i = 0; i < volume.size(); ++i) {
      const double n = 2 * double(i + 1);
      energy += volume[i] * power * swelling * swelling;
      first += n * volume[i] * power * swelling;
      second += n * (n - 1) * volume[i] * power;
      power *= swelling * swelling;
    }
    const double j = 1 + swelling;
    slope = j * first, bend = j * first + j * j * second;
  }

  // Stress and tangent (6, 6) along the principal axes, from derivatives by the volume-preserving strains.
  static void write(const double *e, const double *by, const double (&second)[3][3], double slope, double bend,
                    double *stress, double *c) {
    const double mean = (by[0] + by[1] + by[2]) / 3;
    double rows[3], all = 0;
    for (int a = 0; a < 3; ++a) {
      rows[a] = (second[a][0] + second[a][1] + second[a][2]) / 3;
      all += rows[a] / 3;
    }
    std::fill_n(c, STRAINS * STRAINS, 0.0);
    for (int a = 0; a < 3; ++a) {
      stress[a] = by[a] - mean + slope, stress[3 + a] = 0;
      for (int b = 0; b < 3; ++b)
        c[a * STRAINS + b] = second[a][b] - rows[a] - rows[b] + all + bend;
    }
    for (int s = 3; s < STRAINS; ++s) { // shear turns the axes; equal stretches: half the difference of the slopes
      const int a = s - 3, b = (a + 1) % 3;
      const double apart = e[a] - e[b];
      const double even = (c[a * STRAINS + a] + c[b * STRAINS + b]) / 2 - c[a * STRAINS + b];
      c[s * STRAINS + s] = (std::abs(apart) > 1e-5 ? (by[a] - by[b]) / apart : even) / 2;
    }
  }
};

} // namespace abut
