#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "common/base/error.hpp"
#include "services/recognition/core/picture/picture.hpp"

namespace prehend::recognition {

/// For messages.
inline constexpr const char* picture_kinds = "jpeg, png, bmp, tiff and webp are known";

/// Pictures as files and as bytes (jpeg, png, ...; grey, 16-bit and transparent ones become 8-bit
/// RGB, of an animation the first picture counts). Pixels stay where they are stored; EXIF turns
/// are ignored.
/// Refused: what cannot be read or is cut short, less than 8 px or more than 40 million pixels.
Expected<Picture> load_picture(const std::filesystem::path& file);
Expected<Picture> decode_picture(std::span<const std::uint8_t> bytes, const std::string& where);

/// `quality` of jpeg, 1 to 100; empty when the picture is.
std::vector<std::uint8_t> encode_jpeg(const Picture& picture, int quality = 92);
Expected<void> save_jpeg(const std::filesystem::path& file, const Picture& picture);
Expected<void> save_png(const std::filesystem::path& file, const Picture& picture);
Expected<void> save_png(const std::filesystem::path& file, const Plane& mask);
/// A mask that save_png wrote: 1 where the file is brighter than half.
Expected<Plane> load_mask(const std::filesystem::path& file);

/// A frame (px) and a line of text above it, for people to look at.
void draw_frame(Picture& picture, double x, double y, double width, double height,
                const std::string& text);

/// Made smaller, never larger, so that its longer side has at most that many px.
Picture shrink(const Picture& picture, int longest);
Plane shrink_mask(const Plane& mask, int width, int height);

/// Files in a folder whose name ends like a picture's, in natural order of their names (`shot2`
/// before `shot10`); masks are left out. Kinds that load_picture() does not know are among them, so
/// that it is said.
std::vector<std::filesystem::path> pictures_in(const std::filesystem::path& folder);

}  // namespace prehend::recognition
