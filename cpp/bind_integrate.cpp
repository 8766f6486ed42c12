// The integration over cells for Python: strains at points, and forces, stiffness and stresses of the isotropic
// material or of stresses and tangents that Python has evaluated.
#include "cell_arrays.hpp"

namespace abut {

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
integrate_hyperelastic(const CellArrays &cells, Matrix<double> constants, Law law, bool plane_stress,
                       Matrix<double> displacement, std::optional<Matrix<double>> thermal,
                       std::optional<Output<2>> force, std::optional<Tangent> tangent, std::optional<Output<2>> stress,
                       std::optional<Output<1>> energy, std::optional<Matrix<double>> earlier, bool guessed) {
  if (constants.shape(0) != cells.count() || constants.shape(1) != 2 || (energy && energy->shape(0) != cells.count()))
    throw nb::value_error("cells and materials or energies disagree");
  Results results = cells.results(force, tangent, stress);
  results.energy = energy ? energy->data() : nullptr;
  const Unsound unsound = cells.integrate<FiniteStrain>(cells.state(displacement, thermal, earlier, guessed),
                                                        Hyperelastic{constants.data(), law, plane_stress}, results);
  return told(unsound);
}

static std::tuple<nb::ndarray<nb::numpy, double>, std::optional<std::tuple<std::size_t, double>>>
finite_strains(const CellArrays &cells, Matrix<double> displacement, std::optional<Matrix<double>> thermal) {
  std::vector<double> result(cells.integration_points() * STRAINS);
  const Unsound unsound =
      cells.integrate<FiniteStrain>(cells.state(displacement, thermal), Told{result.data()}, Results{});
  return {to_numpy(std::move(result), {cells.integration_points(), STRAINS}), told(unsound)};
}

static void integrate_given_finite(const CellArrays &cells, Matrix<double> displacement,
                                   std::optional<Matrix<double>> thermal, Matrix<double> strains,
                                   Matrix<double> stresses, Tensor3<double> tangents, bool plane_stress,
                                   std::optional<Output<2>> force, std::optional<Tangent> tangent,
                                   std::optional<Output<2>> stress, std::optional<Matrix<double>> earlier,
                                   bool guessed) {
  const std::size_t points = cells.integration_points();
  if (strains.shape(0) != points || strains.shape(1) != STRAINS || stresses.shape(0) != points ||
      stresses.shape(1) != STRAINS || tangents.shape(0) != points || tangents.shape(1) != STRAINS ||
      tangents.shape(2) != STRAINS)
    throw nb::value_error("integration points and what is given there disagree");
  cells.integrate<FiniteStrain>(cells.state(displacement, thermal, earlier, guessed),
                                GivenFinite{strains.data(), stresses.data(), tangents.data(), plane_stress},
                                cells.results(force, tangent, stress));
}

void bind_integrate(nb::module_ &m) {
  nb::class_<CellArrays>(m, "Cells", "Cells of one type with an integration rule on the reference cell.")
      .def(nb::init<Matrix<double>, Matrix<std::int32_t>, Matrix<double>, Tensor3<double>, Vector<double>, bool, bool,
                    std::size_t>(),
           nb::arg("points").noconvert(), nb::arg("nodes").noconvert(), nb::arg("shapes").noconvert(),
           nb::arg("derivatives").noconvert(), nb::arg("weights").noconvert(), nb::arg("axisymmetric"),
           nb::arg("mean_dilatation"), nb::arg("pressures") = 0);
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
  m.def("finite_strains", &finite_strains, nb::arg("cells"), nb::arg("displacement").noconvert(),
        nb::arg("thermal").noconvert() = nb::none(),
        "Strains (cells q, 6) of Green and Lagrange at the integration points, shear strains doubled, without what "
        "heat makes "
        "freely; and where a cell is inside out its number and det F, with which the strains end.");
  m.def("integrate_given_finite", &integrate_given_finite, nb::arg("cells"), nb::arg("displacement").noconvert(),
        nb::arg("thermal").noconvert().none(), nb::arg("strains").noconvert(), nb::arg("stresses").noconvert(),
        nb::arg("tangents").noconvert(), nb::arg("plane_stress"), nb::arg("force").noconvert() = nb::none(),
        nb::arg("tangent").noconvert() = nb::none(), nb::arg("stress").noconvert() = nb::none(),
        nb::arg("earlier").noconvert() = nb::none(), nb::arg("guessed") = false,
        "As ``integrate_given`` at these strains, with the second stresses of Piola and Kirchhoff and their tangents; "
        "stress: "
        "Cauchy's is written.");
  nb::enum_<Law>(m, "Hyperelastic")
      .value("SAINT_VENANT_KIRCHHOFF", Law::SAINT_VENANT_KIRCHHOFF)
      .value("LOG_SQUARED", Law::LOG_SQUARED)
      .value("SQUARE_LOG", Law::SQUARE_LOG)
      .value("ISOCHORIC", Law::ISOCHORIC);
  m.def("integrate_hyperelastic", &integrate_hyperelastic, nb::arg("cells"), nb::arg("constants").noconvert(),
        nb::arg("law"), nb::arg("plane_stress"), nb::arg("displacement").noconvert(),
        nb::arg("thermal").noconvert() = nb::none(), nb::arg("force").noconvert() = nb::none(),
        nb::arg("tangent").noconvert() = nb::none(), nb::arg("stress").noconvert() = nb::none(),
        nb::arg("energy").noconvert() = nb::none(), nb::arg("earlier").noconvert() = nb::none(),
        nb::arg("guessed") = false,
        "The same under finite strains, with constants (cells, 2) of a hyperelastic law, Cauchy stresses, and energy "
        "(cells,); with an earlier displacement the tangent has the pressures foreseen there. Where a cell has no "
        "sound deformation: its number and det F; what was added up is then "
        "incomplete.");
}

} // namespace abut
