// Laws at points for Python: objects that evaluate strains, and integrate cells.
#include "cell_arrays.hpp"
#include "heated_material.hpp"
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

namespace abut {

using Answer =
    std::tuple<nb::ndarray<nb::numpy, double>, nb::ndarray<nb::numpy, double>, nb::ndarray<nb::numpy, double>>;
using Failure = std::optional<std::tuple<std::size_t, double>>;

// Strains and histories of n points, one after the other in as many threads as there are, by respond(i, strain, before,
// after, stress).
template <class Respond>
Answer at_points(const Matrix<double> &strain, const Matrix<double> &before, std::size_t h, const Respond &respond) {
  constexpr std::size_t FEW_POINTS = 1000;
  const std::size_t n = strain.shape(0);
  if (strain.shape(1) != STRAINS || before.shape(0) != n || before.shape(1) != h)
    throw nb::value_error("strains and histories disagree");
  std::vector<double> stress(n * STRAINS), tangent(n * STRAINS * STRAINS), after(n * h);
  {
    nb::gil_scoped_release release;
    const std::size_t parts = n < FEW_POINTS ? 1 : thread_count();
    run_parts(parts, [&](std::size_t part) {
      for (std::size_t i = n * part / parts; i < n * (part + 1) / parts; ++i) {
        double own[STRAINS];
        std::copy_n(strain.data() + i * STRAINS, STRAINS, own);
        Dense told = respond(i, own, before.data() + i * h, after.data() + i * h, &stress[i * STRAINS]);
        turn_back(told);
        std::copy_n(told.c, STRAINS * STRAINS, &tangent[i * STRAINS * STRAINS]);
      }
    });
  }
  return {to_numpy(std::move(stress), {n, STRAINS}), to_numpy(std::move(tangent), {n, STRAINS, STRAINS}),
          to_numpy(std::move(after), {n, h})};
}

template <class Law>
Dense respond_at(const Law &law, bool logarithmic, double *strain, const double *before, double *after,
                 double *stress) {
  return logarithmic ? PointMaterial<Law, true>{law, false}.respond(strain, before, after, stress)
                     : PointMaterial<Law, false>{law, false}.respond(strain, before, after, stress);
}

// What integrates a law with histories (cells q, h), by material.operator()<logarithmic>(before, after).
struct Histories {
  std::size_t numbers; // of a point
  std::optional<Matrix<double>> before;
  std::optional<Output<2>> after;
};

template <class Make>
Failure integrate_with_history(const CellArrays &cells, bool finite, const State &state, const Histories &histories,
                               Results results, std::optional<Output<1>> energy, const Make &material) {
  const std::size_t points = cells.integration_points(), h = histories.numbers;
  const auto &[numbers, before, after] = histories;
  if ((before && (before->shape(0) != points || before->shape(1) != h)) ||
      (after && (after->shape(0) != points || after->shape(1) != h)) || (energy && energy->shape(0) != cells.count()))
    throw nb::value_error("integration points and histories or energies disagree");
  if (!state.displacement)
    throw nb::value_error("laws at points need displacements");
  results.energy = energy ? energy->data() : nullptr;
  const double *old = before && h ? before->data() : nullptr;
  double *now = after && h ? after->data() : nullptr;
  return told(finite ? cells.integrate<FiniteStrain>(state, material.template operator()<true>(old, now), results)
                     : cells.integrate<SmallStrain>(state, material.template operator()<false>(old, now), results));
}

// A law under small strains, or in the space of logarithmic ones.
class PointLaw {
public:
  virtual ~PointLaw() = default;
  virtual std::size_t history() const = 0;
  virtual Answer evaluate(Matrix<double> strain, Matrix<double> before, bool logarithmic) const = 0;
  virtual Failure integrate(const CellArrays &cells, bool finite, bool plane_stress,
                            std::optional<Matrix<double>> displacement, std::optional<Matrix<double>> thermal,
                            std::optional<Matrix<double>> before, std::optional<Output<2>> force,
                            std::optional<Tangent> tangent, std::optional<Output<2>> stress,
                            std::optional<Output<1>> energy, std::optional<Output<2>> after,
                            std::optional<Matrix<double>> earlier, bool guessed) const = 0;
};

template <class Law> class Held final : public PointLaw {
public:
  explicit Held(Law law) : law(std::move(law)) {}

  std::size_t history() const override { return law.history; }

  Answer evaluate(Matrix<double> strain, Matrix<double> before, bool logarithmic) const override {
    return at_points(strain, before, law.history,
                     [&](std::size_t, double *own, const double *old, double *now, double *stress) {
                       return respond_at(law, logarithmic, own, old, now, stress);
                     });
  }

  Failure integrate(const CellArrays &cells, bool finite, bool plane_stress, std::optional<Matrix<double>> displacement,
                    std::optional<Matrix<double>> thermal, std::optional<Matrix<double>> before,
                    std::optional<Output<2>> force, std::optional<Tangent> tangent, std::optional<Output<2>> stress,
                    std::optional<Output<1>> energy, std::optional<Output<2>> after,
                    std::optional<Matrix<double>> earlier, bool guessed) const override {
    return integrate_with_history(cells, finite, cells.state(displacement, thermal, earlier, guessed),
                                  {law.history, before, after}, cells.results(force, tangent, stress), energy,
                                  [&]<bool logarithmic>(const double *old, double *now) {
                                    return PointMaterial<Law, logarithmic>{law, plane_stress, old, now};
                                  });
  }

private:
  Law law;
};

static std::unique_ptr<PointLaw> hooke(double bulk, double shear) {
  return std::make_unique<Held<Hooke>>(Hooke{bulk, shear});
}

static std::unique_ptr<PointLaw> j2(double bulk, double shear, std::vector<double> table, double slope,
                                    double saturation, double rate, std::vector<double> back) {
  if (table.size() < 2 || table.size() % 2 || back.size() % 2)
    throw nb::value_error("tables have two columns, that of yield stresses a row at least");
  return std::make_unique<Held<J2>>(J2(bulk, shear, {std::move(table), slope, saturation, rate, std::move(back)}));
}

using Row = std::tuple<double, double, double, std::vector<double>, double, double, double, std::vector<double>>;

static std::unique_ptr<J2OverTemperature> j2_over_temperature(const std::vector<Row> &given) {
  std::vector<J2OverTemperature::Row> rows;
  for (const auto &[temperature, young, poisson, table, slope, saturation, rate, back] : given) {
    rows.push_back({temperature, young, poisson, {table, slope, saturation, rate, back}});
    if (table.size() < 2 || table.size() % 2 || back.size() % 2 || table.size() != rows[0].hardening.table.size() ||
        back.size() != rows[0].hardening.back.size())
      throw nb::value_error("tables have two columns, and as many rows at every temperature");
  }
  if (rows.empty())
    throw nb::value_error("no temperatures");
  return std::make_unique<J2OverTemperature>(std::move(rows));
}

static Answer evaluate_over_temperature(const J2OverTemperature &law, Matrix<double> strain, Matrix<double> before,
                                        Vector<double> temperature, bool logarithmic) {
  if (temperature.shape(0) != strain.shape(0))
    throw nb::value_error("strains and temperatures disagree");
  return at_points(strain, before, law.history(),
                   [&](std::size_t i, double *own, const double *old, double *now, double *stress) {
                     return respond_at(law.at(temperature.data()[i]), logarithmic, own, old, now, stress);
                   });
}

static Failure integrate_over_temperature(const J2OverTemperature &law, const CellArrays &cells, bool finite,
                                          bool plane_stress, std::optional<Matrix<double>> displacement,
                                          Vector<double> temperature, Vector<double> swelling,
                                          std::optional<Matrix<double>> before, std::optional<Output<2>> force,
                                          std::optional<Tangent> tangent, std::optional<Output<2>> stress,
                                          std::optional<Output<1>> energy, std::optional<Output<2>> after) {
  const std::size_t points = cells.integration_points();
  if (temperature.shape(0) != points || swelling.shape(0) != points)
    throw nb::value_error("integration points and temperatures disagree");
  return integrate_with_history(cells, finite, cells.state(displacement, std::nullopt, std::nullopt, false),
                                {law.history(), before, after}, cells.results(force, tangent, stress), energy,
                                [&]<bool logarithmic>(const double *old, double *now) {
                                  return HeatedMaterial<J2OverTemperature, logarithmic>{
                                      law, plane_stress, temperature.data(), swelling.data(), old, now};
                                });
}

static std::unique_ptr<PointLaw> stretches(std::vector<double> terms, std::vector<double> powers,
                                           std::vector<double> volume) {
  if (terms.size() % 2 || volume.empty())
    throw nb::value_error("terms have two columns, and the volume needs a modulus");
  return std::make_unique<Held<Stretches>>(Stretches{std::move(terms), std::move(powers), std::move(volume)});
}

void bind_laws(nb::module_ &m) {
  nb::class_<PointLaw>(m, "PointLaw", "A law at a point, under small strains or in the space of logarithmic ones.")
      .def_prop_ro("history", &PointLaw::history, "Numbers in the history of a point.")
      .def("evaluate", &PointLaw::evaluate, nb::arg("strain").noconvert(), nb::arg("before").noconvert(),
           nb::arg("logarithmic"),
           "Stress (n, 6), tangent (n, 6, 6) and new history at strains (n, 6) after histories (n, h). logarithmic: "
           "strains "
           "are those of Green and Lagrange, stresses the second ones of Piola and Kirchhoff.")
      .def("integrate", &PointLaw::integrate, nb::arg("cells"), nb::arg("finite"), nb::arg("plane_stress"),
           nb::arg("displacement").noconvert(), nb::arg("thermal").noconvert() = nb::none(),
           nb::arg("before").noconvert() = nb::none(), nb::arg("force").noconvert() = nb::none(),
           nb::arg("tangent").noconvert() = nb::none(), nb::arg("stress").noconvert() = nb::none(),
           nb::arg("energy").noconvert() = nb::none(), nb::arg("after").noconvert() = nb::none(),
           nb::arg("earlier").noconvert() = nb::none(), nb::arg("guessed") = false,
           "As ``integrate_isotropic`` and ``integrate_hyperelastic``; before and after: histories (cells q, h).");
  nb::class_<J2OverTemperature>(m, "J2OverTemperature",
                                "Von Mises plasticity whose constants depend on the temperature.")
      .def_prop_ro("history", &J2OverTemperature::history, "Numbers in the history of a point.")
      .def("evaluate", &evaluate_over_temperature, nb::arg("strain").noconvert(), nb::arg("before").noconvert(),
           nb::arg("temperature").noconvert(), nb::arg("logarithmic"), "As of ``PointLaw``, at temperatures (n,).")
      .def("integrate", &integrate_over_temperature, nb::arg("cells"), nb::arg("finite"), nb::arg("plane_stress"),
           nb::arg("displacement").noconvert(), nb::arg("temperature").noconvert(), nb::arg("swelling").noconvert(),
           nb::arg("before").noconvert() = nb::none(), nb::arg("force").noconvert() = nb::none(),
           nb::arg("tangent").noconvert() = nb::none(), nb::arg("stress").noconvert() = nb::none(),
           nb::arg("energy").noconvert() = nb::none(), nb::arg("after").noconvert() = nb::none(),
           "As of ``PointLaw``; temperature, swelling: (cells q,) temperatures and thermal strains at the points.");
  m.def("j2_over_temperature", &j2_over_temperature, nb::arg("rows"),
        "Rows of temperature, growing, Young's modulus, Poisson's ratio, and as in ``j2`` table, slope, saturation, "
        "rate, "
        "back, all with the same plastic strains and as many back stresses.");
  m.def("hooke", &hooke, nb::arg("bulk"), nb::arg("shear"), "Isotropic linear elasticity.");
  m.def("stretches", &stretches, nb::arg("terms"), nb::arg("powers"), nb::arg("volume"),
        "Hyperelasticity, of finite strains only: Ogden's terms (n, 2) mu and alpha, flat; factors of powers of I - 3, "
        "and of "
        "even powers of J - 1.");
  m.def("j2", &j2, nb::arg("bulk"), nb::arg("shear"), nb::arg("table"), nb::arg("slope"), nb::arg("saturation"),
        nb::arg("rate"), nb::arg("back"),
        "Von Mises plasticity: table (n, 2) of equivalent plastic strains and yield stresses, to which slope x + "
        "saturation "
        "(1 - exp(-rate x)) is added; back (m, 2): modulus and recall of back stresses; both flat.");
}

} // namespace abut
