// A bounding-box tree over many boxes: built once, asked which boxes meet a given one.
#pragma once
#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

namespace abut {

struct Box {
  double low[3], high[3];
  Box() {
    for (int a = 0; a < 3; ++a) {
      low[a] = std::numeric_limits<double>::infinity();
      high[a] = -low[a];
    }
  }
  void add(const double *x, int dim) {
    for (int a = 0; a < dim; ++a)
      low[a] = std::min(low[a], x[a]), high[a] = std::max(high[a], x[a]);
  }
  void add(const Box &b, int dim) { add(b.low, dim), add(b.high, dim); }
  void inflate(double by, int dim) {
    for (int a = 0; a < dim; ++a)
      low[a] -= by, high[a] += by;
  }
  double diagonal(int dim) const {
    double sum = 0;
    for (int a = 0; a < dim; ++a)
      sum += (high[a] - low[a]) * (high[a] - low[a]);
    return std::sqrt(sum);
  }
  bool meets(const Box &b, int dim) const {
    for (int a = 0; a < dim; ++a)
      if (low[a] > b.high[a] || b.low[a] > high[a])
        return false;
    return true;
  }
};

class Tree {
public:
  Tree(std::vector<Box> boxes, int dim) : boxes_(std::move(boxes)), dim_(dim), order_(boxes_.size()) {
    std::iota(order_.begin(), order_.end(), 0);
    if (!boxes_.empty())
      build(0, int(boxes_.size()));
  }

  // The numbers of all boxes that meet `box` and may be what is looked for, in ascending order. may_hold: false for a
  // box with nothing of that inside.
  template <class MayHold> void query(const Box &box, std::vector<int> &found, MayHold may_hold) const {
    found.clear();
    if (nodes_.empty())
      return;
    std::vector<int> stack{0};
    while (!stack.empty()) {
      const Node &node = nodes_[stack.back()];
      stack.pop_back();
      if (!node.box.meets(box, dim_) || !may_hold(node.box))
        continue;
      if (node.right < 0) {
        for (int i = node.begin; i < node.end; ++i)
          if (boxes_[order_[i]].meets(box, dim_))
            found.push_back(order_[i]);
      } else {
        stack.push_back(node.right);
        stack.push_back(node.left);
      }
    }
    std::sort(found.begin(), found.end());
  }

private:
  struct Node {
    Box box;
    int begin, end, left = -1, right = -1;
  };

  int build(int begin, int end) {
    const int id = int(nodes_.size());
    nodes_.push_back({Box(), begin, end});
    Box box, centres;
    for (int i = begin; i < end; ++i) {
      box.add(boxes_[order_[i]], dim_);
      double c[3];
      centre(order_[i], c);
      centres.add(c, dim_);
    }
    nodes_[id].box = box;
    if (end - begin <= 4)
      return id;
    int axis = 0;
    for (int a = 1; a < dim_; ++a)
      if (centres.high[a] - centres.low[a] > centres.high[axis] - centres.low[axis])
        axis = a;
    const int middle = (begin + end) / 2;
    std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end, [&](int p, int q) {
      return boxes_[p].low[axis] + boxes_[p].high[axis] < boxes_[q].low[axis] + boxes_[q].high[axis];
    });
    const int left = build(begin, middle), right = build(middle, end);
    nodes_[id].left = left, nodes_[id].right = right;
    return id;
  }

  void centre(int i, double *c) const {
    for (int a = 0; a < dim_; ++a)
      c[a] = 0.5 * (boxes_[i].low[a] + boxes_[i].high[a]);
  }

  std::vector<Box> boxes_;
  int dim_;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

} // namespace abut
