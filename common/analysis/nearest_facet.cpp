#include "common/analysis/nearest_facet.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "common/base/random.hpp"

namespace prehend::analysis {
namespace {

using Eigen::VectorXd;

constexpr int most = 6;  // dimensions; fewer leave zeros at the end
// Lengths for a polytope scaled to size 1.
constexpr double joggle = 4e-12;     // of a coordinate
constexpr double tolerance = 3e-11;  // more than twice what a joggled vertex can have moved
constexpr double thinnest = 1e-9;
constexpr double max_size = 1e150;  // beyond, or below its inverse, products overflow
constexpr std::size_t max_facets = 2'000'000;
constexpr double infinity = std::numeric_limits<double>::infinity();

using Point = Eigen::Matrix<double, most, 1>;

/// A simplex of the hull's surface. neighbour[i] shares all vertices with it but vertex[i].
struct Facet {
  Point normal = Point::Zero();  // unit, outward
  double offset = 0;             // normal · x of its plane
  std::array<int, most> vertex{};
  std::array<int, most> neighbour{};
  double beyond = 0;  // distance of the point being added
  int seen_by = -1;   // the last point whose distance was taken

  double distance(const Point& p) const { return normal.dot(p) - offset; }
};

/// A growing hull of vertices in general position.
class Hull {
 public:
  Hull(int dimension, std::uint64_t seed) : dimension_(dimension), random_(seed) {}

  /// d + 1 points that span all dimensions.
  void begin(const std::vector<Point>& simplex);
  /// Facet with the least offset.
  int nearest() const {
    return static_cast<int>(std::min_element(offset_.begin(), offset_.end()) - offset_.begin());
  }
  const Facet& operator[](int facet) const { return facets_[static_cast<std::size_t>(facet)]; }
  /// A point beyond the given facet. False when rounding has made the surface inconsistent.
  bool add(const Point& point, int facet);
  std::size_t size() const { return facets_.size(); }

 private:
  struct Open {
    std::uint64_t key = 0;
    int facet = -1, side = 0;
    int generation = -1;
  };

  Facet& at(int facet) { return facets_[static_cast<std::size_t>(facet)]; }
  int add_vertex(const Point& point);
  int make_facet();
  bool join(const std::vector<int>& fresh, int apex);

