// SPDX-License-Identifier: Apache-2.0
#include "bvh.hpp"

#include <algorithm>
#include <cstddef>
#include <numeric>

namespace pathtracer {
namespace {

constexpr int kBins = 16;
constexpr std::size_t kSmallLeaf = 2;
constexpr std::size_t kLargestLeaf = 8;
constexpr float kStepCost = 1;  // of visiting a node, in units of one item

struct Bin {
  Bounds box;
  std::size_t count = 0;
};

struct Split {
  int axis = -1;  // -1: none was found
  int bin = 0;    // the first one on the far side
  float cost = kInfinity;
};

int bin_of(float position, float low, float high) {
  return std::clamp(static_cast<int>(kBins * (position - low) / (high - low)), 0, kBins - 1);
}

// The cheapest place to part the bins of one axis.
void improve(Split& best, int axis, const std::array<Bin, kBins>& bins) {
  std::array<float, kBins> far_cost{};
  Bin far;
  for (int i = kBins - 1; i > 0; --i) {
    far.box.add(bins[static_cast<std::size_t>(i)].box);
    far.count += bins[static_cast<std::size_t>(i)].count;
    far_cost[static_cast<std::size_t>(i)] =
        far.count == 0 ? kInfinity : far.box.half_area() * static_cast<float>(far.count);
  }
  Bin near;
  for (int i = 1; i < kBins; ++i) {
    near.box.add(bins[static_cast<std::size_t>(i - 1)].box);
    near.count += bins[static_cast<std::size_t>(i - 1)].count;
    if (near.count == 0) continue;
    const float cost = near.box.half_area() * static_cast<float>(near.count) + far_cost[static_cast<std::size_t>(i)];
    if (cost < best.cost) best = {axis, i, cost};
  }
}

}  // namespace

struct Bvh::Builder {
  Bvh& tree;
  std::span<const Bounds> boxes;

  using Items = std::span<std::uint32_t>;

  [[nodiscard]] Split find_split(Items items, const Bounds& centres) const {
    Split best;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(centres.low[axis] < centres.high[axis])) continue;
      std::array<Bin, kBins> bins;
      for (const std::uint32_t item : items) {
        Bin& bin =
            bins[static_cast<std::size_t>(bin_of(boxes[item].centre()[axis], centres.low[axis], centres.high[axis]))];
        bin.box.add(boxes[item]);
        ++bin.count;
      }
      improve(best, axis, bins);
    }
    return best;
  }

  // Items of the near side first; how many these are.
  [[nodiscard]] std::size_t part(Items items, const Bounds& centres, const Split& split) const {
    const auto is_near = [&](std::uint32_t item) {
      return bin_of(boxes[item].centre()[split.axis], centres.low[split.axis], centres.high[split.axis]) < split.bin;
    };
    return static_cast<std::size_t>(std::partition(items.begin(), items.end(), is_near) - items.begin());
  }

  void build(std::size_t first, std::size_t count, int depth) {
    const Items items(tree.items_.data() + first, count);
    Bounds box;
    Bounds centres;
    for (const std::uint32_t item : items) {
      box.add(boxes[item]);
      centres.add(boxes[item].centre());
    }
    const std::size_t index = tree.nodes_.size();
    tree.nodes_.push_back({box, static_cast<std::uint32_t>(first), static_cast<std::uint16_t>(count), 0});
    if (count <= kSmallLeaf) return;

    const Split split = find_split(items, centres);
    const float cost_as_leaf = (static_cast<float>(count) - kStepCost) * box.half_area();
    if (count <= kLargestLeaf && split.cost >= cost_as_leaf) return;
    // Where no plane parts them, or the tree gets too deep for the stack of `walk`: halves.
    const bool use_split = split.axis >= 0 && depth < kMaxDepth / 2;
    const std::size_t near_count = use_split ? part(items, centres, split) : count / 2;
    build(first, near_count, depth + 1);
    tree.nodes_[index].index = static_cast<std::uint32_t>(tree.nodes_.size());
    tree.nodes_[index].count = 0;
    tree.nodes_[index].axis = static_cast<std::uint16_t>(use_split ? split.axis : 0);
    build(first + near_count, count - near_count, depth + 1);
  }
};

Bvh::Bvh(std::span<const Bounds> boxes) : items_(boxes.size()) {
  std::iota(items_.begin(), items_.end(), 0U);
  if (!boxes.empty()) Builder{*this, boxes}.build(0, boxes.size(), 0);
}

}  // namespace pathtracer
