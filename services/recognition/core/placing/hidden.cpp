#include "services/recognition/core/placing/hidden.hpp"

#include <algorithm>
#include <utility>

#include "services/recognition/core/placing/colour_bins.hpp"

namespace prehend::recognition {
namespace {

constexpr int block = 4;  // px, side of the patches' grain

/// Patches of blocks, numbered from 1; 0 elsewhere.
struct Patches {
  Eigen::ArrayXXi pixels;  // of the object in each block
  Eigen::ArrayXXi label;
  int count = 0;
};

class Finder {
 public:
  Finder(const FittingImage& frame, const Area& area, const Silhouette& inside,
         const Silhouette& around, const Eigen::VectorXf& known_colours)
      : frame_(frame),
        area_(area),
        inside_(inside),
        around_(around),
        known_(known_colours),
        hidden_(static_cast<std::size_t>(area.width() * area.height()), 0) {}

  std::vector<std::uint8_t> run() {
    const Patches patches = strange_patches();
    const double all = patches.pixels.sum();
    for (int k = 1; k <= patches.count; ++k) {
      const double share = (patches.label == k).select(patches.pixels, 0).sum() / all;
      if (share > 0.04 && share < 0.6) hide(patches, k);
    }
    int covered = 0;
    area_.visit(inside_, [&](int x, int y) { covered += hidden_[area_.index(x, y)]; });
    const double share = covered / std::max(1.0, all);
    if (share <= 0.05 || share >= 0.5) std::fill(hidden_.begin(), hidden_.end(), std::uint8_t{0});
    return std::move(hidden_);
  }

 private:
  bool taken(int x, int y) const { return frame_.taken.at(x, y) != 0; }
  Eigen::Index bin(int x, int y) const { return frame_.bins[frame_.taken.index(x, y)]; }
  int row(int y) const { return (y - area_.top) / block; }
  int column(int x) const { return (x - area_.left) / block; }

  /// Colours that are more common around the object than in the picture: of what stands beside it.
  /// Shares; all zero when there is nothing.
  Eigen::VectorXf neighbours() const {
    std::vector<std::uint8_t> within(hidden_.size(), 0);
    area_.visit(inside_, [&](int x, int y) { within[area_.index(x, y)] = 1; });
    Eigen::VectorXf ring = Eigen::VectorXf::Zero(known_.size());
    area_.visit(around_, [&](int x, int y) {
      if (!within[area_.index(x, y)] && !taken(x, y)) ring[frame_.colours.at(x, y)] += 1;
    });
    ring = (ring / std::max(1.f, ring.sum()) - frame_.colour_share).cwiseMax(0);
    return ring.sum() > 0.05f ? Eigen::VectorXf(ring / ring.sum()) : Eigen::VectorXf(0 * ring);
  }

  /// Connected blocks whose colours are a fifth as frequent on the object as its own are, or far
  /// more frequent on what stands beside it.
  Patches strange_patches() const {
    const int across = (area_.width() + block - 1) / block;
    const int down = (area_.height() + block - 1) / block;
    const float not_its = 0.2f * known_.squaredNorm();
    Patches made{Eigen::ArrayXXi::Zero(down, across), Eigen::ArrayXXi::Zero(down, across), 0};
    const Eigen::VectorXf others = neighbours();
    Eigen::ArrayXXf frequency = Eigen::ArrayXXf::Zero(down, across);  // of its colours, summed
    Eigen::ArrayXXf foreign = frequency;                              // the same beside it
    area_.visit(inside_, [&](int x, int y) {
      if (taken(x, y)) return;
      ++made.pixels(row(y), column(x));
      frequency(row(y), column(x)) += known_[frame_.colours.at(x, y)];
      foreign(row(y), column(x)) += others[frame_.colours.at(x, y)];
    });
    const auto strange = [&](int r, int c) {
      return r >= 0 && c >= 0 && r < down && c < across && made.label(r, c) == 0 &&
             made.pixels(r, c) > 0 &&
             (frequency(r, c) < not_its * static_cast<float>(made.pixels(r, c)) ||
              foreign(r, c) > 2 * frequency(r, c));
    };
    for (int r = 0; r < down; ++r)
      for (int c = 0; c < across; ++c) {
        if (!strange(r, c)) continue;
        std::vector<std::pair<int, int>> patch{{r, c}};
        made.label(r, c) = ++made.count;
        for (std::size_t i = 0; i < patch.size(); ++i)
          for (const auto& [dr, dc] :
               {std::pair(0, 1), std::pair(1, 0), std::pair(0, -1), std::pair(-1, 0)}) {
            const int next_row = patch[i].first + dr, next_column = patch[i].second + dc;
            if (!strange(next_row, next_column)) continue;
            made.label(next_row, next_column) = made.count;
            patch.push_back({next_row, next_column});
          }
      }
    return made;
  }

  bool beside(const Patches& patches, int k, int x, int y) const {
    const int last_row = static_cast<int>(patches.label.rows()) - 1;
    const int last_column = static_cast<int>(patches.label.cols()) - 1;
    for (int r = std::max(0, row(y) - 1); r <= std::min(row(y) + 1, last_row); ++r)
      for (int c = std::max(0, column(x) - 1); c <= std::min(column(x) + 1, last_column); ++c)
        if (patches.label(r, c) == k) return true;
    return false;
  }

  /// Marks a patch and what is of its colours around it, if it goes on outside.
  void hide(const Patches& patches, int k) {
    Eigen::VectorXf patch = Eigen::VectorXf::Zero(bin_count), object = patch;
    std::vector<std::uint8_t> within(hidden_.size(), 0);
    area_.visit(inside_, [&](int x, int y) {
      within[area_.index(x, y)] = 1;
      if (taken(x, y)) return;
      const int label = patches.label(row(y), column(x));
      if (label == k) patch[bin(x, y)] += 1;
      if (label == 0) object[bin(x, y)] += 1;
    });
    smooth(patch);
    smooth(object);
    const auto alike = [&](int x, int y) {
      const auto b = bin(x, y);
      return patch[b] > 2 * frame_.bin_share[b] && patch[b] > 2 * object[b];
    };
    // Does it cross the outline? Of the pixels just outside, beside the patch, many are like it.
    int outside = 0, crossing = 0;
    area_.visit(around_, [&](int x, int y) {
      if (within[area_.index(x, y)] || taken(x, y) || !beside(patches, k, x, y)) return;
      ++outside;
      crossing += alike(x, y);
    });
    if (outside == 0 || crossing < 0.4 * outside) return;
    area_.visit(around_, [&](int x, int y) {
      if (patches.label(row(y), column(x)) == k || alike(x, y)) hidden_[area_.index(x, y)] = 1;
    });
  }

  const FittingImage& frame_;
  const Area& area_;
  const Silhouette& inside_;
  const Silhouette& around_;
  const Eigen::VectorXf& known_;
  std::vector<std::uint8_t> hidden_;
};

}  // namespace

std::vector<std::uint8_t> find_hidden(const FittingImage& frame, const Area& area,
                                      const Silhouette& inside, const Silhouette& around,
                                      const Eigen::VectorXf& known_colours) {
  return Finder(frame, area, inside, around, known_colours).run();
}

}  // namespace prehend::recognition
