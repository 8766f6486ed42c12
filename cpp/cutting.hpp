// Cutting contactor facets by what they see of a target; see docs/theory/segments.md for the construction.
#pragma once
#include "contactor.hpp"
#include "hidden.hpp"
#include "horizon.hpp"
#include "kin.hpp"
#include "lines.hpp"
#include "tree.hpp"
#include "walls.hpp"

namespace abut {

constexpr std::size_t FEW_FACETS = 500; // not worth a thread

inline Box box_of(const Hull &hull, int dim) {
  Box box;
  for (int i = 0; i < hull.size; ++i)
    box.add(hull.x[i], dim);
  return box;
}

// All that lies within reach of a contactor facet along its normals.
inline Box swept_box(const Facet &c, double reach) {
  const Hull hull(c, c.x), normals(c, c.normals);
  Box box = box_of(hull, c.dim);
  for (int i = 0; i < hull.size; ++i)
    for (int side = -1; side <= 1; side += 2) {
      double far[3];
      for (int a = 0; a < c.dim; ++a)
        far[a] = hull.x[i][a] + side * reach * normals.x[i][a];
      box.add(far, c.dim);
    }
  box.inflate(1e-9 * box.diagonal(c.dim), c.dim);
  return box;
}

// A contactor facet and the target pieces that lie over it, in its mean plane.
struct Over {
  const Contactor3 &c;
  std::vector<Piece> &theirs;

  const Piece &piece(int side) const {
    const int own = int(c.pieces.size());
    return side < own ? c.pieces[side] : theirs[side - own];
  }
  const Curve *curve(const Vertex &v) const { return v.side < 0 ? nullptr : &piece(v.side).curve[v.edge]; }
};

// What it sees of a target facet from a point of the plane.
struct Sight3 {
  const Contactor3 &c;
  Spot<2> own;
  Spot<3> other;
  double x[3], tangent[2][3], n[3], nc[MAX_FACET_NODES], nt[MAX_FACET_NODES];

