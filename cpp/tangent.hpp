// Derivatives of the coupling by the coordinates of both surfaces; see docs/theory/coupling-tangent.md.
#pragma once
#include "segments.hpp"

namespace abut {

// Facet-wise coefficients on the contactor, MAX_FACET_NODES a facet; tractions (none: null) have dim values each, and
// in 2D those along the turned normal (none: null) one. rubs: whether there are tractions, facets or not.
struct Load {
  const double *pressure, *traction, *turned;
  bool rubs;
  // Whether there are tractions on facet f.
  bool rubs_on(std::size_t f, std::size_t dim) const {
    return any(traction, f, MAX_FACET_NODES * dim) || any(turned, f, MAX_FACET_NODES);
  }
  // Whether there is anything on it.
  bool acts_on(std::size_t f, std::size_t dim) const { return any(pressure, f, MAX_FACET_NODES) || rubs_on(f, dim); }

private:
  static bool any(const double *values, std::size_t f, std::size_t n) {
    return values && std::any_of(values + f * n, values + (f + 1) * n, [](double value) { return value != 0; });
  }
};

// Numbers of what is differentiated by: the points of both surfaces, and the contactor's nodal normals.
struct Numbering {
  const std::int32_t *normals; // MAX_FACET_NODES a facet
  std::int32_t target_offset;  // of the target's first point among all
};

// Blocks (row, column, values), several of which may have the same place.
struct Blocks {
  std::vector<std::int32_t> row, column;
  std::vector<double> value;
};

// One list for derivatives by points, one by normals.
struct Derivative {
  Blocks by_points, by_normals;
};

// Values of an entry of the operators: dim along the normal, and with tractions, too, dim x dim of them along the axes,
// in 2D dim along the turned normal.
inline std::size_t operator_width(std::size_t dim, bool rubs) {
  return !rubs ? dim : dim == 3 ? dim + dim * dim : 2 * dim;
}

void append(Derivative &to, Derivative &from); // which is empty afterwards, or of no use

// Rows of `moment` and `operators` are MAX_FACET_NODES f + k, values dim of the gap and dim of the weight; those of
// `force` are points, values dim x dim.
struct TangentLists {
  Derivative moment, force;
  Blocks operators;
  std::vector<double> gap, weight;  // of all facets, MAX_FACET_NODES each
  std::vector<std::int32_t> loaded; // points, with dim values each:
  std::vector<double> load;
};

TangentLists tangent(const Planned &contactor, const Planned &target, const RuleTable &rules, const Options &options,
                     const Load &load, const Numbering &numbering);

// Blocks as compressed rows: those in one place added up in their order.
struct CompressedBlocks {
  std::vector<std::int32_t> start;
  std::vector<std::int32_t> column;
  std::vector<double> value;
};
CompressedBlocks compress(const Blocks &blocks, std::size_t rows, std::size_t width);

} // namespace abut
