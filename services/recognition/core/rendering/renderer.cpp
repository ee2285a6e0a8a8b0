#include "services/recognition/core/rendering/renderer.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "common/base/random.hpp"

namespace prehend::recognition {

using Eigen::Vector3d;
using Eigen::Vector3f;

struct Renderer::Solid {
  model::Shape shape;
  const Texture* texture;
  Pose X_WO;
  double radius;  // of the sphere around it
};

namespace {

constexpr double far_away = std::numeric_limits<double>::infinity();

struct Hit {
  double t = far_away;
  Vector3d normal_O = Vector3d::UnitZ();
};

/// First meeting of a ray with a box centred on the origin (slabs).
Hit hit_box(const Vector3d& half, const Vector3d& p, const Vector3d& d) {
  double enter = -far_away, leave = far_away;
  int axis = 0;
  for (int i = 0; i < 3; ++i) {
    const double inverse = 1 / (std::abs(d[i]) > 1e-12 ? d[i] : 1e-12);
    double a = (-half[i] - p[i]) * inverse, b = (half[i] - p[i]) * inverse;
    if (a > b) std::swap(a, b);
    if (a > enter) {
      enter = a;
      axis = i;
    }
    leave = std::min(leave, b);
  }
  Hit hit;
  if (enter > leave || enter <= 1e-6) return hit;
  hit.t = enter;
  hit.normal_O = Vector3d::Zero();
  hit.normal_O[axis] = d[axis] > 0 ? -1 : 1;
  return hit;
}

/// The same for a cylinder or cone along z: (distance from the axis)² = radius(z)² is quadratic.
Hit hit_round(const model::Shape& shape, const Vector3d& p, const Vector3d& d) {
  const double half = shape.size.z() / 2, rise = model::slope(shape);
  const double radius = model::radius_at(shape, 0) + rise * p.z();
  Hit hit;
  const double a = d.x() * d.x() + d.y() * d.y() - rise * rise * d.z() * d.z();
  const double b = p.x() * d.x() + p.y() * d.y() - rise * d.z() * radius;
  const double c = p.x() * p.x() + p.y() * p.y() - radius * radius;
  const double discriminant = b * b - a * c;
  if (std::abs(a) > 1e-12 && discriminant >= 0) {
    // Of both roots the one where the ray goes in, which no mirror image of a cone counts for.
    const double t = (-b - std::sqrt(discriminant)) / a;
    const double z = p.z() + t * d.z(), r = radius + rise * t * d.z();
    if (t > 1e-6 && std::abs(z) <= half && r > 0) {
      hit.t = t;
      hit.normal_O =
          Vector3d(p.x() + t * d.x(), p.y() + t * d.y(), -rise * r) / (r * std::hypot(1, rise));
    }
  }
  if (std::abs(d.z()) > 1e-12) {
    const double end = d.z() > 0 ? -half : half, r = model::radius_at(shape, end);
    const double t = (end - p.z()) / d.z();
    const double x = p.x() + t * d.x(), y = p.y() + t * d.y();
    if (t > 1e-6 && t < hit.t && x * x + y * y <= r * r) {
      hit.t = t;
      hit.normal_O = Vector3d(0, 0, end > 0 ? 1 : -1);
    }
  }
  return hit;
}

Hit hit_sphere(double radius, const Vector3d& p, const Vector3d& d) {
  Hit hit;
  const double b = p.dot(d), discriminant = b * b - (p.squaredNorm() - radius * radius);
  if (discriminant < 0) return hit;
  const double t = -b - std::sqrt(discriminant);
  if (t <= 1e-6) return hit;
  hit.t = t;
  hit.normal_O = (p + t * d) / radius;
  return hit;
}

/// Linear albedo where the surface has that point and normal.
Vector3f albedo(const model::Shape& shape, const Texture& texture, const Vector3d& p_O,
                const Vector3d& n_O) {
  const Vector3d half = model::half_extents(shape);
  const double up = (p_O.z() + half.z()) / (2 * half.z());
  // The wall of a flat cone faces up, too, but not straight.
  const bool flat = std::abs(n_O.z()) > (shape.kind == model::ShapeKind::cone ? 0.999 : 0.5);
  const Vector3d unit = (p_O.cwiseQuotient(half) + Vector3d::Ones()) / 2;
  if (shape.kind == model::ShapeKind::box) {
    if (flat) return texture.faces[4].at(unit.x(), unit.y());
    if (n_O.x() > 0.5) return texture.faces[0].at(unit.y(), up);
    if (n_O.y() > 0.5) return texture.faces[1].at(1 - unit.x(), up);
    if (n_O.x() < -0.5) return texture.faces[2].at(1 - unit.y(), up);
    return texture.faces[3].at(unit.x(), up);
  }
  if (flat && model::is_upright_round(shape.kind)) return texture.faces[1].at(unit.x(), unit.y());
  const double turn = std::atan2(p_O.y(), p_O.x()) / (2 * std::numbers::pi);
  return texture.faces[0].at(turn < 0 ? turn + 1 : turn, up);
}

/// Linear to 8-bit sRGB by table.
class Encoder {
 public:
  Encoder() {
    for (std::size_t i = 0; i < table_.size(); ++i)
      table_[i] = static_cast<std::uint8_t>(std::lround(
          255 * to_srgb(static_cast<float>(i) / static_cast<float>(table_.size() - 1))));
  }
  std::uint8_t operator()(float linear) const {
    const float scaled = std::clamp(linear, 0.f, 1.f) * static_cast<float>(table_.size() - 1);
    return table_[static_cast<std::size_t>(scaled + 0.5f)];
  }

