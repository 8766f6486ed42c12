// The module: one function per area, each in its own file.
#include "bind.hpp"

NB_MODULE(_core, m) {
  m.doc() = "abut's compiled kernels: stateless, arrays in and out.";
  abut::bind_cells(m);
  abut::bind_facets(m);
  abut::bind_padding(m);
  abut::bind_pattern(m);
  abut::bind_integrate(m);
  abut::bind_interface(m);
  abut::bind_interpolation(m);
  abut::bind_laws(m);
  abut::bind_recovery(m);
  abut::bind_sparse(m);
  abut::bind_strength(m);
  abut::bind_tangent(m);
}
