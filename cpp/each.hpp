// Loops that the compiler writes out.
#pragma once
#include <type_traits>
#include <utility>

namespace abut {

// Calls call(m) for m = from .. to - 1, each a constant.
template <int from, int to, class Call> constexpr void each(Call call) {
  [&]<int... m>(std::integer_sequence<int, m...>) {
    (call(std::integral_constant<int, from + m>()), ...);
  }(std::make_integer_sequence<int, to - from>());
}

} // namespace abut
