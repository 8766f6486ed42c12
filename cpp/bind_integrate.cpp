// The integration over cells for Python: strains at points, and forces, stiffness and stresses of the isotropic
// material or of stresses and tangents that Python has evaluated.
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

// Cells of one type with a rule, all that their kinematics need; shares the arrays with Python.
class CellArrays {
public:
  CellArrays(Matrix<double> points, Matrix<std::int32_t> nodes, Matrix<double> shapes, Tensor3<double> derivatives,
             Vector<double> weights, bool axisymmetric, bool mean_dilatation)
      : points(points), nodes(nodes), shapes(shapes), derivatives(derivatives), weights(weights),
        axisymmetric(axisymmetric), mean_dilatation(mean_dilatation) {
    const std::size_t q = weights.shape(0), n = nodes.shape(1);
    if (q == 0 || shapes.shape(0) != q || shapes.shape(1) != n || derivatives.shape(0) != q ||
        derivatives.shape(1) != n || derivatives.shape(2) != dim() || (dim() != 2 && (axisymmetric || dim() != 3)))
      throw nb::value_error("points, cells and rule disagree");
  }

  std::size_t dim() const { return points.shape(1); }
  std::size_t rows() const { return points.shape(0); }
  std::size_t count() const { return nodes.shape(0); }
  std::size_t integration_points() const { return count() * weights.shape(0); }

  Cells view() const {
    return {points.data(),      nodes.data(),   count(),          nodes.shape(1), shapes.data(),
            derivatives.data(), weights.data(), weights.shape(0), mean_dilatation};
  }

