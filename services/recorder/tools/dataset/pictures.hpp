#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "services/recorder/tools/dataset/dataset.hpp"

namespace prehend::recorder::dataset {

/// A picture: red, green, blue of each pixel, rows from the top.
struct Rgb {
  Size size;
  std::vector<std::uint8_t> bytes;
};

/// The recorded pictures of a camera in an episode, in order, each once: as they were compressed.
/// `take` is given the place of the picture (see Rows::pictures).
Expected<void> read_pictures(
    const RecordedEpisode& episode, const std::string& camera,
    const std::function<Expected<void>(std::size_t place, std::vector<std::uint8_t>)>& take);

/// The picture of every row, at this size. One that cannot be decoded is the one before; fails
/// where there is none.
Expected<void> read_rows(const RecordedEpisode& episode, const std::string& camera, Size size,
                         const std::function<Expected<void>(const Rgb&)>& take);

/// Decodes jpeg and png.
class PictureDecoder {
 public:
  PictureDecoder();
  ~PictureDecoder();
  /// Without a size: as large as it is.
  Expected<Rgb> decode(const std::vector<std::uint8_t>& bytes, Size size = {});

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace prehend::recorder::dataset
