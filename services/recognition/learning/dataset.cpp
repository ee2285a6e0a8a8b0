#include "dataset.hpp"

#include <algorithm>
#include <prehend/recognition_picture/picture_file.hpp>

namespace prehend::recognition {

Expected<TrainingView> load_view(const std::filesystem::path& file) {
  auto picture = load_picture(file);
  if (!picture) return tl::unexpected(picture.error());
  TrainingView view{shrink(*picture, view_side), {}};
  const auto beside = file.parent_path() / (file.stem().string() + ".mask.png");
  std::error_code error;
  if (!std::filesystem::exists(beside, error)) {
    view.mask = centred_mask(view.picture.width, view.picture.height);
    return view;
  }
  const auto mask = load_mask(beside);
  if (!mask) return tl::unexpected(mask.error());
  if (mask->width != picture->width || mask->height != picture->height)
    return fail("has another size than its picture", beside.string());
  view.mask = shrink_mask(*mask, view.picture.width, view.picture.height);
  return view;
}

Expected<std::vector<ClassFolder>> class_folders(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<ClassFolder> found;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    if (entry.is_directory())
      found.push_back({entry.path().filename().string(), pictures_in(entry.path())});
  std::erase_if(found, [](const ClassFolder& c) { return c.files.empty(); });
  if (found.empty())
    return fail("has no folder with pictures", folder.string(), "a folder a class is wanted");
  std::sort(found.begin(), found.end(),
            [](const ClassFolder& a, const ClassFolder& b) { return a.name < b.name; });
  return found;
}

}  // namespace prehend::recognition