  Sight3(const Contactor3 &facet, const double *xi, const double *eta) : c(facet) { begin(xi, eta); }
  void begin(const double *xi, const double *eta) { own.begin(xi), other.begin(eta); }
  // Looks from the contactor at p along its normal; returns the gap between the smooth surfaces, or
  // infinity where nothing is seen: theory (S2), (S14).
  double look(const Facet &t, Point2 p) {
    if (!c.locate(p, own))
      return HUGE_VAL;
    c.facet.position.at(own.xi, x, tangent);
    if (c.flat)
      std::copy(c.plane.n, c.plane.n + 3, n);
    else
      c.facet.normal(own.xi, n);
    if (!project(t, x, n, other))
      return HUGE_VAL;
    return (other.x[0] - x[0]) * n[0] + (other.x[1] - x[1]) * n[1] + (other.x[2] - x[2]) * n[2] -
           c.facet.bulge_at(own.xi) - t.bulge_at(other.xi);
  }
  void find_shapes(const Facet &t) { c.facet.values(own.xi, nc), t.values(other.xi, nt); }
};

// Twice its area.
inline double scale_of(const Piece &piece) {
  double scale = 0;
  for (int i = 0; i < piece.size; ++i)
    scale += std::abs(cross2(piece.p[i] - piece.p[0], piece.p[(i + 1) % piece.size] - piece.p[0]));
  return scale;
}

// Where a fan of triangles begins. Clipping begins where rounding lets it, on an edge that two facets share, and the
// diagonals, and with them the points of integration, must not jump: the vertex farthest back in a direction that turns
// with the contactor's piece, and along which no edges of grids lie.
inline Point2 first_direction(const Piece &piece) {
  const Point2 along = piece.p[1] - piece.p[0];
  return {0.85 * along.x - 0.53 * along.y, 0.85 * along.y + 0.53 * along.x};
}

// Moves vertices where two curves cross on to both, and begins a part of the contactor's piece `mine` where fans begin;
// false for a polygon without area.
inline bool finish(const Over &over, Polygon &polygon, const Piece &mine) {
  if (polygon.size < 3)
    return false;
  Point2 corner[MAX_CLIP];
  for (int i = 0; i < polygon.size; ++i) {
    Vertex &v = polygon.v[i];
    const Vertex &before = polygon.v[(i + polygon.size - 1) % polygon.size];
    const Curve *in = over.curve(before), *out = over.curve(v);
    if (in && out && before.side != v.side && !(in->straight && out->straight))
      polish(*in, *out, v.p);
    corner[i] = v.p;
  }
  const Point2 ahead = first_direction(mine);
  const auto back = [&](const Vertex &a, const Vertex &b) { return dot2(a.p, ahead) < dot2(b.p, ahead); };
  const auto begin = polygon.v.begin(), end = begin + polygon.size;
  std::rotate(begin, std::min_element(begin, end, back), end);
  return !(std::abs(signed_area(corner, polygon.size)) < 1e-15 * scale_of(mine));
}

inline void cut_pieces(const Over &over, const Facet &t, Segment own, Reach reach, std::vector<Segment> &out) {
  const Piece &mine = over.piece(own.mine), &theirs = over.piece(own.theirs);
  Polygon subject;
  for (int i = 0; i < mine.size; ++i)
    subject.push({mine.p[i], own.mine, i});
  own.polygon = clip_convex(subject, theirs.p, theirs.size, own.theirs);
  own.finished = own.polygon;
  if (!finish(over, own.finished, mine))
    return;
  over.c.facet.centre(own.xi), t.centre(own.eta);
  Sight3 at(over.c, own.xi, own.eta);
  own.gap = at.look(t, own.finished.middle());
  if (!reach.has(own.gap) || !(over.c.flat || before_focus(over.c.facet, at.own.xi, own.gap)))
    return;
  double y[3], tangent[2][3], facing[3];
  t.position.at(at.other.xi, y, tangent);
  cross(tangent[0], tangent[1], facing);
  if (dot(facing, at.n, 3) >= -EDGE_ON * std::sqrt(dot(facing, facing, 3)))
    return;
  std::copy(at.own.xi, at.own.xi + 2, own.xi), std::copy(at.other.xi, at.other.xi + 2, own.eta);
  std::copy(at.x, at.x + 3, own.x), std::copy(at.n, at.n + 3, own.n);
  out.push_back(own);
}

inline void find_hidden(const Over &over, const std::vector<Facet> &targets, const std::int32_t *nodes,
                        std::vector<Segment> &segments) {
  find_hidden<Point2>(
      segments, nodes,
      [&](const Segment &a, const Segment &b, Point2 &middle) {
        if (a.mine != b.mine)
          return false;
        Box boxes[2];
        const Segment *both[2] = {&a, &b};
        for (int k = 0; k < 2; ++k)
          for (int i = 0; i < both[k]->polygon.size; ++i)
            boxes[k].add(&both[k]->polygon.v[i].p.x, 2);
        if (!boxes[0].meets(boxes[1], 2))
          return false;
        const Piece &other = over.piece(b.theirs);
        const Polygon common = clip_convex(a.polygon, other.p, other.size, b.theirs);
        Point2 corner[MAX_CLIP];
        for (int i = 0; i < common.size; ++i)
          corner[i] = common.v[i].p;
        middle = common.middle();
        return common.size > 2 && signed_area(corner, common.size) > TOUCHING * scale_of(over.piece(a.mine));
      },
      [&](const Segment &own, Point2 middle) {
        Sight3 at(over.c, own.xi, own.eta);
        return at.look(targets[own.target], middle);
      });
}

// Calls visit(polygon) for what of a segment is not hidden by others.
template <class Visit>
void each_part(const Over &over, const Segment &own, const std::vector<Segment> &segments, Visit visit) {
  if (own.behind.empty()) {
    visit(own.finished);
    return;
  }
  const Piece &mine = over.piece(own.mine);
  const double least = TOUCHING * scale_of(mine);
  std::vector<Polygon> left{own.polygon}, next;
  for (int nearer : own.behind) {
    next.clear();
    for (const Polygon &part : left)
      outside_of(part, over.piece(segments[nearer].theirs), segments[nearer].theirs, least, next);
    left.swap(next);
  }
  for (Polygon &part : left)
    if (finish(over, part, mine))
      visit(part);
}

// What is asked of a target facet: its number, its points' numbers, how often it is divided.
struct Asked {
  int number;
  const std::int32_t *points;
  int subdivide;
};

inline void cut_facet(const Over &over, const Facet &t, const Asked &asked, Reach reach, Carried &carried,
                      std::vector<Segment> &out) {
  const Contactor3 &c = over.c;
  const std::size_t before = over.theirs.size();
  flatten(
      {t, asked.subdivide, true, asked.number},
      [&](const double *eta, int node) {
        if (node >= 0 && c.flat)
          return c.plane.flat(t.x[node]);
        if (node >= 0)
          return carried.find(asked.points[node], [&] { return c.carry(t.x[node]); });
        double y[3];
        t.position.at(eta, y);
        return c.carry(y);
      },
      over.theirs);
  const int own = int(c.pieces.size());
  for (int mine = 0; mine < own; ++mine)
    for (std::size_t theirs = before; theirs < over.theirs.size(); ++theirs) {
      Box a, b;
      for (int i = 0; i < c.pieces[mine].size; ++i)
        a.add(&c.pieces[mine].p[i].x, 2);
      for (int i = 0; i < over.theirs[theirs].size; ++i)
        b.add(&over.theirs[theirs].p[i].x, 2);
      if (!a.meets(b, 2))
        continue;
      Segment segment;
      segment.target = asked.number, segment.mine = mine, segment.theirs = own + int(theirs);
      cut_pieces(over, t, segment, reach, out);
    }
}

// What all threads share: both surfaces, the target's facets, their hulls and the tree of their boxes.
struct Interface {
  const Planned &contactor, &target;
  const RuleTable &rules;
  const Options &options;
  std::vector<Facet> targets;
  std::vector<Hull> hulls;
  Neighbours neighbours;
  Tree tree;
};

inline Interface interface(const Planned &contactor, const Planned &target, const RuleTable &rules,
                           const Options &options) {
  const SurfaceView &surface = target.surface;
  std::vector<Facet> targets(surface.facets);
  std::vector<Hull> hulls(surface.facets);
  std::vector<Box> boxes(surface.facets);
  for (std::size_t t = 0; t < surface.facets; ++t) {
    targets[t] = surface.facet(t);
    hulls[t] = Hull(targets[t], targets[t].x), boxes[t] = box_of(hulls[t], surface.dim);
  }
  std::vector<std::array<double, 3>> normals(surface.facets);
  for (std::size_t t = 0; t < surface.facets; ++t)
    middle_normal(targets[t], normals[t].data());
  Tree tree(std::move(boxes), surface.dim);
  return {contactor,
          target,
          rules,
          options,
          std::move(targets),
          std::move(hulls),
          Neighbours(surface, std::move(normals)),
          std::move(tree)};
}

// Cuts contactor facets, one after another; one for each thread.
class Cutter {
public:
  explicit Cutter(const Interface &both) : both_(both) {}