  int dimension_;
  Random random_;
  std::vector<Point> vertices_;
  std::vector<std::uint64_t> keys_;  // a random one a vertex; a set of vertices has their xor
  std::vector<Facet> facets_;
  std::vector<double> offset_;  // of each facet; infinite for those gone
  std::vector<int> gone_, visible_, fresh_;
  std::vector<Open> open_;  // hash table of ridges that wait for their second facet
  int generation_ = 0;
};

int Hull::add_vertex(const Point& point) {
  vertices_.push_back(point);
  keys_.push_back(random_.bits());
  return static_cast<int>(vertices_.size()) - 1;
}

int Hull::make_facet() {
  if (!gone_.empty()) {
    const int facet = gone_.back();
    gone_.pop_back();
    return facet;
  }
  facets_.emplace_back();
  offset_.push_back(infinity);
  return static_cast<int>(facets_.size()) - 1;
}

void Hull::begin(const std::vector<Point>& simplex) {
  Point centre = Point::Zero();
  for (const Point& p : simplex) {
    add_vertex(p);
    centre += p / static_cast<double>(simplex.size());
  }
  for (int left_out = 0; left_out <= dimension_; ++left_out) {
    const int made = make_facet();
    Facet& facet = at(made);
    int n = 0;
    for (int v = 0; v <= dimension_; ++v) {
      if (v == left_out) continue;
      facet.vertex[static_cast<std::size_t>(n)] = v;
      facet.neighbour[static_cast<std::size_t>(n)] = v;  // facet v is the one without vertex v
      ++n;
    }
    // The normal is what the edges from the first vertex leave over.
    Eigen::MatrixXd edges(dimension_, dimension_ - 1);
    for (int k = 1; k < dimension_; ++k)
      edges.col(k - 1) =
          (simplex[static_cast<std::size_t>(facet.vertex[static_cast<std::size_t>(k)])] -
           simplex[static_cast<std::size_t>(facet.vertex[0])])
              .head(dimension_);
    const Eigen::MatrixXd q = Eigen::HouseholderQR<Eigen::MatrixXd>(edges).householderQ();
    facet.normal.head(dimension_) = q.col(dimension_ - 1);
    facet.offset = facet.normal.dot(simplex[static_cast<std::size_t>(facet.vertex[0])]);
    if (facet.distance(centre) > 0) {
      facet.normal = -facet.normal;
      facet.offset = -facet.offset;
    }
    offset_[static_cast<std::size_t>(made)] = facet.offset;
  }
}

bool Hull::add(const Point& point, int start) {
  const int apex = add_vertex(point);
  visible_.assign(1, start);
  fresh_.clear();
  at(start).beyond = at(start).distance(point);
  at(start).seen_by = apex;
  for (std::size_t k = 0; k < visible_.size(); ++k) {
    const int inner = visible_[k];
    for (int i = 0; i < dimension_; ++i) {
      const auto side = static_cast<std::size_t>(i);
      const int outer = at(inner).neighbour[side];
      Facet& beside = at(outer);
      if (beside.seen_by != apex) {
        beside.seen_by = apex;
        beside.beyond = beside.distance(point);
        if (beside.beyond > 0) visible_.push_back(outer);
      }
      if (beside.beyond > 0) continue;
      // The ridge between the two is on the horizon. The plane through it and the point is the
      // positive combination of their planes that vanishes there: no equations to solve, and its
      // normal points outward because theirs do.
      const int made = make_facet();
      const Facet& seen = at(inner);
      Facet& hidden = at(outer);
      Facet& facet = at(made);
      facet.vertex = seen.vertex;
      facet.vertex[side] = apex;
      facet.neighbour[side] = outer;
      facet.seen_by = apex;
      facet.normal = seen.beyond * hidden.normal - hidden.beyond * seen.normal;
      facet.offset = seen.beyond * hidden.offset - hidden.beyond * seen.offset;
      const double length = facet.normal.norm();
      if (!(length > 0)) return false;
      facet.normal /= length;
      facet.offset /= length;
      facet.beyond = 0;
      offset_[static_cast<std::size_t>(made)] = facet.offset;
      std::replace(hidden.neighbour.begin(), hidden.neighbour.begin() + dimension_, inner, made);
      fresh_.push_back(made);
    }
  }
  for (const int facet : visible_) {
    offset_[static_cast<std::size_t>(facet)] = infinity;
    gone_.push_back(facet);
  }
  return join(fresh_, apex);
}

bool Hull::join(const std::vector<int>& fresh, int apex) {
  std::size_t slots = 64;
  while (slots < 4 * fresh.size() * static_cast<std::size_t>(dimension_)) slots *= 2;
  if (open_.size() < slots) open_.assign(slots, {});
  const std::size_t mask = open_.size() - 1;
  ++generation_;
  std::size_t waiting = 0;
  for (const int index : fresh) {
    Facet& facet = at(index);
    std::uint64_t all = 0;
    for (int i = 0; i < dimension_; ++i)
      all ^= keys_[static_cast<std::size_t>(facet.vertex[static_cast<std::size_t>(i)])];
    for (int i = 0; i < dimension_; ++i) {
      const int vertex = facet.vertex[static_cast<std::size_t>(i)];
      if (vertex == apex) continue;
      const std::uint64_t key = all ^ keys_[static_cast<std::size_t>(vertex)];
      std::size_t slot = key & mask;
      while (open_[slot].generation == generation_ && open_[slot].key != key)
        slot = (slot + 1) & mask;
      Open& open = open_[slot];
      if (open.generation != generation_) {
        open = {key, index, i, generation_};
        ++waiting;
      } else {
        if (open.facet < 0) return false;  // a third facet at one ridge
        facet.neighbour[static_cast<std::size_t>(i)] = open.facet;
        at(open.facet).neighbour[static_cast<std::size_t>(open.side)] = index;
        open.facet = -1;
        --waiting;
      }
    }
  }
  return waiting == 0;
}

/// One attempt with one set of small displacements.
class Attempt {
 public:
  Attempt(int dimension, const Support& support, std::uint64_t seed)
      : dimension_(dimension), support_(support), random_(seed), hull_(dimension, seed + 1) {}

