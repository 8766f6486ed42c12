// Cutting a contactor by the facets of a target, and integrating over the segments.
#pragma once
#include "clip.hpp"
#include "project.hpp"
#include <vector>

namespace abut {

// Of each facet: number of its body, rank, and of the undeformed body its middle, normal, depth and thickness.
constexpr std::size_t KIN = 10;

// How far away what a facet sees may lie, outside of the body and behind.
struct Reach {
  double out, in;
  bool has(double gap) const { return gap <= out && gap >= -in; }
};

struct SurfaceView {
  int dim;
  const double *points;
  std::size_t facets;
  const std::uint8_t *kinds;
  const std::int32_t *nodes;       // facets x MAX_FACET_NODES
  const double *normals = nullptr; // facets x MAX_FACET_NODES x dim, contactor only
  const double *kin = nullptr;     // facets x KIN, of surfaces that may touch themselves
  const double *bulge = nullptr;   // facets x MAX_FACET_NODES: how far the smooth surface lies outside of each facet
  Facet facet(std::size_t f) const;
  const std::int32_t *facet_nodes(std::size_t f) const { return nodes + MAX_FACET_NODES * f; }
};

// A surface and, for each of its facets, integration points per direction and how often it is divided.
struct Planned {
  SurfaceView surface;
  const std::int32_t *points, *subdivisions;
};

// Rules with 1..n points: row n-1 of each table holds the rule with n points.
struct RuleTable {
  std::size_t count, width;
  const double *t, *wt, *r, *wr;
  Rule rule(int n) const {
    const std::size_t row = (std::size_t(n) < 1 ? 0 : std::size_t(n) > count ? count - 1 : n - 1);
    return {int(row) + 1, t + row * width, wt + row * width, r + row * width, wr + row * width};
  }
};

// A facet flattened into a plane: one convex polygon, or several where edges are curved or the facet is not convex.
struct Piece {
  // A point of the facet: its reference coordinates, and which node it is (-1: none).
  struct Place {
    double xi[2];
    int node;
  };
  int size, facet;
  Point2 p[4];
  std::array<Curve, 4> curve;
  Place corner[4], middle[4]; // middles of edges where they `bend`: on facets of second order, along their own lines
  Point2 bulge[4];            // of edges that bend, also along straight ones whose middle is not half-way
  bool bend[4];
};

// What is asked of the integration.
struct Options {
  int degree;         // of the pressure functions: 0, 1 (corners), 2 (the facet's own)
  bool vectorial;     // couple along the normal (dim values an entry) or componentwise (1 value an entry)
  bool keep_points;   // also return every integration point
  bool gap_samples;   // also return where each segment's corners and middle see the target
  bool axisymmetric;  // coordinates are (r, z): integrals run round the axis
  double reach;       // largest distance between the surfaces, either sign
  double largest_gap; // the same outside of the body; no more than reach
  double rounding;    // gaps below this are rounding errors of the coordinates: none
  bool hidden;        // count also what lies behind something nearer: theory (S12)
};

// Entries are (row, column, values): row MAX_FACET_NODES f + k for pressure function k of contactor facet f, column a
// point number.
struct Entries {
  std::vector<std::int32_t> row, column;
  std::vector<double> value;
};

struct IntegrationPoints {
  std::vector<double> weight, gap, normal, pressure, contactor,
      target; // n, n, n dim, MAX_FACET_NODES n, MAX_FACET_NODES n twice
  std::vector<std::int32_t> contactor_facet, target_facet;
};

// Points of the contactor and what they see: gap, normal from target to contactor, shape functions of both sides.
struct GapSamples {
  std::vector<double> gap, normal, contactor, target; // n, n dim, MAX_FACET_NODES n twice
  std::vector<std::int32_t> contactor_facet, target_facet;
};

struct Lists {
  Entries contactor, target;
  IntegrationPoints points;
  GapSamples gap_samples;
};

struct Coupling {
  Lists lists;
  std::vector<double> gap, weight, mass, covered; // MAX_FACET_NODES f, the same, MAX_FACET_NODES^2 f, f
  std::vector<std::int32_t> segments;             // f: how many
};

// `exact_rules` give the moments that are to be met. Points per direction so that int N_i N_j over every facet alone is
// met to the facet's `tolerance`; and the number of subdivisions per direction that the curvature of the facet's
// edges asks for.
void plan(const SurfaceView &surface, const RuleTable &rules, const RuleTable &exact_rules, const double *tolerance,
          bool axisymmetric, std::vector<std::int32_t> &points, std::vector<std::int32_t> &subdivisions);

Coupling couple(const Planned &contactor, const Planned &target, const RuleTable &rules, const Options &options);

} // namespace abut