  // Hands what a contactor facet sees to line(c, segments) in 2D, to face(over, segments) in 3D; segments of one target
  // facet follow each other.
  template <class Line, class Face> void cut(std::size_t f, Line line, Face face) {
    const Facet c = both_.contactor.surface.facet(f);
    find(f, c);
    if (found_.empty())
      return;
    segments_.clear(), pieces_.clear();
    if (c.dim == 2) {
      cut_all(f, c);
      line(c, segments_);
      return;
    }
    const Contactor3 own(c, both_.contactor.subdivisions[f]);
    const Over over{own, pieces_};
    cut_all(f, over);
    face(over, segments_);
  }

private:
  // The target facets that the contactor facet may see within reach.
  void find(std::size_t f, const Facet &c) {
    const double reach = both_.options.reach;
    const Horizon horizon(c, reach);
    both_.tree.query(swept_box(c, reach), found_, [&](const Box &box) { return horizon.may_see(box); });
    std::erase_if(found_, [&](int t) {
      return !horizon.may_see(both_.hulls[t]) ||
             !may_touch(both_.contactor.surface, f, both_.target.surface, std::size_t(t));
    });
  }

  Reach reach(std::size_t f, int t) const {
    const double far = both_.options.reach;
    return {both_.options.largest_gap,
            std::min(far, deepest(both_.contactor.surface, f, both_.target.surface, std::size_t(t)))};
  }

