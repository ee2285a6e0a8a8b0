#include "common/model/catalogue.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "common/base/printable.hpp"
#include "common/base/toml_document.hpp"

namespace prehend::model {
namespace {

std::optional<Eigen::Vector3d> three_numbers(const toml::node_view<const toml::node>& node) {
  const toml::array* array = node.as_array();
  if (!array || array->size() != 3) return std::nullopt;
  Eigen::Vector3d v;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto number = array->at(i).value<double>();
    if (!number) return std::nullopt;
    v[static_cast<Eigen::Index>(i)] = *number;
  }
  return v;
}

/// What is round has one radius, however often it is written.
Expected<void> check_round(const Shape& shape) {
  const Eigen::Vector3d& r = shape.size;
  const bool sphere = shape.kind == ShapeKind::sphere, cylinder = shape.kind == ShapeKind::cylinder;
  if ((!sphere && !cylinder) || (r.x() == r.y() && (cylinder || r.y() == r.z()))) return {};
  return fail(
      fmt::format("a {} has one radius, these are [{:g}, {:g}, {:g}]", to_string(shape.kind), r.x(),
                  r.y(), r.z()),
      {},
      sphere ? "write it three times" : "size is radius, radius, height; what widens is a cone");
}

/// As large as the shape that bounds it, within rounding of what people write.
bool fills(const Mesh& mesh, const Shape& shape) {
  constexpr double tolerance = 0.0015;  // m
  const Eigen::Vector3d off = bounds(mesh).sizes() - 2 * half_extents(shape);
  return off.cwiseAbs().maxCoeff() <= tolerance;
}

/// beside: the folder that names of files are relative to.
Expected<std::shared_ptr<const Mesh>> read_mesh(const toml::table& table, const Shape& shape,
                                                const std::filesystem::path& beside) {
  const std::string name = table["mesh"].value_or("");
  if (name.empty()) return fail("mesh needs the name of a file");
  auto mesh = load_mesh(beside / name, table["mesh_scale"].value_or(1.0));
  if (!mesh) return tl::unexpected(mesh.error());
  const auto in_mm = [](const Eigen::Vector3d& size) {
    return fmt::format("{:.1f} x {:.1f} x {:.1f} mm", 1e3 * size.x(), 1e3 * size.y(),
                       1e3 * size.z());
  };
  if (!fills(*mesh, shape))
    return fail(fmt::format("mesh is {}, but the object is {}", in_mm(bounds(*mesh).sizes()),
                            in_mm(2 * half_extents(shape))),
                {}, "correct size, or set mesh_scale: 0.001 for a mesh in mm");
  return std::make_shared<const Mesh>(moved(*mesh, -bounds(*mesh).center()));
}

Expected<CatalogueObject> read_object(const toml::table& table,
                                      const std::filesystem::path& beside) {
  CatalogueObject object;
  object.name = table["name"].value_or("");
  if (object.name.empty() || object.name.size() > 64) return fail("needs a name of 1 to 64 bytes");
  const auto kind = shape_from_string(table["shape"].value_or(""));
  if (!kind || *kind == ShapeKind::unknown) return fail("shape is no " + shape_words());
  object.shape.kind = *kind;
  const auto size = three_numbers(table["size"]);
  if (!size) return fail("size needs three numbers in metres");
  object.shape.size = *size;
  if (!is_valid(object.shape)) return fail("sizes must be positive");
  constexpr double largest = 5, heaviest = 1000;  // m, kg
  if (object.shape.size.maxCoeff() > largest)
    return fail(fmt::format("its size is beyond {:g} m", largest), {}, "sizes are in metres");
  if (auto ok = check_round(object.shape); !ok) return tl::unexpected(ok.error());
  if (table.contains("mesh")) {
    auto mesh = read_mesh(table, object.shape, beside);
    if (!mesh) return tl::unexpected(mesh.error());
    object.mesh = std::move(*mesh);
    object.mesh_file = table["mesh"].value_or("");
  }
  object.mass = table["mass"].value_or(0.0);
  if (!(object.mass > 0)) return fail("mass must be positive, in kg");
  if (object.mass > heaviest)
    return fail(fmt::format("its mass is beyond {:g} kg", heaviest), {}, "masses are in kg");
  object.material = table["material"].value_or("");
  if (object.material.empty()) return fail("needs a material");

  object.appearance.pattern = table["appearance"]["pattern"].value_or("plain");
  object.appearance.seed = table["appearance"]["seed"].value_or(0u);
  if (const toml::array* colours = table["appearance"]["colours"].as_array())
    for (const toml::node& entry : *colours) {
      const auto colour = three_numbers(toml::node_view<const toml::node>(entry));
      if (!colour || colour->minCoeff() < 0 || colour->maxCoeff() > 1)
        return fail("a colour needs three numbers, 0 to 1");
      object.appearance.colours.push_back(*colour);
    }
  if (object.appearance.colours.empty()) object.appearance.colours.emplace_back(0.6, 0.6, 0.6);
  return object;
}

}  // namespace

Expected<Catalogue> Catalogue::load(const std::filesystem::path& file) {
  const auto document = load_toml(file, "an object catalogue is TOML");
  if (!document) return tl::unexpected(document.error());
  const toml::table& root = *document;
  const toml::array* entries = root["object"].as_array();
  if (!entries || entries->empty())
    return fail("has no [[object]]", file.string(), "list at least one object");
  Catalogue catalogue;
  for (const toml::node& entry : *entries) {
    const toml::table* table = entry.as_table();
    if (!table) return fail("object is no table", file.string(), "write [[object]]");
    auto object = read_object(*table, file.parent_path());
    const std::string where = fmt::format("{}: line {}", file.string(), table->source().begin.line);
    if (!object)
      return fail(fmt::format("object {}: {}", catalogue.objects_.size() + 1, object.error().what),
                  where, object.error().hint);
    if (catalogue.find(object->name))
      return fail("two objects named " + printable(object->name), where, "rename one");
    catalogue.objects_.push_back(std::move(*object));
  }
  return catalogue;
}

const CatalogueObject* Catalogue::find(std::string_view name) const {
  const auto found =
      std::find_if(objects_.begin(), objects_.end(),
                   [&](const CatalogueObject& object) { return object.name == name; });
  return found == objects_.end() ? nullptr : &*found;
}

}  // namespace prehend::model