  enum class Outcome { found, flat, too_wide, too_many, inconsistent };
  Outcome run();
  NearestFacet result;

 private:
  Point farthest(const Point& direction) {
    Point p = Point::Zero();
    p.head(dimension_) = support_(direction.head(dimension_));
    return p / size_;
  }
  Point joggled(Point p) {
    for (int i = 0; i < dimension_; ++i) p[i] += random_.uniform(-joggle, joggle);
    return p;
  }
  std::optional<Outcome> span();

  int dimension_;
  const Support& support_;
  Random random_;
  Hull hull_;
  double size_ = 1;  // what the polytope is divided by: its largest coordinate
};

/// Begins the hull with a simplex of far points, unless the polytope is flat or has no fit size.
std::optional<Attempt::Outcome> Attempt::span() {
  double size = 0;
  for (int i = 0; i < dimension_; ++i) {
    const Point axis = Point::Unit(i);
    size = std::max({size, std::abs(farthest(axis)[i]), std::abs(farthest(-axis)[i])});
  }
  if (!(size > 1 / max_size)) return Outcome::flat;
  if (!(size < max_size)) return Outcome::too_wide;
  size_ = size;
  std::vector<Point> simplex{joggled(farthest(Point::Unit(0)))};
  Eigen::MatrixXd basis(dimension_, 0);  // orthonormal, of the space spanned so far
  while (static_cast<int>(simplex.size()) <= dimension_) {
    // The axis that is farthest from the span, made perpendicular to it.
    Eigen::Index axis = 0;
    (Eigen::VectorXd::Ones(dimension_) - basis.rowwise().squaredNorm()).maxCoeff(&axis);
    VectorXd direction = VectorXd::Unit(dimension_, axis);
    for (int twice = 0; twice < 2; ++twice) direction -= basis * (basis.transpose() * direction);
    Point u = Point::Zero();
    u.head(dimension_) = direction.normalized();
    const Point ahead = farthest(u), behind = farthest(-u);
    const double there = u.dot(ahead - simplex[0]), back = u.dot(simplex[0] - behind);
    if (!(std::max(there, back) > thinnest)) return Outcome::flat;
    simplex.push_back(joggled(there >= back ? ahead : behind));
    VectorXd edge = (simplex.back() - simplex[0]).head(dimension_);
    for (int twice = 0; twice < 2; ++twice) edge -= basis * (basis.transpose() * edge);
    basis.conservativeResize(Eigen::NoChange, basis.cols() + 1);
    basis.col(basis.cols() - 1) = edge.normalized();
  }
  hull_.begin(simplex);
  return std::nullopt;
}

Attempt::Outcome Attempt::run() {
  if (const auto failed = span()) return *failed;
  result.distance = infinity;
  for (;;) {
    const int nearest = hull_.nearest();
    const Point normal = hull_[nearest].normal;
    const double inner = hull_[nearest].offset;
    const Point vertex = farthest(normal);
    // Every plane that supports the polytope bounds the distance from above, the hull from below.
    if (const double outer = normal.dot(vertex); outer < result.distance) {
      result.distance = outer;
      result.normal = normal.head(dimension_);
    }
    if (result.distance <= 0 || inner >= result.distance - tolerance) {
      result.distance *= size_;
      return Outcome::found;
    }
    if (hull_.size() > max_facets) return Outcome::too_many;
    if (!hull_.add(joggled(vertex), nearest)) return Outcome::inconsistent;
  }
}

}  // namespace

Expected<std::optional<NearestFacet>> nearest_facet(int dimension, const Support& support) {
  if (dimension < 2 || dimension > most) return fail("a polytope needs 2 to 6 dimensions");
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    Attempt attempt(dimension, support, seed);
    switch (attempt.run()) {
      case Attempt::Outcome::found:
        return attempt.result;
      case Attempt::Outcome::flat:
        return std::optional<NearestFacet>();
      case Attempt::Outcome::too_wide:
        return fail("wrenches are too large to be measured");
      case Attempt::Outcome::too_many:
        return fail("the convex hull has too many facets", {}, "use fewer contacts or edges");
      case Attempt::Outcome::inconsistent:
        break;  // other displacements
    }
  }
  return fail("convex hull failed", {}, "the wrenches are nearly degenerate");
}

}  // namespace prehend::analysis
