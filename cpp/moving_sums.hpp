// What the integration points of one contactor facet add to the derivatives; see docs/theory/coupling-tangent.md.
#pragma once
#include "accumulator.hpp"
#include "cutting.hpp"
#include "dual.hpp"
#include "lever.hpp"
#include "tangent.hpp"

namespace abut {

// Where int H_k g and int H_k of all facets are added up; facets of one thread are no others'.
struct Moments {
  double *gap, *weight;
};

// Derivatives of a contactor facet's rows with one target facet after another.
template <int D> class MovingSums {
public:
  MovingSums(const Moments &moments, TangentLists &lists, const Interface &both, const Load &load,
             const Numbering &numbering)
      : moments_(moments), lists_(lists), contactor_(both.contactor.surface), target_(both.target.surface),
        degree_(both.options.degree), rounding_(both.options.rounding), load_(load), numbering_(numbering),
        width_(operator_width(D, load.rubs)), rubs_(load.rubs) {}

  void begin(std::size_t f, const Facet &c) {
    f_ = f, c_ = &c, functions_ = pressure_functions(c.kind, degree_), hit_ = false;
    own_columns_ = 2 * D * c.nodes;
    own_.assign(rows(0) * own_columns_, 0);
    own_operator_.assign(functions_ * c.nodes * width_, 0);
    for (double &value : own_load_)
      value = 0;
    lever_.begin(c);
    loaded_ = load_.acts_on(f, D), couples_ = load_.rubs_on(f, D) ? Lever<D>::FORCES : 0;
  }
  // `columns` are those that the rows of all its points have.
  void begin_target(int t, const Facet &facet, const Columns &columns) {
    t_ = t, facet_ = &facet, columns_ = &columns;
    block_.assign(rows(facet.nodes) * columns.size, 0), couple_.assign(couples_ * columns.size, 0);
    other_operator_.assign(functions_ * facet.nodes * width_, 0);
    std::fill(other_load_, other_load_ + MAX_FACET_NODES * D, 0.0);
    for (int q = 0; q < ROWS + couples_; ++q)
      row_[q].resize(columns.size);
  }

  void add(const MovingPoint &at) {
    look(at);
    find_rows(at);
    if (loaded_)
      add_forces(at);
    add_couples();
    add_moments(at);
    add_values(at);
    hit_ = true;
  }

  void end_target() {
    const std::size_t size = columns_->size, mine = D * c_->nodes, theirs = D * facet_->nodes;
    if (couples_)
      lever_.spread(size, couple_.data(), block_.data());
    for (std::size_t r = 0; r < rows(0); ++r) {
      const double *from = &block_[r * size];
      add_row(own_columns_, 1, from, &own_[r * own_columns_]);
    }
    emit_targets(0, mine, contactor_.facet_nodes(f_), 0);
    emit_moments(&block_[mine * size], size, false);
    const double *other = &block_[rows(0) * size];
    emit_own(other, size, theirs, target_.facet_nodes(t_), numbering_.target_offset);
    emit_targets(rows(0), theirs, target_.facet_nodes(t_), numbering_.target_offset);
    emit_load(other_load_, target_.facet_nodes(t_), facet_->nodes, numbering_.target_offset);
    emit_operator(other_operator_, target_.facet_nodes(t_), facet_->nodes, numbering_.target_offset);
  }

  void end() {
    if (!hit_)
      return;
    emit_own(own_.data(), own_columns_, D * c_->nodes, contactor_.facet_nodes(f_), 0);
    emit_moments(&own_[D * c_->nodes * own_columns_], own_columns_, true);
    emit_load(own_load_, contactor_.facet_nodes(f_), c_->nodes, 0);
    emit_operator(own_operator_, contactor_.facet_nodes(f_), c_->nodes, 0);
  }

private:
  // Seeds at a point: reference coordinates, area, and what nodes add to x, to the normal and to y.
  static constexpr int XI = 0, WEIGHT = D - 1, X = D, M = 2 * D, Y = 3 * D, SEEDS = 4 * D;
  using Number = Dual<SEEDS>;
  enum { FORCE = 0, ETA = D, GAP = 2 * D - 1, ROWS = 2 * D, COUPLE = ROWS };

  // Force, reference coordinates on the target, gap and the couple's forces as functions of the seeds.
  void look(const MovingPoint &at) {
    double x[3], m[3], y[3], slope[2][3], turn[2][3], h[MAX_FACET_NODES], dh[MAX_FACET_NODES][3];
    c_->position.at(at.xi, x, slope), c_->direction.at(at.xi, m, turn);
    facet_->position.at(at.eta, y, other_slope_);
    shape(c_->kind, at.xi, nc_, dnc_), shape(facet_->kind, at.eta, nt_, dnt_);
    find_pressures(at.xi, h, dh);
    Number place[D], normal[D], length;
    for (int a = 0; a < D; ++a) {
      place[a] = Number::seed(x[a], X + a), normal[a] = Number::seed(m[a], M + a);
      for (int b = 0; b < D - 1; ++b)
        place[a].d[XI + b] = slope[b][a], normal[a].d[XI + b] = turn[b][a];
      length += normal[a] * normal[a];
    }
    length = Number(-1) / sqrt(length);
    for (Number &value : normal) // from target to contactor: theory (F1)
      value = value * length;
    for (int a = 0; a < D; ++a)
      normal_[a] = normal[a].v;
    if (rubs_)
      lever_.aim(normal_);
    see(place, normal, y);
    apart_ = value_[GAP].v;
    find_force(at, normal, h, dh);
    bulge(at);
  }

  void find_pressures(const double *xi, double *h, double (*dh)[3]) {
    if (degree_ == 0)
      h[0] = 1, dh[0][0] = dh[0][1] = 0;
    else
      shape(degree_ == 2 ? c_->kind : int(LINEAR[c_->kind]), xi, h, dh);
    std::copy(h, h + functions_, h_);
    for (int k = 0; k < functions_; ++k)
      for (int b = 0; b < D - 1; ++b)
        dh_[k][b] = dh[k][b];
  }

  // x - y(eta) = g N, differentiated: theory (T3).
  void see(const Number *place, const Number *normal, const double *y) {
    double g = 0;
    for (int a = 0; a < D; ++a)
      g += (place[a].v - y[a]) * normal[a].v;
    Number rest[D];
    for (int a = 0; a < D; ++a) {
      rest[a] = place[a] - g * normal[a];
      rest[a].d[Y + a] -= 1;
    }
    double inverse[D][D];
    invert(normal, inverse);
    value_[GAP] = Number(g);
    for (int b = 0; b < D - 1; ++b)
      value_[ETA + b] = Number(0);
    for (int b = 0; b < D; ++b)
      for (int a = 0; a < D; ++a)
        for (int s = 0; s < SEEDS; ++s)
          value_[ETA + b].d[s] += inverse[b][a] * rest[a].d[s];
  }

  // Takes the bulges of both facets off the gap; forces act on the facets themselves: theory (T8).
  void bulge(const MovingPoint &at) {
    double n[MAX_FACET_NODES], dn[MAX_FACET_NODES][3];
    auto each = [&](const Facet &facet, const double *xi, auto add) {
      if (!facet.bulge)
        return;
      const int kind = QUADRATIC[facet.kind];
      shape(kind, xi, n, dn);
      for (int i = CORNERS[kind]; i < NODES[kind]; ++i)
        add(facet.bulge[i], i);
    };
    Number &gap = value_[GAP];
    each(*c_, at.xi, [&](double height, int i) {
      gap.v -= height * n[i];
      for (int b = 0; b < D - 1; ++b)
        gap.d[XI + b] -= height * dn[i][b];
    });
    each(*facet_, at.eta, [&](double height, int i) {
      gap.v -= height * n[i];
      for (int b = 0; b < D - 1; ++b)
        for (int s = 0; s < SEEDS; ++s)
          gap.d[s] -= height * dn[i][b] * value_[ETA + b].d[s];
    });
  }

  // Of the matrix whose columns are the target's slopes and the normal.
  void invert(const Number *normal, double (&inverse)[D][D]) const {
    if constexpr (D == 2) {
      const double *s = other_slope_[0], det = s[0] * normal[1].v - s[1] * normal[0].v;
      inverse[0][0] = normal[1].v / det, inverse[0][1] = -normal[0].v / det;
      inverse[1][0] = -s[1] / det, inverse[1][1] = s[0] / det;
    } else {
      const double n[3] = {normal[0].v, normal[1].v, normal[2].v};
      cross(other_slope_[1], n, inverse[0]), cross(n, other_slope_[0], inverse[1]);
      cross(other_slope_[0], other_slope_[1], inverse[2]);
      const double det = dot(other_slope_[0], inverse[0], 3);
      for (auto &row : inverse)
        for (double &value : row)
          value /= det;
    }
  }

  // Area times p N + (I - N N) t.
  void find_force(const MovingPoint &at, const Number *normal, const double *h, const double (*dh)[3]) {
    const Number weight = Number::seed(at.weight, WEIGHT);
    auto coefficient = [&](const double *values, int stride) {
      Number sum;
      for (int k = 0; k < functions_; ++k) {
        sum.v += h[k] * values[stride * k];
        for (int b = 0; b < D - 1; ++b)
          sum.d[XI + b] += dh[k][b] * values[stride * k];
      }
      return sum;
    };
    Number along = coefficient(load_.pressure + MAX_FACET_NODES * f_, 1), t[D];
    if (load_.traction)
      for (int a = 0; a < D; ++a) {
        t[a] = coefficient(load_.traction + MAX_FACET_NODES * D * f_ + a, D);
        along -= t[a] * normal[a];
      }
    if (D == 2 && load_.turned) {
      const Number turned = coefficient(load_.turned + MAX_FACET_NODES * f_, 1);
      t[0] -= turned * normal[1], t[1] += turned * normal[0];
    }
    along = along * weight;
    for (int a = 0; a < D; ++a)
      value_[FORCE + a] = couples_ ? along * normal[a] + weight * t[a] : along * normal[a];
    if (couples_)
      lever_.find(weight * value_[GAP], normal, t, value_ + COUPLE);
  }

  // From seeds to columns.
  void find_rows(const MovingPoint &at) {
    const std::size_t size = columns_->size;
    const int other = first_of_target();
    for (int q = loaded_ ? FORCE : GAP; q < ROWS + couples_; ++q) {
      const double *d = value_[q].d;
      double *row = row_[q].data();
      for (std::size_t s = 0; s < size; ++s)
        row[s] = d[WEIGHT] * at.weight_rate[s];
      for (int b = 0; b < D - 1; ++b)
        add_row(size, d[XI + b], at.rate[b], row);
      for (int i = 0; i < c_->nodes; ++i)
        for (int a = 0; a < D; ++a) {
          row[columns_->point(i) + a] += nc_[i] * d[X + a];
          row[columns_->normal(i) + a] += nc_[i] * d[M + a];
        }
      for (int j = 0; j < facet_->nodes; ++j)
        for (int a = 0; a < D; ++a)
          row[other + D * j + a] += nt_[j] * d[Y + a];
    }
    if (couples_)
      lever_.turn(value_ + COUPLE, *columns_, row_ + COUPLE);
  }

  int first_of_target() const {
    std::size_t k = 0;
    while (columns_->target[k] != t_)
      ++k;
    return columns_->first[k];
  }

  // Shares of the nodes: N_i F on the contactor, -N_j F on the target.
  void add_forces(const MovingPoint &at) {
    const std::size_t size = columns_->size;
    for (int a = 0; a < D; ++a) {
      const double force = value_[FORCE + a].v;
      const double *row = row_[FORCE + a].data();
      for (int i = 0; i < c_->nodes; ++i) {
        own_load_[D * i + a] += nc_[i] * force;
        add_share(size, nc_[i], row, force, dnc_[i], at.rate, &block_[(D * i + a) * size]);
      }
      const double *rate[2] = {row_[ETA].data(), row_[D == 3 ? ETA + 1 : ETA].data()};
      for (int j = 0; j < facet_->nodes; ++j) {
        other_load_[D * j + a] -= nt_[j] * force;
        add_share(size, -nt_[j], row, -force, dnt_[j], rate, &block_[(rows(0) + D * j + a) * size]);
      }
    }
  }

  void add_couples() {
    double load[Lever<D>::FORCES];
    for (int q = 0; q < couples_; ++q) {
      load[q] = value_[COUPLE + q].v;
      add_row(columns_->size, 1, row_[COUPLE + q].data(), &couple_[q * columns_->size]);
    }
    if (couples_)
      lever_.spread(1, load, own_load_);
  }

  static void add_share(std::size_t size, double share, const double *row, double force, const double *slope,
                        const double *const *rate, double *to) {
    const double first = force * slope[0], second = D == 3 ? force * slope[1] : 0;
    const double *xi = rate[0], *eta = rate[1];
    if constexpr (D == 2)
      for (std::size_t s = 0; s < size; ++s)
        to[s] += share * row[s] + first * xi[s];
    else
      for (std::size_t s = 0; s < size; ++s)
        to[s] += share * row[s] + first * xi[s] + second * eta[s];
  }

  // int H_k g and int H_k.
  void add_moments(const MovingPoint &at) {
    const std::size_t size = columns_->size;
    const double g = value_[GAP].v;
    const double *gap = row_[GAP].data(), *xi = at.rate[0], *eta = at.rate[D == 3 ? 1 : 0];
    for (int k = 0; k < functions_; ++k) {
      double *to = &block_[(D * c_->nodes + 2 * k) * size];
      const double first = at.weight * dh_[k][0], second = D == 3 ? at.weight * dh_[k][1] : 0;
      for (std::size_t s = 0; s < size; ++s) {
        const double change = h_[k] * at.weight_rate[s] + first * xi[s] + second * eta[s];
        to[s] += g * change + at.weight * h_[k] * gap[s];
        to[size + s] += change;
      }
    }
  }

  // int H_k g and int H_k; int H_k N_j N and int H_k N_j (I - N N), in 2D along the turned normal, with the target's
  // negative, and the couple's forces.
  void add_values(const MovingPoint &at) {
    const double g = value_[GAP].v, gap = std::abs(g) < rounding_ ? 0 : g;
    double along[D + D * D];
    for (int a = 0; a < D; ++a)
      along[a] = normal_[a];
    if constexpr (D == 2)
      along[D] = -normal_[1], along[D + 1] = normal_[0];
    else
      for (int a = 0; a < D; ++a)
        for (int b = 0; b < D; ++b)
          along[D + D * a + b] = (a == b) - normal_[a] * normal_[b];
    for (int k = 0; k < functions_; ++k) {
      const double area = at.weight * h_[k];
      moments_.gap[MAX_FACET_NODES * f_ + k] += area * gap, moments_.weight[MAX_FACET_NODES * f_ + k] += area;
      for (int i = 0; i < c_->nodes; ++i)
        add_row(width_, area * nc_[i], along, &own_operator_[(k * c_->nodes + i) * width_]);
      if (rubs_)
        lever_.add_operator(area * apart_, normal_, width_, &own_operator_[k * c_->nodes * width_]);
      for (int j = 0; j < facet_->nodes; ++j)
        add_row(width_, -area * nt_[j], along, &other_operator_[(k * facet_->nodes + j) * width_]);
    }
  }

  // Of a block: the contactor's nodes, gap and weight of each pressure function, the target's nodes.
  std::size_t rows(int others) const { return D * (c_->nodes + others) + 2 * functions_; }

  // D rows of a node, or of gap and weight; columns of one point or normal.
  static void push(Blocks &to, std::int32_t row, std::int32_t column, const double *from, std::size_t size, int count) {
    to.row.push_back(row), to.column.push_back(column);
    for (int r = 0; r < count; ++r)
      to.value.insert(to.value.end(), from + r * size, from + r * size + D);
  }

  // By the contactor's points and normals.
  void emit_own(const double *from, std::size_t size, std::size_t count, const std::int32_t *nodes,
                std::int32_t offset) {
    const std::int32_t *points = contactor_.facet_nodes(f_), *normals = numbering_.normals + MAX_FACET_NODES * f_;
    for (std::size_t r = 0; r < count; r += D)
      for (int i = 0; i < c_->nodes; ++i) {
        push(lists_.force.by_points, offset + nodes[r / D], points[i], from + r * size + D * i, size, D);
        push(lists_.force.by_normals, offset + nodes[r / D], normals[i], from + r * size + D * (c_->nodes + i), size,
             D);
      }
  }

  // By the points of all target facets.
  void emit_targets(std::size_t first, std::size_t count, const std::int32_t *nodes, std::int32_t offset) {
    const std::size_t size = columns_->size;
    for (std::size_t k = 0; k < columns_->target.size(); ++k) {
      const std::int32_t *points = target_.facet_nodes(columns_->target[k]);
      const int its = NODES[target_.kinds[columns_->target[k]]];
      for (std::size_t r = 0; r < count; r += D)
        for (int j = 0; j < its; ++j)
          push(lists_.force.by_points, offset + nodes[r / D], numbering_.target_offset + points[j],
               &block_[(first + r) * size + columns_->first[k] + D * j], size, D);
    }
  }

  void emit_moments(const double *from, std::size_t size, bool own) {
    for (int k = 0; k < functions_; ++k) {
      const std::int32_t row = std::int32_t(MAX_FACET_NODES * f_ + k);
      const double *at = from + 2 * k * size;
      if (own) {
        const std::int32_t *points = contactor_.facet_nodes(f_), *normals = numbering_.normals + MAX_FACET_NODES * f_;
        for (int i = 0; i < c_->nodes; ++i) {
          push(lists_.moment.by_points, row, points[i], at + D * i, size, 2);
          push(lists_.moment.by_normals, row, normals[i], at + D * (c_->nodes + i), size, 2);
        }
        continue;
      }
      for (std::size_t n = 0; n < columns_->target.size(); ++n) {
        const std::int32_t *points = target_.facet_nodes(columns_->target[n]);
        for (int j = 0; j < NODES[target_.kinds[columns_->target[n]]]; ++j)
          push(lists_.moment.by_points, row, numbering_.target_offset + points[j], at + columns_->first[n] + D * j,
               size, 2);
      }
    }
  }

  void emit_operator(const std::vector<double> &from, const std::int32_t *nodes, int count, std::int32_t offset) {
    Blocks &to = lists_.operators;
    for (int k = 0; k < functions_; ++k)
      for (int i = 0; i < count; ++i)
        to.row.push_back(std::int32_t(MAX_FACET_NODES * f_ + k)), to.column.push_back(offset + nodes[i]);
    to.value.insert(to.value.end(), from.begin(), from.end());
  }

  void emit_load(const double *from, const std::int32_t *nodes, int count, std::int32_t offset) {
    for (int i = 0; i < count; ++i) {
      lists_.loaded.push_back(offset + nodes[i]);
      lists_.load.insert(lists_.load.end(), from + D * i, from + D * i + D);
    }
  }

  const Moments moments_;
  TangentLists &lists_;
  const SurfaceView &contactor_, &target_;
  const int degree_;
  const double rounding_;
  const Load &load_;
  const Numbering &numbering_;
  const std::size_t width_; // of an entry of the operators
  const bool rubs_;
  int couples_ = 0; // forces that take up the couple of tractions on this facet, or none
  Lever<D> lever_;
  const Facet *c_ = nullptr, *facet_ = nullptr;
  const Columns *columns_ = nullptr;
  std::size_t f_ = 0, own_columns_ = 0;
  int t_ = 0, functions_ = 0;
  bool hit_ = false, loaded_ = false; // whether this facet has a target, and carries anything
  std::vector<double> own_, block_, couple_, row_[ROWS + Lever<D>::FORCES], own_operator_, other_operator_;
  double own_load_[MAX_FACET_NODES * D], other_load_[MAX_FACET_NODES * D];
  Number value_[ROWS + Lever<D>::FORCES];
  double normal_[D], apart_ = 0; // the facets themselves along the normal, without their bulges
  double other_slope_[2][3];
  double nc_[MAX_FACET_NODES], dnc_[MAX_FACET_NODES][3], nt_[MAX_FACET_NODES], dnt_[MAX_FACET_NODES][3];
  double h_[MAX_FACET_NODES], dh_[MAX_FACET_NODES][2];
};

} // namespace abut
