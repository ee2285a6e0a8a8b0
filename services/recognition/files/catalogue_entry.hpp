#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "common/model/catalogue.hpp"
#include "services/recognition/core/learning/training.hpp"

namespace prehend::recognition {

/// An object as the views show it: its three main colours for rendering, no pattern.
model::CatalogueObject described_by(const std::string& name, const model::Shape& shape, double mass,
                                    const std::vector<TrainingView>& views);

/// A mesh as a catalogue has it: beside it, under the object's name.
struct MeshFile {
  std::filesystem::path file;
  double scale = 1;  // metres per unit of the file
};

/// A copy of a catalogue, with the meshes that lie beside it. What is there already stays.
Expected<void> copy_catalogue(const std::filesystem::path& from, const std::filesystem::path& to);

/// The object's [[object]] at the end of a catalogue file; whoever reads it meanwhile sees the old
/// one or the new one. Fails when it is there already or the catalogue could not be read then. The
/// mesh is copied beside the catalogue.
Expected<void> append_to_catalogue(const std::filesystem::path& file,
                                   const model::CatalogueObject& object,
                                   const std::optional<MeshFile>& mesh = {});

}  // namespace prehend::recognition
