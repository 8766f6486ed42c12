#include "bind.hpp"

namespace abut {
void bind_solids(nb::module_ &) {}
} // namespace abut
