// How the edges and corners of pieces move in a contactor facet's mean plane; see docs/theory/coupling-tangent.md.
#pragma once
#include "arena.hpp"
#include "cutting.hpp"
#include "moving_plane.hpp"
#include <deque>
#include <unordered_map>

namespace abut {

// An edge of a piece or a straight cut, with rows of its ends and of its bulge; without rows: what does not move.
struct MovingEdge {
  int side = STRAIGHT, edge = 0;
  Curve curve{};
  Rows2 a, b, bulge;

  // Parameter of the curve's point nearest to p; any on an edge without length.
  double parameter(Point2 p) const {
    const Point2 way = curve.b - curve.a;
    return dot2(way, way) > 0 ? curve.parameter(p) : 0;
  }
  // Adds `factor` times the change of the point at t.
  void add(std::size_t n, double t, double factor, const Rows2 &row) const {
    if (!a)
      return;
    add_row(n, factor * (1 - t), a.x, row.x), add_row(n, factor * (1 - t), a.y, row.y);
    add_row(n, factor * t, b.x, row.x), add_row(n, factor * t, b.y, row.y);
    if (bulge)
      add_row(n, factor * t * (1 - t), bulge.x, row.x), add_row(n, factor * t * (1 - t), bulge.y, row.y);
  }
  // The same along a direction: one row.
  void add_along(std::size_t n, double t, Point2 way, double factor, double *row) const {
    if (!a)
      return;
    add_row(n, factor * (1 - t) * way.x, a.x, row), add_row(n, factor * (1 - t) * way.y, a.y, row);
    add_row(n, factor * t * way.x, b.x, row), add_row(n, factor * t * way.y, b.y, row);
    if (bulge) {
      add_row(n, factor * t * (1 - t) * way.x, bulge.x, row);
      add_row(n, factor * t * (1 - t) * way.y, bulge.y, row);
    }
  }
  // The chord by itself.
  MovingEdge chord() const {
    MovingEdge out = *this;
    out.bulge = {}, out.curve.bulge = {0, 0}, out.curve.straight = true;
    return out;
  }
};

// Rows of the corners and edges that are asked for, each found once.
class MovingEdges {
public:
  // For another contactor facet.
  void begin(const Over &over, const MovingPlane &plane, const std::vector<Facet> &targets, const std::int32_t *nodes) {
    over_ = &over, plane_ = &plane, targets_ = &targets, nodes_ = nodes;
    carried_.clear(), images_.clear(), arena_.clear();
  }
  // For another target facet, with other columns.
  void begin_target(const Columns &columns) {
    columns_ = &columns;
    corners_.clear(), edges_.clear(), rows_.clear();
  }
  std::size_t size() const { return columns_->size; }
  Rows2 take() { return {rows_.take(columns_->size), rows_.take(columns_->size)}; }

  int corners(int side) const { return over_->piece(side).size; }
  Rows2 corner(int side, int k) { return place(side, k, over_->piece(side).corner[k], false); }

  MovingEdge edge(int side, int k) {
    if (side == STRAIGHT)
      return {};
    const int piece = side < 0 ? along_chord(side) : side;
    for (const MovingEdge &known : edges_)
      if (known.side == piece && known.edge == k)
        return side < 0 ? known.chord() : known;
    edges_.push_back(make(piece, k));
    return side < 0 ? edges_.back().chord() : edges_.back();
  }

  // The curve of a polygon's edge, none for straight cuts; it stays where it is until the next target facet.
  const Curve *curve(const Vertex &v) {
    if (v.side < 0)
      return nullptr;
    edge(v.side, v.edge);
    for (const MovingEdge &known : edges_)
      if (known.side == v.side && known.edge == v.edge)
        return &known.curve;
    return nullptr;
  }

private:
  static constexpr double UNEVEN = 1e-9; // of the chord
  struct Corner {
    int side, number;
    bool middle;
    Rows2 rows;
  };

