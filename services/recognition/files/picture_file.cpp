#include "services/recognition/files/picture_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "common/base/file_text.hpp"
#include "common/base/natural_order.hpp"

namespace prehend::recognition {
namespace {

constexpr std::size_t max_pixels = 40'000'000;

/// Pixels as they are stored, whatever an EXIF tag says of a turn: a lens is calibrated, a mask
/// drawn and a place computed in the pixels that the sensor gave.
constexpr int as_stored = cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION;

/// What `read` says, with OpenCV's exceptions (thrown for some broken files) as nothing.
template <class Read>
cv::Mat guarded(Read read) {
  try {
    return read();
  } catch (const cv::Exception&) {
    return {};
  }
}

Expected<Picture> from_bgr(const cv::Mat& image, const std::string& where) {
  if (image.empty() || image.type() != CV_8UC3)
    return fail("is no picture that can be read", where, picture_kinds);
  if (image.cols < 8 || image.rows < 8) return fail("is smaller than 8 px", where);
  if (static_cast<std::size_t>(image.total()) > max_pixels)
    return fail("has more than 40 million pixels", where, "make it smaller");
  Picture made(image.cols, image.rows);
  cv::Mat rgb(image.rows, image.cols, CV_8UC3, made.rgb.data());
  cv::cvtColor(image, rgb, cv::COLOR_BGR2RGB);
  return made;
}

Expected<void> write(const std::filesystem::path& file, const cv::Mat& image) {
  try {
    if (cv::imwrite(file.string(), image)) return {};
  } catch (const cv::Exception&) {
  }
  return fail("cannot be written", file.string(), "is the folder there and writable?");
}

cv::Mat view(const Picture& picture) {
  return cv::Mat(picture.height, picture.width, CV_8UC3,
                 const_cast<std::uint8_t*>(picture.rgb.data()));
}

/// Width times height from the header of a png or jpeg, so that a few bytes cannot ask for
/// gigabytes. Nothing for other formats.
std::optional<std::uint64_t> announced_pixels(std::span<const std::uint8_t> b) {
  const auto at = [&](std::size_t i) { return static_cast<std::uint64_t>(b[i]); };
  const auto two = [&](std::size_t i) { return at(i) << 8 | at(i + 1); };
  if (b.size() > 24 && b[0] == 0x89 && b[1] == 'P')
    return (two(16) << 16 | two(18)) * (two(20) << 16 | two(22));
  if (b.size() < 4 || b[0] != 0xff || b[1] != 0xd8) return std::nullopt;
  for (std::size_t i = 2; i + 9 < b.size() && b[i] == 0xff;) {
    const std::uint8_t marker = b[i + 1];
    if (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc)
      return two(i + 5) * two(i + 7);
    i += 2 + two(i + 2);
  }
  return std::nullopt;
}

/// A jpeg whose last mark is missing: what is lost would be grey.
bool is_cut_short(std::span<const std::uint8_t> b) {
  if (b.size() < 4 || b[0] != 0xff || b[1] != 0xd8) return false;
  std::size_t i = 2;
  while (i + 4 < b.size() && b[i] == 0xff && b[i + 1] != 0xda)
    i += 2 + (static_cast<std::size_t>(b[i + 2]) << 8 | b[i + 3]);
  constexpr std::array<std::uint8_t, 2> last{0xff, 0xd9};
  return i >= b.size() || std::search(b.begin() + static_cast<std::ptrdiff_t>(i), b.end(),
                                      last.begin(), last.end()) == b.end();
}

}  // namespace

Expected<Picture> decode_picture(std::span<const std::uint8_t> bytes, const std::string& where) {
  if (bytes.empty()) return fail("is empty", where);
  if (announced_pixels(bytes).value_or(0) > max_pixels)
    return fail("has more than 40 million pixels", where, "make it smaller");
  if (is_cut_short(bytes)) return fail("is a jpeg that ends early", where, "copy it again");
  return from_bgr(guarded([&] {
                    const cv::Mat raw(1, static_cast<int>(bytes.size()), CV_8UC1,
                                      const_cast<std::uint8_t*>(bytes.data()));
                    return cv::imdecode(raw, as_stored);
                  }),
                  where);
}

Expected<Picture> load_picture(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error))
    return fail("is no file", file.string(), "check the path");
  const auto size = std::filesystem::file_size(file, error);
  if (error || size > 256'000'000)
    return fail("is too large for a picture", file.string(), "more than 256 MB");
  const auto bytes = read_file(file);
  if (!bytes) return tl::unexpected(bytes.error());
  return decode_picture({reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size()},
                        file.string());
}

