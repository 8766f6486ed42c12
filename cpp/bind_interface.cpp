#include "bind.hpp"

namespace abut {
void bind_interface(nb::module_ &) {}
} // namespace abut
