// The one loop over cells and integration points: strain by the kinematics, stress and tangent by the material, and
// what they add up to.
#pragma once
#include "finite_strain.hpp"
#include "foreseen.hpp"
#include "kinematics.hpp"
#include "materials.hpp"
#include "mixed_strain.hpp"
#include "turned.hpp"
#include <algorithm>
#include <cstdint>
#include <new>
#include <optional>
#include <type_traits>
#include <vector>

namespace abut {

// displacement (points, dim); thermal: null, or the thermal strain of each cell at its nodes (cells, n), alike in all
// directions, which the shape functions interpolate; earlier: null, or the displacement from which an iteration of
// Newton's method led here, or a guess if ``guessed``.
struct State {
  const double *displacement = nullptr, *thermal = nullptr, *earlier = nullptr;
  bool guessed = false;
};

// What is asked for; null pointers are left out. All but stresses are added to.
struct Results {
  double *force = nullptr;               // (points, dim)
  const std::int64_t *indptr = nullptr;  // node pattern of the stiffness
  const std::int32_t *indices = nullptr; // sorted in each row
  double *stiffness = nullptr;           // values of the pattern with dim x dim blocks
  double *stress = nullptr; // (cells, rule, 6) at the integration points, written; Cauchy's of finite strains
  double *energy = nullptr; // (cells,) of laws that know it, written
};

// The first cell, in their order, that has no sound deformation, and the determinant of the deformation gradient there;
// where that is positive, plane stress found no stretch out of the plane.
struct Unsound {
  std::size_t cell = SIZE_MAX;
  double determinant = 0;
};

// Points first .. last - 1, whose results a thread owns: it computes all cells that reach into them, so that each is
// added up in the order of the cells, whatever the number of threads.
struct Rows {
  std::int32_t first, last;
  bool has(std::int32_t i) const { return i >= first && i < last; }
};

// Nodal values (n,) of a cell at point q, by shape functions (rule, n).
inline double at_point(const double *shapes, std::size_t n, std::size_t q, const double *values) {
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i)
    sum += shapes[q * n + i] * values[i];
  return sum;
}

// Strain at point q that stresses: less what the temperature makes. thermal (n,) of the cell, or null.
template <class Kinematics>
void mechanical_strain(const Kinematics &kinematics, const Cells &cells, std::size_t q, const double *u,
                       const double *thermal, double *strain) {
  kinematics.strain(q, u, strain);
  if (!thermal)
    return;
  const double free = at_point(kinematics.swelling(), cells.n, q, thermal);
  for (int a = 0; a < 3; ++a)
    strain[a] -= free;
}

// Strains (cells, rule, 6) of the cells first .. last - 1.
template <class Kinematics>
void point_strains(const Cells &cells, const State &state, double *strain, std::size_t first, std::size_t last) {
  constexpr int dim = Kinematics::DIM;
  Kinematics kinematics(cells);
  std::vector<double> x(cells.n * dim), u(cells.n * dim);
  for (std::size_t c = first; c < last; ++c) {
    gather(cells.points, cells.nodes + c * cells.n, cells.n, dim, x.data());
    gather(state.displacement, cells.nodes + c * cells.n, cells.n, dim, u.data());
    kinematics.place(x.data());
    const double *thermal = state.thermal ? state.thermal + c * cells.n : nullptr;
    for (std::size_t q = 0; q < cells.rule; ++q)
      mechanical_strain(kinematics, cells, q, u.data(), thermal, strain + (c * cells.rule + q) * STRAINS);
  }
}

