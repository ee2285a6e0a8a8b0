#include "services/recognition/files/dataset.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "common/base/progress.hpp"
#include "services/recognition/files/picture_file.hpp"

namespace prehend::recognition {

namespace {

std::filesystem::path mask_of(const std::filesystem::path& file) {
  return file.parent_path() / (file.stem().string() + ".mask.png");
}

}  // namespace

Expected<TrainingView> load_view(const std::filesystem::path& file) {
  auto picture = load_picture(file);
  if (!picture) return tl::unexpected(picture.error());
  TrainingView view{shrink(*picture, view_side), {}};
  const auto beside = mask_of(file);
  std::error_code error;
  if (!std::filesystem::exists(beside, error)) {
    view.mask = centred_mask(view.picture.width, view.picture.height);
    return view;
  }
  const auto mask = load_mask(beside);
  if (!mask) return tl::unexpected(mask.error());
  if (mask->width != picture->width || mask->height != picture->height)
    return fail(fmt::format("has {}x{} px, its picture {}x{}", mask->width, mask->height,
                            picture->width, picture->height),
                beside.string(), "draw it over the pixels as stored, without the EXIF turn");
  view.mask = shrink_mask(*mask, view.picture.width, view.picture.height);
  return view;
}

Expected<std::vector<ClassFolder>> class_folders(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<ClassFolder> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.is_directory())
      found.push_back({entry.path().filename().string(), pictures_in(entry.path())});
  if (std::all_of(found.begin(), found.end(), [](const auto& c) { return c.files.empty(); }))
    return fail("has no folder with pictures", folder.string(), "a folder a class is wanted");
  std::sort(found.begin(), found.end(),
            [](const ClassFolder& a, const ClassFolder& b) { return a.name < b.name; });
  return found;
}

Expected<Dataset> load_dataset(const std::filesystem::path& folder) {
  const auto folders = class_folders(folder);
  if (!folders) return tl::unexpected(folders.error());
  std::size_t all = 0, done = 0;
  for (const ClassFolder& c : *folders) all += c.files.size();
  Dataset made;
  Progress progress("reading");
  for (const ClassFolder& c : *folders) {
    if (c.files.empty()) {
      made.left_out.push_back({"has no picture", (folder / c.name).string(), picture_kinds});
      continue;
    }
    made.classes.push_back({c.name, {}});
    made.files.emplace_back();
    for (const auto& file : c.files) {
      auto view = load_view(file);
      progress.show(++done, all);
      if (!view) {
        made.left_out.push_back(view.error());
        continue;
      }
      std::error_code error;
      made.masks = made.masks || std::filesystem::exists(mask_of(file), error);
      made.classes.back().views.push_back(std::move(*view));
      made.files.back().push_back(file);
    }
  }
  return made;
}

DescriptorOptions suited_options(const Dataset& dataset) {
  return dataset.masks ? DescriptorOptions{} : photos_of_objects();
}

}  // namespace prehend::recognition
