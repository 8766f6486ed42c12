// Stiffness of quadrilaterals and hexahedra with 2^dim nodes and as many integration points, by the modes of
// displacement that are products of reference coordinates at the corners (Flanagan, Belytschko 1981), theory (D26).
#pragma once
#include "each.hpp"
#include "kinematics.hpp"
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <optional>

namespace abut {

// The slope of a mode along a reference coordinate has one size at all points, and there the sign of another mode. So
// sums over points by signs are what all pairs of modes need, and sums over modes by signs are what nodes need: a small
// part of the products of each pair of nodes at each point.
template <int dim> class CornerModes {
public:
  static constexpr int CORNERS = 1 << dim, SIZE = dim * dim;
  // By the slopes along reference coordinates: of a stress (b, a), component a across coordinate b, by slope (d, c), c
  // along coordinate d, at [b][a][d][c].
  using Moduli = double[dim][dim][dim][dim];
  using Stress = double[dim][dim];

  // None of other cells or rules.
  static std::optional<CornerModes> of(const Cells &cells) {
    if (cells.n != CORNERS || cells.rule != CORNERS)
      return std::nullopt;
    CornerModes result;
    std::array<bool, CORNERS> seen{};
    for (int k = 0; k < CORNERS; ++k) {
      int corner = 0;
      for (int a = 0; a < dim; ++a)
        corner |= (cells.derivatives[k * dim + a] > 0) << a;
      result.node[corner] = k, result.corner[k] = corner;
      seen[corner] = true;
    }
    if (!std::all_of(seen.begin(), seen.end(), [](bool value) { return value; }))
      return std::nullopt;
    return result.find_points(cells) ? std::optional(result) : std::nullopt;
  }

  // Of point q, times its weight. Pairs below the diagonal may be left out of symmetric ones.
  Moduli &moduli(std::size_t q) { return at_points[point[q]].moduli; }

  // Stress by the dilatation at the centre, times the weight.
  Stress &by_centre(std::size_t q) { return at_points[point[q]].stress; }

  // Slopes of values (n, dim) at nodes, at each point: of component a along reference coordinate b at [a][b].
  void set_slopes(const double *values) {
    double at_corners[CORNERS][dim], by_mode[CORNERS][dim];
    for (int m = 0; m < CORNERS; ++m)
      std::copy_n(values + node[m] * dim, dim, at_corners[m]);
    by_signs<dim, true>(at_corners[0], IN_ORDER, by_mode[0]);
    each<0, dim>([&](auto b) { // a mode of coordinate b has the slope of the one without it, alike on both sides
      constexpr int own = 1 << b;
      double x[CORNERS][dim];
      each<0, CORNERS>([&](auto m) {
        if constexpr (!(m & own))
          for (int a = 0; a < dim; ++a)
            x[m][a] = factors[m | own] * by_mode[m | own][a];
      });
      each<0, dim>([&](auto axis) {
        each<0, CORNERS>([&](auto low) {
          constexpr int bit = 1 << axis, high = low | bit;
          if constexpr (axis != b && !(low & own) && !(low & bit))
            for (int a = 0; a < dim; ++a) {
              const double without = x[low][a], with = x[high][a];
              x[low][a] = without - with, x[high][a] = without + with;
            }
        });
      });
      each<0, CORNERS>([&](auto m) {
        for (int a = 0; a < dim; ++a)
          slopes[m][a][b] = x[m & ~own][a];
      });
    });
  }
  const Stress &slope(std::size_t q) const { return slopes[point[q]]; }

  // Forces (n, dim) of a stress at each point, times its weight: component a across reference coordinate b at [b][a].
  Stress &pushing(std::size_t q) { return pushes[point[q]]; }
  void add_forces(double *force) const {
    Stress by_mode[CORNERS];
    double of_mode[CORNERS][dim], at_corners[CORNERS][dim];
    by_signs<SIZE, true>(pushes[0][0], IN_ORDER, by_mode[0][0]);
    each<1, CORNERS>([&](auto m) {
      for (int a = 0; a < dim; ++a) {
        double sum = 0;
        each<0, dim>([&](auto b) {
          if constexpr (m >> b & 1)
            sum += by_mode[m ^ 1 << b][b][a];
        });
        of_mode[m][a] = factors[m] * sum;
      }
    });
    by_signs<dim, false>(of_mode[0], node, at_corners[0]);
    for (int k = 0; k < CORNERS; ++k)
      for (int a = 0; a < dim; ++a)
        force[k * dim + a] += at_corners[k][a];
  }

  // Writes the stiffness (n, n, dim, dim). symmetric: of symmetric moduli. centre: null, or the change of the
  // dilatation at the centre (n, dim) by displacements.
  void write(bool symmetric, const double *centre, double *block) {
    constexpr int numbers = sizeof(Sums) / sizeof(double), row = CORNERS * SIZE;
    by_signs<numbers, true>(&at_points[0].moduli[0][0][0][0], IN_ORDER, &sums[0].moduli[0][0][0][0]);
    symmetric ? pair_modes<true>() : pair_modes<false>();
    if (centre)
      add_centre(centre);
    for (int m = 1; m < CORNERS; ++m)
      by_signs<SIZE, false>(modes[m][0], node, by_node[m][0]);
    by_signs<row, false>(by_node[0][0], node, block);
  }

private:
  struct Sums {
    Moduli moduli;
    Stress stress;
  };

  // Whether the points lie alike; which corner each is next to.
  bool find_points(const Cells &cells) {
    std::array<bool, CORNERS> seen{};
    for (int q = 0; q < CORNERS; ++q) {
      point[q] = 0;
      for (int a = 0; a < dim; ++a) {
        double place = 0; // along coordinate a
        for (int k = 0; k < CORNERS; ++k)
          place += (corner[k] >> a & 1 ? 1 : -1) * cells.shapes[q * CORNERS + k];
        if (q == 0 && a == 0)
          away = std::abs(place);
        if (std::abs(std::abs(place) - away) > 1e-12 || away == 0)
          return false;
        point[q] |= (place > 0) << a;
      }
      seen[point[q]] = true;
    }
    for (int m = 1; m < CORNERS; ++m)
      factors[m] = std::pow(away, std::popcount(unsigned(m)) - 1) / CORNERS;
    return std::all_of(seen.begin(), seen.end(), [](bool value) { return value; });
  }

  // Rows of numbers at corners to their sums with the signs of each mode, or (not to_modes) of modes to the sums at
  // each corner, row m to the place order[m].
  template <int numbers, bool to_modes>
  static void by_signs(const double *__restrict from, const int *order, double *__restrict to) {
    for (int j = 0; j < numbers; ++j) {
      double x[CORNERS];
      each<0, CORNERS>([&](auto m) { // that of mode 0, a displacement of the whole, has no stiffness
        if constexpr (m == 0 && !to_modes)
          x[m] = 0;
        else
          x[m] = from[m * numbers + j];
      });
      each<0, dim>([&](auto axis) {
        each<0, CORNERS>([&](auto low) {
          constexpr int bit = 1 << axis, high = low | bit;
          if constexpr (!(low & bit)) {
            const double without = x[low], with = x[high];
            x[low] = to_modes ? without + with : without - with;
            x[high] = to_modes ? with - without : without + with;
          }
        });
      });
      each<0, CORNERS>([&](auto m) { to[order[m] * numbers + j] = x[m]; });
    }
  }

  template <bool symmetric> void pair_modes() {
    each<1, CORNERS>([&](auto m) {
      each<(symmetric ? m : 1), CORNERS>([&](auto l) {
        double sum[SIZE] = {0};
        each<0, dim>([&](auto b) {
          each<0, dim>([&](auto d) {
            if constexpr ((m >> b & 1) && (l >> d & 1)) {
              const Moduli &in = sums[(m ^ 1 << b) ^ (l ^ 1 << d)].moduli;
              for (int a = 0; a < dim; ++a)
                for (int c = 0; c < dim; ++c)
                  sum[a * dim + c] += symmetric && b > d ? in[d][c][b][a] : in[b][a][d][c];
            }
          });
        });
        const double both = factors[m] * factors[l];
        for (int a = 0; a < dim; ++a)
          for (int c = 0; c < dim; ++c) {
            modes[m][l][a * dim + c] = both * sum[a * dim + c];
            if constexpr (symmetric && l > m)
              modes[l][m][c * dim + a] = both * sum[a * dim + c];
          }
      });
    });
  }

  // At the centre modes of one coordinate alone have slopes.
  void add_centre(const double *centre) {
    for (int d = 0; d < dim; ++d) {
      double by[dim] = {0};
      for (int k = 0; k < CORNERS; ++k)
        for (int c = 0; c < dim; ++c)
          by[c] += (corner[k] >> d & 1 ? 1.0 : -1.0) / CORNERS * centre[k * dim + c];
      for (int m = 1; m < CORNERS; ++m)
        for (int b = 0; b < dim; ++b)
          if (m >> b & 1)
            for (int a = 0; a < dim; ++a)
              for (int c = 0; c < dim; ++c)
                modes[m][1 << d][a * dim + c] += factors[m] * sums[m ^ 1 << b].stress[b][a] * by[c];
    }
  }

  static constexpr int IN_ORDER[8] = {0, 1, 2, 3, 4, 5, 6, 7};

  double away;             // of the points from the centre, along each coordinate
  double factors[CORNERS]; // slope of a mode at the points, over that of its values at the corners
  int node[CORNERS], corner[CORNERS], point[CORNERS];                    // by corner; by node; by point
  Stress slopes[CORNERS], pushes[CORNERS];                               // by corner
  Sums at_points[CORNERS], sums[CORNERS];                                // by corner; by mode
  double modes[CORNERS][CORNERS][SIZE], by_node[CORNERS][CORNERS][SIZE]; // by modes; by mode and node
};

} // namespace abut
