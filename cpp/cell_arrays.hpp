// Cells of one type with an integration rule, as Python hands them over and every law integrates them.
#pragma once
#include "bind.hpp"
#include "integrate.hpp"
#include "parallel.hpp"
#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>
#include <optional>
#include <tuple>

namespace abut {

template <int n> using Output = nb::ndarray<double, nb::numpy, nb::ndim<n>, nb::c_contig, nb::device::cpu>;
using Tangent = std::tuple<Vector<std::int64_t>, Vector<std::int32_t>, Output<1>>; // indptr, indices, values

// What Python is told of a cell without a sound deformation: its number and determinant.
inline std::optional<std::tuple<std::size_t, double>> told(const Unsound &unsound) {
  if (unsound.cell == SIZE_MAX)
    return std::nullopt;
  return std::make_tuple(unsound.cell, unsound.determinant);
}

// Cells of one type with a rule, all that their kinematics need; shares the arrays with Python.
class CellArrays {
public:
  CellArrays(Matrix<double> points, Matrix<std::int32_t> nodes, Matrix<double> shapes, Tensor3<double> derivatives,
             Vector<double> weights, bool axisymmetric, bool mean_dilatation, std::size_t pressures)
      : points(points), nodes(nodes), shapes(shapes), derivatives(derivatives), weights(weights),
        axisymmetric(axisymmetric), mean_dilatation(mean_dilatation), pressures(pressures) {
    const std::size_t q = weights.shape(0), n = nodes.shape(1);
    if (q == 0 || shapes.shape(0) != q || shapes.shape(1) != n || derivatives.shape(0) != q ||
        derivatives.shape(1) != n || derivatives.shape(2) != dim() || (dim() != 2 && (axisymmetric || dim() != 3)) ||
        (pressures > 1 && pressures != dim() + 1) || pressures > q)
      throw nb::value_error("points, cells and rule disagree");
  }

  std::size_t dim() const { return points.shape(1); }
  std::size_t rows() const { return points.shape(0); }
  std::size_t count() const { return nodes.shape(0); }
  std::size_t integration_points() const { return count() * weights.shape(0); }

  Cells view() const {
    return {points.data(),      nodes.data(),   count(),          nodes.shape(1),  shapes.data(),
            derivatives.data(), weights.data(), weights.shape(0), mean_dilatation, pressures};
  }

  State state(const std::optional<Matrix<double>> &displacement, const std::optional<Matrix<double>> &thermal,
              const std::optional<Matrix<double>> &earlier = std::nullopt, bool guessed = false) const {
    for (const auto &moved : {displacement, earlier})
      if (moved && (moved->shape(0) != rows() || moved->shape(1) != dim()))
        throw nb::value_error("points and displacement disagree");
    if (thermal && (thermal->shape(0) != count() || thermal->shape(1) != nodes.shape(1)))
      throw nb::value_error("cells and thermal strain disagree");
    return {displacement ? displacement->data() : nullptr, thermal ? thermal->data() : nullptr,
            earlier ? earlier->data() : nullptr, guessed};
  }

  Results results(const std::optional<Output<2>> &force, const std::optional<Tangent> &tangent,
                  const std::optional<Output<2>> &at_points) const {
    Results out;
    if (force) {
      if (force->shape(0) != rows() || force->shape(1) != dim())
        throw nb::value_error("points and force disagree");
      out.force = force->data();
    }
    if (tangent) {
      const auto &[indptr, indices, values] = *tangent;
      if (indptr.shape(0) != rows() + 1 || values.shape(0) != indices.shape(0) * dim() * dim())
        throw nb::value_error("points and pattern disagree");
      out.indptr = indptr.data(), out.indices = indices.data(), out.stiffness = values.data();
    }
    if (at_points) {
      if (at_points->shape(0) != integration_points() || at_points->shape(1) != STRAINS)
        throw nb::value_error("integration points and stresses disagree");
      out.stress = at_points->data();
    }
    return out;
  }

  // Calls call.operator()<Kinematics>() with the kinematics of these cells.
  template <template <int, bool> class Kinematics, class Call> void with_kinematics(Call call) const {
    if (axisymmetric)
      call.template operator()<Kinematics<2, true>>();
    else if (dim() == 2)
      call.template operator()<Kinematics<2, false>>();
    else
      call.template operator()<Kinematics<3, false>>();
  }

  template <template <int, bool> class Kinematics, class Material>
  Unsound integrate(const State &state, const Material &material, const Results &results) const {
    const Cells cells = view();
    nb::gil_scoped_release release;
    const std::size_t parts = cells.count < FEW_CELLS ? 1 : thread_count();
    std::vector<Unsound> unsound(parts);
    const auto run = [&]<class Own>() {
      run_parts(parts, [&](std::size_t part) {
        const Rows own{std::int32_t(rows() * part / parts), std::int32_t(rows() * (part + 1) / parts)};
        unsound[part] = abut::integrate<Own>(cells, state, material, results, own);
      });
    };
    bool mixed = false;
    if constexpr (Kinematics<3, false>::finite)
      if ((mixed = pressures > 0))
        with_kinematics<MixedStrain>(run);
    if (!mixed)
      with_kinematics<Kinematics>(run);
    return *std::min_element(unsound.begin(), unsound.end(),
                             [](const Unsound &a, const Unsound &b) { return a.cell < b.cell; });
  }

private:
  Matrix<double> points;
  Matrix<std::int32_t> nodes;
  Matrix<double> shapes;
  Tensor3<double> derivatives;
  Vector<double> weights;
  bool axisymmetric, mean_dilatation;
  std::size_t pressures;
};

} // namespace abut
