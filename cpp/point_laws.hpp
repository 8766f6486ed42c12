// Laws at a point with a history, docs/theory/plasticity.md: respond(strain, before, after, stress, result) writes
// stress, tangent, energy and the history that follows ``before`` (null: the initial one); ``after`` may be null.
// Strains are small or logarithmic, shear strains doubled.
#pragma once
#include "hyperelastic.hpp"
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace abut {

// Double contraction of two symmetric tensors of six components; sums that do not wait for each other.
inline double contracted(const double *a, const double *b) {
  return (a[0] * b[0] + a[1] * b[1]) + (a[2] * b[2] + 2 * (a[5] * b[5] + (a[3] * b[3] + a[4] * b[4])));
}

// Isotropic linear elasticity by bulk and shear modulus.
struct Hooke {
  static constexpr std::size_t history = 0;
  static constexpr bool principal = true; // logarithmic strains along their principal axes will do
  double bulk, shear;

  static constexpr bool symmetric() { return true; }

  void respond(const double *strain, const double *, double *, double *stress, Dense &result) const {
    const double lambda = bulk - 2 * shear / 3;
    std::fill_n(result.c, STRAINS * STRAINS, 0.0);
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b)
        result.c[a * STRAINS + b] = lambda + 2 * shear * (a == b);
      result.c[(3 + a) * STRAINS + 3 + a] = shear;
    }
    result.energy = this->stress(strain, stress);
  }

  // Writes the stress; returns the energy.
  double stress(const double *strain, double *result) const {
    const double trace = strain[0] + strain[1] + strain[2], lambda = bulk - 2 * shear / 3;
    double energy = 0;
    for (int a = 0; a < 3; ++a)
      result[a] = 2 * shear * strain[a] + lambda * trace, result[3 + a] = shear * strain[3 + a];
    for (int s = 0; s < STRAINS; ++s)
      energy += result[s] * strain[s] / 2;
    return energy;
  }

  // Strain out of the plane without stress there, as a first guess.
  double across(const double *strain, const double *) const {
    return -(bulk - 2 * shear / 3) / (bulk + 4 * shear / 3) * (strain[0] + strain[1]);
  }
};

// Von Mises plasticity with associated flow, theory (Y2), (Y3): isotropic hardening by a table of plastic strains and
// yield stresses, linear and saturating terms, and back stresses of Armstrong and Frederick. History: plastic strain
// (shear doubled), equivalent plastic strain, plastic work, and of each back stress the strain (shear not doubled) of
// which it is 2/3 of the modulus, so that it follows a modulus that changes with the temperature, theory (Y12).
class J2 {
public:
  static constexpr int EQUIVALENT = STRAINS, WORK = STRAINS + 1, BACK = STRAINS + 2;
  struct Hardening {
    std::vector<double> table;      // (n, 2) equivalent plastic strain and yield stress, beyond which it is constant
    double slope, saturation, rate; // adds slope x + saturation (1 - exp(-rate x))
    std::vector<double> back;       // (n, 2) modulus and recall of each back stress

    bool fades() const { // some back stress
      for (std::size_t k = 1; k < back.size(); k += 2)
        if (back[k] != 0)
          return true;
      return false;
    }
  };

  J2(double bulk, double shear, Hardening hardening)
      : history(BACK + hardening.back.size() / 2 * STRAINS), elastic{bulk, shear}, hardening(std::move(hardening)) {}

  const std::size_t history;

  // Back stresses that fade make the tangent unsymmetric.
  bool symmetric() const { return !hardening.fades(); }

  void respond(const double *strain, const double *before, double *after, double *stress, Dense &result) const {
    Flowing tangent;
    respond(strain, before, after, stress, tangent, result.energy);
    tangent.write(result.c, {1, 1, 1, 1, 1, 1});
  }

