#include "services/mapping/tools/benchmark/people.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>

#include "services/mapping/tools/benchmark/take_file.hpp"

namespace prehend::mapping {

namespace {

Expected<RealTake> load_recording(const std::filesystem::path& file) {
  if (file.extension() == ".csv") return load_real_take(file);
  if (file.extension() != ".mcap") return fail("is no recording", file.string());
  const auto postures = read_postures(file);
  if (!postures) return tl::unexpected(postures.error());
  RealTake take{file.stem().string(), postures->front().hand_scale, {}};
  for (const Posture& posture : *postures)
    if (features(posture.fingertips, posture.hand_scale))
      take.frames.push_back({to_seconds(posture.stamp.time_since_epoch()), posture.fingertips});
  if (take.frames.empty()) return fail("has no usable hand/posture", file.string());
  return take;
}

}  // namespace

Expected<std::vector<RealTake>> load_people(const std::filesystem::path& folder) {
  std::error_code error;
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    files.push_back(entry.path());
  if (error) return fail(error.message(), folder.string(), "is the path right?");
  std::ranges::sort(files);
  std::vector<RealTake> people;
  std::string first = "put CSV of Leap or of 21 landmarks, or MCAP with hand/posture there";
  for (const auto& file : files)
    if (auto take = load_recording(file))
      people.push_back(std::move(*take));
    else if (&file == &files.front())
      first = take.error().message();
  if (people.empty())
    return fail(
        fmt::format("none of its {} files is a usable recording of a right hand", files.size()),
        folder.string(), first);
  return people;
}

}  // namespace prehend::mapping
