// Behaviours by hand, with the symbols that MFront's generic interface exports: what MGIS loads, where no MFront is at
// hand.
//
// Metal: von Mises with linear isotropic hardening. Maxwell: a fluid whose stress fades, by backward differences.
// Kirchhoff: Saint Venant and Kirchhoff's law of a deformation gradient. Tensors are 11 22 33 12 13 23, shear times
// root 2.
#include <algorithm>
#include <cmath>

struct Before {
  const double *gradients, *forces, *density, *properties, *inside, *stored, *dissipated, *outside;
};
struct After {
  const double *gradients;
  double *forces;
  const double *density, *properties;
  double *inside, *stored, *dissipated;
  const double *outside;
};
struct Data {
  char *message;
  double dt;
  double *K, *rdt, *sound;
  Before s0;
  After s1;
};

static void hooke(double lambda, double mu, double *K) {
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      K[6 * i + j] = (i < 3 && j < 3 ? lambda : 0.0) + (i == j ? 2.0 * mu : 0.0);
}

static double lambda_of(const double *p) { return p[0] * p[1] / ((1.0 + p[1]) * (1.0 - 2.0 * p[1])); }

static double mu_of(const double *p) { return p[0] / (2.0 * (1.0 + p[1])); }

static int metal(Data *d) {
  const double *p = d->s1.properties, *old = d->s0.inside;
  const double lambda = lambda_of(p), mu = mu_of(p), hardening = p[3];
  double elastic[6], normal[6], trace = 0.0, size = 0.0;
  for (int i = 0; i < 6; ++i)
    elastic[i] = old[i] + d->s1.gradients[i] - d->s0.gradients[i];
  for (int i = 0; i < 3; ++i)
    trace += elastic[i];
  for (int i = 0; i < 6; ++i) {
    normal[i] = 2.0 * mu * (elastic[i] - (i < 3 ? trace / 3.0 : 0.0));
    size += normal[i] * normal[i];
  }
  const double mises = std::sqrt(1.5 * size), beyond = mises - p[2] - hardening * old[6];
  const double flow = std::max(beyond, 0.0) / (3.0 * mu + hardening);
  for (double &n : normal)
    n *= mises > 0.0 ? 1.5 / mises : 0.0;
  for (int i = 0; i < 6; ++i)
    elastic[i] -= flow * normal[i];
  for (int i = 0; i < 6; ++i)
    d->s1.forces[i] = (i < 3 ? lambda * trace : 0.0) + 2.0 * mu * elastic[i];
  std::copy(elastic, elastic + 6, d->s1.inside);
  d->s1.inside[6] = old[6] + flow;
  hooke(lambda, mu, d->K);
  if (flow > 0.0)
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) {
        const double shape = 1.5 * ((i == j ? 1.0 : 0.0) - (i < 3 && j < 3 ? 1.0 / 3.0 : 0.0));
        const double square = 4.0 * mu * mu, share = flow / mises;
        d->K[6 * i + j] +=
            square * (share - 1.0 / (3.0 * mu + hardening)) * normal[i] * normal[j] - square * share * shape;
      }
  return 1;
}

static int maxwell(Data *d) {
  const double *p = d->s1.properties;
  const double lambda = lambda_of(p), mu = mu_of(p), fade = 1.0 / (1.0 + d->dt / p[2]);
  hooke(lambda * fade, mu * fade, d->K);
  for (int i = 0; i < 6; ++i) {
    d->s1.forces[i] = fade * d->s0.forces[i];
    for (int j = 0; j < 6; ++j)
      d->s1.forces[i] += d->K[6 * i + j] * (d->s1.gradients[j] - d->s0.gradients[j]);
  }
  return 1;
}

static int kirchhoff(Data *d) {
  if (d->K[1] < 0.5 || d->K[1] > 1.5 || d->K[2] < 0.5 || d->K[2] > 1.5)
    return -1; // S and dS/dE alone
  static const int place[3][3] = {{0, 3, 5}, {4, 1, 7}, {6, 8, 2}},
                   of[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
  const double *p = d->s1.properties, *F = d->s1.gradients;
  double strain[6];
  for (int i = 0; i < 6; ++i) {
    double c = 0.0;
    for (int k = 0; k < 3; ++k)
      c += F[place[k][of[i][0]]] * F[place[k][of[i][1]]];
    strain[i] = 0.5 * (c - (i < 3 ? 1.0 : 0.0)) * (i < 3 ? 1.0 : std::sqrt(2.0));
  }
  hooke(lambda_of(p), mu_of(p), d->K);
  for (int i = 0; i < 6; ++i) {
    d->s1.forces[i] = 0.0;
    for (int j = 0; j < 6; ++j)
      d->s1.forces[i] += d->K[6 * i + j] * strain[j];
  }
  return 1;
}

#define OF(name, law, type, kinematic, gradient, gradient_type, third, n_properties, n_inside)                         \
  unsigned short name##_mfront_mkt = 1, name##_api_version = 1, name##_BehaviourType = type,                           \
                 name##_BehaviourKinematic = kinematic, name##_SymmetryType = 0, name##_ElasticSymmetryType = 0,       \
                 name##_requiresStiffnessTensor = 0, name##_requiresThermalExpansionCoefficientTensor = 0,             \
                 name##_ComputesInternalEnergy = 0, name##_ComputesDissipatedEnergy = 0, name##_nGradients = 1,        \
                 name##_nThermodynamicForces = 1, name##_nTangentOperatorBlocks = 2,                                   \
                 name##_nMaterialProperties = n_properties, name##_nInternalStateVariables = n_inside,                 \
                 name##_nExternalStateVariables = 0, name##_nParameters = 0, name##_nInitializeFunctions = 0,          \
                 name##_nPostProcessings = 0;                                                                          \
  const char *name##_Gradients[] = {gradient}, *name##_ThermodynamicForces[] = {"Stress"},                             \
             *name##_TangentOperatorBlocks[] = {"Stress", gradient},                                                   \
             *name##_MaterialProperties[] = {"YoungModulus", "PoissonRatio", third, "Hardening"},                      \
             *name##_InternalStateVariables[] = {"ElasticStrain", "EquivalentPlasticStrain"};                          \
  int name##_GradientsTypes[] = {gradient_type}, name##_ThermodynamicForcesTypes[] = {1},                              \
      name##_InternalStateVariablesTypes[] = {1, 0}, name##_ParametersTypes[] = {0};                                   \
  const char *name##_tfel_version = "", *name##_mfront_interface = "Generic";                                          \
  int name##_Tridimensional(Data *d) { return law(d); }

extern "C" {
OF(Metal, metal, 1, 1, "Strain", 1, "YieldStress", 4, 2)
OF(Maxwell, maxwell, 1, 1, "Strain", 1, "RelaxationTime", 3, 0)
OF(Kirchhoff, kirchhoff, 2, 3, "DeformationGradient", 3, "", 2, 0)
}