  MovingEdge make(int side, int k) {
    const Piece &piece = over_->piece(side);
    MovingEdge out{side, k, piece.curve[k], corner(side, k), corner(side, (k + 1) % piece.size), {}};
    if (piece.bend[k] && uneven(piece, k)) // as soon as it bends, it is this curve
      out.curve.bulge = piece.bulge[k], out.curve.straight = false;
    if (piece.bend[k]) { // four times the middle's distance from the chord's: theory (S6)
      const Rows2 middle = place(side, k, piece.middle[k], true);
      out.bulge = take();
      const double *from[3] = {middle.x, out.a.x, out.b.x}, *up[3] = {middle.y, out.a.y, out.b.y};
      const double factor[3] = {4, -2, -2};
      for (int i = 0; i < 3; ++i)
        add_row(size(), factor[i], from[i], out.bulge.x), add_row(size(), factor[i], up[i], out.bulge.y);
    }
    return out;
  }

  // Straight, with its middle not half-way.
  static bool uneven(const Piece &piece, int k) {
    const Curve &curve = piece.curve[k];
    const Point2 chord = curve.b - curve.a, bulge = piece.bulge[k];
    return curve.straight && dot2(bulge, bulge) > UNEVEN * UNEVEN * dot2(chord, chord) && dot2(chord, chord) > 0;
  }

  Rows2 place(int side, int number, const Piece::Place &at, bool middle) {
    for (const Corner &known : corners_)
      if (known.side == side && known.number == number && known.middle == middle)
        return known.rows;
    const Rows2 rows = take();
    if (side < int(over_->c.pieces.size())) {
      plane_->flat(at.xi, rows);
    } else {
      const int t = over_->piece(side).facet;
      const Facet &facet = (*targets_)[t];
      double n[MAX_FACET_NODES] = {0};
      facet.values(at.xi, n);
      const Rows2 image = carry(t, at, side, number, middle);
      const double *from[2] = {image.x, image.y};
      double *to[2] = {rows.x, rows.y};
      const std::size_t own = plane_->size() - 3, first = first_column(t);
      for (int a = 0; a < 2; ++a) {
        std::copy(from[a], from[a] + own, to[a]);
        for (int j = 0; j < facet.nodes; ++j)
          for (int b = 0; b < 3; ++b)
            to[a][first + 3 * j + b] += n[j] * from[a][own + b];
      }
    }
    corners_.push_back({side, number, middle, rows});
    return rows;
  }

  std::size_t first_column(int t) const {
    std::size_t k = 0;
    while (columns_->target[k] != t)
      ++k;
    return columns_->first[k];
  }

  // Nodes are those of several target facets; other points belong to one piece.
  Rows2 carry(int t, const Piece::Place &at, int side, int number, bool middle) {
    const Facet &facet = (*targets_)[t];
    auto find = [&](const double *v) {
      const std::size_t n = plane_->size();
      const Rows2 row{arena_.take(n), arena_.take(n)};
      plane_->carried(v, row);
      return row;
    };
    if (at.node >= 0) {
      Rows2 &known = carried_[nodes_[MAX_FACET_NODES * std::size_t(t) + at.node]];
      return known ? known : known = find(facet.x[at.node]);
    }
    Rows2 &known = images_[8 * side + 2 * number + middle];
    double v[3];
    facet.position.at(at.xi, v);
    return known ? known : known = find(v);
  }

  const Over *over_ = nullptr;
  const MovingPlane *plane_ = nullptr;
  const std::vector<Facet> *targets_ = nullptr;
  const std::int32_t *nodes_ = nullptr;
  const Columns *columns_ = nullptr;
  std::unordered_map<int, Rows2> carried_, images_; // by point; by piece and place
  std::vector<Corner> corners_;
  std::deque<MovingEdge> edges_; // they stay where they are
  Arena arena_, rows_;
};

} // namespace abut
