// Functions of the pressure and of the dilatation within a mixed cell, docs/theory/elements.md (E6).
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace abut {

// 1, or 1 and the coordinates (dim of them), orthonormal under the weights of an integration rule: their values at its
// points.
class CellFunctions {
public:
  CellFunctions(std::size_t count, std::size_t rule, int dim)
      : count(count), rule(rule), dim(dim), values(rule * count) {}

  // Of a cell with the points of the rule at x (rule, dim), weights that include the volume.
  void place(const double *x, const double *weights) {
    for (std::size_t m = 0; m < count; ++m) {
      for (std::size_t q = 0; q < rule; ++q)
        at(q, m) = m == 0 ? 1 : x[q * dim + m - 1];
      for (int again = 0; again < 2; ++again) // Gram and Schmidt, twice against rounding
        for (std::size_t k = 0; k < m; ++k) {
          double common = 0;
          for (std::size_t q = 0; q < rule; ++q)
            common += weights[q] * at(q, k) * at(q, m);
          for (std::size_t q = 0; q < rule; ++q)
            at(q, m) -= common * at(q, k);
        }
      double square = 0;
      for (std::size_t q = 0; q < rule; ++q)
        square += weights[q] * at(q, m) * at(q, m);
      for (std::size_t q = 0; q < rule; ++q)
        at(q, m) /= std::sqrt(square);
    }
  }

  double at(std::size_t q, std::size_t m) const { return values[q * count + m]; }

  // result (rule, width): the projection of fields (rule, width) on the functions; sums (count, width): its factors.
  void project(const double *fields, const double *weights, std::size_t width, double *sums, double *result) const {
    std::fill_n(sums, count * width, 0.0);
    for (std::size_t q = 0; q < rule; ++q)
      for (std::size_t m = 0; m < count; ++m) {
        const double factor = weights[q] * at(q, m);
        for (std::size_t j = 0; j < width; ++j)
          sums[m * width + j] += factor * fields[q * width + j];
      }
    std::fill_n(result, rule * width, 0.0);
    for (std::size_t q = 0; q < rule; ++q)
      for (std::size_t m = 0; m < count; ++m)
        for (std::size_t j = 0; j < width; ++j)
          result[q * width + j] += at(q, m) * sums[m * width + j];
  }

  const std::size_t count;

private:
  double &at(std::size_t q, std::size_t m) { return values[q * count + m]; }

  std::size_t rule;
  int dim;
  std::vector<double> values; // (rule, count)
};

} // namespace abut
