// Loops over ranges on several threads. The result must not depend on how many there are.
#pragma once
#include <cstddef>
#include <cstdlib>
#include <exception>
#include <thread>
#include <vector>

namespace abut {

constexpr std::size_t FEW_CELLS = 5000; // not worth a thread

// OMP_NUM_THREADS, which also limits the linear algebra libraries, or else one thread a core.
inline std::size_t thread_count() {
  if (const char *wanted = std::getenv("OMP_NUM_THREADS"))
    if (const long n = std::atol(wanted); n > 0)
      return std::size_t(n);
  const unsigned cores = std::thread::hardware_concurrency();
  return cores ? cores : 1;
}

// Calls work(part) for part = 0 .. parts - 1, each on a thread of its own; the first exception is passed on.
template <class Work> void run_parts(std::size_t parts, Work work) {
  if (parts <= 1) {
    work(std::size_t(0));
    return;
  }
  std::vector<std::exception_ptr> failed(parts);
  std::vector<std::thread> threads;
  for (std::size_t part = 0; part < parts; ++part)
    threads.emplace_back([&, part] {
      try {
        work(part);
      } catch (...) {
        failed[part] = std::current_exception();
      }
    });
  for (std::thread &thread : threads)
    thread.join();
  for (const std::exception_ptr &error : failed)
    if (error)
      std::rethrow_exception(error);
}

} // namespace abut