 private:
  std::array<std::uint8_t, 8192> table_;
};

std::uint32_t hash(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352du;
  x ^= x >> 15;
  x *= 0x846ca68bu;
  return x ^ (x >> 16);
}

/// 1-2-1 in both directions, in place: the lens.
void blur(std::vector<Vector3f>& light, int width, int height) {
  const auto w = static_cast<std::size_t>(width), h = static_cast<std::size_t>(height);
  for (std::size_t y = 0; y < h; ++y) {
    Vector3f before = light[y * w];
    for (std::size_t x = 0; x < w; ++x) {
      const Vector3f here = light[y * w + x];
      const Vector3f& after = light[y * w + std::min(x + 1, w - 1)];
      light[y * w + x] = (before + 4 * here + after) / 6;
      before = here;
    }
  }
  std::vector<Vector3f> above(light.begin(), light.begin() + width);
  for (std::size_t y = 0; y < h; ++y)
    for (std::size_t x = 0; x < w; ++x) {
      const Vector3f here = light[y * w + x];
      const Vector3f& below = light[std::min(y + 1, h - 1) * w + x];
      light[y * w + x] = (above[x] + 4 * here + below) / 6;
      above[x] = here;
    }
}

}  // namespace

Renderer::Renderer(const std::vector<model::CatalogueObject>& objects) {
  for (const model::CatalogueObject& object : objects)
    known_.emplace(object.name, std::pair(object.shape, paint(object)));
}

std::vector<Renderer::Solid> Renderer::solids(const model::Scene& scene) const {
  std::vector<Solid> made;
  for (const model::PlacedObject& placed : scene.objects) {
    const auto found = known_.find(placed.name);
    if (found == known_.end()) continue;
    const auto& [shape, texture] = found->second;
    made.push_back({shape, &texture, placed.X_WO, model::half_extents(shape).norm()});
  }
  return made;
}

namespace {

template <class Solid>
Hit hit_solid(const Solid& solid, const Vector3d& p_W, const Vector3d& d_W) {
  const Vector3d to_centre = solid.X_WO.translation() - p_W;
  const double along = to_centre.dot(d_W);
  if (to_centre.squaredNorm() - along * along > solid.radius * solid.radius) return {};
  const auto R_OW = solid.X_WO.linear().transpose();
  const Vector3d p = R_OW * -to_centre, d = R_OW * d_W;
  switch (solid.shape.kind) {
    case model::ShapeKind::box:
      return hit_box(solid.shape.size / 2, p, d);
    case model::ShapeKind::cylinder:
    case model::ShapeKind::cone:
      return hit_round(solid.shape, p, d);
    case model::ShapeKind::sphere:
      return hit_sphere(solid.shape.size.x(), p, d);
    case model::ShapeKind::unknown:
      break;
  }
  return {};
}

/// What lies under and behind the objects.
class Surroundings {
 public:
  explicit Surroundings(const model::Scene& scene) : seed_(scene.texture_seed) {
    Random random(seed_);
    const auto linear = [](const Vector3d& c) -> Vector3f {
      return c.cast<float>().cwiseMax(0.f).cwiseMin(1.f).unaryExpr(&to_linear);
    };
    table_ = linear(scene.table_colour);
    floor_ = linear(
        Vector3d::Constant(random.uniform(0.25, 0.6)) +
        0.12 * Vector3d(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5));
    grain_turn_ = random.uniform(0, std::numbers::pi);
    grain_ = random.uniform(0.04, 0.12);
    stretch_ = random.uniform(1.0, 6.0);
  }
  Vector3f table(double x, double y) const {
    const double c = std::cos(grain_turn_), s = std::sin(grain_turn_);
    const double u = (c * x + s * y) / 0.02, v = (c * y - s * x) / (0.02 / stretch_);
    const double n =
        0.6 * value_noise(u, v, seed_) + 0.4 * value_noise(3.1 * u, 3.1 * v, seed_ + 1);
    const double broad = value_noise(x / 0.3, y / 0.3, seed_ + 2);
    return table_ * static_cast<float>(1 + grain_ * n + 0.05 * broad);
  }
  Vector3f floor(double x, double y) const {
    return floor_ * static_cast<float>(1 + 0.15 * value_noise(x / 0.12, y / 0.12, seed_ + 3));
  }