  State state(const std::optional<Matrix<double>> &displacement, const std::optional<Matrix<double>> &thermal) const {
    if (displacement && (displacement->shape(0) != rows() || displacement->shape(1) != dim()))
      throw nb::value_error("points and displacement disagree");
    if (thermal && (thermal->shape(0) != count() || thermal->shape(1) != nodes.shape(1)))
      throw nb::value_error("cells and thermal strain disagree");
    return {displacement ? displacement->data() : nullptr, thermal ? thermal->data() : nullptr};
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
    with_kinematics<Kinematics>([&]<class Own>() {
      run_parts(parts, [&](std::size_t part) {
        const Rows own{std::int32_t(rows() * part / parts), std::int32_t(rows() * (part + 1) / parts)};
        unsound[part] = abut::integrate<Own>(cells, state, material, results, own);
      });
    });
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
};

static nb::ndarray<nb::numpy, double> strains(const CellArrays &cells, Matrix<double> displacement,
                                              std::optional<Matrix<double>> thermal) {
  const State state = cells.state(displacement, thermal);
  std::vector<double> result(cells.integration_points() * STRAINS);
  {
    nb::gil_scoped_release release;
    const std::size_t parts = cells.count() < FEW_CELLS ? 1 : thread_count();
    cells.with_kinematics<SmallStrain>([&]<class Kinematics>() {
      run_parts(parts, [&](std::size_t part) {
        point_strains<Kinematics>(cells.view(), state, result.data(), cells.count() * part / parts,
                                  cells.count() * (part + 1) / parts);
      });
    });
  }
  return to_numpy(std::move(result), {cells.integration_points(), STRAINS});
}

static void integrate_isotropic(const CellArrays &cells, Matrix<double> moduli, bool plane_stress,
                                std::optional<Matrix<double>> displacement, std::optional<Matrix<double>> thermal,
                                std::optional<Output<2>> force, std::optional<Tangent> tangent,
                                std::optional<Output<2>> stress) {
  if (moduli.shape(0) != cells.count() || moduli.shape(1) != 2)
    throw nb::value_error("cells and materials disagree");
  if ((force || stress) && !displacement)
    throw nb::value_error("forces and stresses need displacements");
  cells.integrate<SmallStrain>(cells.state(displacement, thermal), Isotropic{moduli.data(), plane_stress},
                               cells.results(force, tangent, stress));
}

static void integrate_given(const CellArrays &cells, std::optional<Matrix<double>> stresses,
                            std::optional<Tensor3<double>> tangents, std::optional<Output<2>> force,
                            std::optional<Tangent> tangent) {
  const std::size_t points = cells.integration_points();
  if ((stresses && (stresses->shape(0) != points || stresses->shape(1) != STRAINS)) ||
      (tangents && (tangents->shape(0) != points || tangents->shape(1) != STRAINS || tangents->shape(2) != STRAINS)))
    throw nb::value_error("integration points and what is given there disagree");
  if ((force && !stresses) || (tangent && !tangents))
    throw nb::value_error("forces need stresses, and the stiffness needs tangents");
  cells.integrate<SmallStrain>(State{},
                               Given{stresses ? stresses->data() : nullptr, tangents ? tangents->data() : nullptr},
                               cells.results(force, tangent, std::nullopt));
}

static std::optional<std::tuple<std::size_t, double>>
integrate_hyperelastic(const CellArrays &cells, Matrix<double> constants, int law, bool plane_stress,
                       Matrix<double> displacement, std::optional<Matrix<double>> thermal,
                       std::optional<Output<2>> force, std::optional<Tangent> tangent, std::optional<Output<2>> stress,
                       std::optional<Output<1>> energy) {
  if (constants.shape(0) != cells.count() || constants.shape(1) != 2 || (energy && energy->shape(0) != cells.count()))
    throw nb::value_error("cells and materials or energies disagree");
  if (law < 0 || law > int(Law::ISOCHORIC))
    throw nb::value_error("no such law");
  Results results = cells.results(force, tangent, stress);
  results.energy = energy ? energy->data() : nullptr;
  const Unsound unsound = cells.integrate<FiniteStrain>(
      cells.state(displacement, thermal), Hyperelastic{constants.data(), Law(law), plane_stress}, results);
  if (unsound.cell == SIZE_MAX)
    return std::nullopt;
  return std::make_tuple(unsound.cell, unsound.determinant);
}

void bind_integrate(nb::module_ &m) {
  nb::class_<CellArrays>(m, "Cells", "Cells of one type with an integration rule on the reference cell.")
      .def(
          nb::init<Matrix<double>, Matrix<std::int32_t>, Matrix<double>, Tensor3<double>, Vector<double>, bool, bool>(),
          nb::arg("points").noconvert(), nb::arg("nodes").noconvert(), nb::arg("shapes").noconvert(),
          nb::arg("derivatives").noconvert(), nb::arg("weights").noconvert(), nb::arg("axisymmetric"),
          nb::arg("mean_dilatation"));
  m.def("strains", &strains, nb::arg("cells"), nb::arg("displacement").noconvert(),
        nb::arg("thermal").noconvert() = nb::none(),
        "Strains (cells q, 6) xx yy zz xy yz zx at the integration points, shear strains doubled, less thermal strains "
        "(cells, n) of the nodes.");
  m.def(
      "integrate_isotropic", &integrate_isotropic, nb::arg("cells"), nb::arg("moduli").noconvert(),
      nb::arg("plane_stress"), nb::arg("displacement").noconvert() = nb::none(),
      nb::arg("thermal").noconvert() = nb::none(), nb::arg("force").noconvert() = nb::none(),
      nb::arg("tangent").noconvert() = nb::none(), nb::arg("stress").noconvert() = nb::none(),
      "Adds up, in place, what is asked for of cells with the moduli (cells, 2) lambda and mu: force (n_points, dim), "
      "tangent (indptr, indices, values of a block pattern); stress (cells q, 6) at the integration points is "
      "written.");
  m.def("integrate_given", &integrate_given, nb::arg("cells"), nb::arg("stresses").noconvert() = nb::none(),
        nb::arg("tangents").noconvert() = nb::none(), nb::arg("force").noconvert() = nb::none(),
        nb::arg("tangent").noconvert() = nb::none(),
        "The same with stresses (cells q, 6) and tangents (cells q, 6, 6) at the integration points.");
  m.def("integrate_hyperelastic", &integrate_hyperelastic, nb::arg("cells"), nb::arg("constants").noconvert(),
        nb::arg("law"), nb::arg("plane_stress"), nb::arg("displacement").noconvert(),
        nb::arg("thermal").noconvert() = nb::none(), nb::arg("force").noconvert() = nb::none(),
        nb::arg("tangent").noconvert() = nb::none(), nb::arg("stress").noconvert() = nb::none(),
        nb::arg("energy").noconvert() = nb::none(),
        "The same under finite strains, with constants (cells, 2) of a hyperelastic law, Cauchy stresses, and energy "
        "(cells,). Where a cell has no sound deformation: its number and det F; what was added up is then "
        "incomplete.");
}

} // namespace abut