std::vector<std::uint8_t> encode_jpeg(const Picture& picture, int quality) {
  std::vector<std::uint8_t> bytes;
  if (picture.empty()) return bytes;
  cv::Mat bgr;
  cv::cvtColor(view(picture), bgr, cv::COLOR_RGB2BGR);
  cv::imencode(".jpg", bgr, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return bytes;
}

Expected<void> save_jpeg(const std::filesystem::path& file, const Picture& picture) {
  const std::vector<std::uint8_t> bytes = encode_jpeg(picture);
  std::ofstream stream(file, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  if (!bytes.empty() && stream.flush()) return {};
  return fail("cannot be written", file.string(), "is the folder there and writable?");
}

Expected<void> save_png(const std::filesystem::path& file, const Picture& picture) {
  cv::Mat bgr;
  cv::cvtColor(view(picture), bgr, cv::COLOR_RGB2BGR);
  return write(file, bgr);
}

Expected<void> save_png(const std::filesystem::path& file, const Plane& mask) {
  cv::Mat image(mask.height, mask.width, CV_8UC1, const_cast<std::uint8_t*>(mask.values.data()));
  return write(file, image * 255);
}

Expected<Plane> load_mask(const std::filesystem::path& file) {
  const auto picture = load_picture(file);
  if (!picture) return tl::unexpected(picture.error());
  Plane mask(picture->width, picture->height);
  for (std::size_t i = 0; i < mask.values.size(); ++i)
    mask.values[i] = picture->rgb[3 * i] > 127 ? 1 : 0;
  return mask;
}

void draw_frame(Picture& picture, double x, double y, double width, double height,
                const std::string& text) {
  cv::Mat image(picture.height, picture.width, CV_8UC3, picture.rgb.data());
  const cv::Scalar colour(255, 220, 0);
  const cv::Point corner(static_cast<int>(x), static_cast<int>(y));
  cv::rectangle(image,
                cv::Rect(corner, cv::Size(static_cast<int>(width), static_cast<int>(height))),
                colour, 2);
  cv::putText(image, text, corner + cv::Point(0, -6), cv::FONT_HERSHEY_SIMPLEX, 0.5, colour, 1,
              cv::LINE_AA);
}

Picture shrink(const Picture& picture, int longest) {
  const int side = std::max(picture.width, picture.height);
  if (side <= longest) return picture;
  const double factor = static_cast<double>(longest) / side;
  Picture made(std::max(1, static_cast<int>(picture.width * factor + 0.5)),
               std::max(1, static_cast<int>(picture.height * factor + 0.5)));
  cv::Mat target = view(made);
  cv::resize(view(picture), target, target.size(), 0, 0, cv::INTER_AREA);
  return made;
}

Plane shrink_mask(const Plane& mask, int width, int height) {
  Plane made(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      made.at(x, y) = mask.at(x * mask.width / width, y * mask.height / height);
  return made;
}

std::vector<std::filesystem::path> pictures_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> found;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    std::string ending = entry.path().extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    const bool picture = ending == ".jpg" || ending == ".jpeg" || ending == ".png" ||
                         ending == ".bmp" || ending == ".tif" || ending == ".tiff" ||
                         ending == ".webp" || ending == ".gif" || ending == ".heic" ||
                         ending == ".heif" || ending == ".avif";
    if (picture && entry.path().stem().extension() != ".mask") found.push_back(entry.path());
  }
  std::sort(found.begin(), found.end(), [](const auto& a, const auto& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  return found;
}

}  // namespace prehend::recognition