  // The same with the parts of the tangent.
  void respond(const double *strain, const double *before, double *after, double *stress, Flowing &tangent,
               double &energy) const {
    double trial[STRAINS], deviator[STRAINS];
    for (int s = 0; s < STRAINS; ++s)
      trial[s] = strain[s] - (before ? before[s] : 0);
    energy = elastic.stress(trial, stress);
    tangent.diagonal = 2 * elastic.shear, tangent.spherical = elastic.bulk - 2 * elastic.shear / 3;
    const double mean = (stress[0] + stress[1] + stress[2]) / 3;
    for (int s = 0; s < STRAINS; ++s)
      deviator[s] = stress[s] - (s < 3) * mean;
    const double start = before ? before[EQUIVALENT] : 0;
    Flow flow(*this, deviator, before, start);
    const double yield = yield_stress(start).first;
    if (flow.excess <= ROUNDING * yield) {
      if (after)
        keep(before, after);
      return;
    }
    flow.solve();
    const double way = ROOT * flow.amount;
    for (int s = 0; s < STRAINS; ++s)
      stress[s] = deviator[s] - 2 * elastic.shear * way * flow.normal[s] + (s < 3) * mean;
    flow.linearise(tangent);
    double square = 0;
    for (int s = 0; s < STRAINS; ++s) {
      const double left = stress[s] - (s < 3) * mean;
      square += (s < 3 ? 1 : 2) * left * left;
    }
    energy = mean * mean / (2 * elastic.bulk) + square / (4 * elastic.shear);
    if (after)
      flow.write(before, after, yield);
  }

  double across(const double *strain, const double *before) const {
    if (!before)
      return elastic.across(strain, nullptr);
    const double trial[2] = {strain[0] - before[0], strain[1] - before[1]};
    return before[2] + elastic.across(trial, nullptr);
  }

private:
  static constexpr double ROOT = 1.224744871391589049; // of 3/2
  static constexpr double ROUNDING = 1e-12;            // excess over the yield stress that is none
  static constexpr int LIMIT = 200;                    // iterations; about five are needed

  // Yield stress at an equivalent plastic strain, and its slope.
  std::pair<double, double> yield_stress(double x) const {
    const auto &t = hardening.table;
    double value = t[t.size() - 1], slope = 0;
    for (std::size_t i = 0; i + 3 < t.size(); i += 2)
      if (x < t[i + 2]) {
        slope = (t[i + 3] - t[i + 1]) / (t[i + 2] - t[i]);
        value = t[i + 1] + slope * (x - t[i]);
        break;
      }
    const double fading = hardening.saturation == 0 ? 0 : hardening.saturation * std::exp(-hardening.rate * x);
    return {value + hardening.slope * x + hardening.saturation - fading,
            slope + hardening.slope + hardening.rate * fading};
  }

  void keep(const double *before, double *after) const {
    if (before)
      std::copy_n(before, history, after);
    else
      std::fill_n(after, history, 0.0);
  }

  // The return to the yield surface by implicit Euler, theory (Y4), (Y5): one equation for the growth ``amount`` of the
  // equivalent plastic strain.
  struct Flow {
    const J2 &law;
    const double *deviator, *before; // of the trial stress; the history
    double start, amount = 0;
    double normal[STRAINS], turning[STRAINS]; // shifted trial stress, a unit normal once solved; by the amount
    double size, along, excess, slope; // of the former; of the latter, along it; the equation, minus its derivative
    double kinematic, stiffening;      // modulus of the back stresses after an amount, secant and tangent

    Flow(const J2 &law, const double *deviator, const double *before, double start)
        : law(law), deviator(deviator), before(before), start(start) {
      shift();
      evaluate();
    }

