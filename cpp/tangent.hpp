// Derivatives of the coupling by the coordinates of both surfaces; see docs/theory/coupling-tangent.md.
#pragma once
#include "segments.hpp"

namespace abut {

// Facet-wise coefficients on the contactor, MAX_FACET_NODES a facet; tractions (none: null) have dim values each.
struct Load {
  const double *pressure, *traction;
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

// Rows of `moment` are MAX_FACET_NODES f + k, values dim of the gap and dim of the weight; those of `force` are points,
// values dim x dim.
struct TangentLists {
  Derivative moment, force;
  std::vector<std::int32_t> loaded; // points, with dim values each:
  std::vector<double> load;
};

TangentLists tangent(const Planned &contactor, const Planned &target, const RuleTable &rules, const Options &options,
                     const Load &load, const Numbering &numbering);

// Blocks as compressed rows: those in one place added up in their order.
struct CompressedBlocks {
  std::vector<std::int64_t> start;
  std::vector<std::int32_t> column;
  std::vector<double> value;
};
CompressedBlocks compress(const Blocks &blocks, std::size_t rows, std::size_t width);

} // namespace abut