  // Says what each segment is for: walls hide what is behind them. add(own, plane) gives the plane that touches a
  // segment its corners.
  template <class Add> void cast(std::size_t f, const Facet &c, Add add) {
    double deep = 0;
    for (Segment &own : segments_) {
      own.role = role_of(both_.contactor.surface, f, both_.target.surface, std::size_t(own.target));
      if (own.role == Role::counts && both_.neighbours.wall(own.target, own.x, own.n, own.gap))
        own.role = Role::hides;
      if (own.role == Role::counts)
        deep = std::max(deep, -own.gap);
    }
    if (!both_.contactor.surface.kin || deep <= 0 || !find_sides(f, c, deep))
      return;
    for (Segment &own : segments_)
      if (own.role == Role::counts && own.gap < 0 && seen_through(own, add))
        own.role = Role::hides;
  }

  // The target's facets that are nearer than `deep` to the contactor facet.
  bool find_sides(std::size_t f, const Facet &c, double deep) {
    Box around = box_of(Hull(c, c.x), c.dim);
    around.inflate(deep, c.dim);
    both_.tree.query(around, sides_, [](const Box &) { return true; });
    std::erase_if(sides_,
                  [&](int t) { return !may_touch(both_.contactor.surface, f, both_.target.surface, std::size_t(t)); });
    return !sides_.empty();
  }

  // Whether a segment sees its target through the target's body: theory (S18), (S19).
  template <class Add> bool seen_through(const Segment &own, Add add) const {
    Touching plane(both_.target.surface.dim, own.x, own.n);
    add(own, plane);
    return std::any_of(sides_.begin(), sides_.end(), [&](int t) {
      return same_body(both_.target.surface, std::size_t(t), std::size_t(own.target)) &&
             plane.shows_through(both_.targets[t], both_.neighbours.normal(t), -own.gap);
    });
  }

  void cut_all(std::size_t f, const Facet &c) {
    for (int t : found_)
      cut_line(c, both_.targets[t], t, reach(f, t), segments_);
    cast(f, c, [&](const Segment &own, Touching &plane) {
      for (const double xi : {own.begin, own.end}) {
        const double at[2] = {xi, 0};
        double x[3];
        c.position.at(at, x), plane.add(x);
      }
    });
    if (!both_.options.hidden)
      find_hidden(c, both_.targets, both_.target.surface.nodes, segments_);
  }

  void cut_all(std::size_t f, const Over &over) {
    const Planned &target = both_.target;
    carried_.begin();
    for (int t : found_)
      cut_facet(over, both_.targets[t], {t, target.surface.facet_nodes(t), target.subdivisions[t]}, reach(f, t),
                carried_, segments_);
    cast(f, over.c.facet, [&](const Segment &own, Touching &plane) {
      for (int i = 0; i < own.finished.size; ++i) {
        double x[3];
        over.c.plane.lift(own.finished.v[i].p, x), plane.add(x);
      }
    });
    if (!both_.options.hidden)
      find_hidden(over, both_.targets, target.surface.nodes, segments_);
  }

  const Interface &both_;
  std::vector<int> found_, sides_;
  std::vector<Piece> pieces_;
  std::vector<Segment> segments_;
  Carried carried_;
};

// Calls begin(t), then integrate(segment) for each of its segments, then end(t), for one target facet that counts after
// another.
template <class Begin, class Integrate, class End>
void by_target(const std::vector<Segment> &segments, Begin begin, Integrate integrate, End end) {
  for (std::size_t i = 0; i < segments.size();) {
    const int t = segments[i].target;
    if (segments[i].role != Role::counts) {
      ++i;
      continue;
    }
    begin(t);
    for (; i < segments.size() && segments[i].target == t; ++i)
      integrate(segments[i]);
    end(t);
  }
}

// The rule for what a contactor facet sees of a target facet: theory (Q5).
inline Rule rule_of(const Interface &both, std::size_t f, int t) {
  return both.rules.rule(std::max(both.contactor.points[f], both.target.points[t]));
}

} // namespace abut