    // The trial stress, shifted by what the back stresses are after an amount.
    void shift() {
      const auto &back = law.hardening.back;
      kinematic = 0, stiffening = 0;
      std::copy_n(deviator, STRAINS, normal);
      std::fill_n(turning, STRAINS, 0.0);
      for (std::size_t k = 0; 2 * k < back.size(); ++k) {
        const double share = 1 / (1 + back[2 * k + 1] * amount);
        kinematic += share * back[2 * k], stiffening += share * share * back[2 * k];
        if (!before)
          continue;
        const double *old = before + BACK + k * STRAINS;
        const double by = 2.0 / 3 * back[2 * k] * share, turned = back[2 * k + 1] * share * by;
        for (int s = 0; s < STRAINS; ++s)
          normal[s] -= by * old[s], turning[s] += turned * old[s];
      }
      size = std::sqrt(contracted(normal, normal));
      along = size > 0 ? contracted(normal, turning) / size : 0;
    }

    void evaluate() {
      const auto [yield, hardening] = law.yield_stress(start + amount);
      excess = ROOT * size - (3 * law.elastic.shear + kinematic) * amount - yield;
      slope = 3 * law.elastic.shear + hardening + stiffening - ROOT * along;
    }

    // Newton's method within the bounds where the excess changes its sign.
    void solve() {
      double low = 0, high = ROOT * std::sqrt(contracted(deviator, deviator));
      for (std::size_t k = 0; before && 2 * k < law.hardening.back.size(); ++k) {
        const double *old = before + BACK + k * STRAINS;
        high += ROOT * 2.0 / 3 * law.hardening.back[2 * k] * std::sqrt(contracted(old, old));
      }
      high /= 3 * law.elastic.shear;
      const double rounding = 4 * std::numeric_limits<double>::epsilon() * ROOT * size;
      for (int i = 0; i < LIMIT && std::abs(excess) > rounding; ++i) {
        (excess > 0 ? low : high) = amount;
        double next = amount + excess / slope;
        if (!(next > low && next < high))
          next = (low + high) / 2;
        if (next == amount)
          break;
        amount = next;
        if (!law.hardening.back.empty())
          shift();
        evaluate();
      }
      const double over = size > 0 ? 1 / size : 1;
      for (double &value : normal)
        value *= over;
    }

    // The consistent tangent, theory (Y6), (Y7).
    void linearise(Flowing &tangent) const {
      const double shear = law.elastic.shear;
      const double bent = 2 * shear * ROOT * amount / size;
      const double by = ROOT * 2 * shear / slope; // amount by strain, times the normal
      tangent.flows = true;
      tangent.diagonal = 2 * shear * (1 - bent), tangent.spherical = law.elastic.bulk - tangent.diagonal / 3;
      tangent.coaxial = law.hardening.back.empty();
      tangent.factor = 2 * shear * (bent - ROOT * by);
      for (int s = 0; s < STRAINS; ++s) {
        tangent.stress[s] = tangent.factor * normal[s] + bent * by * (along * normal[s] - turning[s]);
        tangent.normal[s] = normal[s];
      }
    }

    // The new history; work is the mean of what flow takes at the beginning and at the end.
    void write(const double *before, double *after, double yield) const {
      const auto &back = law.hardening.back;
      const double way = ROOT * amount;
      double taken = (yield + law.yield_stress(start + amount).first) / 2 * amount;
      for (int s = 0; s < STRAINS; ++s)
        after[s] = (before ? before[s] : 0) + (s < 3 ? 1 : 2) * way * normal[s];
      for (std::size_t k = 0; 2 * k < back.size(); ++k) {
        const double share = 1 / (1 + back[2 * k + 1] * amount);
        for (int s = 0; s < STRAINS; ++s) {
          const double old = before ? before[BACK + k * STRAINS + s] : 0, now = share * (old + way * normal[s]);
          taken += (s < 3 ? 1 : 2) * back[2 * k] / 3 * (old + now) * way * normal[s];
          after[BACK + k * STRAINS + s] = now;
        }
      }
      after[EQUIVALENT] = start + amount;
      after[WORK] = (before ? before[WORK] : 0) + taken;
    }
  };

  Hooke elastic;
  Hardening hardening;
};