template <class Kinematics, class Material> class Integration {
public:
  Integration(const Cells &cells, const State &state, const Material &material, const Results &results, Rows rows)
      : cells(cells), state(state), material(material), results(results), rows(rows), kinematics(cells), n(cells.n),
        x(n * dim), u(n * dim), stress(cells.rule * STRAINS), tangent(cells.rule), force(n * dim),
        block(results.stiffness ? n * n * dim * dim : 0), strains(foresees() ? stress.size() : 0),
        foreseen(strains.size()), bent(foresees() ? cells.rule : 0) {}

  // Ends at the first cell without a sound deformation, and says which.
  Unsound run() {
    for (std::size_t c = 0; c < cells.count; ++c) {
      own = cells.nodes + c * n;
      if (std::none_of(own, own + n, [&](std::int32_t i) { return rows.has(i); }))
        continue;
      gather(cells.points, own, n, dim, x.data());
      kinematics.place(x.data());
      if constexpr (Kinematics::finite) {
        if (const double determinant = evaluate_finite(c); std::isfinite(determinant))
          return {c, determinant};
      } else
        evaluate(c);
      if (results.force)
        add_force();
      turning = stress.data();
      if constexpr (Kinematics::finite)
        if (results.stiffness && foresees())
          foresee();
      if (results.stiffness)
        add_stiffness();
      if (results.stress && rows.has(own[0]))
        write_stress(c);
    }
    return {};
  }

private:
  static constexpr int dim = Kinematics::DIM;
  using Tangent = typename Material::Tangent;

  static constexpr bool knows_energy = std::is_same_v<Tangent, Dense>;

  void evaluate(std::size_t c) {
    double energy = 0;
    const bool stressed = results.force || results.stress;
    const bool strained = (Material::stress_by_strain && stressed) || Material::tangent_by_strain;
    const double *thermal = state.thermal ? state.thermal + c * n : nullptr;
    double strain[STRAINS];
    if (strained)
      gather(state.displacement, own, n, dim, u.data());
    for (std::size_t q = 0; q < cells.rule; ++q) {
      if (strained)
        mechanical_strain(kinematics, cells, q, u.data(), thermal, strain);
      const Point point{c, c * cells.rule + q, rows.has(own[0])};
      new (&tangent[q]) Tangent(material.evaluate(point, strain, stressed ? &stress[q * STRAINS] : nullptr));
      if constexpr (knows_energy)
        energy += kinematics.reference_volume(q) * tangent[q].energy;
    }
    if (knows_energy && results.energy && rows.has(own[0]))
      results.energy[c] = energy;
  }

  // Not a number where all is sound, else the determinant of the deformation gradient.
  double evaluate_finite(std::size_t c) {
    double determinant, strain[STRAINS], energy = 0;
    gather(state.displacement, own, n, dim, u.data());
    if (!kinematics.deform(u.data(), determinant))
      return std::isfinite(determinant) ? determinant : 0;
    for (std::size_t q = 0; q < cells.rule; ++q) {
      kinematics.strain(q, strain);
      if (foresees())
        std::copy_n(strain, STRAINS, &strains[q * STRAINS]);
      const double stretch = 1 + (state.thermal ? at_point(kinematics.swelling(), n, q, state.thermal + c * n) : 0);
      double *const at = &stress[q * STRAINS];
      // In its place: copies of a tangent take as long as some laws.
      const Point point{c, c * cells.rule + q, rows.has(own[0]), q ? &tangent[q - 1] : nullptr};
      new (&tangent[q]) Tangent(heated(material, point, stretch, strain, at));
      if (!tangent[q].sound)
        return kinematics.determinant(q);
      if (material.plane_stress)
        kinematics.thicken(q, stretch * std::sqrt(1 + 2 * strain[2]));
      energy += kinematics.reference_volume(q) * tangent[q].energy;
    }
    if constexpr (requires { kinematics.collect(stress.data()); })
      kinematics.collect(stress.data());
    if (results.energy && rows.has(own[0]))
      results.energy[c] = energy;
    return std::nan("");
  }

  // Whether the cells have a volume of their own, F-bar's or that of mixed cells, whose pressure is foreseen.
  bool foresees() const { return state.earlier && (cells.mean_dilatation || cells.pressures > 0); }

  // The stiffness takes pressures as they were foreseen where the iteration began, as if they were unknowns beside
  // displacements, theory (D24): what displacements add to the volume beyond the first order is no stress yet.
  void foresee() {
    if (!past)
      past.emplace(cells);
    gather(state.earlier, own, n, dim, u.data());
    double determinant;
    past->place(x.data());
    foreseen = stress;
    if (!past->deform(u.data(), determinant))
      return;
    kinematics.bend(*past, state.guessed, bent.data());
    for (std::size_t q = 0; q < cells.rule; ++q) {
      turn_back(tangent[q]);
      foresee_pressure(&strains[q * STRAINS], bent[q], &foreseen[q * STRAINS], tangent[q].c);
    }
    turning = foreseen.data();
    if constexpr (requires { kinematics.collect(foreseen.data()); })
      kinematics.collect(foreseen.data());
  }

  void add_force() {
    std::fill(force.begin(), force.end(), 0.0);
    for (std::size_t q = 0; q < cells.rule; ++q)
      kinematics.add_force(q, &stress[q * STRAINS], force.data());
    kinematics.complete_force(force.data());
    for (std::size_t i = 0; i < n; ++i)
      for (int a = 0; rows.has(own[i]) && a < dim; ++a)
        results.force[std::size_t(own[i]) * dim + a] += force[i * dim + a];
  }

  void write_stress(std::size_t c) {
    if constexpr (Kinematics::finite)
      for (std::size_t q = 0; q < cells.rule; ++q)
        kinematics.to_cauchy(q, &stress[q * STRAINS]);
    std::copy(stress.begin(), stress.end(), results.stress + c * cells.rule * STRAINS);
  }

  void add_stiffness() {
    if (!kinematics.by_modes())
      std::fill(block.begin(), block.end(), 0.0);
    for (std::size_t q = 0; q < cells.rule; ++q)
      if constexpr (Kinematics::finite) {
        if (!kinematics.by_modes())
          turn_back(tangent[q]);
        kinematics.add_stiffness(q, tangent[q], turning + q * STRAINS, material.symmetric(), block.data());
      } else if constexpr (std::is_same_v<Tangent, Moduli>)
        kinematics.add_stiffness(q, tangent[q], block.data());
      else
        kinematics.add_stiffness(q, tangent[q].c, half(), block.data());
    if constexpr (std::is_same_v<Tangent, Moduli>)
      kinematics.finish(tangent[0], block.data());
    else
      kinematics.complete(material.symmetric(), block.data());
    const bool symmetric = half();
    for (std::size_t i = 0; i < n; ++i)
      if (rows.has(own[i]))
        symmetric ? scatter<true>(i) : scatter<false>(i);
  }

  // Whether only half of the block, which is symmetric, is added up.
  bool half() const {
    if (kinematics.by_modes())
      return false;
    if constexpr (Kinematics::finite)
      return material.symmetric() && kinematics.symmetric();
    else
      return material.symmetric();
  }

  // The rows of node i. A symmetric block holds nodes i <= k only.
  template <bool symmetric> void scatter(std::size_t i) {
    const std::int64_t row = results.indptr[own[i]], length = results.indptr[own[i] + 1] - row;
    const std::int32_t *begin = results.indices + row, *end = begin + length;
    double *out = results.stiffness + row * dim * dim;
    for (std::size_t k = 0; k < n; ++k) {
      const std::int64_t position = std::lower_bound(begin, end, own[k]) - begin;
      const bool stored = !symmetric || i <= k;
      const double *in = &block[(stored ? i * n + k : k * n + i) * dim * dim];
      for (int a = 0; a < dim; ++a)
        for (int b = 0; b < dim; ++b)
          out[a * dim * length + position * dim + b] += stored ? in[a * dim + b] : in[b * dim + a];
    }
  }

  const Cells &cells;
  const State &state;
  const Material &material;
  const Results &results;
  Rows rows;
  Kinematics kinematics;
  std::size_t n;
  std::vector<double> x, u, stress;
  std::vector<Tangent> tangent;
  std::vector<double> force, block;
  std::vector<double> strains, foreseen, bent; // at the points: strains, stresses with foreseen pressures, as ``bend``
  std::optional<Kinematics> past;              // where the iteration began
  const double *turning = nullptr;             // stresses that the stiffness has
  const std::int32_t *own = nullptr;           // nodes of the cell
};

template <class Kinematics, class Material>
Unsound integrate(const Cells &cells, const State &state, const Material &material, const Results &results, Rows rows) {
  return Integration<Kinematics, Material>(cells, state, material, results, rows).run();
}

} // namespace abut
