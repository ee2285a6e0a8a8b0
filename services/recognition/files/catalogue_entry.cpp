#include "services/recognition/files/catalogue_entry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "common/base/file_text.hpp"

namespace prehend::recognition {

namespace {

/// By the catalogue of this text, if it is one.
Expected<void> replace(const std::filesystem::path& file, const std::string& text) {
  const std::filesystem::path fresh = file.string() + ".new";
  std::ofstream out(fresh);
  out << text;
  out.close();
  if (!out) return fail("cannot be written", fresh.string(), "is the place writable?");
  std::error_code error;
  if (const auto after = model::Catalogue::load(fresh); !after) {
    std::filesystem::remove(fresh, error);
    return fail(after.error().what, file.string());
  }
  std::filesystem::rename(fresh, file, error);
  if (error) return fail(error.message(), file.string(), "is the place writable?");
  return {};
}

}  // namespace

model::CatalogueObject described_by(const std::string& name, const model::Shape& shape, double mass,
                                    const std::vector<TrainingView>& views) {
  std::vector<Eigen::Vector3f> samples;
  Random random(1);
  for (const TrainingView& view : views)
    for (int i = 0; i < 400; ++i) {
      const std::size_t p = random.index(view.picture.pixels());
      const std::uint8_t* rgb = &view.picture.rgb[3 * p];
      if (view.mask.values[p]) samples.push_back(Eigen::Vector3f(rgb[0], rgb[1], rgb[2]) / 255.f);
    }
  model::CatalogueObject made;
  made.name = name;
  made.shape = shape;
  made.mass = mass;
  made.material = "plastic";
  made.appearance.pattern = "blobs";
  made.appearance.seed = 1;
  const Palette main = Palette::learn({}, samples, 3, 1);
  for (const Eigen::Vector3f& colour : main.centres())
    made.appearance.colours.push_back(colour.cast<double>());
  return made;
}

Expected<void> copy_catalogue(const std::filesystem::path& from, const std::filesystem::path& to) {
  const auto catalogue = model::Catalogue::load(from);
  if (!catalogue) return tl::unexpected(catalogue.error());
  const auto copy = [](const std::filesystem::path& file,
                       const std::filesystem::path& kept) -> Expected<void> {
    std::error_code error;
    if (kept.has_parent_path()) std::filesystem::create_directories(kept.parent_path(), error);
    std::filesystem::copy_file(file, kept, std::filesystem::copy_options::skip_existing, error);
    if (error)
      return fail(error.message(), kept.string(), "it would begin as a copy of " + file.string());
    return {};
  };
  // The catalogue last: one without its meshes cannot be read.
  for (const model::CatalogueObject& object : catalogue->objects()) {
    const std::filesystem::path mesh = object.mesh_file.lexically_normal();
    if (!object.mesh || mesh.is_absolute()) continue;
    if (*mesh.begin() == "..")
      return fail("the mesh of " + object.name + " lies outside the catalogue's folder",
                  from.string(), "move " + mesh.filename().string() + " into it");
    if (auto copied = copy(from.parent_path() / mesh, to.parent_path() / mesh); !copied)
      return copied;
  }
  return copy(from, to);
}

Expected<void> append_to_catalogue(const std::filesystem::path& file,
                                   const model::CatalogueObject& object,
                                   const std::optional<MeshFile>& mesh) {
  const auto before = model::Catalogue::load(file);
  if (!before) return tl::unexpected(before.error());
  if (before->find(object.name))
    return fail(object.name + " is there already", file.string(), "choose another name");
  auto read = read_file(file);
  if (!read) return tl::unexpected(read.error());
  std::string text = std::move(*read);
  const Eigen::Vector3d& size = object.shape.size;
  text += fmt::format(
      "\n[[object]]\nname = \"{}\"\nshape = \"{}\"\nsize = [{:.4f}, {:.4f}, {:.4f}]\n"
      "mass = {:.3f}\nmaterial = \"{}\"\n",
      object.name, model::to_string(object.shape.kind), size.x(), size.y(), size.z(), object.mass,
      object.material);
  if (mesh)
    text += fmt::format("mesh = \"{}\"\nmesh_scale = {}\n",
                        object.name + mesh->file.extension().string(), mesh->scale);
  text += "[object.appearance]\ncolours = [";
  for (std::size_t i = 0; i < object.appearance.colours.size(); ++i) {
    const Eigen::Vector3d& c = object.appearance.colours[i];
    text += fmt::format("{}[{:.2f}, {:.2f}, {:.2f}]", i == 0 ? "" : ", ", c.x(), c.y(), c.z());
  }
  text += fmt::format("]\npattern = \"{}\"\nseed = {}\n", object.appearance.pattern,
                      object.appearance.seed);
  // Beside the real file, which may be reached through a link.
  std::error_code error;
  const auto real = std::filesystem::canonical(file, error);
  if (!mesh) return replace(real, text);
  const auto kept = real.parent_path() / (object.name + mesh->file.extension().string());
  std::filesystem::copy_file(mesh->file, kept, error);
  if (error) return fail(error.message(), kept.string(), "is there a mesh of that name already?");
  auto replaced = replace(real, text);
  if (!replaced) std::filesystem::remove(kept, error);
  return replaced;
}

}  // namespace prehend::recognition
