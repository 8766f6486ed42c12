// Rows of numbers that are thrown away together.
#pragma once
#include <algorithm>
#include <cstddef>
#include <memory>
#include <vector>

namespace abut {

class Arena {
public:
  // n zeros.
  double *take(std::size_t n) {
    while (block_ < blocks_.size() && used_ + n > blocks_[block_].size)
      ++block_, used_ = 0;
    if (block_ == blocks_.size()) {
      const std::size_t size = std::max(n, LEAST);
      blocks_.push_back({size, std::make_unique_for_overwrite<double[]>(size)});
    }
    double *row = blocks_[block_].data.get() + used_;
    used_ += n;
    std::fill(row, row + n, 0.0);
    return row;
  }
  void clear() { block_ = used_ = 0; }

private:
  static constexpr std::size_t LEAST = 1 << 14;
  struct Block {
    std::size_t size;
    std::unique_ptr<double[]> data;
  };
  std::vector<Block> blocks_;
  std::size_t block_ = 0, used_ = 0;
};

} // namespace abut