 private:
  std::uint64_t seed_;
  Vector3f table_, floor_;
  double grain_turn_, grain_, stretch_;
};

/// The table's top in W, m; beyond it is the floor.
constexpr double table_x = 0.75, table_near = -0.60, table_far = 0.70, floor_z = -0.72;

/// What a ray of light brings to the camera. Keeps a reference to the bodies.
template <class Solid>
class Tracer {
 public:
  Tracer(const std::vector<Solid>& bodies, const model::Scene& scene, const Vector3d& eye,
         double light_radius)
      : bodies_(bodies),
        surroundings_(scene),
        eye_(eye),
        light_radius_(light_radius),
        lamp_(scene.light.to_light_W.normalized()),
        lamp_u_(lamp_.unitOrthogonal()),
        lamp_v_(lamp_.cross(lamp_u_)),
        ambient_(static_cast<float>(scene.light.ambient)),
        shine_((scene.light.colour * scene.light.gain).cast<float>()) {}

  /// d: unit, from the eye into the scene. noise: random bits for this ray.
  Vector3f trace(const Vector3d& d, std::uint32_t noise) const {
    Hit best;
    const Solid* nearest = nullptr;
    for (const Solid& body : bodies_) {
      const Hit hit = hit_solid(body, eye_, d);
      if (hit.t < best.t) {
        best = hit;
        nearest = &body;
      }
    }
    const double t_table = d.z() < -1e-9 ? -eye_.z() / d.z() : far_away;
    if (nearest && best.t < t_table) {
      const Vector3d p_W = eye_ + best.t * d;
      const Vector3d p_O = nearest->X_WO.inverse() * p_W;
      const Vector3d normal_W = nearest->X_WO.linear() * best.normal_O;
      return shade(albedo(nearest->shape, *nearest->texture, p_O, best.normal_O),
                   normal_W.dot(lamp_), p_W, normal_W, noise);
    }
    if (t_table == far_away) return surroundings_.floor(d.x() * 3, d.z() * 3).cwiseProduct(shine_);
    const Vector3d p = eye_ + t_table * d;
    if (std::abs(p.x()) < table_x && p.y() > table_near && p.y() < table_far)
      return shade(surroundings_.table(p.x(), p.y()), lamp_.z(), p, Vector3d::UnitZ(), noise);
    const double t_floor = (floor_z - eye_.z()) / d.z();
    const Vector3d q = eye_ + t_floor * d;
    return surroundings_.floor(q.x(), q.y()).cwiseProduct(shine_) * (0.6f * ambient_ + 0.2f);
  }

 private:
  /// Share of the lamp seen from a point, by four rays to a lamp of some size.
  float lit(const Vector3d& p_W, std::uint32_t noise) const {
    bool near = false;
    for (const Solid& body : bodies_) {
      const Vector3d to = body.X_WO.translation() - p_W;
      const double along = to.dot(lamp_);
      const double reach = body.radius + light_radius_ * std::max(0.0, along);
      near = near || (along > -body.radius && to.squaredNorm() - along * along < reach * reach);
    }
    if (!near) return 1.f;
    constexpr int rays = 4;
    int free = 0;
    for (int i = 0; i < rays; ++i) {
      const double angle = 2 * std::numbers::pi * (i + (noise & 0xff) / 256.0) / rays;
      const double r = light_radius_ * std::sqrt((i + ((noise >> 8) & 0xff) / 256.0) / rays);
      const Vector3d d =
          (lamp_ + r * (std::cos(angle) * lamp_u_ + std::sin(angle) * lamp_v_)).normalized();
      const bool hidden = std::any_of(bodies_.begin(), bodies_.end(), [&](const Solid& body) {
        return hit_solid(body, p_W, d).t < far_away;
      });
      if (!hidden) ++free;
    }
    return static_cast<float>(free) / rays;
  }

  /// `facing` is the cosine between normal and lamp; the table under the lamp gets all of it.
  Vector3f shade(const Vector3f& colour, double facing, const Vector3d& p_W,
                 const Vector3d& normal_W, std::uint32_t noise) const {
    const float direct = facing > 0 ? lit(p_W + 1e-4 * normal_W, noise) : 0.f;
    const float amount =
        ambient_ + (1 - ambient_) * direct * static_cast<float>(std::max(0.0, facing));
    return colour.cwiseProduct(shine_) * amount;
  }