// Between laws at some temperatures, growing, all with the plastic strains and back stresses of the first: every
// constant is linear in the temperature between them, and constant beyond, theory (Y12).
class J2OverTemperature {
public:
  struct Row {
    double temperature, young, poisson;
    J2::Hardening hardening;
  };

  explicit J2OverTemperature(std::vector<Row> rows) : rows(std::move(rows)) {}

  std::size_t history() const { return J2::BACK + rows[0].hardening.back.size() / 2 * STRAINS; }

  // At every temperature.
  bool symmetric() const {
    return std::all_of(rows.begin(), rows.end(), [](const Row &row) { return !row.hardening.fades(); });
  }

  J2 at(double temperature) const {
    std::size_t upper = 0;
    while (upper + 1 < rows.size() && rows[upper].temperature < temperature)
      ++upper;
    const Row &high = rows[upper], &low = rows[upper ? upper - 1 : 0];
    const double apart = high.temperature - low.temperature;
    const double share = apart > 0 ? std::clamp((temperature - low.temperature) / apart, 0.0, 1.0) : 1;
    const auto between = [share](double a, double b) { return a + share * (b - a); };
    const double young = between(low.young, high.young), poisson = between(low.poisson, high.poisson);
    J2::Hardening now = low.hardening;
    for (std::size_t i = 1; i < now.table.size(); i += 2)
      now.table[i] = between(low.hardening.table[i], high.hardening.table[i]);
    for (std::size_t i = 0; i < now.back.size(); ++i)
      now.back[i] = between(low.hardening.back[i], high.hardening.back[i]);
    now.slope = between(low.hardening.slope, high.hardening.slope);
    now.saturation = between(low.hardening.saturation, high.hardening.saturation);
    now.rate = between(low.hardening.rate, high.hardening.rate);
    return {bulk_modulus(young, poisson), young / (2 * (1 + poisson)), std::move(now)};
  }

private:
  // Bodies that keep their volume have a large bulk modulus instead of none.
  static double bulk_modulus(double young, double poisson) {
    constexpr double INCOMPRESSIBLE = 1e7; // over the shear modulus, as in materials/elastic.py
    return young / std::max(3 * (1 - 2 * poisson), 2 * (1 + poisson) / INCOMPRESSIBLE);
  }

  std::vector<Row> rows;
};

// The strain out of the plane that leaves no stress there, by Newton's method within bounds; the tangent is that of the
// components in the plane. False where there is none.
template <class Law>
bool respond_in_plane(const Law &law, double *strain, const double *before, double *after, double *stress,
                      Dense &result) {
  constexpr int Z = 2, LIMIT = 100;
  double low = -std::numeric_limits<double>::infinity(), high = -low;
  strain[Z] = law.across(strain, before);
  for (int i = 0; i < LIMIT; ++i) {
    law.respond(strain, before, after, stress, result);
    const double own = result.c[Z * STRAINS + Z];
    double largest = 0;
    for (int s = 0; s < STRAINS; ++s)
      largest = std::max(largest, std::abs(strain[s]));
    const bool close = std::abs(stress[Z]) <= 1e-11 * own * largest;
    double next = strain[Z] - stress[Z] / own;
    (stress[Z] > 0 ? high : low) = strain[Z];
    if (std::abs(stress[Z]) <= 1e-15 * own * largest || (close && (i > 12 || next == strain[Z]))) {
      double column[STRAINS], row[STRAINS];
      for (int s = 0; s < STRAINS; ++s)
        column[s] = result.c[s * STRAINS + Z], row[s] = result.c[Z * STRAINS + s];
      for (int s = 0; s < STRAINS; ++s)
        for (int t = 0; t < STRAINS; ++t)
          result.c[s * STRAINS + t] = s == Z || t == Z ? 0 : result.c[s * STRAINS + t] - column[s] * row[t] / own;
      stress[Z] = 0;
      return own > 0;
    }
    if (!(next > low && next < high))
      next = (low + high) / 2;
    strain[Z] = next;
  }
  return false;
}

} // namespace abut
