// Slips of held places; see docs/theory/coupling-tangent.md.
#include "slip.hpp"
#include "accumulator.hpp"
#include "parallel.hpp"

namespace abut {

namespace {

constexpr std::size_t FEW_POINTS = 2000; // not worth a thread

// The slip at a point in D dimensions, C components, and its derivatives by x_C - x_T and by the sum of the normals.
template <int D> struct SlipAt {
  static constexpr int C = D == 2 ? 1 : 3;
  double value[C], by_apart[C][D], by_sum[C][D];

  SlipAt(const double *apart, const double *sum) {
    double n[D], length = 0;
    for (int a = 0; a < D; ++a)
      length += sum[a] * sum[a];
    length = std::sqrt(length);
    for (int a = 0; a < D; ++a)
      n[a] = sum[a] / length;
    if constexpr (D == 2)
      in_plane(apart, n, length);
    else
      in_space(apart, n, length);
  }

private:
  void in_plane(const double *apart, const double *n, double length) {
    value[0] = apart[1] * n[0] - apart[0] * n[1];
    by_apart[0][0] = -n[1], by_apart[0][1] = n[0];
    const double along = (apart[1] * n[0] - apart[0] * n[1]) / length; // the part of (d_y, -d_x) along N
    by_sum[0][0] = apart[1] / length - along * n[0], by_sum[0][1] = -apart[0] / length - along * n[1];
  }
  // v = (I - N N) d, so that dv = (I - N N) dd - (h I + N d) (I - N N) dS / |S|.
  void in_space(const double *apart, const double *n, double length) {
    double h = 0;
    for (int a = 0; a < D; ++a)
      h += apart[a] * n[a];
    for (int a = 0; a < D; ++a)
      value[a] = apart[a] - h * n[a];
    for (int a = 0; a < D; ++a)
      for (int b = 0; b < D; ++b) {
        by_apart[a][b] = (a == b) - n[a] * n[b];
        by_sum[a][b] = -(h * by_apart[a][b] + n[a] * value[b]) / length;
      }
  }
};

// Adds up the points of one contactor facet, target by target.
template <int D> class SlipSums {
public:
  static constexpr int C = SlipAt<D>::C;
  SlipSums(const SlipView &view, const Numbering &numbering, double *value, Derivative &by)
      : view_(view), numbering_(numbering), value_(value), by_(by) {}

  void run(std::size_t first, std::size_t last) {
    for (std::size_t q = first; q < last; ++q) {
      const bool another = q == first || view_.facet[q] != view_.facet[q - 1];
      if (q > first && (another || view_.target_facet[q] != view_.target_facet[q - 1]))
        end_target(q - 1);
      if (q > first && another)
        end(q - 1);
      add(q);
    }
    if (last > first)
      end_target(last - 1), end(last - 1);
  }

private:
  using Block = double[MAX_FACET_NODES][MAX_FACET_NODES][C][D];

  void add(std::size_t q) {
    const double *own = view_.own + MAX_FACET_NODES * q, *other = view_.other + MAX_FACET_NODES * q;
    const std::int32_t *nodes = view_.nodes + MAX_FACET_NODES * view_.facet[q];
    const std::int32_t *target = view_.target_nodes + MAX_FACET_NODES * view_.target_facet[q];
    const double *normals = view_.normals + MAX_FACET_NODES * D * view_.facet[q];
    double apart[D] = {0}, sum[D] = {0};
    for (int j = 0; j < MAX_FACET_NODES; ++j)
      for (int a = 0; a < D; ++a) {
        if (nodes[j] >= 0) // from target to contactor: theory (F1)
          apart[a] += own[j] * view_.points[D * nodes[j] + a], sum[a] -= own[j] * normals[D * j + a];
        if (target[j] >= 0)
          apart[a] -= other[j] * view_.target_points[D * target[j] + a];
      }
    const SlipAt<D> at(apart, sum);
    for (int k = 0; k < MAX_FACET_NODES; ++k) {
      const double area = view_.weight[q] * view_.pressure[MAX_FACET_NODES * q + k];
      if (area == 0)
        continue;
      for (int c = 0; c < C; ++c)
        value_[C * (MAX_FACET_NODES * view_.facet[q] + k) + c] += area * at.value[c];
      for (int j = 0; j < MAX_FACET_NODES && nodes[j] >= 0; ++j) {
        add_block(area * own[j], at.by_apart, by_own_[k][j]);
        add_block(-area * own[j], at.by_sum, by_normal_[k][j]);
      }
      for (int j = 0; j < MAX_FACET_NODES && target[j] >= 0; ++j)
        add_block(-area * other[j], at.by_apart, by_other_[k][j]);
    }
  }

  static void add_block(double share, const double (&from)[C][D], double (&to)[C][D]) {
    for (int c = 0; c < C; ++c)
      for (int a = 0; a < D; ++a)
        to[c][a] += share * from[c][a];
  }

  void end_target(std::size_t q) {
    const std::int32_t *target = view_.target_nodes + MAX_FACET_NODES * view_.target_facet[q];
    emit(by_.by_points, view_.facet[q], target, numbering_.target_offset, by_other_);
  }
  void end(std::size_t q) {
    const std::size_t f = view_.facet[q];
    emit(by_.by_points, f, view_.nodes + MAX_FACET_NODES * f, 0, by_own_);
    emit(by_.by_normals, f, numbering_.normals + MAX_FACET_NODES * f, 0, by_normal_);
  }

  static void emit(Blocks &to, std::size_t f, const std::int32_t *columns, std::int32_t offset, Block &block) {
    for (int k = 0; k < MAX_FACET_NODES; ++k)
      for (int j = 0; j < MAX_FACET_NODES; ++j) {
        const double *values = &block[k][j][0][0];
        if (columns[j] < 0 || std::all_of(values, values + C * D, [](double v) { return v == 0; }))
          continue;
        to.row.push_back(std::int32_t(MAX_FACET_NODES * f + k)), to.column.push_back(offset + columns[j]);
        to.value.insert(to.value.end(), values, values + C * D);
      }
    double *all = &block[0][0][0][0];
    std::fill(all, all + MAX_FACET_NODES * MAX_FACET_NODES * C * D, 0.0);
  }

  const SlipView &view_;
  const Numbering &numbering_;
  double *value_;
  Derivative &by_;
  Block by_own_ = {}, by_normal_ = {}, by_other_ = {};
};

template <int D> SlipLists slips(const SlipView &view, std::size_t facets, const Numbering &numbering) {
  SlipLists out;
  out.value.assign(SlipAt<D>::C * MAX_FACET_NODES * facets, 0);
  const std::size_t parts = view.n < FEW_POINTS ? 1 : thread_count();
  std::vector<Derivative> lists(parts);
  auto start = [&](std::size_t part) { // of a facet
    std::size_t q = view.n * part / parts;
    while (q > 0 && q < view.n && view.facet[q] == view.facet[q - 1])
      ++q;
    return q;
  };
  run_parts(parts, [&](std::size_t part) {
    SlipSums<D>(view, numbering, out.value.data(), lists[part]).run(start(part), start(part + 1));
  });
  for (Derivative &part : lists)
    append(out.by, part);
  return out;
}

} // namespace

SlipLists slip(const SlipView &view, int dim, std::size_t facets, const Numbering &numbering) {
  return dim == 2 ? slips<2>(view, facets, numbering) : slips<3>(view, facets, numbering);
}

} // namespace abut