  const std::vector<Solid>& bodies_;
  Surroundings surroundings_;
  Vector3d eye_;
  double light_radius_;
  Vector3d lamp_, lamp_u_, lamp_v_;  // towards the lamp, and across
  float ambient_;
  Vector3f shine_;
};

/// Where several samples a pixel pay: the rectangles around the objects.
template <class Solid>
Plane around_objects(const std::vector<Solid>& bodies, const CameraModel& camera) {
  Plane fine(camera.width, camera.height);
  for (const Solid& body : bodies) {
    Eigen::Array2d low(1e9, 1e9), high(-1e9, -1e9);
    const Vector3d half = model::half_extents(body.shape);
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
      const auto pixel = camera.project(body.X_WO * half.cwiseProduct(sign));
      low = low.min(pixel ? pixel->array() : Eigen::Array2d(0, 0));
      high = high.max(pixel ? pixel->array() : Eigen::Array2d(camera.width, camera.height));
    }
    low = low.max(-1e6), high = high.min(1e6);
    for (int y = std::max(0, int(low.y()) - 2); y < std::min(camera.height, int(high.y()) + 3); ++y)
      for (int x = std::max(0, int(low.x()) - 2); x < std::min(camera.width, int(high.x()) + 3);
           ++x)
        fine.at(x, y) = 1;
  }
  return fine;
}

}  // namespace

Picture Renderer::render_still(const model::Scene& scene, const CameraModel& camera,
                               const RenderOptions& options) const {
  const std::vector<Solid> bodies = solids(scene);
  const Tracer tracer(bodies, scene, camera.X_WC.translation(), options.light_radius);
  const auto trace = [&](double px, double py, std::uint32_t noise) {
    return tracer.trace(camera.ray({px, py}), noise);
  };
  const Plane fine = around_objects(bodies, camera);

  std::vector<Vector3f> light(static_cast<std::size_t>(camera.width) *
                              static_cast<std::size_t>(camera.height));
  const int side = options.samples >= 4 ? 2 : 1;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const std::size_t index = fine.index(x, y);
      const auto noise = hash(static_cast<std::uint32_t>(index));
      if (!fine.values[index] || side == 1) {
        light[index] = trace(x, y, noise);
        continue;
      }
      Vector3f sum = Vector3f::Zero();
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i)
          sum +=
              trace(x - 0.25 + 0.5 * i, y - 0.25 + 0.5 * j, hash(noise + 4u * unsigned(2 * j + i)));
      light[index] = sum / static_cast<float>(side * side);
    }
  blur(light, camera.width, camera.height);

  static const Encoder encode;
  Picture made(camera.width, camera.height);
  for (std::size_t i = 0; i < light.size(); ++i)
    for (int c = 0; c < 3; ++c) made.rgb[3 * i + static_cast<std::size_t>(c)] = encode(light[i][c]);
  return made;
}

void Renderer::add_noise(Picture& picture, double sigma, std::uint64_t seed) {
  // A table of normal deviates and a fast walk through it: a fresh normal for every pixel would
  // take longer than the rendering.
  static const auto deviates = [] {
    std::array<float, 8192> made;
    Random random(12345);
    for (float& value : made) value = static_cast<float>(random.normal());
    return made;
  }();
  auto state = static_cast<std::uint32_t>(seed * 2654435761u) | 1u;
  const auto scale = static_cast<float>(sigma);
  for (std::uint8_t& value : picture.rgb) {
    state = state * 1664525u + 1013904223u;
    const float noisy = static_cast<float>(value) + scale * deviates[state >> 19];
    value = static_cast<std::uint8_t>(std::clamp(noisy + 0.5f, 0.f, 255.f));
  }
}

Picture Renderer::render(const model::Scene& scene, const CameraModel& camera,
                         const RenderOptions& options) const {
  Picture made = render_still(scene, camera, options);
  if (options.sensor_noise > 0) add_noise(made, options.sensor_noise, options.noise_seed);
  return made;
}

Plane Renderer::mask(const model::Scene& scene, std::size_t object,
                     const CameraModel& camera) const {
  const std::vector<Solid> bodies = solids(scene);
  Plane made(camera.width, camera.height);
  if (object >= bodies.size()) return made;
  const Vector3d eye = camera.X_WC.translation();
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const Vector3d d = camera.ray({double(x), double(y)});
      double nearest = far_away;
      std::size_t which = bodies.size();
      for (std::size_t i = 0; i < bodies.size(); ++i) {
        const Hit hit = hit_solid(bodies[i], eye, d);
        if (hit.t >= nearest) continue;
        nearest = hit.t;
        which = i;
      }
      made.at(x, y) = which == object;
    }
  return made;
}

}  // namespace prehend::recognition
