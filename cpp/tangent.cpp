// The loop over contactor facets for derivatives; see docs/theory/coupling-tangent.md.
#include "tangent.hpp"
#include "moving_lines.hpp"
#include "moving_pieces.hpp"
#include "parallel.hpp"

namespace abut {

static void append(Blocks &to, Blocks &from) {
  append(to.row, from.row), append(to.column, from.column), append(to.value, from.value);
}
void append(Derivative &to, Derivative &from) {
  append(to.by_points, from.by_points), append(to.by_normals, from.by_normals);
}

namespace {

constexpr std::size_t FEW_MOVING_FACETS = 50; // not worth a thread

// Differentiates what contactor facets see, one after another; one for each thread.
class Differentiator {
public:
  Differentiator(const Interface &both, const Moments &moments, TangentLists &lists, const Load &load,
                 const Numbering &numbering)
      : both_(both), cutter_(both), lines_(moments, lists, both, load, numbering),
        faces_(moments, lists, both, load, numbering), pieces_(faces_) {}

  void run(std::size_t f) {
    cutter_.cut(
        f, [&](const Facet &c, const std::vector<Segment> &segments) { run_line(f, c, segments); },
        [&](const Over &over, const std::vector<Segment> &segments) { run_face(f, over, segments); });
  }

private:
  void run_line(std::size_t f, const Facet &c, const std::vector<Segment> &segments) {
    MovingLine line(c, both_.targets, segments, both_.options.axisymmetric, lines_);
    sum(
        f, c, segments, lines_, [] {},
        [&](const Segment &own, const Rule &rule) { line.integrate(own, rule, columns_); });
  }

  void run_face(std::size_t f, const Over &over, const std::vector<Segment> &segments) {
    const MovingPlane plane(over.c);
    edges_.begin(over, plane, both_.targets, both_.target.surface.nodes);
    sum(
        f, over.c.facet, segments, faces_, [&] { pieces_.begin_target(edges_, columns_); },
        [&](const Segment &own, const Rule &rule) {
          each_part(over, own, segments, [&](const Polygon &part) {
            pieces_.integrate(over, plane, both_.targets[own.target], own, part, rule);
          });
        });
  }

  template <int D, class Begin, class Integrate>
  void sum(std::size_t f, const Facet &c, const std::vector<Segment> &segments, MovingSums<D> &sums, Begin begin,
           Integrate integrate) {
    sums.begin(f, c);
    for (std::size_t i = 0; i < segments.size();) {
      const int t = segments[i].target;
      if (segments[i].role != Role::counts) {
        ++i;
        continue;
      }
      const std::size_t first = i;
      while (i < segments.size() && segments[i].target == t)
        ++i;
      find_columns(c, segments, first, i);
      sums.begin_target(t, both_.targets[t], columns_);
      begin();
      for (std::size_t k = first; k < i; ++k)
        integrate(segments[k], rule_of(both_, f, t));
      sums.end_target();
    }
    sums.end();
  }

  // Segments first .. last - 1 see one target facet; what hides them moves their ends.
  void find_columns(const Facet &c, const std::vector<Segment> &segments, std::size_t first, std::size_t last) {
    columns_.begin(c.dim, c);
    for (std::size_t i = first; i < last; ++i) {
      columns_.of(segments[i].target, both_.targets[segments[i].target].nodes);
      for (int nearer : segments[i].behind)
        columns_.of(segments[nearer].target, both_.targets[segments[nearer].target].nodes);
    }
  }

  const Interface &both_;
  Cutter cutter_;
  MovingSums<2> lines_;
  MovingSums<3> faces_;
  MovingPieces pieces_;
  MovingEdges edges_;
  Columns columns_;
};

} // namespace

TangentLists tangent(const Planned &contactor, const Planned &target, const RuleTable &rules, const Options &options,
                     const Load &load, const Numbering &numbering) {
  const std::size_t facets = contactor.surface.facets;
  const Interface both = interface(contactor, target, rules, options);
  const std::size_t parts = facets < FEW_MOVING_FACETS ? 1 : thread_count();
  std::vector<TangentLists> lists(parts);
  TangentLists out;
  out.gap.assign(MAX_FACET_NODES * facets, 0), out.weight.assign(MAX_FACET_NODES * facets, 0);
  run_parts(parts, [&](std::size_t part) {
    Differentiator differentiator(both, {out.gap.data(), out.weight.data()}, lists[part], load, numbering);
    for (std::size_t f = facets * part / parts; f < facets * (part + 1) / parts; ++f)
      differentiator.run(f);
  });
  for (TangentLists &part : lists) {
    append(out.moment, part.moment), append(out.force, part.force), append(out.operators, part.operators);
    append(out.loaded, part.loaded), append(out.load, part.load);
  }
  return out;
}

CompressedBlocks compress(const Blocks &blocks, std::size_t rows, std::size_t width) {
  const std::size_t n = blocks.row.size();
  CompressedBlocks out;
  std::vector<std::int64_t> begin(rows + 1, 0);
  for (std::int32_t row : blocks.row)
    ++begin[row + 1];
  for (std::size_t r = 0; r < rows; ++r)
    begin[r + 1] += begin[r];
  std::vector<std::int64_t> order(n), fill(begin.begin(), begin.end() - 1);
  for (std::size_t i = 0; i < n; ++i)
    order[fill[blocks.row[i]]++] = std::int64_t(i);
  out.start.assign(1, 0);
  for (std::size_t r = 0; r < rows; ++r) {
    std::stable_sort(order.begin() + begin[r], order.begin() + begin[r + 1],
                     [&](std::int64_t i, std::int64_t j) { return blocks.column[i] < blocks.column[j]; });
    for (std::int64_t k = begin[r]; k < begin[r + 1]; ++k) {
      const double *value = &blocks.value[width * order[k]];
      if (k == begin[r] || blocks.column[order[k]] != out.column.back()) {
        out.column.push_back(blocks.column[order[k]]);
        out.value.insert(out.value.end(), value, value + width);
        continue;
      }
      double *sum = &out.value[out.value.size() - width];
      for (std::size_t a = 0; a < width; ++a)
        sum[a] += value[a];
    }
    out.start.push_back(std::int32_t(out.column.size()));
  }
  return out;
}

} // namespace abut
