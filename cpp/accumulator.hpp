// What the segments of one contactor facet add up to; see docs/theory/segments.md.
#pragma once
#include "segments.hpp"

namespace abut {

inline int pressure_functions(int kind, int degree) {
  return degree == 0 ? 1 : degree == 1 ? CORNERS[kind] : NODES[kind];
}

inline void pressure_values(int kind, int degree, const double *xi, const double *own, double *h) {
  if (degree == 0) {
    h[0] = 1;
  } else if (degree == 2 || !quadratic(kind)) {
    for (int k = 0; k < NODES[kind]; ++k)
      h[k] = own[k];
  } else {
    double d[MAX_FACET_NODES][3];
    shape(LINEAR[kind], xi, h, d);
  }
}

// Sums of one contactor facet with all its targets.
class Accumulator {
public:
  // Values facet by facet go to `out`, which all threads share; lists to `own`.
  Accumulator(Coupling &out, Lists &own, const Options &options, int dim)
      : out_(out), lists_(own), options_(options), dim_(dim) {}

  void begin(std::size_t f, const Facet &c) {
    f_ = f, functions_ = pressure_functions(c.kind, options_.degree), nodes_ = c.nodes;
    clear(own_);
  }
  void begin_target(std::size_t t, int nodes) { t_ = t, target_nodes_ = nodes, hit_ = false; }

  // A point with weight dS, gap g, normal N from target to contactor, and the shape functions of both sides: summed
  // up to theory (F5), with the same weight on both sides, theory (F7).
  void add(int kind, const double *xi, const double *nc, const double *nt, double weight, double gap,
           const double *normal) {
    double h[MAX_FACET_NODES] = {0};
    pressure_values(kind, options_.degree, xi, nc, h);
    if (std::abs(gap) < options_.rounding)
      gap = 0;
    if (!hit_)
      hit_ = true, clear(other_);
    out_.covered[f_] += weight;
    double wh[MAX_FACET_NODES];
    for (int k = 0; k < functions_; ++k) {
      wh[k] = weight * h[k];
      out_.gap[MAX_FACET_NODES * f_ + k] += wh[k] * gap, out_.weight[MAX_FACET_NODES * f_ + k] += wh[k];
    }
    add_products(functions_, wh, h, functions_, &out_.mass[PRODUCTS * f_]);
    for (int a = 0; a < (options_.vectorial ? dim_ : 1); ++a) {
      double whn[MAX_FACET_NODES];
      for (int k = 0; k < functions_; ++k)
        whn[k] = options_.vectorial ? wh[k] * normal[a] : wh[k];
      add_products(functions_, whn, nc, nodes_, own_[a]);
      add_products(functions_, whn, nt, target_nodes_, other_[a]);
    }
    if (options_.keep_points)
      keep(h, nc, nt, weight, gap, normal);
  }

  void end_target(const std::int32_t *nodes) {
    if (!hit_)
      return;
    emit(lists_.target, other_, nodes, target_nodes_);
  }
  void count_segment() { ++out_.segments[f_]; }
  bool wants_sights() const { return options_.gap_samples; }
  void see(const double *nc, const double *nt, double gap, const double *normal) {
    GapSamples &s = lists_.gap_samples;
    s.gap.push_back(std::abs(gap) < options_.rounding ? 0 : gap);
    s.normal.insert(s.normal.end(), normal, normal + dim_);
    for (int k = 0; k < MAX_FACET_NODES; ++k) {
      s.contactor.push_back(k < nodes_ ? nc[k] : 0);
      s.target.push_back(k < target_nodes_ ? nt[k] : 0);
    }
    s.contactor_facet.push_back(std::int32_t(f_)), s.target_facet.push_back(std::int32_t(t_));
  }
  void end(const std::int32_t *nodes) {
    if (out_.segments[f_] > 0)
      emit(lists_.contactor, own_, nodes, nodes_);
  }

private:
  static constexpr int PRODUCTS = MAX_FACET_NODES * MAX_FACET_NODES;
  using Block = double[3][PRODUCTS]; // by direction: pressure function times node
  static void clear(Block &block) { std::fill(&block[0][0], &block[0][0] + 3 * PRODUCTS, 0.0); }

  template <int N> static void add_rows(int rows, const double *a, const double *b, double *block) {
    for (int k = 0; k < rows; ++k)
      for (int j = 0; j < N; ++j)
        block[MAX_FACET_NODES * k + j] += a[k] * b[j];
  }
  // Adds a_k b_j; the numbers of nodes of facets are known to the compiler, which makes it twice as fast.
  static void add_products(int rows, const double *a, const double *b, int columns, double *block) {
    switch (columns) {
    case 1:
      return add_rows<1>(rows, a, b, block);
    case 2:
      return add_rows<2>(rows, a, b, block);
    case 3:
      return add_rows<3>(rows, a, b, block);
    case 4:
      return add_rows<4>(rows, a, b, block);
    case 6:
      return add_rows<6>(rows, a, b, block);
    case 8:
      return add_rows<8>(rows, a, b, block);
    default:
      return add_rows<9>(rows, a, b, block);
    }
  }

  void emit(Entries &entries, const Block &block, const std::int32_t *nodes, int count) {
    const int width = options_.vectorial ? dim_ : 1;
    for (int k = 0; k < functions_; ++k)
      for (int j = 0; j < count; ++j) {
        entries.row.push_back(std::int32_t(MAX_FACET_NODES * f_ + k));
        entries.column.push_back(nodes[j]);
        for (int a = 0; a < width; ++a)
          entries.value.push_back(block[a][MAX_FACET_NODES * k + j]);
      }
  }

  void keep(const double *h, const double *nc, const double *nt, double weight, double gap, const double *normal) {
    IntegrationPoints &p = lists_.points;
    p.weight.push_back(weight), p.gap.push_back(gap);
    p.normal.insert(p.normal.end(), normal, normal + dim_);
    for (int k = 0; k < MAX_FACET_NODES; ++k) {
      p.pressure.push_back(k < functions_ ? h[k] : 0);
      p.contactor.push_back(k < nodes_ ? nc[k] : 0);
      p.target.push_back(k < target_nodes_ ? nt[k] : 0);
    }
    p.contactor_facet.push_back(std::int32_t(f_)), p.target_facet.push_back(std::int32_t(t_));
  }

  Coupling &out_;
  Lists &lists_;
  const Options &options_;
  int dim_;
  std::size_t f_ = 0, t_ = 0;
  int functions_ = 0, nodes_ = 0, target_nodes_ = 0;
  bool hit_ = false;
  Block own_, other_;
};

template <class T> void append(std::vector<T> &to, std::vector<T> &from) {
  if (to.empty())
    to.swap(from);
  else
    to.insert(to.end(), from.begin(), from.end());
}
inline void append(Entries &to, Entries &from) {
  append(to.row, from.row), append(to.column, from.column), append(to.value, from.value);
}
inline void append(IntegrationPoints &to, IntegrationPoints &from) {
  append(to.weight, from.weight), append(to.gap, from.gap), append(to.normal, from.normal);
  append(to.pressure, from.pressure), append(to.contactor, from.contactor), append(to.target, from.target);
  append(to.contactor_facet, from.contactor_facet), append(to.target_facet, from.target_facet);
}
inline void append(GapSamples &to, GapSamples &from) {
  append(to.gap, from.gap), append(to.normal, from.normal);
  append(to.contactor, from.contactor), append(to.target, from.target);
  append(to.contactor_facet, from.contactor_facet), append(to.target_facet, from.target_facet);
}

} // namespace abut
